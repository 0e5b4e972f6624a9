"""Error of the tool tip along a program: what the axes do to it, whatever it cuts."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.effects import read_effects
from vmach.job import read_job
from vmach.machine import Variant
from vmach.prediction import displacement_of
from vmach.preparation import prepare
from vmach.toolpath import PathStates
from vmach.units import um_from_mm

__all__ = ["TipErrors", "tip_errors", "write_tip_errors_csv"]

_COLUMNS = ("line", "tool", "time_s", "X_mm", "Y_mm", "Z_mm", "dx_um", "dy_um", "dz_um")


@dataclass(frozen=True)
class TipErrors:
    """Displacement of the tip at every node of a program.

    Attributes
    ----------
    states : PathStates
        K nodes, at most 5 mm apart, in the order of the program.
    error_mm : (K, 3) float64
        Actual minus nominal, machine axes.
    notes : tuple of str
        What the user should know of the program before trusting the numbers.
    """

    states: PathStates
    error_mm: np.ndarray
    notes: tuple[str, ...] = ()

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


def tip_errors(job_path: Path, variant: Variant) -> TipErrors:
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
    return TipErrors(nodes, moved.shift_mm, preparation.notes)


def write_tip_errors_csv(path: Path, found: TipErrors) -> None:
    """Write line, time, nose position in machine coordinates (mm) and error (um) of every node."""
    states = found.states
    columns = (states.line, states.tool, states.time_s.round(4))
    rows = zip(
        *columns, *states.nose_mm.round(6).T, *um_from_mm(found.error_mm).round(4).T, strict=True
    )
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_COLUMNS)
        writer.writerows(rows)
