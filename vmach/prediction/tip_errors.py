"""Error of the tool tip along a program: what the axes do to it, whatever it cuts.

Source: ISO 230-1 (tool relative to workpiece, at the functional point); the equations of
`vmach.machine.displacement`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.effects import EffectInstance, read_effects
from vmach.files.csv_table import Cells, rounded, whole
from vmach.job import Job, read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates
from vmach.prediction import displacement_of

__all__ = ["TipErrors", "tip_error_columns", "tip_errors"]


@dataclass(frozen=True)
class TipErrors:
    """Displacement of the tip at every node of a program.

    Attributes
    ----------
    states : PathStates
        K nodes, at most 5 mm apart, in the order of the program.
    error_mm : (K, 3) float64
        Actual minus nominal, machine axes.
    notes : tuple of Note
        What the user should know of the program before trusting the numbers.
    """

    states: PathStates
    error_mm: np.ndarray
    notes: tuple[Note, ...] = ()

    def summary(self) -> dict:
        """Figures for people and programs, um."""
        length = np.linalg.norm(self.error_mm, axis=1)
        worst = int(np.argmax(length))
        return {
            "nodes": len(length),
            "largest_abs_xyz_um": um_from_mm(np.abs(self.error_mm).max(axis=0)).tolist(),
            "range_xyz_um": um_from_mm(np.ptp(self.error_mm, axis=0)).tolist(),
            "largest_error_um": um_from_mm(float(length[worst])),
            "at_line": int(self.states.line[worst]),
            "at_nose_mm": self.states.nose_mm[worst].round(6).tolist(),
        }


def tip_errors(job_path: Job | str | Path, variant: Variant) -> TipErrors:
    """Error of the tip along the job's program by the machine's errors and the job's effects.

    Raises
    ------
    InputError, gcode.ProgramError
    """
    job = read_job(job_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    preparation = prepare(job)
    nodes = preparation.path.nodes
    moved = displacement_of(preparation, nodes, variant, effects)
    notes = (*preparation.notes, *_left_out(effects))
    return TipErrors(nodes, moved.shift_mm, notes)


def _left_out(effects: Sequence[EffectInstance]) -> list[Note]:
    """Effects that show on a surface alone, whatever the axes do."""
    names = [found.label for found in effects if found.effect.needs_surface]
    if not names:
        return []
    said = f"not in these errors, for they act where the tool meets the part: {', '.join(names)}"
    return [Note.plain(Kind.LEFT_OUT, said, len(names), "1", place=names[0])]


def tip_error_columns(found: TipErrors) -> dict[str, Cells]:
    """Line, time, nose position in machine coordinates (mm) and error (um) of every node."""
    states = found.states
    return {
        "line": whole(states.line),
        "tool": whole(states.tool),
        "time_s": rounded(states.time_s, 4),
        **{f"{axis}_mm": rounded(q, 6) for axis, q in zip("XYZ", states.nose_mm.T, strict=True)},
        **{f"d{axis}_um": rounded(um_from_mm(error), 4)
           for axis, error in zip("xyz", found.error_mm.T, strict=True)},
    }  # fmt: skip
