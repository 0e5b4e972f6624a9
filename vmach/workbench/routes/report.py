"""The report of what is on the screen."""

from __future__ import annotations

import base64
import binascii
import io
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from vmach.base.finite_number import is_number
from vmach.errors import InputError
from vmach.workbench.exchange import read_json, session_of
from vmach.workbench.results import result_place

__all__ = ["routes"]

#: bytes of the request: a picture of the screen, coded for JSON, and what is shown
_MOST = 8_000_000
_PICTURE = "data:image/jpeg;base64,"
#: numbers of the view, and how many each takes
_VIEW = {"azimuth_rad": 1, "elevation_rad": 1, "zoom": 1, "target_mm": 3, "section": 4,
         "range_um": 1}  # fmt: skip
_LARGEST = 1e7


async def _report(request: Request) -> Response:
    session = session_of(request)
    folder, _, _ = session.need_job()
    asked = await read_json(request, most=_MOST)
    shown = asked.get("shown") if isinstance(asked.get("shown"), dict) else {}
    (tolerance_um,) = _numbers(asked, "tolerance_um", 1)
    if tolerance_um <= 0:
        raise InputError(f"tolerance_um = {tolerance_um:g}", accepted="above 0")
    view, picture = _view(asked.get("view")), _picture(asked.get("picture"))
    look = {"quantity": str(shown.get("quantity", "deviation")),
            "model": str(shown.get("model", "abbe"))}  # fmt: skip
    minus = await session.ask_other("point_values", **look) if asked.get("is_difference") else None
    place = result_place(session, "screen.html", is_folder=False)
    with TemporaryDirectory() as room:
        still = Path(room) / "screen.jpg"
        if picture is not None:
            still.write_bytes(picture)
        await session.ask(
            "screen_report",
            path=str(folder.inside(str(place))),
            picture=None if picture is None else str(still),
            view=view,
            tolerance_um=tolerance_um,
            changes=session.changes,
            minus=minus,
            **look,
        )
    return JSONResponse({"page": str(place)})


def _view(asked: Any) -> dict[str, Any]:
    """The direction, zoom, section and scale of the screen."""
    if not isinstance(asked, dict):
        raise InputError("view", accepted=", ".join(_VIEW))
    found = {name: _numbers(asked, name, count) for name, count in _VIEW.items()}
    return {name: value if len(value) > 1 else value[0] for name, value in found.items()}


def _numbers(asked: Mapping[str, Any], name: str, count: int) -> tuple[float, ...]:
    given = asked.get(name)
    values = given if isinstance(given, list) else [given]
    is_good = len(values) == count and all(is_number(value, _LARGEST) for value in values)
    if not is_good:
        raise InputError(f"{name} = {str(given)[:60]}", accepted=f"{count} finite numbers")
    return tuple(float(value) for value in values)


def _picture(asked: Any) -> bytes | None:
    """A JPEG of the screen; it is read as a picture before it is put into the page."""
    from PIL import Image

    if asked is None:
        return None
    try:
        if not isinstance(asked, str) or not asked.startswith(_PICTURE):
            raise ValueError
        content = base64.b64decode(asked.removeprefix(_PICTURE), validate=True)
        with Image.open(io.BytesIO(content), formats=("JPEG",)) as picture:
            picture.load()
        return content
    except (ValueError, OSError, binascii.Error, Image.DecompressionBombError):
        raise InputError("picture", accepted=f"an address of data, {_PICTURE} ...") from None


routes = [Route("/api/report", _report, methods=["POST"])]
