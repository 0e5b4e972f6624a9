"""Error budget: what each component error and each effect adds to a point's deviation."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.machine.displacement import contributions
from vmach.prediction import ActingEffect, Prediction
from vmach.toolpath import PathStates
from vmach.units import um_from_mm

__all__ = ["PROGRAM", "ErrorBudget", "error_budget", "write_budget_csv"]

#: the share that a perfect machine would leave too: cusps, rounding of the program
PROGRAM = "program"
#: rows of a file written at a time
_ROWS = 10_000


@dataclass(frozen=True)
class ErrorBudget:
    """Shares of B sources in the deviations of the points that a tool cut.

    Attributes
    ----------
    sources : tuple of str
        `PROGRAM`, symbols of component and squareness errors, labels of effects.
    share_mm : (C, B) float64
        Along the outward normal, positive where the source leaves material. A row adds up to
        the point's deviation; C points, in the order of the cut points.
    """

    sources: tuple[str, ...]
    share_mm: np.ndarray

    def largest(self, point: int, count: int = 3) -> list[tuple[str, float]]:
        """The sources with the largest shares at a point, with their shares in mm."""
        order = np.argsort(-np.abs(self.share_mm[point]))[:count]
        return [(self.sources[k], float(self.share_mm[point, k])) for k in order]


def error_budget(prediction: Prediction, effects: Sequence[ActingEffect] = ()) -> ErrorBudget:
    """Split predicted deviations into their sources.

    Every source is evaluated at the contact that made the point. What is left beside them is
    the program's own share; it also holds the terms of second order, far below 0.01 um.

    Parameters
    ----------
    prediction : Prediction
    effects : sequence of ActingEffect
        Those that the prediction was made with.
    """
    states = prediction.states
    normals = prediction.normals[prediction.is_cut]
    machine = prediction.preparation.job.machine
    direction = states.direction if machine.separate_directions else None
    parts = contributions(
        machine, states.nose_mm, states.tool_mm, prediction.variant, direction=direction
    )
    sources, columns = [PROGRAM], [prediction.deviation_mm[prediction.is_cut]]
    for name, part in parts:
        sources.append(name)
        columns.append(np.einsum("ij,ij->i", part.at(states.contact_mm), normals))
    for effect in effects:
        moved = effect.displacement(states).at(states.contact_mm) + effect.at_surface(states)
        sources.append(effect.label)
        columns.append(np.einsum("ij,ij->i", moved, normals))
    share = np.column_stack(columns)
    share[:, 0] -= share[:, 1:].sum(axis=1)
    return ErrorBudget(tuple(sources), share)


def write_budget_csv(path: Path, ids: np.ndarray, states: PathStates, budget: ErrorBudget) -> None:
    """Write one row for every point that was cut: how it was made, and its budget in um.

    Columns: id; line and tool; X, Y, Z of the spindle nose in machine coordinates; the sign of
    the last motion of each axis; feed; time; one column a source.
    """
    header = "id line tool X_mm Y_mm Z_mm direction_X direction_Y direction_Z feed_mm_min time_s"
    made = (
        ids,
        states.line,
        states.tool,
        *states.nose_mm.round(6).T,
        *states.direction.astype(int).T,
        states.feed_mm_per_min.round(3),
        states.time_s.round(3),
    )
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*header.split(), *(f"{source}_um" for source in budget.sources)])
        for begin in range(0, len(ids), _ROWS):  # as text, all rows would fill the memory
            rows = slice(begin, begin + _ROWS)
            columns = [values[rows].tolist() for values in made]
            shares_um = um_from_mm(budget.share_mm[rows]).T.tolist()
            columns += [[f"{value:.4f}" for value in share] for share in shares_um]
            writer.writerows(zip(*columns, strict=True))
