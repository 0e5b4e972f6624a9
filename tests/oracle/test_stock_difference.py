"""Differences of two solids against closed forms, and against brute force over all triangles."""

import numpy as np
import pytest
import trimesh

from stock.solid.difference import Surface, find_differences


def surface(mesh):
    return Surface(np.array(mesh.vertices), np.array(mesh.faces))


def box(size, at):
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(np.add(at, np.divide(size, 2.0)))
    return mesh


PLATE = box((60, 40, 10), (0, 0, 0))


def united(*meshes):
    return surface(trimesh.boolean.union(meshes, engine="manifold"))


def without(mesh, *cutters):
    return surface(trimesh.boolean.difference([mesh, *cutters], engine="manifold"))


def test_equal_solids_do_not_differ():
    assert find_differences(surface(PLATE), surface(PLATE), 0.01) == []


def test_less_than_the_threshold_does_not_count():
    assert find_differences(surface(PLATE), surface(box((60, 40, 10.09), (0, 0, 0))), 0.1) == []


@pytest.mark.parametrize("wide", [0.5, 3.0])
def test_a_rib_that_was_cut_away_is_one_gouge(wide):
    nominal = united(PLATE, box((wide, 20, 4), (30, 10, 9)))
    (found,) = find_differences(surface(PLATE), nominal, 0.1)
    assert found.depth_mm == pytest.approx(-3.0, abs=1e-9)
    assert found.point_mm[2] == pytest.approx(13.0)
    assert found.high_mm - found.low_mm == pytest.approx([wide, 20, 3], abs=1.0)
    # two long sides, two short ones and the top, less what is within the threshold
    area = 2 * 3 * (wide + 20) + wide * 20
    assert found.area_mm2 == pytest.approx(area, rel=0.15)


def test_a_hole_that_is_missing_is_one_excess():
    hole = trimesh.creation.cylinder(2.0, 30.0, sections=64)
    hole.apply_translation((20, 20, 0))
    (found,) = find_differences(surface(PLATE), without(PLATE, hole), 0.1)
    # the middle of its wall is 5 mm from either side of the plate
    assert found.depth_mm == pytest.approx(5.0, rel=0.02)
    assert found.volume_mm3 == pytest.approx(np.pi * 2.0**2 * 10.0, rel=0.01)


def chamfered(size):
    """A wedge of the given leg along the upper edge at x = 0."""
    leg = np.array([[-1, -1, 10 - size - 1], [size + 1, -1, 11], [-1, -1, 11]], float)
    both = np.vstack([leg, np.add(leg, [0, 42, 0])])
    return without(PLATE, trimesh.convex.convex_hull(both))


def test_a_chamfer_cut_too_small_is_seen_on_its_narrow_face():
    # legs of 1 mm wanted, of 0.5 mm cut: 0.5/sqrt(2) mm are left, on a face 1.41 mm wide
    (found,) = find_differences(chamfered(0.5), chamfered(1.0), 0.1)
    assert found.depth_mm == pytest.approx(0.5 / np.sqrt(2.0), rel=1e-6)
    assert found.high_mm[1] - found.low_mm[1] == pytest.approx(40.0, abs=1.0)
    assert found.low_mm[2] >= 9.0 - 1e-9
    assert found.high_mm[0] <= 1.0 + 1e-9


def test_places_apart_are_listed_apart_deepest_first():
    part = without(PLATE, box((4, 4, 1), (5, 5, 9.7)), box((4, 4, 1), (50, 30, 9.5)))
    found = find_differences(part, surface(PLATE), 0.1)
    assert [one.depth_mm for one in found] == pytest.approx([-0.5, -0.3])
    assert [one.area_mm2 for one in found] == pytest.approx([18, 18], rel=0.6)


def test_the_side_and_the_depth_are_those_of_brute_force():
    rng = np.random.default_rng(3)
    ball = trimesh.creation.icosphere(subdivisions=2, radius=6.0)
    part = trimesh.boolean.difference(
        [PLATE, ball.apply_translation((30, 20, 12))], engine="manifold"
    )
    (found,) = find_differences(surface(part), surface(PLATE), 0.1)
    grid = rng.uniform((24, 14, 6), (36, 26, 10), (4000, 3))
    depth = np.where(np.linalg.norm(grid - (30, 20, 12), axis=1) < 6.0, 10.0 - grid[:, 2], 0.0)
    assert found.depth_mm < 0
    assert -found.depth_mm == pytest.approx(depth.max(), rel=0.08)


def test_the_answer_is_the_same_bit_by_bit():
    nominal = united(PLATE, box((3, 20, 4), (30, 10, 9)))
    one, other = (find_differences(surface(PLATE), nominal, 0.1) for _ in range(2))
    assert [x.depth_mm for x in one] == [x.depth_mm for x in other]
    assert [x.area_mm2 for x in one] == [x.area_mm2 for x in other]
