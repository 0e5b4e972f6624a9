"""The program moved against the predicted error, tables for controls, and accuracy figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.base.units import mm_from_um
from vmach.compensation.compensate import Compensation
from vmach.compensation.compensate import compensate as compensate_job
from vmach.controller_tables import FORMATS, MadeTables, make_tables
from vmach.controller_tables.table_task import task_of_job, task_of_machine
from vmach.effects import read_effects
from vmach.files.atomic import atomic_folder
from vmach.iso230 import Evaluation, evaluate
from vmach.job import Job, read_job
from vmach.machine import Machine, Variant
from vmach.machine.tables.runs import Runs
from vmach.machine.variant_name import variant_called
from vmach.plausibility import admitted_machine
from vmach.volumetric.field import Volume, error_field, measured_volume
from vmach.volumetric.volumetric import VolumetricAccuracy, assess

__all__ = ["accuracy", "compensate", "control_tables", "evaluate_axis", "read_machine"]


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

    Examples
    --------
    >>> from dataclasses import replace
    >>> import vmach
    >>> job = vmach.read_job("samples/freecad_pocket/job.toml")
    >>> found = vmach.compensate(replace(job, nominal=None, blank=None))
    >>> found.text.startswith(b"(")
    True
    >>> found.after.largest_mm < 0.2 * found.before.largest_mm
    True
    """
    read = read_job(job)
    return compensate_job(
        read,
        read_effects(read.effects, file=read.path, job=read),
        variant=variant_called(model),
        resolution_mm=resolution_mm,
        tolerance_mm=mm_from_um(tolerance_um),
        limit_mm=mm_from_um(limit_um),
        residual_limit_mm=mm_from_um(residual_limit_um),
        dialect=dialect,
    )


def read_machine(path: str | Path) -> Machine:
    """Read a machine file and its tables, and refuse what no machine can be.

    Raises
    ------
    InputError
        Anything wrong with the files, with file, line, key, value and what is accepted.

    Examples
    --------
    >>> import vmach
    >>> machine = vmach.read_machine("samples/iso10791_7/machine.toml")
    >>> str(machine.chain), len(machine.components)
    ("t (C) Z b Y' X' w", 18)
    """
    return admitted_machine(path)


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

    Examples
    --------
    >>> import vmach
    >>> machine = vmach.read_machine("samples/iso10791_7/machine.toml")
    >>> found = vmach.accuracy(machine, tool_length_mm=150, grid=(5, 5, 5))
    >>> round(1e3 * found.largest_difference_mm, 1)
    34.0
    """
    known = machine if isinstance(machine, Machine) else admitted_machine(machine)
    space = measured_volume(known, grid)
    if volume_mm is not None:
        low, high = np.asarray(volume_mm, dtype=float).T
        space = Volume(low, high, grid)
    tool_mm = np.array([0.0, 0.0, -tool_length_mm])
    return assess(error_field(known, space, tool_mm, variant_called(model)))


def control_tables(
    what: Machine | Job,
    folder: str | Path,
    *,
    formats: Sequence[str] = tuple(FORMATS),
    model: str = Variant.ABBE,
    tool_length_mm: float = 0.0,
    tolerance_um: float = 0.2,
) -> list[MadeTables]:
    """Compensation tables for controls, read back and applied as the control would.

    Parameters
    ----------
    what : Machine or Job
        The measured volume of a machine, or a job's program and effects.
    folder : path
        Gets a folder of each format's name; whole or not at all.
    formats : sequence of str
    model : {"abbe", "htm"}
    tool_length_mm : float
        From the spindle nose to the tip; a job has its own.
    tolerance_um : float
        Of straight lines between entries; sets their number.

    Raises
    ------
    InputError

    Examples
    --------
    >>> import vmach
    >>> machine = vmach.read_machine("samples/iso10791_7/machine.toml")
    >>> (made,) = vmach.control_tables(machine, "tables", formats=["linuxcnc"])
    >>> made.after.rms_mm < made.before.rms_mm
    True
    """
    variant, tolerance_mm = variant_called(model), mm_from_um(tolerance_um)
    if isinstance(what, Machine):
        task = task_of_machine(
            what, variant, tool_length_mm=tool_length_mm, tolerance_mm=tolerance_mm
        )
    else:
        task = task_of_job(what, variant, tolerance_mm=tolerance_mm)
    target = Path(folder)
    with atomic_folder(target) as place:
        made = make_tables(task, place, formats=formats)
        return [
            replace(one, files=tuple(target / path.relative_to(place) for path in one.files))
            for one in made
        ]


def evaluate_axis(position_mm: np.ndarray, forward: np.ndarray, backward: np.ndarray) -> Evaluation:
    """Accuracy, repeatability and reversal of one axis after ISO 230-2:2014.

    Parameters
    ----------
    position_mm : (K,) array
        Target positions, increasing.
    forward, backward : (n, K) array
        Deviations at the targets, approached in positive and in negative direction, one row a
        run, in one unit.

    Returns
    -------
    Evaluation
        In the unit of the deviations.

    Raises
    ------
    ValueError
        Arrays that do not fit.

    Examples
    --------
    >>> import numpy as np
    >>> import vmach
    >>> forward = np.array([[1.0, 2.0, 3.0], [1.2, 2.1, 3.3]])
    >>> found = vmach.evaluate_axis(np.array([0.0, 100.0, 200.0]), forward, forward - 4.0)
    >>> round(found.B, 3), round(found.B_mean, 3)
    (4.0, 4.0)
    """
    return evaluate(Runs(np.asarray(position_mm, float), forward, backward))
