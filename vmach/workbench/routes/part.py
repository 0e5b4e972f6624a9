"""The part: mesh, colours, points, lines of the program, the tool along it."""

from __future__ import annotations

import math
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from vmach.errors import InputError
from vmach.workbench.exchange import framed, number_of, read_json, session_of
from vmach.workbench.model.remote import ModelStopped

__all__ = ["routes"]

#: lines of a program in one answer
_MOST_LINES = 2000
_LARGEST = 10**9


async def _about(request: Request) -> Response:
    return JSONResponse((await session_of(request).ask("about"))[0])


async def _measured(request: Request) -> Response:
    return JSONResponse((await session_of(request).ask("measured"))[0])


async def _mesh(request: Request) -> Response:
    _, content = await session_of(request).ask("mesh")
    return Response(content, media_type="application/octet-stream")


async def _values(request: Request) -> Response:
    session, query = session_of(request), request.query_params
    changes = [] if query.get("as_is") else session.changes
    return framed(*await session.ask(
        "values",
        quantity=query.get("quantity", "deviation"),
        model=query.get("model", "abbe"),
        changes=changes,
        tolerance_um=_positive(query.get("tolerance_um")),
    ))  # fmt: skip


async def _what_if(request: Request) -> Response:
    """Move the sliders: the new colours, and how far the measurement is from them."""
    session = session_of(request)
    asked = await read_json(request)
    changes = asked.get("changes")
    if not isinstance(changes, list) or len(changes) > 60:
        raise InputError("changes", accepted="a list of effects")
    shown = asked.get("shown") if isinstance(asked.get("shown"), dict) else {}
    figures, content = await session.ask(
        "values", quantity=str(shown.get("quantity", "deviation")),
        model=str(shown.get("model", "abbe")), changes=changes,
    )  # fmt: skip
    residual, _ = await session.ask("residual", changes=changes)
    tab, gesture = (str(asked.get(name, ""))[:40] for name in ("tab", "gesture"))
    session.set_changes(changes, tab=tab, gesture=gesture)
    return framed(figures | {"residual_rms_um": residual["rms_um"]}, content)


async def _other_about(request: Request) -> Response:
    return JSONResponse((await session_of(request).ask_other("about"))[0])


async def _other_mesh(request: Request) -> Response:
    _, content = await session_of(request).ask_other("mesh")
    return Response(content, media_type="application/octet-stream")


async def _other_values(request: Request) -> Response:
    """Values of the job beside; none where it was put away while they were asked for."""
    session, query = session_of(request), request.query_params
    look = {name: query.get(name, usual) for name, usual in
            (("quantity", "deviation"), ("model", "abbe"))}  # fmt: skip
    try:
        return framed(*await session.ask_other("values", **look))
    except (InputError, ModelStopped):
        if session.other is not None:
            raise
        return framed({}, b"")


async def _difference(request: Request) -> Response:
    """The open job less the one beside it, at the points of both."""
    session, query = session_of(request), request.query_params
    look = {name: query.get(name, usual) for name, usual in
            (("quantity", "deviation"), ("model", "abbe"))}  # fmt: skip
    minus = await session.ask_other("point_values", **look)
    tolerance_um = _positive(query.get("tolerance_um"))
    return framed(*await session.ask(
        "difference", minus=minus, changes=session.changes, tolerance_um=tolerance_um, **look
    ))  # fmt: skip


async def _exact(request: Request) -> Response:
    """The part cut anew with the sliders as they are."""
    session = session_of(request)
    return framed(*await session.ask("exact", changes=session.changes))


async def _point(request: Request) -> Response:
    query = request.query_params
    record, _ = await session_of(request).ask(
        "point", points=query.get("points", "surface"), at=_three(query, "xyz"),
        normal=_three(query, "ijk"),
    )  # fmt: skip
    return JSONResponse(record)


async def _line(request: Request) -> Response:
    line = number_of(request.query_params.get("line"), "line", default=1, most=_LARGEST)
    return framed(*await session_of(request).ask("line", line=line))


async def _program(request: Request) -> Response:
    query = request.query_params
    record, _ = await session_of(request).ask(
        "program",
        first=number_of(query.get("first"), "first", default=1, most=_LARGEST),
        count=number_of(query.get("count"), "count", default=200, most=_MOST_LINES),
    )
    return JSONResponse(record)


async def _effects(request: Request) -> Response:
    return JSONResponse((await session_of(request).ask("effects"))[0])


async def _playback(request: Request) -> Response:
    return framed(*await session_of(request).ask("playback"))


def _three(query: Any, names: str) -> list[float]:
    return [_finite(query.get(name), name) for name in names]


def _positive(text: str | None) -> float | None:
    if text is None:
        return None
    value = _finite(text, "tolerance_um")
    if not 0 < value < 1e6:
        raise InputError(f"tolerance_um = {text[:20]!r}", accepted="above 0")
    return value


def _finite(text: str | None, name: str) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} = {str(text)[:20]!r}", accepted="a number")
    return value


routes = [
    Route("/api/about", _about),
    Route("/api/measured", _measured),
    Route("/api/mesh", _mesh),
    Route("/api/values", _values),
    Route("/api/what-if", _what_if, methods=["POST"]),
    Route("/api/other/about", _other_about),
    Route("/api/other/mesh", _other_mesh),
    Route("/api/other/values", _other_values),
    Route("/api/other/difference", _difference),
    Route("/api/exact", _exact),
    Route("/api/point", _point),
    Route("/api/line", _line),
    Route("/api/program", _program),
    Route("/api/effects", _effects),
    Route("/api/playback", _playback),
]
