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
from vmach.files.text_file import read_text
from vmach.iso230.by_run import Outlier, outliers, run_figures
from vmach.iso230.evaluation import Evaluation, evaluate
from vmach.iso230.uncertainty import Budget, expanded, parameter_uncertainties
from vmach.machine import Machine, read_machine
from vmach.machine.chain import ROTARY_AXES
from vmach.machine.tables.error_table import (
    MM_PER,
    POSITION_MM_PER,
    POSITION_RAD_PER,
    RAD_PER,
    read_error_table,
)
from vmach.machine.tables.runs import Runs

__all__ = ["EvaluatedTable", "evaluated_tables", "iso230_figures"]

#: a slope below this is what rounding leaves of none, um/m
_FLAT_UM_PER_M = 0.1
#: largest range in degrees, and the fewest targets of a rotary axis; eight beyond (ISO 230-2:2014)
_ROTARY_TARGETS = ((90.0, 3), (180.0, 5))


@dataclass(frozen=True)
class EvaluatedTable:
    """One evaluated table of a machine, or of a file."""

    name: str
    is_angle: bool
    is_positioning: bool
    result: Evaluation
    is_rotary: bool = False
    """Whether the positions are angles, in degrees."""

    @property
    def unit(self) -> str:
        return "urad" if self.is_angle else "um"

    @property
    def factor(self) -> float:
        return 1e6 if self.is_angle else 1e3

    @property
    def position_unit(self) -> str:
        return "deg" if self.is_rotary else "mm"

    @property
    def extent(self) -> float:
        """From the first target to the last, in `position_unit`."""
        position = self.result.runs.position_mm
        return float(position[-1] - position[0])


def evaluated_tables(data: Path, unit: str | None) -> Iterator[EvaluatedTable]:
    """The table of a CSV, or all tables of a machine, rotary axes behind the linear ones.

    Parameters
    ----------
    data : Path
    unit : str or None
        Of readings whose columns name none; um without it.

    Raises
    ------
    InputError
        If `data` cannot be read or evaluated.
    """
    if data.suffix == ".toml":
        yield from _of_machine(read_machine(data))
        return
    heading = _heading(data)
    is_rotary = not {f"position_{own}" for own in POSITION_RAD_PER}.isdisjoint(heading)
    unit = unit or _unit_of(heading, data, is_rotary=is_rotary)
    if unit not in MM_PER and unit not in RAD_PER:
        raise InputError(f"--unit {unit}", accepted=", ".join((*MM_PER, *RAD_PER)))
    is_angle = unit not in MM_PER
    units = RAD_PER if is_angle else MM_PER
    positions = POSITION_RAD_PER if is_rotary else POSITION_MM_PER
    table = read_error_table(data, units, unit, positions=positions)
    try:
        result = evaluate(table.in_degrees if is_rotary else table.as_runs)
    except InputError as error:
        raise InputError(error.what, file=data, accepted=error.accepted) from None
    yield EvaluatedTable(data.stem, is_angle, is_angle == is_rotary, result, is_rotary)


def _of_machine(machine: Machine) -> Iterator[EvaluatedTable]:
    for name, component in machine.components.items():
        means = Runs(component.position_mm, component.forward, component.backward)
        result = evaluate(component.runs or means)
        yield EvaluatedTable(name, component.is_angle, name[1] == name[2], result)
    for axis in machine.rotary.values():
        for name, error in axis.components.items():
            if error.runs is not None:
                is_angle = name[1] in ROTARY_AXES
                yield EvaluatedTable(name, is_angle, name[1] == name[2], evaluate(error.runs), True)


def _heading(data: Path) -> list[str]:
    """Names of the columns of a table."""
    lines = read_text(data, what="error table").splitlines()
    stated = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    return [cell.strip() for cell in stated[0].split(",")] if stated else []


def _unit_of(heading: list[str], data: Path, *, is_rotary: bool) -> str:
    """Of the readings, as their columns name it; um of a linear axis where they do not."""
    for name in heading:
        unit = name.rpartition("_")[2]
        if not name.startswith("position_") and (unit in MM_PER or unit in RAD_PER):
            return unit
    if is_rotary:
        raise InputError(
            "readings over angles, without a unit", file=data, line=1,
            accepted="columns such as forward_1_arcsec, or --unit arcsec",
        )  # fmt: skip
    return "um"


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
    found = outliers(result.runs)
    notes = [*_notes(axis, runs), *result.runs.notes, *_outlier_notes(axis, found)]
    entry: dict[str, Any] = {
        "unit": axis.unit, "runs": runs, "targets": len(result.runs.position_mm),
        "length_mm": None if axis.is_rotary else axis.extent,
        "range_deg": axis.extent if axis.is_rotary else None, "figures": figures,
        "by_run": [own.record(axis.factor) for own in run_figures(result.runs)],
        "outliers": [own.record(axis.factor) for own in found],
        "notes": [str(note) for note in notes], "note_records": note_records(notes),
    }  # fmt: skip
    if axis.is_positioning and not axis.is_rotary and axis.result.A is not None:
        standard = parameter_uncertainties(budget, axis.extent, runs)
        entry["U_k2"] = {k: round(expanded(u) * axis.factor, 2) for k, u in standard.items()}
    return entry


def _asked_targets(axis: EvaluatedTable) -> tuple[float, str]:
    """Fewest targets of the standard, and the words for it.

    Source: ISO 230-2:2014, 5.3: linear axes up to and beyond 2 m, rotary axes by their range.
    """
    if axis.is_rotary:
        least = next((n for range_deg, n in _ROTARY_TARGETS if axis.extent <= range_deg), 8)
        return least, f"at least {least} over {axis.extent:g} degrees"
    of_length = max(5.0, 5.0 * axis.extent / 1000.0) if axis.extent <= 2000.0 else 0.0
    return of_length, "at least five, and five a metre"


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


def _outlier_notes(axis: EvaluatedTable, found: tuple[Outlier, ...]) -> Iterator[Note]:
    for own in found:
        size = axis.factor * own.from_others
        said = (
            f"run {own.run} {own.direction} reads {axis.factor * own.deviation:.2f} {axis.unit} at "
            f"{own.position:g} {axis.position_unit}, {abs(size):.2f} {axis.unit} from the mean of "
            "the other runs there: an outlier? It counts in the figures"
        )
        yield Note.question(Kind.OUTLIER, said, size, axis.unit, place=axis.name)


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
    least, asked = _asked_targets(axis)
    if targets < least:
        said = f"{targets} targets; the standard asks for {asked}"
        yield Note.plain(Kind.TARGETS, said, targets, "1", place=axis.name)
    if not axis.is_positioning and not axis.is_angle and not axis.is_rotary:
        yield from _slope_note(axis)
    if not axis.is_positioning or axis.is_rotary:
        said = "no uncertainty is stated: the budget covers positioning only"
        yield Note.plain(Kind.BUDGET, said, place=axis.name)
