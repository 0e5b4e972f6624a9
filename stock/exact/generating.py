"""The move that was meant to make a surface point, whatever other moves did there.

The surface that a tool generates has, where it touches, the tool's own normal turned round. So
the generating place on the path is the one where the tool point with outward normal -n comes
closest to the surface point. A program that cuts into its own part somewhere still has one.

Source: closed form derived here: the tool's outward normal where it touches is -n.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, njit_part, read_only
from stock.sweeps import Sweeps
from stock.threads import run_in_parts
from stock.tools import Tool

__all__ = ["Generation", "find_generating"]

#: straight pieces that an arc is looked at in; the place found is then refined on the arc
_CHORDS = 16
#: outline points whose heights over the tangent differ by less than this are both touched
_TIE_MM = 1e-9
#: a normal with a smaller horizontal part than this is that of a floor
_FLOOR = 1e-9
#: share of a chord to which the place on it is known where it is searched for: on a chord of a
#: metre as closely as `_ALIKE_MM`
_ON_THE_WAY = 1e-12
#: chords whose tools come as close but for this are alike: the last one counts
_ALIKE_MM = 1e-9
#: points that are worth a thread, each of which looks at thousands of chords
_WORTH_A_THREAD = 8


@dataclass(frozen=True)
class Generation:
    """Generating place of P surface points.

    Attributes
    ----------
    sweep : (P,) int64
        The last of the sweeps that come closest.
    parameter : (P,) float64
        Where on it, 0 to 1.
    contact_mm : (P, 3) float64
        Tool point from the tip that generates the surface there.
    miss_mm : (P,) float64
        Distance from that tool point to the surface point, without displacement.
    """

    sweep: np.ndarray
    parameter: np.ndarray
    contact_mm: np.ndarray
    miss_mm: np.ndarray


def find_generating(
    points_mm: np.ndarray, normals: np.ndarray, *, sweeps: Sweeps, tools: Sequence[Tool]
) -> Generation:
    """Find the generating place of each surface point by looking at every sweep.

    Parameters
    ----------
    points_mm, normals : (P, 3) float64
        Nominal surface points and outward unit normals.
    sweeps : Sweeps
        Only their nominal geometry counts; not empty.
    tools : sequence of Tool
        What ``sweeps.tool`` points into.

    Notes
    -----
    The effort grows as points times sweeps: meant for few points.
    """
    pieces = np.where(sweeps.sweep_rad == 0, 1, _CHORDS)
    index = np.repeat(np.arange(len(sweeps)), pieces)
    within = np.arange(len(index)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    begin, end = within / pieces[index], (within + 1) / pieces[index]
    chords = np.stack(
        [sweeps.nominal_tip_at(index, begin), sweeps.nominal_tip_at(index, end)], axis=1
    )
    supports = np.empty((len(points_mm), len(tools), 7))
    for k, normal in enumerate(normals):
        supports[k] = [_support(tool, normal) for tool in tools]
    chord, share = _closest(points_mm, chords, supports, sweeps.tool[index])
    sweep = index[chord]
    parameter = begin[chord] + share * (end[chord] - begin[chord])
    own = supports[np.arange(len(points_mm)), sweeps.tool[sweep]]
    for k in np.flatnonzero(sweeps.sweep_rad[sweep] != 0):
        parameter[k] = _refined(points_mm[k], own[k], sweeps, sweep[k], parameter[k])
    tips = sweeps.nominal_tip_at(sweep, parameter)
    contact = np.empty((len(points_mm), 3))
    for k, offset in enumerate(points_mm - tips):
        contact[k] = _touching(offset, own[k])
    miss = np.linalg.norm(tips + contact - points_mm, axis=1)
    return Generation(sweep, parameter, contact, miss)


def _support(tool: Tool, normal: np.ndarray) -> np.ndarray:
    """Tool points with outward normal `-normal`, (7,): two ends of a segment and a flag.

    For a floor or a ceiling it is a disc: the segment leads from the axis to its rim, and the
    flag says that it may be turned about the axis.
    """
    across = math.hypot(normal[0], normal[1])
    up = -normal[2]
    if across < _FLOOR:
        corner = tool.corners[0] if up < 0 else tool.corners[-1]
        height = corner.z_mm + math.copysign(corner.radius_mm, up)
        return np.array([0.0, 0.0, height, corner.r_mm, 0.0, height, 1.0])
    azimuth = (-normal[0] / across, -normal[1] / across)
    heights = [across * c.r_mm + up * c.z_mm + c.radius_mm for c in tool.corners]
    touched = [c for c, h in zip(tool.corners, heights, strict=True) if h > max(heights) - _TIE_MM]
    ends = []
    for corner in (touched[0], touched[-1]):
        radius = corner.r_mm + corner.radius_mm * across
        ends += [radius * azimuth[0], radius * azimuth[1], corner.z_mm + corner.radius_mm * up]
    return np.array([*ends, 0.0])


def _closest(
    points_mm: np.ndarray, chords: np.ndarray, supports: np.ndarray, tool: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The last of the chords whose tools come closest to each point, and where on it.

    Parameters
    ----------
    points_mm : (P, 3) float64
    chords : (C, 2, 3) float64
    supports : (P, T, 7) float64
        Of every tool at each point.
    tool : (C,) int32
        Which of them goes along a chord.
    """
    points = read_only(np.ascontiguousarray(points_mm))
    chord, share = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
    run_in_parts(
        lambda begin, end: _closest_of_some(
            (points, supports), (chords, tool), (chord, share), begin, end
        ),
        len(points),
        least=_WORTH_A_THREAD,
    )
    return chord, share


@njit_kernel()
def _closest_of_some(surface, path, found, begin, end):
    """For points `begin` to `end`."""
    (points, supports), (chords, tool), (chord, share) = surface, path, found
    for i in range(begin, end):
        best, point = np.inf, _vector(points[i])
        for k in range(len(chords)):
            first, last = _vector(chords[k, 0]), _vector(chords[k, 1])
            enough = best + _ALIKE_MM
            distance, s = _approach(point, first, last, supports[i, tool[k]], enough)
            if distance <= enough:
                best = min(best, distance)
                chord[i], share[i] = k, s


@njit_inlined()
def _vector(a):
    return a[0], a[1], a[2]


@njit_inlined()
def _less(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit_inlined()
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit_part()
def _approach(point, start, end, support, enough):
    """Least distance of the support on the chord from the point, and where that is.

    Beyond `enough` it may be another place and its distance.
    """
    way, offset = _less(end, start), _less(point, start)
    first, last = _vector(support), _vector(support[3:])
    if support[6] == 1.0:
        return _between_disc_and_point(_less(offset, (0.0, 0.0, first[2])), way, last[0], enough)
    return _between_segments(_less(offset, first), _less(last, first), way)


@njit_part()
def _between_disc_and_point(offset, way, radius, enough):
    """The same of a level disc on its way from the origin."""
    # the point is nearest at one place seen from above, at another in height; in all, between them
    across = _share(offset[0] * way[0] + offset[1] * way[1], way[0] ** 2 + way[1] ** 2)
    upright = _share(offset[2] * way[2], way[2] ** 2) if way[2] != 0.0 else across
    across = across if way[0] != 0.0 or way[1] != 0.0 else upright
    least = math.hypot(_beside_disc(offset, way, radius, across), offset[2] - upright * way[2])
    if least > enough:
        return least, across
    low, high = min(across, upright), max(across, upright)
    while high - low > _ON_THE_WAY:  # ternary search: the distance is convex
        left, right = (2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0
        if _from_disc(offset, way, radius, left) < _from_disc(offset, way, radius, right):
            high = right
        else:
            low = left
    s = 0.5 * (low + high)
    return _from_disc(offset, way, radius, s), s


@njit_inlined()
def _share(part, whole):
    """Part of a whole, 0 to 1; 0 of nothing."""
    return min(max(part / whole, 0.0), 1.0) if whole > 0.0 else 0.0


@njit_inlined()
def _beside_disc(offset, way, radius, s):
    """How far beside a level disc at s on its way a point is, seen from above."""
    return max(math.hypot(offset[0] - s * way[0], offset[1] - s * way[1]) - radius, 0.0)


@njit_inlined()
def _from_disc(offset, way, radius, s):
    """Distance of the point from that disc."""
    return math.hypot(_beside_disc(offset, way, radius, s), offset[2] - s * way[2])


@njit_part()
def _between_segments(offset, edge, way):
    """Least of abs(offset - t edge - s way) over s and t in [0, 1], and its s."""
    best, place = np.inf, 0.0
    a, b, c = _dot(way, way), _dot(way, edge), _dot(edge, edge)
    d, e = _dot(way, offset), _dot(edge, offset)
    determinant = a * c - b * b
    for candidate in range(5):
        if candidate == 0:
            if determinant <= 1e-12 * a * c:
                continue
            s, t = (c * d - b * e) / determinant, (a * e - b * d) / determinant
            if s < 0.0 or s > 1.0 or t < 0.0 or t > 1.0:
                continue
        elif candidate <= 2:
            s = candidate - 1.0
            t = 0.0 if c == 0.0 else min(max((e - s * b) / c, 0.0), 1.0)
        else:
            t = candidate - 3.0
            s = 0.0 if a == 0.0 else min(max((d - t * b) / a, 0.0), 1.0)
        gap = _less(_less(offset, _times(t, edge)), _times(s, way))
        distance = math.sqrt(_dot(gap, gap))
        if distance < best:
            best, place = distance, s
    return best, place


@njit_inlined()
def _times(k, a):
    return k * a[0], k * a[1], k * a[2]


def _refined(
    point: np.ndarray, support: np.ndarray, sweeps: Sweeps, sweep: int, parameter: float
) -> float:
    """The parameter of the closest approach on the arc itself, by golden section."""
    ratio = (math.sqrt(5) - 1) / 2
    low, high = max(parameter - 1 / _CHORDS, 0.0), min(parameter + 1 / _CHORDS, 1.0)

    def distance(s: float) -> float:
        tip = sweeps.nominal_tip_at(np.array([sweep]), np.array([s]))[0]
        return float(np.linalg.norm(point - tip - _touching(point - tip, support)))

    while high - low > 1e-9:
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        if distance(left) < distance(right):
            high = right
        else:
            low = left
    return 0.5 * (low + high)


def _touching(offset: np.ndarray, support: np.ndarray) -> np.ndarray:
    """The point of the support, as seen from the tip, that is nearest to `offset`."""
    if support[6] == 1.0:
        across = math.hypot(offset[0], offset[1])
        share = min(support[3] / across, 1.0) if across > 0 else 0.0
        return np.array([share * offset[0], share * offset[1], support[2]])
    edge = support[3:6] - support[:3]
    length = float(edge @ edge)
    t = 0.0 if length == 0.0 else min(max(float((offset - support[:3]) @ edge) / length, 0.0), 1.0)
    return support[:3] + t * edge
