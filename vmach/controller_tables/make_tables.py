"""Write tables, read them back, apply them as the control would, and say what is left."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.projection import Projection
from vmach.controller_tables.samples import ErrorSamples
from vmach.controller_tables.table_formats import FORMATS, AppliedTables, TableFormat, projected
from vmach.controller_tables.table_task import TableTask

__all__ = ["MadeTables", "Residual", "make_tables"]

_FINER = (1, 2, 4, 8, 16, 32)
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
    """
    return [_made(task, folder / name, options=options or {}) for name in formats]


def _made(task: TableTask, folder: Path, *, options: Mapping[str, Any]) -> MadeTables:
    name, table_format = folder.name, FORMATS[folder.name]
    finer, applied, after = 0, None, None
    while True:
        knots = task.knots(table_format.most_entries, _FINER[finer])
        folder.mkdir(parents=True)
        files = table_format.write(folder, task, knots, options)
        applied = table_format.read(folder, options)
        last, after = after, _residual(applied, task.check)
        gain = np.inf if last is None else last.rms_mm - after.rms_mm
        done = gain < task.tolerance_mm or finer + 1 == len(_FINER) or not task.has_effects
        if done or _is_full(knots, table_format):
            break
        shutil.rmtree(folder)
        finer += 1
    longer = task.longer_tool(_LONGER_MM)
    return MadeTables(
        name=name,
        files=tuple(files),
        entries=tuple(len(one.position_mm) for one in knots),
        before=_residual(None, task.check),
        after=after,
        with_longer_tool=longer and (_residual(None, longer), _residual(applied, longer)),
        left=_left(task, table_format, knots),
    )


def _is_full(knots, table_format: TableFormat) -> bool:
    return all(one.intervals + 1 >= table_format.most_entries for one in knots)


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
