"""Points near the edges of faces that are narrow somewhere, and what such points count."""

import numpy as np
import pytest

from vmach.nominal.frame import Frame
from vmach.nominal.part import Mesh, NominalPart
from vmach.nominal.surfaces.elementary import Cylinder, Plane, Torus
from vmach.nominal.surfaces.face import SurfaceFace
from vmach.nominal.surfaces.trimming import Trim
from vmach.report import Column, column_statistics

WORLD = Frame(np.zeros(3), np.eye(3))
MARGIN_MM = 0.1


def face(surface, loops, area_mm2):
    """A face whose edges, (N, 2) u and v each, have it on their left."""
    lines = [surface.evaluate(np.asarray(loop, float)) for loop in loops]
    return SurfaceFace("face", surface.kind, Trim.from_polylines(surface, lines), 1.0, area_mm2)


def closed(corners):
    return [*corners, corners[0]]


def sampled(one, spacing_mm):
    points, _, weight = one.sample(spacing_mm, MARGIN_MM)
    return points, weight


@pytest.mark.parametrize("spacing_mm", [2.0, 5.0, 20.0])
@pytest.mark.parametrize("share", [0.3, 0.9, 1.4, 1.6, 2.0, 2.4])
def test_a_strip_has_rows_near_both_edges_and_one_between(spacing_mm, share):
    """Of every width below 2.5 spacings; wider ones have three even rows."""
    wide, long = share * spacing_mm, 12.0 * spacing_mm
    for corners, across in (
        ([(0, 0), (long, 0), (long, wide), (0, wide)], 1),
        ([(0, 0), (wide, 0), (wide, long), (0, long)], 0),
    ):
        points, weight = sampled(face(Plane(WORLD), [closed(corners)], wide * long), spacing_mm)
        place = points[:, across]
        along = points[:, 1 - across]
        for row in (place < 2.0 * MARGIN_MM, place > wide - 2.0 * MARGIN_MM):
            assert np.diff(np.sort(np.r_[0.0, along[row], long])).max() <= 1.5 * spacing_mm
        assert ((place > 2.0 * MARGIN_MM) & (place < wide - 2.0 * MARGIN_MM)).sum() >= 10
        # what the points stand for is the area, at an even point for each square
        assert weight.sum() == pytest.approx(round(share) * 12 if share > 1 else 12)
    points, weight = sampled(
        face(Plane(WORLD), [closed([(0, 0), (24, 0), (24, 16), (0, 16)])], 384.0), 2.0
    )
    assert len(points) == 96 and (weight == 1.0).all()


def test_a_tongue_of_a_wide_face_has_rows_near_its_edges():
    """40 x 40 mm with tongues of 3 x 20 mm in X and in Y: wide on the whole, narrow there."""
    corners = [(0, 0), (40, 0), (40, 10), (60, 10), (60, 13), (40, 13),
               (40, 40), (23, 40), (23, 60), (20, 60), (20, 40), (0, 40)]  # fmt: skip
    points, _ = sampled(face(Plane(WORLD), [closed(corners)], 1720.0), 2.0)
    x, y, _ = points.T
    for tongue, place in (((x > 41) & (x < 59), y - 10.0), ((y > 41) & (y < 59), x - 20.0)):
        assert (tongue & (place < 0.2)).sum() >= 8
        assert (tongue & (place > 2.8)).sum() >= 8
        assert (tongue & (place > 0.2) & (place < 2.8)).sum() >= 8
    # the wide part keeps its even points
    inside = (x < 38) & (y < 38)
    assert inside.sum() == pytest.approx(38 * 38 / 4, rel=0.1)


def circle(v, *, forward):
    u = np.linspace(0.0, 2.0 * np.pi, 65)
    return np.column_stack([u if forward else u[::-1], np.full(65, v)])


def test_a_low_band_round_a_cylinder_has_three_rows():
    surface = Cylinder(WORLD, 10.0)
    loops = [circle(0.0, forward=True), circle(1.5, forward=False)]
    points, weight = sampled(face(surface, loops, 30.0 * np.pi), 2.0)
    for row in (points[:, 2] < 0.2, np.abs(points[:, 2] - 0.75) < 0.3, points[:, 2] > 1.3):
        assert row.sum() >= 20
    assert weight.sum() == pytest.approx(31)


@pytest.mark.parametrize("begin", [0.0, 1.0, 3.0, 6.0])
def test_a_small_fillet_round_a_torus_is_filled_as_any_face(begin):
    """A quarter of a tube of 0.5 mm, wherever it begins around the tube, over the seam too."""
    surface, end = Torus(WORLD, 10.0, 0.5), begin + np.pi / 2.0
    loops = [circle(begin, forward=True), circle(end, forward=False)]
    one = face(surface, loops, 50.0)
    low, high = one.trim.v_range()
    assert np.mod(low - begin + 1.0, 2.0 * np.pi) == pytest.approx(1.0)
    assert high - low == pytest.approx(np.pi / 2.0)
    points, weight = sampled(one, 2.0)
    v = np.mod(surface.parameters(points)[:, 1] - begin, 2.0 * np.pi)
    assert ((v > 0.0) & (v < np.pi / 2.0)).all()
    arc_mm = 0.5 * v
    for row in (arc_mm < 0.2, np.abs(arc_mm - np.pi / 8.0) < 0.1, arc_mm > np.pi / 4.0 - 0.2):
        assert row.sum() >= 20
    around_mm = 2.0 * np.pi * (10.0 + 0.5 * np.cos(begin + np.pi / 4.0))
    assert weight.sum() == pytest.approx(round(around_mm / 2.0))


def test_the_whole_torus_but_a_slit_keeps_its_range():
    surface = Torus(WORLD, 10.0, 3.0)
    loops = [circle(2.2, forward=True), circle(2.0, forward=False)]
    low, high = face(surface, loops, 1000.0).trim.v_range()
    assert (low, high - low) == (pytest.approx(2.2), pytest.approx(2.0 * np.pi - 0.2))


def test_points_along_edges_share_what_even_points_stand_for():
    """The mean over a strip is that of its even points, the worst value that of all."""
    corners = closed([(0, 0), (40, 0), (40, 3), (0, 3)])
    part = NominalPart(
        None, (face(Plane(WORLD), [corners], 120.0),), Mesh([[0, 0, 0]], [[0, 0, 0]], [0]), 0.0, 0.0
    )
    points = part.sample(2.0, edge_margin_mm=MARGIN_MM)
    assert points.weight.sum() == pytest.approx(40)
    deviation = points.point_mm[:, 1] - 1.5  # odd over the strip
    column = Column("v", "V", deviation, np.full(len(points), "cut"), weight=points.weight)
    figures = column_statistics(column, 1.0)
    assert figures.mean_mm == pytest.approx(0.0, abs=1e-12)
    assert figures.max_mm > 1.3
    assert figures.outside_count == (np.abs(deviation) > 1.0).sum()
    assert figures.outside_share == pytest.approx(0.5)  # of the points; not two thirds
