"""Tolerance zones of ISO 1101 about derived features: how wide one has to be.

Source: ISO 1101 (zones); smallest enclosing zone by cutting planes (Kelley 1960).
"""

from __future__ import annotations

import numpy as np

from vmach.features.association.associate import RANK
from vmach.features.association.linear_program import solve
from vmach.features.datum_system import DatumSystem
from vmach.features.derived import DerivedPoints
from vmach.features.measure import Measure

__all__ = ["across_axis", "along", "derived_zone", "everywhere"]

#: a zone is found when the largest distance is within this of its bound, mm
_CLOSE_MM = 1e-10
_CUTS = 200


def across_axis(axis: np.ndarray) -> np.ndarray:
    """Projection for a cylindrical zone, (3, 3): what is normal to the axis counts."""
    return np.eye(3) - np.outer(axis, axis)


def along(direction: np.ndarray) -> np.ndarray:
    """Projection for a zone between two planes, (3, 3): what is along their normal counts."""
    return np.outer(direction, direction)


def everywhere() -> np.ndarray:
    """Projection for a spherical zone, (3, 3)."""
    return np.eye(3)


def derived_zone(
    derived: DerivedPoints,
    nominal_mm: np.ndarray,
    projection: np.ndarray,
    system: DatumSystem,
    basis: np.ndarray,
) -> Measure:
    """Width or diameter of the smallest zone about nominal places that holds derived points.

    Parameters
    ----------
    derived : DerivedPoints
        S points.
    nominal_mm : (S, 3) array
        A nominal place of each: any point of its axis, the centre.
    projection : (S, 3, 3) array
        What of the distance counts.
    system : DatumSystem
        Frame that the zone stands in.
    basis : (6, F) array
        Motions of the zone that are allowed, about `system.about_mm`.
    """
    seen = system.pose.undo(derived.points_mm)
    apart = np.einsum("sij,sj->si", projection, seen - nominal_mm)
    motions = np.einsum("sij,sjk->sik", projection, _point_motions(seen - system.about_mm) @ basis)
    half, push = _smallest(apart, motions)
    rows, weight = [system.rows], [-_motion_push(push, seen - system.about_mm) @ system.gain]
    world = push @ system.pose.turn.T
    for vector, own, gain in zip(world, derived.rows, derived.gain, strict=True):
        if vector.any():
            rows.append(own)
            weight.append(vector @ gain)
    return Measure(2.0 * half, np.concatenate(rows), 2.0 * np.concatenate(weight))


def _point_motions(arm: np.ndarray) -> np.ndarray:
    """Motion of points at `arm` (S, 3) by unit shifts and turns, (S, 3, 6)."""
    x, y, z = arm.T
    zero = np.zeros_like(x)
    turn = np.array([[zero, z, -y], [-z, zero, x], [y, -x, zero]]).transpose(2, 0, 1)
    return np.concatenate([np.broadcast_to(np.eye(3), turn.shape), turn], axis=2)


def _motion_push(push: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Change of the half width with a motion of the points, (6,)."""
    return np.concatenate([push.sum(axis=0), np.cross(arm, push).sum(axis=0)])


def _smallest(apart: np.ndarray, motions: np.ndarray) -> tuple[float, np.ndarray]:
    """Least largest length of ``apart - motions y``, and its change with each `apart`, (S, 3)."""
    count = len(apart)
    table = motions.reshape(3 * count, -1)
    if table.shape[1]:
        _, size, right = np.linalg.svd(table, full_matrices=False)
        kept = right[size > RANK * max(size.max(initial=0.0), 1.0)].T
        motions = motions @ kept
    push = np.zeros_like(apart)
    if not motions.shape[2]:
        length = np.linalg.norm(apart, axis=1)
        worst = int(length.argmax())
        push[worst] = apart[worst] / max(length[worst], 1e-300)
        return float(length[worst]), push
    return _by_cuts(apart, motions, push)


def _by_cuts(apart: np.ndarray, motions: np.ndarray, push: np.ndarray):
    """Bound every length by its components in the directions where it was too long so far."""
    free = motions.shape[2]
    which, direction = [], []
    y, bound, weight = np.zeros(free), -1.0, np.empty(0)
    for _ in range(_CUTS):
        left = apart - motions @ y
        length = np.linalg.norm(left, axis=1)
        if length.max() <= max(bound, 0.0) + _CLOSE_MM:
            break
        long = np.flatnonzero(length > (0.5 * length.max() if bound < 0.0 else bound))
        which += long.tolist()
        unit = left[long] / np.maximum(length[long], 1e-300)[:, None]
        direction += unit.tolist()
        if bound < 0.0:  # from both sides at first, so that the program has a bottom
            which += long.tolist()
            direction += (-unit).tolist()
        u, s = np.array(direction), np.array(which)
        rows = np.hstack([np.einsum("ci,cik->ck", u, motions[s]), np.ones((len(u), 1))])
        limit = np.r_[np.full(free, 20.0 * max(float(np.abs(apart).max()), 1e-9)), np.inf]
        found = solve(np.r_[np.zeros(free), 1.0], rows, np.einsum("ci,ci->c", u, apart[s]), limit)
        y, bound, weight = found.x[:free], float(found.x[free]), found.weight
    if len(weight):
        np.add.at(push, np.array(which)[: len(weight)],
                  weight[:, None] * np.array(direction)[: len(weight)])  # fmt: skip
    return float(np.linalg.norm(apart - motions @ y, axis=1).max()), push
