"""``vmach accuracy MACHINE``: volumetric accuracy, what it comes from, and pictures."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from vmach.accuracy.comparison import Comparison, compare_variants
from vmach.accuracy.diagonals import Diagonal, diagonals
from vmach.accuracy.field import ErrorField, Volume, error_field, measured_volume
from vmach.accuracy.grouping import group_vectors
from vmach.accuracy.histogram import difference_histogram
from vmach.accuracy.profile import ProfileErrors, read_profile
from vmach.accuracy.volumetric import VolumetricAccuracy, assess, contributions_between
from vmach.atomic import atomic_folder
from vmach.errors import InputError
from vmach.machine import Machine, Variant, read_machine
from vmach.machine.audit import audit
from vmach.machine.double_counting import double_counting
from vmach.progress import progress_bar
from vmach.units import um_from_mm

__all__ = ["accuracy"]

_GROUPING_TOLERANCES = (0.05, 0.1, 0.2)
_GROUPING_POINTS = 30_000
_MOST_POINTS = 5_000_000
_CONE_GRID = (12, 8, 6)
_PROFILE_SPACING_MM = 5.0


def accuracy(
    machine: Annotated[Path, typer.Argument(metavar="MACHINE", help="machine.toml")],
    tool_length: Annotated[
        float, typer.Option(min=0.0, max=1e4, help="from spindle nose to tip along Z, mm")
    ] = 0.0,
    model: Annotated[Variant, typer.Option(help="arms of the machine's angular errors")] = (
        Variant.ABBE
    ),
    grid: Annotated[str, typer.Option(help="points along X,Y,Z; one number for all")] = "21",
    volume: Annotated[
        str | None, typer.Option(help="reduced volume: xmin,xmax,ymin,ymax,zmin,zmax of the nose")
    ] = None,
    profile: Annotated[
        Path | None,
        typer.Option(help="CSV x,y,z of nose positions: a path to give the error along"),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="folder for json and pictures")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the figures as JSON")] = False,
) -> None:
    """Largest difference of the errors at any two points, and what it comes from."""
    known = read_machine(machine)
    tool_mm = np.array([0.0, 0.0, -tool_length])
    space = _volume(known, volume, _counts(grid))
    with progress_bar() as progress:
        progress("evaluate", 0, 1)
        field = error_field(known, space, tool_mm, model)
        comparison = _comparison(known, tool_mm, {model: field})
        path = None
        if profile is not None:
            path = read_profile(profile).divided(_PROFILE_SPACING_MM).errors(known, tool_mm, model)
        report = _report(known, field, comparison, tool_mm, model=model)
        if path is not None:
            report["profile"] = _profile_dict(profile, path)
        if out is not None:
            pictures = _pictures(known, field, comparison, tool_mm, model=model)
            _write(out, report, pictures | _profile_picture(path))
    if as_json:
        print(json.dumps(report, indent=1))
    else:
        _print(Console(), report)


def _report(
    machine: Machine, field: ErrorField, comparison: Comparison | None,
    tool_mm: np.ndarray, *, model: Variant,
) -> dict[str, Any]:  # fmt: skip
    """All figures, as they stand in ``accuracy.json``."""
    result = assess(field)
    found = diagonals(machine, field.volume, tool_mm, model)
    return {
        "machine": machine.name,
        "chain": str(machine.chain),
        "model": str(model),
        "tool_length_mm": -float(tool_mm[2]),
        "volume": _volume_dict(field.volume),
        "volumetric": _volumetric_dict(result),
        "contributions_percent": _shares(machine, result, tool_mm, model),
        "grouping": _grouping(field),
        "diagonals": [_diagonal_dict(one) for one in found],
        "variants": _variants_dict(comparison),
        "double_counting": _double_counting(machine),
        "findings": [str(finding) for finding in audit(machine)],
    }


def _counts(text: str) -> tuple[int, int, int]:
    parts = text.split(",")
    parts = parts * 3 if len(parts) == 1 else parts
    if len(parts) != 3 or not all(part.strip().isdigit() and int(part) > 1 for part in parts):
        raise InputError(f"--grid {text}", accepted="a number of points, or three: 21,11,11")
    counts = tuple(int(part) for part in parts)
    if math.prod(counts) > _MOST_POINTS:
        raise InputError(
            f"--grid {text} has {math.prod(counts)} points", accepted=f"{_MOST_POINTS} at most"
        )
    return counts


def _volume(machine: Machine, text: str | None, counts: tuple[int, int, int]) -> Volume:
    if text is None:
        return measured_volume(machine, counts)
    try:
        ends = np.array([float(part) for part in text.split(",")]).reshape(3, 2)
    except ValueError:
        raise InputError(
            f"--volume {text}", accepted="six numbers: xmin,xmax,ymin,ymax,zmin,zmax"
        ) from None
    low, high = machine.travel_mm
    if not (np.isfinite(ends).all() and (ends[:, 0] >= low).all() and (ends[:, 1] <= high).all()):
        raise InputError(
            f"--volume {text} is not within the travel",
            accepted=", ".join(f"{a:g} .. {b:g}" for a, b in zip(low, high, strict=True)),
        )
    return Volume(ends[:, 0], ends[:, 1], counts)


def _comparison(
    machine: Machine, tool_mm: np.ndarray, fields: dict[Variant, ErrorField]
) -> Comparison | None:
    """Both forms of the arms, where every measuring point is known."""
    try:
        machine.measuring_points_mm()
    except InputError:
        return None
    volume = next(iter(fields.values())).volume
    return compare_variants(machine, volume, tool_mm, known=fields)


def _um(value_mm: float | np.ndarray) -> Any:
    """Micrometres with three decimals, as plain numbers or lists."""
    return np.round(um_from_mm(np.asarray(value_mm, dtype=float)), 3).tolist()


def _volume_dict(volume: Volume) -> dict[str, Any]:
    return {
        "low_mm": np.asarray(volume.low_mm).tolist(),
        "high_mm": np.asarray(volume.high_mm).tolist(),
        "grid": list(volume.counts),
    }


def _volumetric_dict(result: VolumetricAccuracy) -> dict[str, Any]:
    return {
        "largest_difference_um": _um(result.largest_difference_mm),
        "between": [
            {"nose_mm": np.round(nose, 3).tolist(), "error_um": _um(error)}
            for nose, error in zip(result.worst_nose_mm, result.worst_error_mm, strict=True)
        ],
        "pairs": result.pairs,
        "points": result.points,
        "largest_error_um": _um(result.largest_mm),
        "mean_error_um": _um(result.mean_mm),
        "rms_error_um": _um(result.rms_mm),
        "p95_error_um": _um(result.p95_mm),
        "range_xyz_um": _um(result.range_mm),
    }


def _shares(
    machine: Machine, result: VolumetricAccuracy, tool_mm: np.ndarray, model: Variant
) -> dict[str, float]:
    shares = contributions_between(machine, result.worst_nose_mm, tool_mm, model)
    return {one.name: round(100.0 * one.share, 2) for one in shares}


def _grouping(field: ErrorField) -> list[dict[str, Any]]:
    if len(field.error_mm) > _GROUPING_POINTS:
        return []
    rows = []
    for tolerance in _GROUPING_TOLERANCES:
        found = group_vectors(field.error_mm, tolerance)
        rows.append({
            "angular_tolerance": tolerance, "records": len(found.kept),
            "comparisons": found.comparisons,
            "largest_difference_um": _um(found.largest_difference),
        })  # fmt: skip
    return rows


def _diagonal_dict(diagonal: Diagonal) -> dict[str, Any]:
    figures = diagonal.result
    return {
        "diagonal": diagonal.name,
        "kind": "body" if len(diagonal.name) > 5 else "face",
        "length_mm": round(float(figures.runs.position_mm[-1]), 3),
        "E_um": _um(figures.E), "M_um": _um(figures.M), "B_um": _um(figures.B),
    }  # fmt: skip


def _variants_dict(comparison: Comparison | None) -> dict[str, Any] | None:
    if comparison is None:
        return None
    return {
        "mean_htm_um": _um(comparison.mean_htm_mm),
        "mean_abbe_um": _um(comparison.mean_abbe_mm),
        "abbe_smaller_percent": round(comparison.smaller_percent, 2),
        "in_words": comparison.in_words,
        "note": "depends on where the reflectors stood: a figure of this machine and set-up",
    }


def _double_counting(machine: Machine) -> list[dict[str, Any]]:
    return [
        {
            "component": one.component, "reading_um": _um(one.reading_mm),
            "angular_share_um": _um(one.share_mm), "correlation": round(one.correlation, 3),
        }
        for one in double_counting(machine)
    ]  # fmt: skip


def _profile_dict(path: Path, moved: ProfileErrors) -> dict[str, Any]:
    length = np.linalg.norm(moved.error_mm, axis=1)
    return {
        "file": str(path),
        "points": len(length),
        "length_mm": round(float(moved.distance_mm[-1]), 3),
        "largest_error_um": _um(length.max()),
        "range_xyz_um": _um([np.ptp(column) for column in moved.error_mm.T]),
        "largest_difference_um": _um(moved.largest_difference_mm),
    }


def _pictures(
    machine: Machine, field: ErrorField, comparison: Comparison | None,
    tool_mm: np.ndarray, *, model: Variant,
) -> dict[str, bytes]:  # fmt: skip
    from vmach.accuracy.pictures import draw_cones, draw_histogram, draw_maps

    largest = assess(field).largest_difference_mm
    edges, counts, _ = difference_histogram(field.error_mm, largest)
    coarse = Volume(field.volume.low_mm, field.volume.high_mm, _CONE_GRID)
    pictures = {
        "histogram.png": draw_histogram(field.magnitude_mm, edges, counts, largest_mm=largest),
        "cones.png": draw_cones(
            error_field(machine, coarse, tool_mm, model), title=f"{machine.name}, arms: {model}"
        ),
    }
    if comparison is not None:
        pictures["htm_abbe.png"] = draw_maps(comparison, title=machine.name)
    return pictures


def _profile_picture(moved: ProfileErrors | None) -> dict[str, bytes]:
    if moved is None:
        return {}
    from vmach.accuracy.pictures import draw_profile

    return {"profile.png": draw_profile(moved.distance_mm, moved.error_mm, title="profile")}


def _write(out: Path, report: dict[str, Any], pictures: dict[str, bytes]) -> None:
    with atomic_folder(out) as folder:
        for name, picture in pictures.items():
            (folder / name).write_bytes(picture)
        (folder / "accuracy.json").write_text(json.dumps(report, indent=1) + "\n")


def _print(console: Console, report: dict[str, Any]) -> None:
    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    figures, volume = report["volumetric"], report["volume"]
    box = ", ".join(
        f"{axis} {low:g} .. {high:g}"
        for axis, low, high in zip("XYZ", volume["low_mm"], volume["high_mm"], strict=True)
    )
    say(f"{report['machine']}   {report['chain']}   arms: {report['model']}")
    say(f"nose {box} mm, grid {' x '.join(map(str, volume['grid']))}, "
        f"tool length {report['tool_length_mm']:g} mm")  # fmt: skip
    say(f"volumetric accuracy {figures['largest_difference_um']:.1f} um: the largest of "
        f"{figures['pairs']} differences, between")  # fmt: skip
    for end in figures["between"]:
        say(f"   nose {end['nose_mm']} mm with error {end['error_um']} um")
    say(f"error of the tip: largest {figures['largest_error_um']:.1f}, mean "
        f"{figures['mean_error_um']:.1f}, RMS {figures['rms_error_um']:.1f} um")  # fmt: skip
    console.print(_shares_table(report))
    console.print(_grouping_table(report))
    console.print(_diagonal_table(report))
    if report["variants"]:
        variants = report["variants"]
        say(f"mean error with conventional arms {variants['mean_htm_um']:.1f} um, Abbe-consistent "
            f"{variants['mean_abbe_um']:.1f} um: {variants['in_words']} "
            f"({variants['note']})")  # fmt: skip
    if "profile" in report:
        profile = report["profile"]
        say(f"profile {profile['file']}: largest error {profile['largest_error_um']:.1f} um, "
            f"largest difference {profile['largest_difference_um']:.1f} um")  # fmt: skip
    for line in report["findings"]:
        say(line)


def _table(title: str, headings: tuple[str, ...], rows: list[list[str]]) -> Table:
    table = Table(title=title, title_justify="left")
    for place, heading in enumerate(headings):
        table.add_column(heading, justify="right" if place else "left")
    for row in rows:
        table.add_row(*row)
    return table


def _shares_table(report: dict[str, Any]) -> Table:
    counted = {one["component"]: one for one in report["double_counting"]}
    rows = [
        [name, f"{share:.1f}", *_share_cells(counted.get(name))]
        for name, share in report["contributions_percent"].items()
    ]
    return _table(
        "between the two worst points; angles in the readings",
        ("error", "share, %", "reading, um", "of it angle x arm, um"),
        rows,
    )


def _share_cells(counted: dict[str, Any] | None) -> list[str]:
    if counted is None:
        return ["", ""]
    return [f"{counted['reading_um']:.1f}", f"{counted['angular_share_um']:.1f}"]


def _grouping_table(report: dict[str, Any]) -> Table:
    exact = report["volumetric"]
    rows = [["exact", str(exact["points"]), str(exact["pairs"]),
             f"{exact['largest_difference_um']:.1f}"]]  # fmt: skip
    rows += [
        [str(row["angular_tolerance"]), str(row["records"]), str(row["comparisons"]),
         f"{row['largest_difference_um']:.1f}"]
        for row in report["grouping"]
    ]  # fmt: skip
    headings = ("grouping", "vectors", "comparisons", "largest difference, um")
    return _table("grouping by direction beside the exact result", headings, rows)


def _diagonal_table(report: dict[str, Any]) -> Table:
    rows = [
        [row["diagonal"], f"{row['length_mm']:.0f}",
         *(f"{row[key]:.1f}" for key in ("E_um", "M_um", "B_um"))]
        for row in report["diagonals"]
    ]  # fmt: skip
    return _table("diagonals, ISO 230-6", ("diagonal", "mm", "E, um", "M, um", "B, um"), rows)
