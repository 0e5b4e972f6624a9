"""Error models side by side, and against measured points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.api.records import Rows
from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.job import Job
from vmach.machine import Variant
from vmach.machine.variant_name import variant_called
from vmach.report.result import InspectedPoints
from vmach.run.pipeline import inspect_part

__all__ = ["ModelComparison", "compare"]

_ALL = (Variant.NONE, Variant.HTM, Variant.ABBE)


@dataclass(frozen=True)
class ModelComparison(Rows):
    """Deviations of P points under several error models.

    Attributes
    ----------
    id, feature : (P,) str
    point_mm, normal : (P, 3) float64
        Nominal point and outward unit normal, workpiece coordinates.
    deviation_um : mapping of model to (P,) float64
        ``none``, ``htm``, ``abbe`` and, where the points were measured, ``measured``; aligned as
        the job asks. NaN where no tool made the surface.
    remainder_rms_um : mapping of model to float
        RMS of measured minus predicted, each after its own best fit; empty without measurement.
    notes : tuple of Note
    """

    id: np.ndarray
    feature: np.ndarray
    point_mm: np.ndarray
    normal: np.ndarray
    deviation_um: dict[str, np.ndarray]
    remainder_rms_um: dict[str, float]
    notes: tuple[Note, ...] = ()

    _PARTS = {"point_mm": ("x_mm", "y_mm", "z_mm"), "normal": ("i", "j", "k")}

    def __len__(self) -> int:
        return len(self.id)

    def columns(self) -> dict[str, np.ndarray]:
        """Every column (P,) by its name, one ``MODEL_um`` a model."""
        models = {f"{name}_um": values for name, values in self.deviation_um.items()}
        return super().columns() | models


def compare(job: Job | str | Path, *, models: Sequence[str] = _ALL) -> ModelComparison:
    """Deviations under several error models: at the measured points, else on the nominal CAD.

    Parameters
    ----------
    job : Job or path
    models : sequence of {"none", "htm", "abbe"}

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError

    Examples
    --------
    >>> from dataclasses import replace
    >>> import vmach
    >>> job = vmach.read_job("samples/freecad_pocket")
    >>> job = replace(job, inspection=replace(job.inspection, spacing_mm=12.0))
    >>> sorted(vmach.compare(job).deviation_um)
    ['abbe', 'htm', 'none']
    """
    variants = tuple(map(variant_called, models))
    found = inspect_part(job, variants=variants, prefer_measured=True)
    return _comparison(found.points, found.notes)


def _comparison(points: InspectedPoints, notes: Sequence[Note]) -> ModelComparison:
    deviation = {
        column.name: np.where(column.is_cut, um_from_mm(column.deviation_mm), np.nan)
        for column in points.columns
    }
    rms = {column.name: column.remainder_rms_mm for column in points.columns}
    return ModelComparison(
        id=points.id,
        feature=points.feature,
        point_mm=points.point_mm,
        normal=points.normal,
        deviation_um=deviation,
        remainder_rms_um={
            name: float(um_from_mm(value)) for name, value in rms.items() if value is not None
        },
        notes=tuple(notes),
    )
