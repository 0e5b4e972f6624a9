"""Arcs whose end and centre are rounded: the centre or radius that keeps them best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from vmach.program_text.blocks.pieces import circle_through

__all__ = ["ArcFit", "WantedArc", "best_centre", "best_radius", "chord_miss"]

#: rounded centres that are tried, steps from the nearest
_TRIES = np.array(list(product((-2, -1, 0, 1, 2), repeat=2)), float)
#: places along an arc at which it is compared with the wanted one
_SHARES = np.array([0.25, 0.5, 0.75])
#: an arc that is written turns by no more, and by about as much as the wanted one
_LARGEST_SWEEP_RAD = np.radians(190.0)
_SWEEP_SLACK_RAD = 0.3
#: with R, arcs this near to a half circle have no certain centre
_UNCERTAIN_RAD = np.radians(170.0)


@dataclass(frozen=True)
class WantedArc:
    """Three points of an arc in its plane; program units.

    Attributes
    ----------
    begin, middle, end : (2,) float64
        Wanted.
    start, stop : (2,) float64
        Where the tool really is before the arc and after it.
    """

    begin: np.ndarray
    middle: np.ndarray
    end: np.ndarray
    start: np.ndarray
    stop: np.ndarray

    @property
    def centre(self) -> np.ndarray | None:
        """Of the circle through the three points, (3,) mm; None where they are in line."""
        return circle_through(self.begin, self.middle, self.end)

    @property
    def is_counter_clockwise(self) -> bool:
        """Sense from first over second axis."""
        first, second = self.middle - self.begin, self.end - self.middle
        return bool(first[0] * second[1] - first[1] * second[0] > 0.0)


@dataclass(frozen=True)
class ArcFit:
    """A way to write an arc.

    Attributes
    ----------
    value : (2,) float64 or float
        Centre in the numbers of the words, or the radius.
    miss : float
        Largest distance from the wanted arc, program units.
    """

    value: np.ndarray | float
    miss: float


def best_centre(
    arc: WantedArc, origin: np.ndarray, step: float, accepts: Callable[[float, float], bool]
) -> ArcFit | None:
    """The rounded centre whose arc is nearest to the wanted one.

    Parameters
    ----------
    arc : WantedArc
    origin : (2,) float64
        Where the words of the centre count from.
    step : float
        Resolution of the words.
    accepts : callable
        Whether the control accepts radii at start and end.
    """
    centre = arc.centre
    if centre is None:
        return None
    values = np.round((centre - origin) / step) * step + step * _TRIES
    centres = origin + values
    misses = _misses(arc, centre, centres)
    first, last = (np.linalg.norm(p - centres, axis=1) for p in (arc.start, arc.stop))
    # controls differ in what they do with unlike radii: half their difference counts as well
    badness = np.maximum(misses, 0.5 * np.abs(first - last))
    for index in np.argsort(badness, kind="stable"):
        if not np.isfinite(misses[index]):
            return None
        if accepts(float(first[index]), float(last[index])):
            return ArcFit(values[index], float(misses[index]))
    return None


def best_radius(arc: WantedArc, step: float) -> ArcFit | None:
    """The rounded radius, negative for more than half a circle; None where none is certain."""
    centre = arc.centre
    if centre is None:
        return None
    sweep = _sweep(arc, centre[None], arc.end)[0]
    if sweep > _UNCERTAIN_RAD:
        return None
    radius = float(np.linalg.norm(arc.begin - centre))
    near = round(radius / step) * step
    fits = []
    for value in (near, near - step, near + step):
        found = _centre_of_radius(arc, value)
        if found is not None:
            fits.append(ArcFit(value, float(_misses(arc, centre, found[None])[0])))
    return min(fits, key=lambda fit: fit.miss, default=None)


def chord_miss(arc: WantedArc) -> float:
    """Distance of the wanted middle from the straight line to the written end."""
    along = arc.stop - arc.start
    length = float(np.linalg.norm(along))
    out = arc.middle - arc.start
    if length == 0.0:
        return float(np.linalg.norm(out))
    return float(abs(along[0] * out[1] - along[1] * out[0]) / length)


def _misses(arc: WantedArc, centre: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Largest distance of the arcs about `centres` from the circle about `centre`, (K,)."""
    sense = 1.0 if arc.is_counter_clockwise else -1.0
    out, last = arc.start - centres, arc.stop - centres
    radii = np.linalg.norm(out, axis=1), np.linalg.norm(last, axis=1)
    sweep, wanted = _sweep(arc, centres, arc.stop), _sweep(arc, centre[None], arc.end)[0]
    angle = np.arctan2(out[:, 1], out[:, 0])[:, None] + sense * _SHARES * sweep[:, None]
    radius = radii[0][:, None] + _SHARES * (radii[1] - radii[0])[:, None]
    points = centres[:, None] + radius[..., None] * np.stack([np.cos(angle), np.sin(angle)], -1)
    off = np.abs(np.linalg.norm(points - centre, axis=-1) - np.linalg.norm(arc.begin - centre))
    wild = (sweep > _LARGEST_SWEEP_RAD) | (np.abs(sweep - wanted) > _SWEEP_SLACK_RAD)
    return np.where(wild, np.inf, off.max(axis=1))


def _sweep(arc: WantedArc, centres: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Angle from start to `stop` about every centre in the arc's sense, (K,) rad."""
    first, last = arc.start - centres, stop - centres
    cross = first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0]
    angle = np.arctan2(cross, (first * last).sum(axis=1))
    return np.mod(angle if arc.is_counter_clockwise else -angle, 2.0 * np.pi)


def _centre_of_radius(arc: WantedArc, radius: float) -> np.ndarray | None:
    """Centre of the shorter arc of this radius, as a control finds it."""
    chord = arc.stop - arc.start
    half = 0.5 * float(np.linalg.norm(chord))
    if half == 0.0 or half >= radius:
        return None
    left = np.array([-chord[1], chord[0]]) / (2.0 * half)
    away = np.sqrt(radius**2 - half**2) * (1.0 if arc.is_counter_clockwise else -1.0)
    return arc.start + 0.5 * chord + away * left
