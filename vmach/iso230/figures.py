"""The figures of ISO 230-2 of every table, as plain numbers for JSON and for print.

Source: the formulas of `vmach.iso230.evaluation` (ISO 230-2:2014).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.note import Kind, Note, note_records
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.iso230.evaluation import Evaluation, evaluate
from vmach.iso230.uncertainty import Budget, expanded, parameter_uncertainties
from vmach.machine.component_errors import ComponentError
from vmach.machine.files.machine_file import read_machine
from vmach.machine.tables.error_table import MM_PER, RAD_PER, ErrorTable, read_error_table
from vmach.machine.tables.runs import Runs

__all__ = ["EvaluatedTable", "evaluated_tables", "iso230_figures"]

#: a slope below this is what rounding leaves of none, um/m
_FLAT_UM_PER_M = 0.1


@dataclass(frozen=True)
class EvaluatedTable:
    """One evaluated table of a machine, or of a file."""

    name: str
    is_angle: bool
    is_positioning: bool
    result: Evaluation

    @property
    def unit(self) -> str:
        return "urad" if self.is_angle else "um"

    @property
    def factor(self) -> float:
        return 1e6 if self.is_angle else 1e3

    @property
    def length_mm(self) -> float:
        position_mm = self.result.runs.position_mm
        return float(position_mm[-1] - position_mm[0])


def evaluated_tables(data: Path, unit: str) -> Iterator[EvaluatedTable]:
    """The table of a CSV, or all tables of a machine.

    Raises
    ------
    InputError
        If `data` cannot be read or evaluated.
    """
    if data.suffix == ".toml":
        for name, component in read_machine(data).components.items():
            runs = component.runs or _means(component.position_mm, component)
            yield EvaluatedTable(name, component.is_angle, name[1] == name[2], evaluate(runs))
        return
    if unit not in MM_PER and unit not in RAD_PER:
        raise InputError(f"--unit {unit}", accepted=", ".join((*MM_PER, *RAD_PER)))
    is_angle = unit not in MM_PER
    table = read_error_table(data, RAD_PER if is_angle else MM_PER, unit)
    try:
        result = evaluate(table.runs or _means(table.position, table))
    except InputError as error:
        raise InputError(error.what, file=data, accepted=error.accepted) from None
    yield EvaluatedTable(data.stem, is_angle, not is_angle, result)


def _means(position_mm: np.ndarray, table: ComponentError | ErrorTable) -> Runs:
    """A table of means as one run: enough for E, M and B."""
    return Runs(position_mm, table.forward, table.backward)


def iso230_figures(
    data: Path, tables: tuple[EvaluatedTable, ...], budget: Budget, *, budget_source: str
) -> dict[str, Any]:
    """All figures, as they stand in ``iso230.json``."""
    return {
        "data": str(data),
        "standard": "ISO 230-2:2014",
        "budget_um": {
            "source": budget_source,
            "u_device": round(um_from_mm(budget.device_mm), 4),
            "u_setup": round(um_from_mm(budget.setup_mm), 4),
            "u_eve": round(um_from_mm(budget.eve_u_mm), 4),
            "u_misalignment_per_m": round(um_from_mm(budget.misalignment_mm(1e3)), 4),
        },
        "tables": {axis.name: _table_figures(axis, budget) for axis in tables},
    }


def _table_figures(axis: EvaluatedTable, budget: Budget) -> dict[str, Any]:
    result = axis.result
    figures = {
        name: None if value is None else round(value * axis.factor, 4)
        for name, value in result.figures().items()
    }
    sides = (result.runs.forward, result.runs.backward)
    runs = min(int(np.isfinite(side).sum(axis=0).min()) for side in sides)
    notes = list(_notes(axis, runs))
    entry: dict[str, Any] = {
        "unit": axis.unit, "runs": runs, "targets": len(result.runs.position_mm),
        "length_mm": axis.length_mm, "figures": figures,
        "notes": [str(note) for note in notes], "note_records": note_records(notes),
    }  # fmt: skip
    if axis.is_positioning and axis.result.A is not None:
        standard = parameter_uncertainties(budget, axis.length_mm, runs)
        entry["U_k2"] = {k: round(expanded(u) * axis.factor, 2) for k, u in standard.items()}
    return entry


def _slope_note(axis: EvaluatedTable) -> Iterator[Note]:
    """What a straightness is without the slope of its line, which is squareness or alignment.

    Source: ISO 230-1:2012, straightness deviation from a least squares reference line.
    """
    result = axis.result
    place_mm = result.runs.position_mm - result.runs.position_mm.mean()
    middle = 0.5 * (result.mean_forward + result.mean_backward)
    slope = float(place_mm @ middle / (place_mm @ place_mm))
    if abs(1e6 * slope) >= _FLAT_UM_PER_M:
        means = np.concatenate((result.mean_forward, result.mean_backward))
        left = means - slope * np.tile(place_mm, 2)
        said = (
            f"the figures hold a slope of {1e6 * slope:.1f} um/m; about the least squares line "
            f"(straightness, ISO 230-1) the means vary by {um_from_mm(float(np.ptp(left))):.2f} um"
        )
        yield Note.plain(Kind.SLOPE, said, 1e6 * slope, "um/m", place=axis.name)


def _notes(axis: EvaluatedTable, runs: int) -> Iterator[Note]:
    if axis.result.A is None:
        said = "means only: A and R need at least two runs in either direction"
        yield Note.plain(Kind.RUNS, said, runs, "1", place=axis.name)
    elif runs < 5:
        said = f"{runs} runs; the standard asks for five"
        yield Note.plain(Kind.RUNS, said, runs, "1", place=axis.name)
    if axis.result.B == 0.0:
        said = "the same values for both directions: B says nothing, the rest is of one direction"
        yield Note.plain(Kind.DIRECTION, said, 0.0, axis.unit, place=axis.name)
    targets = len(axis.result.runs.position_mm)
    if axis.length_mm <= 2000.0 and targets < max(5, 5 * axis.length_mm / 1000.0):
        said = f"{targets} targets; the standard asks for at least five, and five a metre"
        yield Note.plain(Kind.TARGETS, said, targets, "1", place=axis.name)
    if not axis.is_positioning and not axis.is_angle:
        yield from _slope_note(axis)
    if not axis.is_positioning:
        said = "no uncertainty is stated: the budget covers positioning only"
        yield Note.plain(Kind.BUDGET, said, place=axis.name)
