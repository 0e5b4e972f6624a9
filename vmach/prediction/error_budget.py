"""Error budget: what each component error and each effect adds to a point's deviation.

Source: closed form derived here: to first order a displacement e_i changes the deviation along
the normal n by n . e_i, so that shares add up.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.base.units import um_from_mm
from vmach.files.csv_table import fixed, rounded, whole, words, write_csv
from vmach.job import Job
from vmach.machine import RigidDisplacement, Variant
from vmach.machine.displacement import contributions
from vmach.path.toolpath import PathStates
from vmach.path.touched_zero import touched_zero
from vmach.prediction import ActingEffect, Prediction

__all__ = ["PROGRAM", "ErrorBudget", "budget_at", "error_budget", "write_budget_csv"]

#: the share that a perfect machine would leave too: cusps, rounding of the program
PROGRAM = "program"


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
    cut = prediction.is_cut
    return budget_at(
        prediction.states,
        prediction.normals[cut],
        prediction.deviation_mm[cut],
        job=prediction.preparation.job,
        variant=prediction.variant,
        effects=effects,
    )


def budget_at(
    states: PathStates,
    normals: np.ndarray,
    deviation_mm: np.ndarray,
    *,
    job: Job,
    variant: Variant,
    effects: Sequence[ActingEffect] = (),
) -> ErrorBudget:
    """The same of C states that made surface points, with normals (C, 3), deviations (C,) mm."""
    zero = touched_zero(job, states)
    at_touch = dict(_parts(zero.states, job, variant, effects)) if zero else {}
    sources, columns = [PROGRAM], [deviation_mm]
    for name, part in _parts(states, job, variant, effects):
        moved = part.at(states.contact_mm)
        if zero is not None:
            moved = moved - zero.shift_mm(at_touch[name].shift_mm)
        sources.append(name)
        columns.append(np.einsum("ij,ij->i", moved, normals))
    for number, effect in enumerate(effects, len(sources) - len(effects)):
        columns[number] += np.einsum("ij,ij->i", effect.at_surface(states), normals)
    share = np.column_stack(columns)
    share[:, 0] -= share[:, 1:].sum(axis=1)
    return ErrorBudget(tuple(sources), share)


def _parts(
    states: PathStates, job: Job, variant: Variant, effects: Sequence[ActingEffect]
) -> Iterator[tuple[str, RigidDisplacement]]:
    """Every error of the machine, then every effect on the whole tool."""
    direction = states.direction if job.machine.separate_directions else None
    yield from contributions(
        job.machine, states.nose_mm, states.tool_mm, variant, direction=direction
    )
    for effect in effects:
        yield effect.label, effect.displacement(states)


def write_budget_csv(path: Path, ids: np.ndarray, states: PathStates, budget: ErrorBudget) -> None:
    """Write one row for every point that was cut, (P,): how it was made, and its budget in um.

    Columns: id; line and tool; X, Y, Z of the spindle nose in machine coordinates; the sign of
    the last motion of each axis; feed; time; one column a source.
    """
    axes = "XYZ"
    columns = {
        "id": words(ids),
        "line": whole(states.line),
        "tool": whole(states.tool),
        **{f"{axis}_mm": rounded(q, 6) for axis, q in zip(axes, states.nose_mm.T, strict=True)},
        **{f"direction_{axis}": whole(sign)
           for axis, sign in zip(axes, states.direction.T, strict=True)},
        "feed_mm_min": rounded(states.feed_mm_per_min, 3),
        "time_s": rounded(states.time_s, 3),
        **{f"{source}_um": fixed(um_from_mm(share), 4)
           for source, share in zip(budget.sources, budget.share_mm.T, strict=True)},
    }  # fmt: skip
    with path.open("wb") as file:
        write_csv(file, columns)
