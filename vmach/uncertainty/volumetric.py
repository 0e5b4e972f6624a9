"""Monte Carlo for the volumetric accuracy of a machine.

The largest difference of two error vectors is no sum of contributions: where the corrections lie
otherwise, other points are the two worst. So every draw looks for its own pair. Only corners of
the convex hull can be among them, and few points of a grid ever are corners.

Source: JCGM 101:2008, clauses 5 to 7.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numba import njit

from stock.threads import run_in_parts
from vmach.base.stage_clock import Progress, silent
from vmach.machine import Machine, Variant
from vmach.uncertainty.corrections import Corrections, Part
from vmach.uncertainty.monte_carlo import Drawn, Plan, propagate, stage_random
from vmach.uncertainty.tables import Cause, TableUncertainty
from vmach.volumetric.farthest_pair import corners_of_hull, farthest_pair
from vmach.volumetric.field import ErrorField

__all__ = ["FIGURES", "AccuracyDrawn", "draw_accuracy"]

#: what is drawn, in this order
FIGURES = ("largest_difference", "largest_error", "range_x", "range_y", "range_z")
#: draws that tell which points can be corners, and as many that check it
_PILOTS, _CHECKS = 200, 50
#: points whose causes are looked at together; a thousand numbers each
_BATCH = 2000
#: stages with a number that no stage of the main draws has
_PILOT_STAGE, _CHECK_STAGE = 2**31, 2**31 + 1


@dataclass(frozen=True)
class AccuracyDrawn:
    """Volumetric figures under all corrections.

    Attributes
    ----------
    drawn : Drawn
        Of `FIGURES`, mm.
    stated_mm : (5,) float64
        The same figures without corrections.
    share : dict of label to float
        Of the variance of first order of the difference between the two worst points.
    candidates : int
        Points of the grid that were looked at in every draw.
    missed_mm : float
        By how much these fell short of the whole grid, in the draws that checked it.
    plan : Plan
    """

    drawn: Drawn
    stated_mm: np.ndarray
    share: dict[str, float]
    candidates: int
    missed_mm: float
    plan: Plan


def draw_accuracy(
    machine: Machine,
    field: ErrorField,
    tool_mm: np.ndarray,
    variant: Variant,
    plan: Plan,
    *,
    progress: Progress = silent,
) -> AccuracyDrawn:
    """Propagate the corrections of a machine's tables to its volumetric accuracy.

    Parameters
    ----------
    machine : Machine
    field : ErrorField
        Of this machine, tool and variant.
    tool_mm : (3,) float64
        From the spindle nose to the tip.
    variant : Variant
    plan : Plan
    progress : Progress
    """
    moving = _Moving(machine, field, tool_mm, variant)
    pilots = moving.drawn_fields(plan.seed, _PILOT_STAGE, _PILOTS)
    rows = np.unique(np.concatenate([corners_of_hull(one) for one in pilots]))
    corrections = moving.corrections(rows)
    base = field.error_mm[rows]

    def values(random: np.random.Generator, count: int) -> np.ndarray:
        moved = corrections.values_mm(corrections.draw(random, count))
        return _figures_of(base[:, :, None] + moved.reshape(len(rows), 3, count))

    drawn = propagate(values, plan, progress=lambda done, most: progress("draw", done, most))
    checks = moving.drawn_fields(plan.seed, _CHECK_STAGE, _CHECKS)
    missed = max(farthest_pair(one)[2] - farthest_pair(one[rows])[2] for one in checks)
    stated = _figures_of(np.ascontiguousarray(field.error_mm[:, :, None]))[:, 0]
    stated[0] = farthest_pair(field.error_mm)[2]
    return AccuracyDrawn(drawn, stated, moving.shares(), len(rows), max(missed, 0.0), plan)


@dataclass(frozen=True)
class _Moving:
    """The corrections of a machine at the points of a grid."""

    machine: Machine
    field: ErrorField
    tool_mm: np.ndarray
    variant: Variant

    def causes(self, rows: np.ndarray) -> Iterator[Cause]:
        if self.variant is Variant.NONE:
            return
        nose = self.field.nose_mm(rows)
        tool = np.broadcast_to(self.tool_mm, nose.shape)
        tables = TableUncertainty.of(self.machine)
        yield from tables.causes(self.machine, nose, tool, self.variant)

    def parts(self, rows: np.ndarray) -> list[Part]:
        """Signatures on the three components of every point, point by point, (3 R, Q)."""
        return [
            Part(
                cause.label,
                (cause.lever.shift_mm[:, :, None] * cause.size[:, None, :]).reshape(
                    -1, cause.size.shape[1]
                ),
                cause.pool,
            )
            for cause in self.causes(rows)
        ]

    def corrections(self, rows: np.ndarray) -> Corrections:
        return Corrections.of(self.parts(rows), 3 * len(rows))

    def drawn_fields(self, seed: int, stage: int, count: int) -> np.ndarray:
        """Error vectors of the whole grid in a few draws, (count, P, 3) mm."""
        everything = np.arange(len(self.field.error_mm))
        fields = np.repeat(self.field.error_mm[None], count, axis=0)
        for start in range(0, len(everything), _BATCH):
            rows = everything[start : start + _BATCH]
            parts = self.parts(rows)
            if not parts:
                return fields
            # all columns, so that every batch of points has the same draws
            whole = np.hstack([part.signature_mm for part in parts])
            drawn = stage_random(seed, stage).standard_normal((whole.shape[1], count))
            fields[:, rows] += (whole @ drawn).reshape(len(rows), 3, count).transpose(2, 0, 1)
        return fields

    def shares(self) -> dict[str, float]:
        """Of the variance of the difference between the two worst points, to first order."""
        first, second, size = farthest_pair(self.field.error_mm)
        pair = np.array([first, second])
        if first == second or size == 0.0:
            return {}
        error = self.field.error_mm[pair]
        along = (error[1] - error[0]) / size
        found: dict[str, float] = {}
        for part in self.parts(pair):
            apart = along @ (part.signature_mm[3:] - part.signature_mm[:3])
            found[part.label] = found.get(part.label, 0.0) + float(apart @ apart)
        total = sum(found.values())
        ranked = sorted(found.items(), key=lambda one: -one[1])
        return {label: value / total for label, value in ranked} if total else {}


def _figures_of(errors_mm: np.ndarray) -> np.ndarray:
    """`FIGURES` of M draws of C error vectors, (C, 3, M) to (5, M)."""
    errors = np.ascontiguousarray(errors_mm.transpose(2, 0, 1))
    found = np.empty((len(FIGURES), len(errors)))
    run_in_parts(
        lambda begin, end: _fill_figures(errors, (begin, end), found), len(errors), least=1
    )
    return found


@njit(cache=True, nogil=True)
def _fill_figures(errors, part, found):
    for m in range(part[0], part[1]):
        apart, longest = 0.0, 0.0
        for a in range(errors.shape[1]):
            x, y, z = errors[m, a, 0], errors[m, a, 1], errors[m, a, 2]
            longest = max(longest, x * x + y * y + z * z)
            for b in range(a):
                dx, dy, dz = x - errors[m, b, 0], y - errors[m, b, 1], z - errors[m, b, 2]
                apart = max(apart, dx * dx + dy * dy + dz * dz)
        found[0, m], found[1, m] = np.sqrt(apart), np.sqrt(longest)
        for k in range(3):
            found[2 + k, m] = errors[m, :, k].max() - errors[m, :, k].min()
