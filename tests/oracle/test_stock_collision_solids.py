"""Collisions against set operations on solids, move after move."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from manifold3d import Manifold

from stock import find_collisions, make_tool
from stock.collision import collision
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


def test_very_many_short_moves_collide_as_the_long_ones_do(monkeypatch):
    """Every move in 200 parts, which are followed as one: the same contacts, of a part nearby."""
    rng = np.random.default_rng(7)
    path = np.column_stack([rng.uniform(-14, 14, (16, 2)), rng.uniform(-16, 1, 16)])
    parts, rapid = 200, np.arange(2, 15, 3)
    fine = np.concatenate([np.linspace(a, b, parts, endpoint=False) for a, b in pairwise(path)])
    fine = np.vstack([fine, path[-1]])
    bodies = {"shanks": [SHANK], "holders": [HOLDER], "cell_mm": 0.25}
    tools = [make_tool("flat", diameter_mm=6.0, length_mm=6.0)]
    whole = find_collisions(polyline(path), tools, (LOW, HIGH), rapid_moves=rapid, **bodies)
    monkeypatch.setattr(collision, "_FEW_STROKES", 100)
    of_parts = (rapid[:, None] * parts + np.arange(parts)).ravel()
    found = find_collisions(polyline(fine), tools, (LOW, HIGH), rapid_moves=of_parts, **bodies)
    assert {(c.move // parts, c.kind) for c in found} == {(c.move, c.kind) for c in whole}
    assert len(found) < 3 * len(whole)
    depth = {(c.move, c.kind): c.depth_mm for c in whole}
    for c in found:
        assert c.depth_mm == pytest.approx(depth[c.move // parts, c.kind], abs=0.5)
        reach = 9.0 if c.kind == "holder" else 3.0
        assert np.linalg.norm(fine[c.move, :2] - c.place_mm[:2]) < reach + 0.5
