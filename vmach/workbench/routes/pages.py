"""The page itself, its scripts, and the viewer that the reports have too."""

from __future__ import annotations

from pathlib import Path

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

import vmach
from vmach.base.colour_ramp import COLOUR_STOPS
from vmach.workbench.exchange import refused

__all__ = ["routes"]

_STATIC = Path(__file__).parents[1] / "static"
#: scripts of the reports' viewer; no module of the reports is loaded for them
_VIEWER = {name: Path(vmach.__file__).parent / "report" / "page" / name
           for name in ("detail.js", "scene.js", "gestures.js")}  # fmt: skip
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript",
          ".svg": "image/svg+xml"}  # fmt: skip


async def _page(request: Request) -> Response:
    return _file(_STATIC / "index.html")


async def _static(request: Request) -> Response:
    name = request.path_params["name"]
    known = {path.name: path for path in _STATIC.iterdir() if path.suffix in _TYPES}
    return _file(known[name]) if name in known else refused("no such page", 404)


async def _viewer(request: Request) -> Response:
    name = request.path_params["name"]
    if name not in _VIEWER:
        return refused("no such script", 404)
    return _file(_VIEWER[name])


def _file(path: Path) -> Response:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".css":
        text = text.replace("RAMP_COLOURS", ", ".join(COLOUR_STOPS))
    return Response(text, media_type=_TYPES[path.suffix])


routes = [
    Route("/", _page),
    Route("/static/{name}", _static),
    Route("/viewer/{name}", _viewer),
]
