"""Write tables, read them back, apply them as the control would, and say what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from vmach.base.stage_clock import Progress, silent
from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import Projection
from vmach.controller_tables.samples import ErrorSamples
from vmach.controller_tables.table_format import AppliedTables, TableFormat, projected
from vmach.controller_tables.table_formats import FORMATS
from vmach.controller_tables.table_task import TableTask

__all__ = ["MadeTables", "Residual", "make_tables"]

#: times the entries that the machine's tables need; the last is the most there can be
_FINER = (1, 4, 16, 1000)
#: by which a tool is longer to show what tables for one length leave of another
_LONGER_MM = 100.0


@dataclass(frozen=True)
class Residual:
    """Length of the error vector of the tool tip over the check, mm.

    Attributes
    ----------
    mean_mm, rms_mm, largest_mm : float
    largest_xyz_mm : (3,) float64
        Largest magnitude in each axis.
    """

    mean_mm: float
    rms_mm: float
    largest_mm: float
    largest_xyz_mm: np.ndarray

    @classmethod
    def of(cls, vectors_mm: np.ndarray, weight: np.ndarray) -> Residual:
        """Figures of (P, 3) vectors."""
        length = np.linalg.norm(vectors_mm, axis=1)
        rms = float(np.sqrt(weight @ length**2))
        return cls(float(weight @ length), rms, float(length.max()), np.abs(vectors_mm).max(axis=0))


@dataclass(frozen=True)
class MadeTables:
    """Tables of one format and what they do.

    Attributes
    ----------
    name : str
        Key of `FORMATS`.
    files : tuple of Path
    entries : (int, int, int)
        Positions along X, Y, Z.
    before, after : Residual
        Without the tables, and with them as the control applies what was read back.
    with_longer_tool : (Residual, Residual) or None
        Before and after with a tool 100 mm longer than the tables were made for.
    left : dict of str to (float, float), or None
        Root mean square of every component error before and after, mm; None for formats that
        hold the error model itself.
    """

    name: str
    files: tuple[Path, ...]
    entries: tuple[int, int, int]
    before: Residual
    after: Residual
    with_longer_tool: tuple[Residual, Residual] | None
    left: dict[str, tuple[float, float]] | None

    @property
    def format(self) -> TableFormat:
        """What the format can hold."""
        return FORMATS[self.name]


def make_tables(
    task: TableTask,
    folder: Path,
    *,
    formats: Sequence[str] = tuple(FORMATS),
    options: Mapping[str, Any] | None = None,
    progress: Progress = silent,
) -> list[MadeTables]:
    """Write tables of the given formats into folders of their names.

    Parameters
    ----------
    task : TableTask
    folder : Path
        An empty folder.
    formats : sequence of str
        Keys of `FORMATS`.
    options : mapping, optional
        ``comp_type`` (0 or 1) for LinuxCNC, ``cec_entries`` (correction or error) for CEC.
    progress : Progress
        Told how many formats are done.
    """
    made: list[MadeTables] = []
    for name in formats:
        progress("tables", len(made), len(formats))
        made.append(_made(task, folder / name, options=options or {}))
    return made


def _made(task: TableTask, folder: Path, *, options: Mapping[str, Any]) -> MadeTables:
    table_format = FORMATS[folder.name]
    knots = _entries(task, folder, options=options)
    files, applied = _written(task, folder, knots, options=options)
    longer = task.longer_tool(_LONGER_MM)
    return MadeTables(
        name=folder.name,
        files=tuple(files),
        entries=tuple(len(one.position_mm) for one in knots),
        before=_residual(None, task.check),
        after=_residual(applied, task.check),
        with_longer_tool=longer and (_residual(None, longer), _residual(applied, longer)),
        left=_left(task, table_format, knots),
    )


def _entries(
    task: TableTask, folder: Path, *, options: Mapping[str, Any]
) -> tuple[Knots, Knots, Knots]:
    """Positions of the entries. The machine's tables say how many are needed; the shape of a
    job's effects is only seen in what is left, so there as few as come within tolerance of what
    the most that the control takes would leave."""
    most = FORMATS[folder.name].most_entries
    knots = task.knots(most)
    if not task.has_effects:
        return knots

    def left_mm(tried: tuple[Knots, Knots, Knots]) -> float:
        with TemporaryDirectory() as place:
            trial = Path(place) / folder.name
            applied = _written(task, trial, tried, options=options)[1]
        return _residual(applied, task.check).rms_mm

    best_mm = left_mm(task.knots(most, _FINER[-1]))
    for finer in _FINER[:-1]:
        knots = task.knots(most, finer)
        if left_mm(knots) < best_mm + task.tolerance_mm:
            return knots
    return task.knots(most, _FINER[-1])


def _written(
    task: TableTask, folder: Path, knots: tuple[Knots, Knots, Knots], *, options: Mapping[str, Any]
) -> tuple[list[Path], AppliedTables]:
    """The files, and what the control makes of them."""
    folder.mkdir(parents=True)
    table_format = FORMATS[folder.name]
    files = table_format.write(folder, task, knots, options)
    return files, table_format.read(folder, options)


def _residual(applied: AppliedTables | None, check: ErrorSamples) -> Residual:
    """Error plus correction: the correction is so small that the error does not change by it."""
    error = check.error_mm
    if applied is not None:
        states = (check.nose_mm, check.direction, check.tool_mm)
        error = error + applied.applied_correction(*states)
    return Residual.of(error, check.weight)


def _left(task: TableTask, table_format: TableFormat, knots) -> dict | None:
    if table_format.terms is None:
        return None
    projection: Projection = projected(task, table_format.terms(task), knots)[0]
    errors = projection.samples.of_components(task.machine, task.variant)
    shares = task.check.of_components(task.machine, task.variant)
    nothing = np.zeros_like(projection.samples.error_mm)
    errors = {name: errors.get(name, nothing) for name in shares}
    return projection.left(errors, task.check, shares)
