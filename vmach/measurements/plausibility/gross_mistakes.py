"""Which tool or work offset is not as the job says, where a part lies far from its prediction.

Source: equations (6), (7) and (21) of docs/laws.md: what a tool's radius and length and a shift of
one work offset do to a surface.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gcode import WORK_OFFSETS
from vmach.job import Job
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.part_check import EXPLAINED_MM, FEW

__all__ = ["gross_mistake"]


@dataclass(frozen=True)
class _Mistake:
    """What tools or a work offset may have been: columns (P, k), one mm of each amount."""

    tools: Sequence[int]
    offset: str
    columns: np.ndarray


def gross_mistake(part: Measurement, job: Job) -> str | None:
    """What to look at, where one mistake explains why readings lie far from the prediction.

    Parameters
    ----------
    part : Measurement
        Points that the program cuts, with whatever lies far off.
    job : Job

    Returns
    -------
    str or None
        A question; None where the pose of the part explains them, or no single mistake does.
    """
    if _amounts_mm(part, np.zeros((len(part), 0))) is not None:
        return None
    further_out = _amounts_mm(part, np.ones((len(part), 1)))
    for mistake in _mistakes(part):
        amounts = _amounts_mm(part, mistake.columns)
        if amounts is not None:
            found = _question(mistake, amounts, job)
            return found if further_out is None else f"{found} {_of_probe(further_out, 'Or is')}"
    return None if further_out is None else _of_probe(further_out, "Is")


def _of_probe(further_out_mm: np.ndarray, begin: str) -> str:
    """A question where all surfaces lie out, or in, by the same amount, (1,) mm."""
    (size,) = further_out_mm
    way, what = ("out", "still in the points") if size > 0 else ("in", "taken off twice")
    return (
        f"{begin} the radius of the measuring probe {what}? Every surface lies "
        f"{abs(size):.3f} mm further {way}"
    )


def _amounts_mm(part: Measurement, columns: np.ndarray) -> np.ndarray | None:
    """Least squares beside the pose, (k,) mm; None where it does not explain the readings."""
    every = np.hstack([columns, part.nuisance])
    residual = part.measured_mm - part.predicted_mm
    found = np.linalg.lstsq(every, residual, rcond=None)[0]
    is_odd = np.abs(residual - every @ found) > EXPLAINED_MM
    return found[: columns.shape[1]] if is_odd.mean() <= FEW else None


def _mistakes(part: Measurement) -> Iterator[_Mistake]:
    """What may be wrong, the plain mistakes first."""
    states, normal = part.states, part.sensing
    across = np.hypot(normal[:, 0], normal[:, 1])
    tools = np.unique(states.tool).tolist()
    of_tool = {
        n: -np.column_stack([across, normal[:, 2]]) * (states.tool == n)[:, None] for n in tools
    }
    for n in tools:
        yield _Mistake([n], "", of_tool[n])
    cut_in = states.moves.work_offset[states.move]
    used = np.unique(cut_in).tolist()
    for k in [*used[1:], used[0]] if len(used) > 1 else []:  # the first is the reference
        yield _Mistake([], WORK_OFFSETS[k - 1], normal * (cut_in == k)[:, None])
    for n, m in itertools.combinations(tools, 2):
        yield _Mistake([n, m], "", np.hstack([of_tool[n], of_tool[m]]))


def _question(mistake: _Mistake, amounts_mm: np.ndarray, job: Job) -> str:
    if mistake.offset:
        by = ", ".join(f"{value:.3f}" for value in np.round(amounts_mm, 3) + 0.0)
        return f"what was cut in {mistake.offset} lies ({by}) mm away: is this work offset right?"
    each = dict(zip(mistake.tools, amounts_mm.reshape(-1, 2).tolist(), strict=True))
    said = " and ".join(f"tool {n} were {_other_size(*own)}" for n, own in each.items())
    meant = {n: job.tools[n].diameter_mm + 2.0 * radius for n, (radius, _) in each.items()}
    others = [job.tools[n].diameter_mm for n in reversed(mistake.tools)]
    is_near = np.abs(np.subtract([*meant.values()], others)).max() <= 2.0 * EXPLAINED_MM
    if len(meant) > 1 and is_near:
        return f"the part is as if {said}: were the two exchanged?"
    return f"the part is as if {said}: is it that tool, and are its length and diameter right?"


def _other_size(radius_mm: float, length_mm: float) -> str:
    """In words; what is as small as what stays unexplained is not said."""
    sizes = {
        ("larger in diameter", "smaller in diameter"): 2.0 * radius_mm,
        ("longer", "shorter"): length_mm,
    }
    said = [
        f"{abs(size):.3f} mm {more if size > 0 else less}"
        for (more, less), size in sizes.items()
        if abs(size) > EXPLAINED_MM
    ]
    return " and ".join(said) or "as it is"
