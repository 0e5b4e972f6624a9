"""What the pages share: style, macros, scripts, and numbers as people write them."""

from __future__ import annotations

import base64
import io
import json
import math
from functools import cache
from pathlib import Path

import jinja2
from markupsafe import Markup
from PIL import Image

from vmach.base.colour_ramp import COLOUR_STOPS
from vmach.base.units import um_from_mm, with_micro_sign

__all__ = [
    "asset",
    "jpeg_data_uri",
    "render_page",
    "script_json",
    "style_sheet",
    "um_decimals",
    "um_text",
    "viewer_scripts",
]

_HERE = Path(__file__).parent
_JPEG_QUALITY = 82


def render_page(template: Path, **values: object) -> str:
    """A page from its template, which may import the macros of this package."""
    return _environment(template.parent).get_template(template.name).render(**values)


def um_decimals(largest_mm: float) -> int | None:
    """Digits after the point of lengths in um up to the largest; None: powers of ten."""
    largest_um = um_from_mm(largest_mm)
    if largest_um >= 1 or largest_um == 0:
        return 2
    return 4 if largest_um >= 0.01 else None


def um_text(length_mm: float, *, decimals: int | None, signed: bool = False) -> str:
    """A length in um as people write it; a dash where there is none."""
    if not math.isfinite(length_mm):
        return "–"
    length_um = um_from_mm(length_mm)
    text = f"{abs(length_um):.1e}" if decimals is None else f"{abs(length_um):.{decimals}f}"
    if float(text) == 0:
        return text
    return ("−" if length_um < 0 else "+" if signed else "") + text


def jpeg_data_uri(picture: Image.Image) -> str:
    """A picture as a data URI, as JPEG because it is a quarter of the size."""
    buffer = io.BytesIO()
    picture.convert("RGB").save(buffer, "JPEG", quality=_JPEG_QUALITY)
    return "data:image/jpeg;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")


def script_json(data: object) -> Markup:
    """JSON that is safe inside a <script> element."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def style_sheet(*more: Markup) -> Markup:
    """The style sheet, and a page's own, with the ramp of the colour bar in place."""
    sheets = Markup("\n").join([asset("page.css"), *more])
    return sheets.replace("RAMP_COLOURS", ", ".join(COLOUR_STOPS))


def asset(name: str, folder: Path = _HERE) -> Markup:
    """A style sheet or a script, to be put into a page as it is."""
    return Markup((folder / name).read_text(encoding="utf-8"))


def viewer_scripts() -> list[Markup]:
    """The scripts of the map that turns, for a page that has one."""
    return [asset(name) for name in ("detail.js", "scene.js", "gestures.js")]


@cache
def _environment(folder: Path) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([folder, _HERE]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["micro"] = with_micro_sign
    environment.globals["zip"] = zip
    return environment
