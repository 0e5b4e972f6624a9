"""summary.json: the figures of a run for machines and scripts."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path

from vmach.base.note import note_records
from vmach.base.units import um_from_mm
from vmach.files.atomic import atomic_file
from vmach.report.figures.arms import arms_summary
from vmach.report.figures.circular_tests import circular_summary
from vmach.report.figures.differences import differences_summary
from vmach.report.figures.features import features_summary
from vmach.report.figures.statistics import (
    Statistics,
    column_statistics,
    feature_statistics,
    worst_apart_mm,
    worst_places,
)
from vmach.report.result import Column, InspectedPoints, RunRecord

__all__ = ["SCHEMA", "SIGN_CONVENTION", "summary", "write_summary"]

SCHEMA = "vmach-summary-1"
SIGN_CONVENTION = "positive: material left, negative: too much removed"


def write_summary(path: str | Path, points: InspectedPoints, run: RunRecord) -> None:
    """Write `summary` as JSON; docs/report.md describes every key.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    text = json.dumps(summary(points, run), indent=1, ensure_ascii=False, allow_nan=False)
    with atomic_file(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")


def summary(points: InspectedPoints, run: RunRecord) -> dict:
    """Return the figures of a run as nested dicts of plain numbers and strings.

    Lengths are in um (coordinates in mm); a figure that does not exist, such as the mean of no
    points, is None.
    """
    return {
        "schema": SCHEMA,
        "title": run.title,
        "model": run.model,
        "sign_convention": SIGN_CONVENTION,
        "tolerance_um": um_from_mm(run.tolerance_mm),
        "points": len(points),
        "worst_apart_mm": worst_apart_mm(points),
        "variants": {
            column.name: _column_summary(points, column, run) for column in points.columns
        },
        "differences": differences_summary(run),
        "features": features_summary(run),
        "circular_tests": circular_summary(run),
        "htm_against_abbe": arms_summary(points, run),
        "run": {
            "command": run.command,
            "started_at": run.started_at,
            "files": [asdict(file) for file in run.files],
            "versions": dict(run.versions),
            "stages_s": dict(run.stages_s),
            "facts": dict(run.facts),
            "warnings": list(run.warnings),
            "warning_records": note_records(run.notes),
        },
    }


def _column_summary(points: InspectedPoints, column: Column, run: RunRecord) -> dict:
    features = feature_statistics(points, column, run.tolerance_mm)
    return {
        "label": column.label,
        **_figures(column_statistics(column, run.tolerance_mm)),
        "remainder_rms_um": _um(column.remainder_rms_mm),
        "features": {name: _figures(statistics) for name, statistics in features.items()},
        "worst": [_worst(points, column, run, i) for i in worst_places(points, column).tolist()],
    }


def _figures(statistics: Statistics) -> dict:
    return {
        "status": statistics.status_counts,
        "mean_um": _um(statistics.mean_mm),
        "rms_um": _um(statistics.rms_mm),
        "min_um": _um(statistics.min_mm),
        "max_um": _um(statistics.max_mm),
        "peak_to_valley_um": _um(statistics.peak_to_valley_mm),
        "outside_tolerance": statistics.outside_count,
        "outside_tolerance_share": _number(statistics.outside_share),
    }


def _worst(points: InspectedPoints, column: Column, run: RunRecord, index: int) -> dict:
    line = int(points.line[index])
    has_cause = points.cause is not None and column.name == points.primary.name
    return {
        "id": str(points.id[index]),
        "feature": str(points.feature[index]),
        "deviation_um": _um(float(column.deviation_mm[index])),
        "point_mm": points.point_mm[index].tolist(),
        "normal": points.normal[index].tolist(),
        "line": line,
        "nc": run.nc_text(line),
        "tool": int(points.tool[index]),
        "move": int(points.move[index]),
        "time_s": float(points.time_s[index]),
        **({"cause": str(points.cause[index])} if has_cause else {}),
    }


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else value


def _um(length_mm: float | None) -> float | None:
    return None if _number(length_mm) is None else um_from_mm(length_mm)
