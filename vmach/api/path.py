"""Error of the tool along a program."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.api.records import Rows
from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.job import Job
from vmach.machine import Variant
from vmach.machine.variant_name import variant_called
from vmach.prediction.tip_errors import tip_errors

__all__ = ["PathErrors", "path_errors"]


@dataclass(frozen=True)
class PathErrors(Rows):
    """Displacement of the tool's tip at K places of a program, at most 5 mm apart.

    Attributes
    ----------
    line, tool : (K,) int64
        NC line (1-based) and tool.
    time_s : (K,) float64
        Since the program's start.
    nose_mm : (K, 3) float64
        Axis positions, machine coordinates.
    error_um : (K, 3) float64
        Actual minus nominal place of the tip against the workpiece, machine axes.
    notes : tuple of Note
        What to know before trusting the numbers.
    """

    line: np.ndarray
    tool: np.ndarray
    time_s: np.ndarray
    nose_mm: np.ndarray
    error_um: np.ndarray
    notes: tuple[Note, ...] = ()

    _PARTS = {
        "nose_mm": ("X_mm", "Y_mm", "Z_mm"),
        "error_um": ("dx_um", "dy_um", "dz_um"),
    }

    def __len__(self) -> int:
        return len(self.line)


def path_errors(job: Job | str | Path, *, model: str = Variant.ABBE) -> PathErrors:
    """Error of the tool's tip along the job's program, by the machine and the job's effects.

    Parameters
    ----------
    job : Job or path
    model : {"abbe", "htm", "none"}

    Raises
    ------
    InputError, gcode.ProgramError

    Examples
    --------
    >>> import vmach
    >>> found = vmach.path_errors("samples/freecad_pocket")
    >>> found.error_um.shape == found.nose_mm.shape == (len(found), 3)
    True
    """
    found = tip_errors(job, variant_called(model))
    states = found.states
    return PathErrors(
        line=states.line.astype(np.int64),
        tool=states.tool.astype(np.int64),
        time_s=states.time_s,
        nose_mm=states.nose_mm,
        error_um=um_from_mm(found.error_mm),
        notes=found.notes,
    )
