"""The program moved against the predicted error, and the machine's accuracy."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.api.points import _variant
from vmach.base.units import mm_from_um
from vmach.compensation.compensate import Compensation
from vmach.compensation.compensate import compensate as compensate_job
from vmach.effects import read_effects
from vmach.job import Job, read_job
from vmach.machine import Machine, Variant
from vmach.plausibility import admitted_machine
from vmach.volumetric.field import Volume, error_field, measured_volume
from vmach.volumetric.volumetric import VolumetricAccuracy, assess

__all__ = ["accuracy", "compensate"]


def compensate(
    job: Job | str | Path,
    *,
    model: str = Variant.ABBE,
    resolution_mm: float = 1e-3,
    tolerance_um: float = 0.1,
    limit_um: float = 500.0,
    residual_limit_um: float = 5.0,
    dialect: str | None = None,
) -> Compensation:
    """Move a job's program against the predicted error of the tool's tip, and verify it.

    Parameters
    ----------
    job : Job or path
    model : {"abbe", "htm", "none"}
    resolution_mm : float
        Of the target control.
    tolerance_um : float
        Largest residual before rounding; points are inserted for it.
    limit_um : float
        Largest correction accepted.
    residual_limit_um : float
        Largest residual accepted in the written program.
    dialect : str, optional
        Of the target control; that of the program where left out.

    Returns
    -------
    Compensation
        Its `text` is the program, bytes.

    Raises
    ------
    InputError, gcode.ProgramError
    """
    read = read_job(job)
    return compensate_job(
        read,
        read_effects(read.effects, file=read.path, job=read),
        variant=_variant(model),
        resolution_mm=resolution_mm,
        tolerance_mm=mm_from_um(tolerance_um),
        limit_mm=mm_from_um(limit_um),
        residual_limit_mm=mm_from_um(residual_limit_um),
        dialect=dialect,
    )


def accuracy(
    machine: Machine | str | Path,
    *,
    tool_length_mm: float = 0.0,
    model: str = Variant.ABBE,
    grid: tuple[int, int, int] = (21, 21, 21),
    volume_mm: tuple[tuple[float, float], ...] | None = None,
) -> VolumetricAccuracy:
    """Volumetric accuracy: the largest difference of the errors at any two points.

    Parameters
    ----------
    machine : Machine or path
    tool_length_mm : float
        From the spindle nose to the tip, along Z.
    model : {"abbe", "htm", "none"}
    grid : (int, int, int)
        Points along X, Y and Z.
    volume_mm : ((low, high), (low, high), (low, high)), optional
        Nose positions in machine coordinates; the travel that the tables cover where left out.

    Raises
    ------
    InputError
    """
    known = machine if isinstance(machine, Machine) else admitted_machine(machine)
    space = measured_volume(known, grid)
    if volume_mm is not None:
        low, high = np.asarray(volume_mm, dtype=float).T
        space = Volume(low, high, grid)
    tool_mm = np.array([0.0, 0.0, -tool_length_mm])
    return assess(error_field(known, space, tool_mm, _variant(model)))
