"""report.html: one file to read, turn, print and send; it asks the network for nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image

from vmach.base.colour_ramp import COLOUR_STOPS, UNKNOWN_COLOUR
from vmach.base.units import um_from_mm
from vmach.features.result import FeatureResult
from vmach.files.atomic import atomic_file
from vmach.report.figures.arms import arms_text
from vmach.report.figures.circular_tests import (
    FIGURES,
    circular_limits,
    circular_values,
    circular_verdict,
)
from vmach.report.figures.features import COVERAGE, flag_text, flagged, spread_text, used_share
from vmach.report.figures.statistics import (
    column_statistics,
    common_range_mm,
    feature_statistics,
    worst_apart_mm,
    worst_places,
)
from vmach.report.figures.summary import SIGN_CONVENTION
from vmach.report.page.kit import (
    asset,
    jpeg_data_uri,
    render_page,
    script_json,
    style_sheet,
    um_decimals,
    um_text,
    viewer_scripts,
)
from vmach.report.page.payload import MAX_POINTS, encode_payload
from vmach.report.page.polar_plot import polar_plot
from vmach.report.pictures.histogram import histograms
from vmach.report.result import Column, DisplayMesh, InspectedPoints, RunRecord

__all__ = ["ReportView", "write_report_html"]

_HERE = Path(__file__).parent
_SLIDER_STEPS = 200


@dataclass(frozen=True)
class ReportView:
    """How the part is seen when the report is opened.

    Attributes
    ----------
    azimuth_rad, elevation_rad : float
        Direction from which it is looked at.
    zoom : float
        1 shows all of it.
    target_mm : tuple of 3 float
        What is in the middle, workpiece coordinates.
    section : tuple of 4 float
        Normal and distance of the plane beyond which all is cut away; zeros for none.
    range_um : float
        End of the colour scale.
    """

    azimuth_rad: float
    elevation_rad: float
    zoom: float
    target_mm: tuple[float, float, float]
    section: tuple[float, float, float, float]
    range_um: float


def write_report_html(
    path: str | Path,
    mesh: DisplayMesh,
    points: InspectedPoints,
    run: RunRecord,
    *,
    stills: Sequence[Path] = (),
    view: ReportView | None = None,
) -> None:
    """Write the report.

    Parameters
    ----------
    path : path
        File to write.
    mesh : DisplayMesh
        With a colouring for every column of the points, and of their remainders.
    points, run : InspectedPoints, RunRecord
    stills : sequence of path
        The pictures for print and for browsers without WebGL 2.
    view : ReportView, optional
        How the part is seen at first; else all of it, from above and the front.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    deviations, remainders, differences = (
        [_column_view(points, v, run, span_mm=max(_largest_mm(group), 1e-12)) for v in group]
        for group in _groups(points)
    )
    page = render_page(
        _HERE / "page.html.jinja",
        run=run,
        points=points.with_remainders(),
        variants=deviations,
        remainders=remainders,
        differences=differences,
        arms=arms_text(points, run),
        primary=points.primary.name,
        histograms=[h for group in _groups(points) for h in histograms(group)],
        columns=_optional_columns(points),
        apart_mm=worst_apart_mm(points),
        pickable=min(len(points), MAX_POINTS),
        um=partial(um_text, decimals=um_decimals(_largest_mm(points.columns))),
        sign_convention=SIGN_CONVENTION,
        is_signed=points.primary.is_signed,
        stills=[_data_uri(png) for png in stills],
        page_data=script_json(_page_data(points, run, view)),
        payload=encode_payload(mesh, points.with_remainders(), run),
        css=style_sheet(),
        drawing=_drawing(run),
        circles=_circles(run),
        scripts=[*viewer_scripts(), asset("page.js")],
    )
    with atomic_file(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _groups(points: InspectedPoints) -> tuple[Sequence[Column], ...]:
    """Columns that share a scale: deviations, measured minus predicted, HTM minus Abbe."""
    return points.columns, points.remainders, points.differences


def _column_view(
    points: InspectedPoints, column: Column, run: RunRecord, *, span_mm: float
) -> dict:
    """Everything that the template shows of one column."""
    return {
        "name": column.name,
        "label": column.label,
        "statistics": column_statistics(column, run.tolerance_mm),
        "features": feature_statistics(points, column, run.tolerance_mm),
        "worst": worst_places(points, column).tolist(),
        "span_mm": span_mm,
    }


def _optional_columns(points: InspectedPoints) -> dict[str, bool]:
    """Which optional rows and columns the tables have."""
    return {
        "cause": points.cause is not None,
        "uncut": any((v.status == "uncut").any() for v in points.columns),
        "gouged": any((v.status == "gouged away").any() for v in points.columns),
    }


def _page_data(points: InspectedPoints, run: RunRecord, view: ReportView | None) -> dict:
    """What the script of the page needs apart from the payload."""
    thresholds_mm = _tolerance_steps(points, run.tolerance_mm)
    columns = {}
    for group in _groups(points):
        scale = {
            "range_um": view.range_um if view else um_from_mm(common_range_mm(group)),
            "largest_um": um_from_mm(_largest_mm(group)),
        }
        for column in group:
            columns[column.name] = scale | _column_data(points, column, thresholds_mm)
    return {
        "variants": columns,
        "primary": points.primary.name,
        "thresholds_um": um_from_mm(thresholds_mm).tolist(),
        "tolerance_index": int(np.searchsorted(thresholds_mm, run.tolerance_mm)),
        "decimals": um_decimals(_largest_mm(points.columns)),
        "colour_stops": COLOUR_STOPS,
        "unknown_colour": UNKNOWN_COLOUR,
        "flags": [_flag(result) for result in flagged(run.features)],
        "view": asdict(view) if view else None,
    }


def _flag(result: FeatureResult) -> dict:
    """A flag over the map: where it points, what it says, and its verdict."""
    title, value = flag_text(result).split("\n")
    verdict = (result.measured or result.predicted).verdict
    return {
        "places": [{"at": list(p.at_mm), "normal": list(p.normal)} for p in result.places],
        "title": title,
        "value": value,
        "verdict": verdict.name.lower(),
    }


def _drawing(run: RunRecord) -> dict:
    """What the template shows of the drawing's requirements."""
    return {
        "rows": [(result, used_share(result)) for result in run.features],
        "has_measured": any(result.measured for result in run.features),
        "coverage": COVERAGE,
        "is_drawn": any(r.predicted and r.predicted.interval_mm for r in run.features),
        "spread_text": spread_text,
    }


def _circles(run: RunRecord) -> dict:
    """What the template shows of the circular tests."""
    tests = run.circular_tests
    return {
        "rows": [
            (test, circular_values(test), circular_verdict(test), polar_plot(test))
            for test in tests
        ],
        "figures": FIGURES,
        "accepted": circular_limits(tests[0]) if tests else "",
    }


def _column_data(points: InspectedPoints, column: Column, thresholds_mm: np.ndarray) -> dict:
    size = np.abs(column.deviation_mm[column.is_cut])
    weight = np.ones(size.size) if column.weight is None else column.weight[column.is_cut]
    order = np.argsort(size)
    up_to = np.concatenate([[0.0], np.cumsum(weight[order])])
    worst = worst_places(points, column) if column.is_signed else ()
    within = np.searchsorted(size[order], thresholds_mm, side="right")
    return {
        "label": column.label,
        "is_signed": column.is_signed,
        "weight": up_to[-1],
        "outside": (up_to[-1] - up_to[within]).tolist(),
        "worst": [
            {"at": points.point_mm[i].tolist(), "normal": points.normal[i].tolist()} for i in worst
        ],
    }


def _tolerance_steps(points: InspectedPoints, tolerance_mm: float) -> np.ndarray:
    """Positions of the tolerance slider; the tolerance of the run is exactly one of them."""
    end = max(2 * tolerance_mm, 1.1 * _largest_mm(points.columns))
    return np.unique(np.append(np.linspace(0, end, _SLIDER_STEPS + 1), tolerance_mm))


def _largest_mm(columns: Sequence[Column]) -> float:
    return max([0.0, *(float(np.abs(v.deviation_mm[v.is_cut]).max(initial=0)) for v in columns)])


def _data_uri(png: Path) -> str:
    with Image.open(png) as picture:
        return jpeg_data_uri(picture)
