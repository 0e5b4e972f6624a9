"""``vmach iso230 DATA``: figures, diagrams and uncertainty of bidirectional runs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from vmach.atomic import atomic_folder
from vmach.errors import InputError
from vmach.iso230.evaluation import Evaluation, evaluate
from vmach.iso230.uncertainty import Budget, expanded, parameter_uncertainties
from vmach.machine.error_table import MM_PER, RAD_PER, read_error_table
from vmach.machine.machine_file import read_machine
from vmach.machine.runs import Runs
from vmach.progress import progress_bar
from vmach.stage_clock import Progress
from vmach.toml_file import FileSection, NonNegative, read_toml

__all__ = ["iso230"]


class _BudgetFile(FileSection):
    """Keys of a budget file; what is left out is as in Table 8 of the KTH thesis."""

    wavelength_um: NonNegative = 0.06
    air_um: NonNegative = 0.9
    dead_path_um: NonNegative = 0.0
    resolution_um: NonNegative = 0.002
    misalignment_mrad: NonNegative = 5.0
    abbe_offset_mm: NonNegative = 25.0
    angle_urad: NonNegative = 60.0
    eve_um: NonNegative = 1.5


@dataclass(frozen=True)
class _Axis:
    """One evaluated table."""

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


def iso230(
    data: Annotated[
        Path, typer.Argument(metavar="DATA", help="CSV of bidirectional runs, or a machine.toml")
    ],
    unit: Annotated[str, typer.Option(help="of a CSV's readings: um, urad, arcsec ...")] = "um",
    budget: Annotated[
        Path | None, typer.Option(help="TOML with the uncertainty contributors of the laser")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="folder for json and diagrams")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the figures as JSON")] = False,
) -> None:
    """Accuracy, repeatability and reversal after ISO 230-2, with their uncertainty."""
    contributors = _read_budget(budget)
    axes = tuple(_tables(data, unit))
    if not axes:
        raise InputError("the machine has no error tables of linear axes", file=data)
    report = {
        "data": str(data),
        "standard": "ISO 230-2:2014",
        "budget_um": {
            "source": str(budget) if budget else "assumed: Table 8 of the KTH thesis",
            "u_device": round(contributors.device_mm * 1e3, 4),
            "u_setup": round(contributors.setup_mm * 1e3, 4),
            "u_eve": round(contributors.eve_u_mm * 1e3, 4),
            "u_misalignment_per_m": round(contributors.misalignment_mm(1e3) * 1e3, 4),
        },
        "tables": {axis.name: _as_dict(axis, contributors) for axis in axes},
    }
    if out is not None:
        with progress_bar() as progress:
            _write(out, report, axes, progress)
    if as_json:
        print(json.dumps(report, indent=1))
    else:
        _print(Console(), report)


def _read_budget(path: Path | None) -> Budget:
    file = _BudgetFile() if path is None else read_toml(path, _BudgetFile, what="budget file")
    return Budget(
        wavelength_mm=file.wavelength_um * 1e-3,
        air_mm=file.air_um * 1e-3,
        dead_path_mm=file.dead_path_um * 1e-3,
        resolution_mm=file.resolution_um * 1e-3,
        misalignment_rad=file.misalignment_mrad * 1e-3,
        abbe_offset_mm=file.abbe_offset_mm,
        angle_rad=file.angle_urad * 1e-6,
        eve_mm=file.eve_um * 1e-3,
    )


def _tables(data: Path, unit: str) -> Iterator[_Axis]:
    """The table of a CSV, or all tables of a machine."""
    if data.suffix == ".toml":
        for name, component in read_machine(data).components.items():
            runs = component.runs or _means(component)
            yield _Axis(name, component.is_angle, name[1] == name[2], evaluate(runs))
        return
    if unit not in MM_PER and unit not in RAD_PER:
        raise InputError(f"--unit {unit}", accepted=", ".join((*MM_PER, *RAD_PER)))
    is_angle = unit not in MM_PER
    table = read_error_table(data, RAD_PER if is_angle else MM_PER, unit)
    try:
        result = evaluate(table.runs or _means(table))
    except InputError as error:
        raise InputError(error.what, file=data, accepted=error.accepted) from None
    yield _Axis(data.stem, is_angle, not is_angle, result)


def _means(table: Any) -> Runs:
    """A table of means as one run: enough for E, M and B."""
    return Runs(table.position_mm, table.forward, table.backward)


def _as_dict(axis: _Axis, budget: Budget) -> dict[str, Any]:
    result = axis.result
    figures = {
        name: None if value is None else round(value * axis.factor, 4)
        for name, value in result.figures().items()
    }
    runs = min(len(result.runs.forward), len(result.runs.backward))
    entry: dict[str, Any] = {
        "unit": axis.unit, "runs": runs, "targets": len(result.runs.position_mm),
        "length_mm": axis.length_mm, "figures": figures, "notes": list(_notes(axis, runs)),
    }  # fmt: skip
    if axis.is_positioning and axis.result.A is not None:
        standard = parameter_uncertainties(budget, axis.length_mm, runs)
        entry["U_k2"] = {k: round(expanded(u) * axis.factor, 2) for k, u in standard.items()}
    return entry


def _notes(axis: _Axis, runs: int) -> Iterator[str]:
    if axis.result.A is None:
        yield "means only: A and R need at least two runs in either direction"
        if axis.result.B == 0.0:
            yield "the same values for both directions: B says nothing"
    elif runs < 5:
        yield f"{runs} runs; the standard asks for five"
    targets = len(axis.result.runs.position_mm)
    if axis.length_mm <= 2000.0 and targets < 5 * axis.length_mm / 1000.0:
        yield f"{targets} targets; the standard asks for at least five a metre"
    if not axis.is_positioning:
        yield "no uncertainty: the budget is one of positioning"


def _write(out: Path, report: dict[str, Any], axes: tuple[_Axis, ...], progress: Progress) -> None:
    """The figures and one diagram a table, all files or none."""
    from vmach.iso230.diagram import draw_evaluation

    with atomic_folder(out) as folder:
        for count, axis in enumerate(axes):
            progress("draw", count, len(axes))
            picture = draw_evaluation(
                axis.result, title=f"{axis.name}, ISO 230-2", unit=axis.unit, factor=axis.factor
            )
            (folder / f"{axis.name}.png").write_bytes(picture)
        (folder / "iso230.json").write_text(json.dumps(report, indent=1) + "\n")


def _print(console: Console, report: dict[str, Any]) -> None:
    names = ("A", "R", "E", "M", "B", "B_mean")
    table = Table(title=f"{report['standard']}  {report['data']}")
    for heading in ("table", "unit", "runs", *names):
        table.add_column(heading, justify="left" if heading in ("table", "unit") else "right")
    for name, entry in report["tables"].items():
        values = [entry["figures"][key] for key in names]
        cells = ["-" if value is None else f"{value:.2f}" for value in values]
        table.add_row(name, entry["unit"], str(entry["runs"]), *cells)
    console.print(table)
    for name, entry in report["tables"].items():
        if "U_k2" in entry:
            parts = ", ".join(f"{key} {value:.1f}" for key, value in entry["U_k2"].items())
            _say(console, f"{name}: expanded uncertainty U (k = 2), um: {parts}")
    _say(console, f"uncertainty budget: {report['budget_um']['source']}")
    notes: dict[str, list[str]] = {}
    for name, entry in report["tables"].items():
        for note in entry["notes"]:
            notes.setdefault(note, []).append(name)
    for note, subjects in notes.items():
        _say(console, f"{' '.join(subjects)}: {note}")


def _say(console: Console, text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)
