"""The figures of volumetric accuracy as text and tables."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rich.console import Console
from rich.table import Table

__all__ = ["print_accuracy"]

#: a reading is angle times arm and a rest
_MAY_CANCEL = "angle x arm and the rest of a reading may cancel"


def print_accuracy(console: Console, report: dict[str, Any]) -> None:
    """Print the figures of ``accuracy.json`` for people."""

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
        f"{figures['pairs']:,} differences, between")  # fmt: skip
    for end in figures["between"]:
        nose, error = _vector(end["nose_mm"], ".1f"), _vector(end["error_um"], "+.1f")
        say(f"   nose {nose} mm with error {error} um")
    say(f"error of the tip: largest {figures['largest_error_um']:.1f}, mean "
        f"{figures['mean_error_um']:.1f}, RMS {figures['rms_error_um']:.1f} um")  # fmt: skip
    say(f"range of the error: {_vector(figures['range_xyz_um'], '.1f')} um")
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
    if "uncertainty" in report:
        _say_uncertainty(say, report["uncertainty"])
    for line in report["findings"]:
        say(line)


def _say_uncertainty(say: Callable[[str], None], found: dict[str, Any]) -> None:
    """Intervals of the figures, and what they come from."""
    for name, one in found["figures"].items():
        said = name.removesuffix("_um").replace("_", " ")
        say(f"{said}: {one['stated_um']:.1f} um, with all corrections {one['mean_um']:.1f} um, "
            f"u {one['u_um']:.2f} um, {100 * found['coverage']:g} % in {one['low_um']:.1f} .. "
            f"{one['high_um']:.1f} um")  # fmt: skip
    ranked = [f"{label} {share:.0f} %" for label, share in found["contributors_percent"].items()]
    say(f"{found['draws']} draws (JCGM 101); of the variance: {', '.join(ranked[:5])}")
    if found["do_not_stand"]:
        say(f"{found['do_not_stand']} of these do not stand after so many draws; "
            "--draws allows more")  # fmt: skip


def _vector(values: list[float], digits: str) -> str:
    return "  ".join(f"{axis} {v:{digits}}" for axis, v in zip("XYZ", values, strict=True))


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
    table = _table(
        "share in the largest difference; ranges of readings",
        ("error", "share, %", "range of reading, um", "range of angle x arm in it, um"),
        rows,
    )
    if counted:
        table.caption, table.caption_justify = _MAY_CANCEL, "left"
    return table


def _share_cells(counted: dict[str, Any] | None) -> list[str]:
    if counted is None:
        return ["", ""]
    return [f"{counted['reading_um']:.1f}", f"{counted['angular_share_um']:.1f}"]


def _grouping_table(report: dict[str, Any]) -> Table:
    exact = report["volumetric"]
    rows = [["exact", f"{exact['points']:,}", f"{exact['pairs']:,}",
             f"{exact['largest_difference_um']:.1f}"]]  # fmt: skip
    rows += [
        [f"below {row['angular_tolerance']:g}", f"{row['records']:,}", f"{row['comparisons']:,}",
         f"{row['largest_difference_um']:.1f}"]
        for row in report["grouping"]
    ]  # fmt: skip
    headings = ("grouping", "vectors", "comparisons", "largest difference, um")
    title = "grouping by direction (difference of unit vectors, no unit) beside the exact result"
    return _table(title, headings, rows)


def _diagonal_table(report: dict[str, Any]) -> Table:
    rows = [
        [row["diagonal"], f"{row['length_mm']:.0f}",
         *(f"{row[key]:.1f}" for key in ("E_um", "M_um", "B_um"))]
        for row in report["diagonals"]
    ]  # fmt: skip
    return _table("diagonals, ISO 230-6", ("diagonal", "mm", "E, um", "M, um", "B, um"), rows)
