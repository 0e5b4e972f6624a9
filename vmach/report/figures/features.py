"""What the drawing asks for and what was found, for the terminal, summary.json and the page."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from vmach.base.units import um_from_mm
from vmach.features.result import FeatureResult, Value
from vmach.features.verdict import Verdict
from vmach.report.result import RunRecord

__all__ = [
    "COVERAGE",
    "features_csv",
    "features_summary",
    "features_table",
    "flag_text",
    "flagged",
    "spread_text",
    "used_share",
]

#: coverage factor of the expanded uncertainties that are printed (GUM, 95 %)
COVERAGE = 2.0
#: flags on a picture, at most
_MOST_FLAGS = 8
#: NC lines and shares that the JSON and the CSV list
_LISTED = 3


def features_summary(run: RunRecord) -> list[dict]:
    """The value of ``features`` in summary.json."""
    return [_record(result, run) for result in run.features]


def _record(result: FeatureResult, run: RunRecord) -> dict:
    return {
        "feature": result.feature,
        "requirement": result.callout,
        "characteristic": result.characteristic,
        "label": result.label,
        "faces": list(result.faces),
        "datums": list(result.datums),
        "nominal_mm": result.nominal_mm,
        "lower_mm": result.lower_mm,
        "upper_mm": result.upper_mm,
        "values": {name: _value(value) for name, value in result.values.items()},
        "primary": result.primary,
        "shares_um": {s.source: um_from_mm(s.share_mm) for s in result.shares},
        "cause": result.cause,
        "lines": [
            {"line": one.line, "nc": run.nc_text(one.line), "tool": one.tool, "share": one.share}
            for one in result.lines
        ],
        "point_mm": list(result.places[0].at_mm) if result.places else None,
        "reason": result.reason,
    }


def _value(value: Value) -> dict:
    return {
        "value_mm": value.value_mm,
        "u_um": None if value.u_mm is None else um_from_mm(value.u_mm),
        "verdict": str(value.verdict),
        "interval_mm": None if value.interval_mm is None else list(value.interval_mm),
    }


def features_table(run: RunRecord) -> Table | None:
    """A rich table, a row a value; None where the job asks for nothing."""
    if not run.features:
        return None
    has_measured = any(result.measured for result in run.features)
    table = Table(title=Text("The drawing"), title_justify="left", caption_justify="left")
    table.caption = f"predicted {_spread_text(run)}, mm; verdict after ISO 14253-1 with it"
    table.add_column("requirement")
    table.add_column("predicted", justify="right", no_wrap=True)
    if has_measured:
        table.add_column("measured", justify="right", no_wrap=True)
    table.add_column("verdict")
    table.add_column("most of it", no_wrap=True)
    for result in run.features:
        cells = [f"{result.feature}: {result.title}", _cell(result.predicted)]
        if has_measured:
            cells.append(_cell(result.measured))
        judged = result.measured or result.predicted
        cells += [str(judged.verdict) if judged else result.reason, result.cause.split(",")[0]]
        table.add_row(*map(Text, cells))
    return table


def _spread_text(run: RunRecord) -> str:
    values = [result.predicted for result in run.features if result.predicted]
    return "and 95 % interval" if any(v.interval_mm for v in values) else "± U (k = 2)"


def _cell(value: Value | None) -> str:
    return "–" if value is None else f"{value.value_mm:.4f}{spread_text(value)}"


def spread_text(value: Value) -> str:
    """How far a value is known: the interval of draws, else the expanded uncertainty."""
    if value.interval_mm is not None:
        low, high = value.interval_mm
        return f" ({low:.4f} to {high:.4f})"
    return "" if value.u_mm is None else f" ± {COVERAGE * value.u_mm:.4f}"


def used_share(result: FeatureResult) -> float:
    """How much of the tolerance the value uses, 0 to 1 and beyond; NaN without a value."""
    value = result.measured or result.predicted
    if value is None or result.upper_mm is None:
        return math.nan
    if result.lower_mm is None:
        return value.value_mm / result.upper_mm
    half = (result.upper_mm - result.lower_mm) / 2.0
    return abs(value.value_mm - (result.upper_mm + result.lower_mm) / 2.0) / half


def flagged(features: Sequence[FeatureResult]) -> list[FeatureResult]:
    """The results that matter most, one a feature: not conforming first, then by use."""
    shown = [r for r in features if r.places and r.predicted is not None]
    rank = {Verdict.FAILS: 0, Verdict.OPEN: 1, Verdict.CONFORMS: 2}

    def order(result: FeatureResult) -> tuple[int, float]:
        return rank[(result.measured or result.predicted).verdict], -used_share(result)

    chosen: dict[str, FeatureResult] = {}
    for result in sorted(shown, key=order):
        chosen.setdefault(result.feature, result)
    return list(chosen.values())[:_MOST_FLAGS]


def flag_text(result: FeatureResult) -> str:
    """Two lines: feature and requirement, value and verdict."""
    value = result.measured or result.predicted
    return f"{result.feature}: {result.title}\n{value.value_mm:.4f} mm, {value.verdict}"


_COLUMNS = (
    "feature", "requirement", "label", "nominal_mm", "lower_mm", "upper_mm", "predicted_mm",
    "predicted_u_um", "verdict", "measured_mm", "measured_u_um", "measured_verdict",
    "predicted_low_mm", "predicted_high_mm", "lines",
    "largest_shares",
)  # fmt: skip


def features_csv(features: Sequence[FeatureResult]) -> str:
    """One row a value; cells are empty where there is none."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(_COLUMNS)
    for result in features:
        limits = [result.nominal_mm, result.lower_mm, result.upper_mm]
        row = [result.feature, result.callout, result.label, *map(_number, limits)]
        row += [*_cells(result.predicted), *_cells(result.measured)]
        drawn = result.predicted.interval_mm if result.predicted else None
        row += [_number(end) for end in drawn or (None, None)]
        lines = " ".join(str(one.line) for one in result.lines[:_LISTED])
        writer.writerow([*row, lines, result.cause])
    return text.getvalue()


def _cells(value: Value | None) -> list[str]:
    if value is None:
        return ["", "", ""]
    u = "" if value.u_mm is None else f"{um_from_mm(value.u_mm):.4f}"
    return [_number(value.value_mm), u, str(value.verdict)]


def _number(length_mm: float | None) -> str:
    return "" if length_mm is None else f"{length_mm:.6f}"
