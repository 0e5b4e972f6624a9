"""The virtual part against full hulls of the tool at both ends of every stroke.

The part is cut with hulls that leave out what neighbouring strokes remove; here whole tools are
swept, one at a time, and a dense march of the tool's distance field looks for leftovers.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from manifold3d import Manifold, Mesh64, OpType

from stock import cut_part, make_tool
from tests.stock_solid_cases import edge_uses, polyline

START = np.array([0.0, 0.0, -3.0])
BOX = ((-15.0, -15.0, -12.0), (15.0, 15.0, 0.0))

#: name -> (tool, outline from the axis below, as fine points (r, z))
ARC = np.linspace(0, np.pi / 2, 13)
TOOLS = {
    "flat": (
        make_tool("flat", diameter_mm=6.0, length_mm=30.0),
        [(3.0, 0.0), (3.0, 30.0)],
    ),
    "ball": (
        make_tool("ball", diameter_mm=6.0, length_mm=30.0),
        [*zip(3 * np.sin(ARC), 3 - 3 * np.cos(ARC), strict=True), (3.0, 30.0)],
    ),
    "bull": (
        make_tool("bull", diameter_mm=6.0, length_mm=30.0, corner_radius_mm=1.0),
        [*zip(2 + np.sin(ARC), 1 - np.cos(ARC), strict=True), (3.0, 30.0)],
    ),
    "drill": (
        make_tool("drill", diameter_mm=6.0, length_mm=30.0, angle_deg=118.0),
        [(0.0, 0.0), (3.0, 3 / np.tan(np.radians(59))), (3.0, 30.0)],
    ),
    "short": (
        make_tool("ball", diameter_mm=6.0, length_mm=5.0),
        [*zip(3 * np.sin(ARC), 3 - 3 * np.cos(ARC), strict=True), (3.0, 5.0)],
    ),
    "profile": (
        make_tool("profile", points_mm=[(2, 0), (4, 1), (4, 3), (1, 5)]),
        [(2.0, 0.0), (4.0, 1.0), (4.0, 3.0), (1.0, 5.0)],
    ),
}


def random_path(kind: str, rng: np.random.Generator) -> np.ndarray:
    count = 24
    if kind == "long":
        return np.column_stack([rng.uniform(-12, 12, (count, 2)), rng.uniform(-6, 1, count)])
    if kind == "short":
        steps = rng.normal(size=(count, 3)) * [0.3, 0.3, 0.05]
        return np.cumsum(steps, axis=0) + START
    if kind == "grid":  # repeated places, reversals, straight up and down
        path = np.cumsum(rng.integers(-1, 2, (count, 3)) * [3, 3, 1.0], axis=0)
        return np.clip(path + START, [-12, -12, -8], [12, 12, 1])
    if kind == "plunges":
        places = np.column_stack([rng.uniform(-12, 12, (count // 3, 2)), np.full(count // 3, -4)])
        path = np.repeat(places, 3, axis=0)
        path[::3, 2], path[2::3, 2] = 1.0, 1.0
        return path
    angle = np.linspace(0, 12, count)
    return np.column_stack([8 * np.cos(angle), 8 * np.sin(angle), -angle / 3])


def part_of_full_hulls(path, tilt, outline) -> Manifold:
    angles = 2 * np.pi * np.arange(48) / 48
    tool = np.concatenate(
        [
            np.column_stack([r * np.cos(angles), r * np.sin(angles), 0 * angles + z])
            for r, z in outline
        ]
    )
    placed = [tip + tool + np.cross(lean, tool) for tip, lean in zip(path, tilt, strict=True)]
    hulls = [Manifold.hull_points(np.concatenate(pair)) for pair in pairwise(placed)]
    size = tuple(np.subtract(BOX[1], BOX[0]))
    box = Manifold.cube(size).translate(BOX[0])
    return box - Manifold.batch_boolean(hulls, OpType.Add)


@pytest.mark.parametrize("kind", ["long", "short", "grid", "plunges", "helix"])
@pytest.mark.parametrize("name", TOOLS)
def test_same_part_as_full_hulls(name, kind):
    tool, outline = TOOLS[name]
    rng = np.random.default_rng(list(name.encode() + kind.encode()))
    path = random_path(kind, rng)
    path = path[np.append(True, np.abs(np.diff(path, axis=0)).max(axis=1) > 0)]
    tilt = rng.normal(scale=1e-5, size=path.shape)
    part = cut_part(polyline(path, tilt_rad=tilt), [tool], BOX)
    full = part_of_full_hulls(path, tilt, outline)
    assert edge_uses(part.triangles) == (0, 0)
    solid = solid_of(part)
    leftover, gone = solid - full, full - solid
    area = full.surface_area()
    assert leftover.volume() <= 4e-3 * area  # the facets of both, on average
    assert gone.volume() <= 4e-3 * area
    assert thickest(leftover) < 0.05


def solid_of(part) -> Manifold:
    return Manifold(Mesh64(np.array(part.vertices_mm), part.triangles.astype(np.uint64)))


def thickest(solid: Manifold) -> float:
    """Thickness 2 V / A of the thickest of the pieces that are more than dust."""
    pieces = [piece for piece in solid.decompose() if piece.volume() > 1e-3]
    return max((2 * piece.volume() / piece.surface_area() for piece in pieces), default=0.0)


@pytest.mark.parametrize("kind", ["long", "helix"])
def test_surface_lies_on_the_sweep_of_a_ball(kind):
    """Facets of 0.01 mm leave 0.02 mm at most where they are chords both ways."""
    path = random_path(kind, np.random.default_rng(7))
    part = cut_part(polyline(path), [TOOLS["ball"][0]], BOX, tolerance_mm=0.01)
    corners = part.vertices_mm[part.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    real = np.linalg.norm(normal, axis=1) > 1e-3 * longest  # slivers bound nothing
    weights = np.random.default_rng(8).dirichlet([1, 1, 1], (real.sum(), 2))
    points = np.einsum("tsk,tkx->tsx", weights, corners[real]).reshape(-1, 3)
    depth = ball_depth(points, path, radius=3.0)
    assert depth.max() < 0.022
    assert depth[np.repeat(part.move[real] >= 0, 2)].min() > -1e-3


def ball_depth(points: np.ndarray, path: np.ndarray, *, radius: float) -> np.ndarray:
    """Depth inside the union of all places of the ball end mill, by marching along the path."""
    depth = np.full(len(points), -np.inf)
    for start, end in pairwise(path):
        for share in np.linspace(0, 1, int(np.linalg.norm(end - start) / 0.1) + 2):
            arm = points - (start + share * (end - start))
            off = np.hypot(arm[:, 0], arm[:, 1])
            below = np.hypot(off, arm[:, 2] - radius)
            distance = np.where(arm[:, 2] < radius, below, off)
            np.maximum(depth, radius - distance, out=depth)
    return depth
