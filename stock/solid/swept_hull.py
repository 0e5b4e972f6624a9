"""Points whose hull is what one stroke of a tool removes beyond its neighbours in the path.

A convex tool K that goes straight sweeps the hull of K at both ends. Most of that hull's caps
lie inside the neighbouring strokes, so a stroke keeps only

* the silhouette of K in its own direction, at both ends (the prism between them),
* at the start, the silhouette in the direction of the stroke before, and the part of K that
  looks forward for the stroke before but backward for this one (the outside of the corner),
* at the end the foremost point, so that neighbours overlap and do not merely touch.

Whole caps are kept where the path begins and ends. The union of these hulls equals the union of
the full ones: a tool point behind the corner lies in the stroke before, and a point in front of
the end in a stroke that follows.

Source: closed form derived here: a convex body that goes straight sweeps the hull of its two ends.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker, njit_part

__all__ = ["swept_points"]

#: rounding of an azimuth: a corner right at the edge of what looks forward counts with it
_SLACK_RAD = 1e-9
#: parts of a unit vector below this are rounding
_NOTHING = 1e-12
#: a motion is level where a flat end rises by less than this over the tool's radius, mm
_LEVEL_MM = 1e-4


@njit_maker()
def swept_points(
    rings: np.ndarray,
    azimuths: np.ndarray,
    placement: np.ndarray,
    before: np.ndarray,
    ends: np.ndarray,
) -> np.ndarray:
    """Points of one stroke.

    Parameters
    ----------
    rings : (K, 4) float64
        Radius, height and interval of normals of the rings, see `RingStack`.
    azimuths : (K,) int64
        Points on each full ring.
    placement : (4, 3) float64
        Tip at the start and at the end, mm; tilt at the start and at the end, rad.
    before : (3,) float64
        Motion of the stroke before, in any length.
    ends : (2,) bool
        The path begins, ends with this stroke.

    Returns
    -------
    (P, 3) float64
    """
    heading = _heading(placement[1] - placement[0])
    heading0 = heading if ends[0] else _heading(before)
    corners, most = 0, 0
    for number in azimuths:
        corners, most = corners + number, max(most, number)
    out = np.empty((2 * (corners + 8 * len(rings)) + 1, 3))
    angles = np.empty(most + 8)
    count = 0
    foremost, reach = 0, -np.inf
    for k in range(len(rings)):
        front, back = _view(rings[k], azimuths[k], heading)
        front0, back0 = _view(rings[k], azimuths[k], heading0)
        advance = rings[k, 0] * heading[1] + rings[k, 1] * heading[2]
        if advance > reach:
            foremost, reach = k, advance
        angle_count = azimuths[k]
        for j in range(angle_count):
            angles[j] = 2 * np.pi * j / azimuths[k]
        on_axis = rings[k, 0] == 0.0
        if not on_axis:
            for sign in (-1.0, 1.0):
                angles[angle_count] = heading[0] + sign * front
                angles[angle_count + 1] = heading[0] + sign * back
                angles[angle_count + 2] = heading0[0] + sign * front0
                angles[angle_count + 3] = heading0[0] + sign * back0
                angle_count += 4
        for j in range(angle_count):
            off, off0 = _apart(angles[j], heading[0]), _apart(angles[j], heading0[0])
            forward, backward = off <= front + _SLACK_RAD, off >= back - _SLACK_RAD
            forward0, backward0 = off0 <= front0 + _SLACK_RAD, off0 >= back0 - _SLACK_RAD
            both = on_axis or (forward and backward)
            corner = forward0 and (backward or backward0)
            if both or corner or (ends[0] and backward):
                _place(out[count], rings[k], angles[j], placement[0], placement[2])
                count += 1
            if both or (ends[1] and forward):
                _place(out[count], rings[k], angles[j], placement[1], placement[3])
                count += 1
    _place(out[count], rings[foremost], heading[0], placement[1], placement[3])
    return out[: count + 1]


@njit_part()
def _heading(step: np.ndarray) -> tuple[float, float, float]:
    """Azimuth, level and rising part of the unit vector along `step`; +X where it is zero."""
    length = np.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2)
    if length == 0.0:
        return 0.0, 1.0, 0.0
    return np.arctan2(step[1], step[0]), np.hypot(step[0], step[1]) / length, step[2] / length


@njit_part()
def _view(
    ring: np.ndarray, azimuths: int, heading: tuple[float, float, float]
) -> tuple[float, float]:
    """Largest angle off the heading's azimuth that looks forward, smallest that looks back.

    Flat ends have no side in a level motion: the walls alone decide. Angles closer than the
    ring's own corners become one, that of the upper facet, which may be a wall.
    """
    lo, hi = ring[2], ring[3]
    if ring[0] * abs(heading[2]) <= _LEVEL_MM:
        if lo == 0.0:
            lo = hi
        elif hi == np.pi:
            hi = lo
    below = _half_front(lo, heading[1], heading[2])
    above = _half_front(hi, heading[1], heading[2])
    if abs(above - below) * azimuths < 2 * np.pi:
        return above, above
    return max(below, above), min(below, above)


@njit_part()
def _half_front(inclination: float, level: float, rise: float) -> float:
    """Half the azimuth range around the motion in which one inclination looks forward.

    The normal (sin i cos a, sin i sin a, -cos i) looks forward along (level, 0, rise) where
    sin i cos a level >= cos i rise. Walls that slide along themselves, in a vertical motion,
    look forward on one half, as if the motion were level by next to nothing.
    """
    side, lift = np.sin(inclination) * level, np.cos(inclination) * rise
    if side < _NOTHING and abs(lift) < _NOTHING:
        return np.pi / 2
    if lift <= -side:
        return np.pi
    return 0.0 if lift >= side else np.arccos(lift / side)


@njit_part()
def _apart(a: float, b: float) -> float:
    """Angle between two azimuths, 0 to pi."""
    turn = abs(a - b) % (2 * np.pi)
    return min(turn, 2 * np.pi - turn)


@njit_part()
def _place(
    out: np.ndarray, ring: np.ndarray, azimuth: float, tip: np.ndarray, tilt: np.ndarray
) -> None:
    """Write the point c of a ring where the tool carries it: tip + c + tilt x c."""
    x, y, z = ring[0] * np.cos(azimuth), ring[0] * np.sin(azimuth), ring[1]
    out[0] = tip[0] + x + tilt[1] * z - tilt[2] * y
    out[1] = tip[1] + y + tilt[2] * x - tilt[0] * z
    out[2] = tip[2] + z + tilt[0] * y - tilt[1] * x
