"""Collisions against set operations on solids, move after move."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from manifold3d import Manifold

from stock import find_collisions, make_tool
from tests.stock_solid_cases import polyline

LOW, HIGH = (-15.0, -15.0, -30.0), (15.0, 15.0, 0.0)
FLUTE, SHANK = [(3.0, 0.0), (3.0, 6.0)], [(2.5, 6.0), (2.5, 40.0)]
HOLDER = [(6.0, 14.0), (9.0, 20.0), (9.0, 60.0)]


def swept(outline, start, end) -> Manifold:
    angles = 2 * np.pi * np.arange(96) / 96
    body = np.concatenate(
        [
            np.column_stack([r * np.cos(angles), r * np.sin(angles), 0 * angles + z])
            for r, z in outline
        ]
    )
    return Manifold.hull_points(np.concatenate([start + body, end + body]))


def widest(solid: Manifold) -> float:
    """Height of the tallest piece that is wider than a cell; 0 where there is none."""
    boxes = [np.reshape(piece.bounding_box(), (2, 3)) for piece in solid.decompose()]
    spans = [high - low for low, high in boxes]
    return max((s[2] for s in spans if min(s[0], s[1]) > 0.6), default=0.0)


@pytest.mark.parametrize("seed", range(6))
def test_same_moves_as_solids(seed):
    rng = np.random.default_rng(seed)
    path = np.column_stack([rng.uniform(-14, 14, (16, 2)), rng.uniform(-16, 1, 16)])
    rapid = np.arange(2, 15, 3)
    found = find_collisions(
        polyline(path),
        [make_tool("flat", diameter_mm=6.0, length_mm=6.0)],
        (LOW, HIGH),
        rapid_moves=rapid,
        shanks=[SHANK],
        holders=[HOLDER],
        cell_mm=0.25,
    )
    depth = {(c.move, c.kind): c.depth_mm for c in found}
    stock = Manifold.cube(tuple(np.subtract(HIGH, LOW))).translate(LOW)
    sure = free = 0
    for move, (start, end) in enumerate(pairwise(path)):
        flutes = swept(FLUTE, start, end)
        after = stock - flutes
        bodies = {"shank": swept(SHANK, start, end), "holder": swept(HOLDER, start, end)}
        certain = {kind: after ^ body for kind, body in bodies.items()}
        if move in rapid:
            bodies["rapid in material"] = flutes
            certain["rapid in material"] = stock ^ flutes
        for kind, body in bodies.items():
            if (stock ^ body).volume() < 1e-6:
                assert (move, kind) not in depth
                free += 1
            elif widest(certain[kind]) > 1.0:
                assert depth.get((move, kind), 0.0) > 0.0, (move, kind)
                sure += 1
        stock = after
    assert sure >= 5
    assert free >= 5
