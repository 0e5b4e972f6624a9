"""The first-order displacement as one compiled loop over the states.

All curves of an axis share one list of breaks, so that a state looks its piece up once an axis
and then evaluates up to six cubics. `vmach.machine.displacement.contributions` says the same in
plain NumPy, component by component; tests hold the two against each other.

Source: the equations of `vmach.machine.displacement`; nothing else is stated here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from stock.threads import run_in_parts
from vmach.machine.component_errors import component_of
from vmach.machine.machine import Machine

__all__ = ["AxisCurves", "CompiledErrors", "compile_errors", "displace"]

_BUCKETS_PER_BREAK = 4  #: so that mostly the first piece looked at is the right one
_MEAN = 0  #: then forward, backward: the order of `ComponentError.curves`


@dataclass(frozen=True)
class AxisCurves:
    """The six component errors of one axis on common breaks, signs applied.

    Attributes
    ----------
    breaks : (K,) float64
    origins : (K + 1,) float64
    coefficients : (3, K + 1, 6, D) float64
        Mean, forward, backward; piece; EX EY EZ EA EB EC; power of the local coordinate, as many
        as the curves need.
    buckets : (B + 1,) int64
        Piece at the start of each of B equal stretches between the first and the last break, so
        that finding a piece takes the same time however many there are.
    """

    breaks: np.ndarray
    origins: np.ndarray
    coefficients: np.ndarray
    buckets: np.ndarray


@dataclass(frozen=True)
class CompiledErrors:
    """Curves of X, Y, Z, and the constants of the chain."""

    axes: tuple[AxisCurves, AxisCurves, AxisCurves]
    arm_masks: np.ndarray
    squareness_rad: np.ndarray


def compile_errors(machine: Machine) -> CompiledErrors:
    """Bring a machine's curves into the form of the kernel."""
    curves = tuple(_axis_curves(machine, axis) for axis in "XYZ")
    across = machine.squareness_rad * (1.0 - np.eye(3))
    return CompiledErrors(curves, machine.chain.arm_masks, across)


def _axis_curves(machine: Machine, axis: str) -> AxisCurves:
    mine = {name: c for name, c in machine.components.items() if name[2] == axis}
    parts = [curve.breaks for c in mine.values() for curve in c.curves]
    breaks = np.unique(np.concatenate(parts)) if parts else np.array([0.0, 1.0])
    coefficients = np.zeros((3, len(breaks) + 1, 6, 4))
    for name, component in mine.items():
        direction, _, angular = component_of(name)
        for way, curve in enumerate(component.curves):
            column = direction + 3 * angular
            coefficients[way, :, column] = (
                machine.component_sign(name) * curve.on(breaks).coefficients
            )
    powers = 1 + max(np.flatnonzero(np.abs(coefficients).max(axis=(0, 1, 2))), default=0)
    starts = np.linspace(breaks[0], breaks[-1], _BUCKETS_PER_BREAK * len(breaks) + 1)
    return AxisCurves(
        breaks,
        np.concatenate((breaks[:1], breaks)),
        np.ascontiguousarray(coefficients[..., :powers]),
        # one piece early: rounding may put a position into the bucket after its own
        np.maximum(np.searchsorted(breaks, starts, side="right") - 1, 0),
    )


def displace(
    errors: CompiledErrors,
    nose_mm: np.ndarray,
    tool_mm: np.ndarray,
    *,
    reference_mm: np.ndarray,
    reference_travel: np.ndarray,
    direction: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Shift and tilt of the tool by all errors.

    Parameters
    ----------
    errors : CompiledErrors
    nose_mm : (P, 3) float64
    tool_mm : (P, 3) or (1, 3) float64
    reference_mm : (3, 3, 3) float64
        Point that the arm of E_ij starts at, i direction, j axis.
    reference_travel : (3, 3) float64
        Travel of that point along axis j per mm of q_j.
    direction : (P, 3) int8 or None
        Sign of the last motion of every axis; None for the mean of both.

    Returns
    -------
    shift_mm, tilt_rad : (P, 3) float64
    """
    ways = np.zeros((1, 3), dtype=np.int8) if direction is None else direction
    shift, tilt = np.empty_like(nose_mm), np.empty_like(nose_mm)
    # arm of E_ij along k per mm of q_k; own travel of the measuring point taken off
    gains = errors.arm_masks - reference_travel[:, :, None] * np.eye(3)
    packed = tuple((c.breaks, c.origins, c.coefficients, c.buckets) for c in errors.axes)
    states, chain = (nose_mm, tool_mm, ways), (gains, reference_mm, errors.squareness_rad)
    run_in_parts(
        lambda begin, end: _loop(
            states, packed, chain, (shift, tilt), part=(begin, end), values=np.empty((3, 6))
        ),
        len(nose_mm),
    )
    return shift, tilt


@njit(cache=True, inline="always")
def _piece(x, breaks, buckets):
    """Number of breaks at or below x."""
    last = len(breaks)
    if x < breaks[0]:
        return 0
    if x >= breaks[last - 1]:
        return last
    share = (x - breaks[0]) / (breaks[last - 1] - breaks[0])
    k = buckets[int(share * (len(buckets) - 1))]
    while breaks[k] <= x:
        k += 1
    return k


@njit(cache=True, inline="always")
def _axis(x, way, curves, values):
    """The six errors of one axis at x."""
    breaks, origins, coefficients, buckets = curves
    k = _piece(x, breaks, buckets)
    h = x - origins[k]
    top = coefficients.shape[3] - 1
    for n in range(6):
        value = coefficients[way, k, n, top]
        for power in range(top - 1, -1, -1):
            value = value * h + coefficients[way, k, n, power]
        values[n] = value


@njit(cache=True, inline="always")
def _way(sign):
    """Index of the curve: mean, forward or backward."""
    return 1 if sign > 0 else (2 if sign < 0 else _MEAN)


@njit(cache=True, nogil=True, error_model="numpy", _nrt=False)
def _loop(states, curves, chain, found, part, values):
    """Shift and tilt of the states from part[0] to part[1]."""
    nose, tool, ways = states
    gains, reference, sigma = chain
    shift, tilt = found
    for p in range(part[0], part[1]):
        q = nose[p]
        t = tool[p] if len(tool) > 1 else tool[0]
        way = ways[p] if len(ways) > 1 else ways[0]
        _axis(q[0], _way(way[0]), curves[0], values[0])
        _axis(q[1], _way(way[1]), curves[1], values[1])
        _axis(q[2], _way(way[2]), curves[2], values[2])
        _add_up(q, t, values, gains, reference, sigma, shift[p], tilt[p])


@njit(cache=True, inline="always")
def _add_up(q, t, values, gains, reference, sigma, shift, tilt):
    """Shift and tilt at one state."""
    for i in range(3):
        b, c = (i + 1) % 3, (i + 2) % 3
        # sigma_j x e_j along i: only axes across i lean towards it
        e = q[c] * sigma[c, b] - q[b] * sigma[b, c]
        w = 0.0
        for j in range(3):
            arm_b = t[b] + gains[i, j, b] * q[b] - reference[i, j, b]
            arm_c = t[c] + gains[i, j, c] * q[c] - reference[i, j, c]
            e += values[j, i] + values[j, 3 + b] * arm_c - values[j, 3 + c] * arm_b
            w += values[j, 3 + i]
        shift[i] = e
        tilt[i] = w
