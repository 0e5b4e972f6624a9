"""report.html: one file to read, turn, print and send; it asks the network for nothing."""

from __future__ import annotations

import base64
import io
import json
import math
from functools import cache, partial
from pathlib import Path

import jinja2
import numpy as np
from markupsafe import Markup
from PIL import Image

from vmach.atomic import atomic_file
from vmach.report.colours import COLOUR_STOPS, UNKNOWN_COLOUR
from vmach.report.heatmap import common_range_mm
from vmach.report.histogram import histograms
from vmach.report.payload import MAX_POINTS, encode_payload
from vmach.report.result import DisplayMesh, InspectedPoints, RunRecord, Variant
from vmach.report.statistics import (
    feature_statistics,
    variant_statistics,
    worst_apart_mm,
    worst_places,
)
from vmach.report.summary import SIGN_CONVENTION
from vmach.units import um_from_mm, with_micro_sign

__all__ = ["write_report_html"]

_HERE = Path(__file__).parent
_SLIDER_STEPS = 200
_JPEG_QUALITY = 82


def write_report_html(
    path: str | Path,
    mesh: DisplayMesh,
    points: InspectedPoints,
    run: RunRecord,
    *,
    heatmap_png: str | Path | None = None,
) -> None:
    """Write the report.

    Parameters
    ----------
    path : path
        File to write.
    mesh : DisplayMesh
        With a colouring for every variant of the points.
    points, run : InspectedPoints, RunRecord
    heatmap_png : path, optional
        The picture for print and for browsers without WebGL 2.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    page = _environment().get_template("page.html.jinja").render(
        run=run,
        points=points,
        variants=[_variant_view(points, variant, run) for variant in points.variants],
        primary=points.primary.name,
        histograms=histograms(points),
        columns=_variant_columns(points),
        apart_mm=worst_apart_mm(points),
        pickable=min(len(points), MAX_POINTS),
        span_mm=max(_largest_mm(points), 1e-12),
        um=partial(_um_text, decimals=_decimals(points)),
        sign_convention=SIGN_CONVENTION,
        still=None if heatmap_png is None else _jpeg_data_uri(heatmap_png),
        page_data=_script_json(_page_data(points, run)),
        payload=encode_payload(mesh, points, run),
        css=_style_sheet(),
        scripts=[_asset("scene.js"), _asset("page.js")],
    )  # fmt: skip
    with atomic_file(path) as temporary:
        temporary.write_text(page, encoding="utf-8")


def _variant_view(points: InspectedPoints, variant: Variant, run: RunRecord) -> dict:
    """Everything that the template shows of one variant."""
    return {
        "name": variant.name,
        "label": variant.label,
        "statistics": variant_statistics(variant, run.tolerance_mm),
        "remainder_rms_mm": variant.remainder_rms_mm,
        "features": feature_statistics(points, variant, run.tolerance_mm),
        "worst": worst_places(points, variant).tolist(),
    }


def _variant_columns(points: InspectedPoints) -> dict[str, bool]:
    """Which optional rows and columns the tables have."""
    return {
        "cause": points.cause is not None,
        "remainder": any(v.remainder_rms_mm is not None for v in points.variants),
        "uncut": any((v.status == "uncut").any() for v in points.variants),
        "gouged": any((v.status == "gouged away").any() for v in points.variants),
    }


def _page_data(points: InspectedPoints, run: RunRecord) -> dict:
    """What the script of the page needs apart from the payload."""
    thresholds_mm = _tolerance_steps(points, run.tolerance_mm)
    variants = {}
    for variant in points.variants:
        size = np.sort(np.abs(variant.deviation_mm[variant.is_cut]))
        within = np.searchsorted(size, thresholds_mm, side="right")
        worst = worst_places(points, variant)
        variants[variant.name] = {
            "label": variant.label,
            "count": size.size,
            "outside": (size.size - within).tolist(),
            "worst": [
                {"at": points.point_mm[i].tolist(), "normal": points.normal[i].tolist()}
                for i in worst
            ],
        }
    return {
        "variants": variants,
        "primary": points.primary.name,
        "thresholds_um": um_from_mm(thresholds_mm).tolist(),
        "tolerance_index": int(np.searchsorted(thresholds_mm, run.tolerance_mm)),
        "range_um": um_from_mm(common_range_mm(points)),
        "largest_um": um_from_mm(_largest_mm(points)),
        "decimals": _decimals(points),
        "colour_stops": COLOUR_STOPS,
        "unknown_colour": UNKNOWN_COLOUR,
    }


def _tolerance_steps(points: InspectedPoints, tolerance_mm: float) -> np.ndarray:
    """Positions of the tolerance slider; the tolerance of the run is exactly one of them."""
    end = max(2 * tolerance_mm, 1.1 * _largest_mm(points))
    return np.unique(np.append(np.linspace(0, end, _SLIDER_STEPS + 1), tolerance_mm))


def _largest_mm(points: InspectedPoints) -> float:
    return max(float(np.abs(v.deviation_mm[v.is_cut]).max(initial=0)) for v in points.variants)


def _decimals(points: InspectedPoints) -> int | None:
    """Digits after the point of every deviation in um on the page; None: powers of ten."""
    largest_um = um_from_mm(_largest_mm(points))
    if largest_um >= 1 or largest_um == 0:
        return 2
    return 4 if largest_um >= 0.01 else None


def _jpeg_data_uri(png: str | Path) -> str:
    """Return a picture as a data URI, as JPEG because it is a quarter of the size."""
    buffer = io.BytesIO()
    with Image.open(png) as picture:
        picture.convert("RGB").save(buffer, "JPEG", quality=_JPEG_QUALITY)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def _script_json(data: object) -> Markup:
    """JSON that is safe inside a <script> element."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _um_text(length_mm: float, *, decimals: int | None, signed: bool = False) -> str:
    """A length in um as people write it; a dash where there is none."""
    if not math.isfinite(length_mm):
        return "–"
    length_um = um_from_mm(length_mm)
    text = f"{abs(length_um):.1e}" if decimals is None else f"{abs(length_um):.{decimals}f}"
    if float(text) == 0:
        return text
    return ("−" if length_um < 0 else "+" if signed else "") + text


def _style_sheet() -> Markup:
    """The style sheet with the ramp of the colour bar in place."""
    return _asset("page.css").replace("RAMP_COLOURS", ", ".join(COLOUR_STOPS))


def _asset(name: str) -> Markup:
    return Markup((_HERE / name).read_text(encoding="utf-8"))


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_HERE),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["micro"] = with_micro_sign
    return environment
