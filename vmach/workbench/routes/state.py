"""What is open, what happens, and the end."""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response, StreamingResponse
from starlette.routing import Route

from vmach import __version__
from vmach.base.colour_ramp import COLOUR_STOPS, UNKNOWN_COLOUR
from vmach.errors import InputError
from vmach.workbench.exchange import read_json, refused, session_of
from vmach.workbench.new_job import SHAPES, new_job_text
from vmach.workbench.opened_folder import OpenedFolder
from vmach.workbench.recent_jobs import recent_jobs
from vmach.workbench.samples import sample_jobs
from vmach.workbench.session import Session

__all__ = ["offered_job", "routes"]

#: the status of an answer that asks first
_WOULD_END_WORK = 409
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,60}")


def _whole_state(session: Session) -> dict[str, Any]:
    return session.record() | {
        "version": __version__,
        "colour_stops": COLOUR_STOPS,
        "unknown_colour": UNKNOWN_COLOUR,
    }


async def _state(request: Request) -> Response:
    return JSONResponse(_whole_state(session_of(request)))


async def _events(request: Request) -> Response:
    session = session_of(request)
    if session.events.is_full:
        return refused("too many tabs listen", 503)
    said = session.events.listen(lambda: _whole_state(session))
    return StreamingResponse(said, media_type="text/event-stream")


async def _start_page(request: Request) -> Response:
    """Samples, jobs that were opened before, and those of the opened folder."""
    session = session_of(request)
    here = session.folder or OpenedFolder(Path.cwd().resolve())
    return JSONResponse({
        "folder": str(here.root),
        "samples": sample_jobs(),
        "recent": [str(path) for path in recent_jobs()],
        "jobs": [str(path) for path in here.jobs()],
        "files": here.files(),
        "shapes": SHAPES,
    })  # fmt: skip


async def _open(request: Request) -> Response:
    """Open a job that the start page offers, or one of the opened folder."""
    session = session_of(request)
    told = await read_json(request)
    job = offered_job(session, str(told.get("job", "")))
    ending = session.work_that_ends_with(job)
    if ending and told.get("ends_work") is not True:
        said = f"{', '.join(ending)} is at work in {session.folder.root}"
        return refused(f"{said}; opening a job of another folder ends it", _WOULD_END_WORK)
    session.open(job)
    return JSONResponse(session.record())


def offered_job(session: Session, name: str) -> Path:
    """A job that the start page offers, or one of the opened folder, by its name."""
    known = [str(path) for path in recent_jobs()] + [one["job"] for one in sample_jobs()]
    here = session.folder or OpenedFolder(Path.cwd().resolve())
    known += [str(path) for path in here.jobs()]
    if name in known:
        return Path(name)
    if Path(name).is_absolute():
        raise InputError(f"{name!r} is not on the start page", hint="vmach open JOB opens it")
    return here.existing(name)


async def _new_job(request: Request) -> Response:
    """Write a job of files that lie in the folder, and open it."""
    session, told = session_of(request), await read_json(request)
    folder = session.folder or OpenedFolder(Path.cwd().resolve())
    name = told.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise InputError(
            f"name = {str(name)[:60]!r}",
            accepted="letters a to z without accents, digits, - and _, without blanks",
            hint=f"{_plain_name(str(name))!r} would do",
        )
    text = new_job_text(told)
    for key in ("machine", "program", "nominal", "measured"):
        if told.get(key):
            folder.existing(str(told[key]))
    path = folder.check_new(f"{name}.toml")
    if path.exists():
        raise InputError("file is there already", file=path.name, hint="choose another name")
    path.write_text(text, encoding="utf-8")
    try:
        await session.check_job(path)
    except BaseException:
        path.unlink()
        raise
    session.open(path)
    return JSONResponse(session.record())


def _plain_name(name: str) -> str:
    """The nearest name that is accepted."""
    bare = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9_-]+", "-", bare).strip("-_")[:60] or "job"


async def _compare(request: Request) -> Response:
    """Put another job beside the open one, or put it away."""
    session = session_of(request)
    session.need_job()
    name = (await read_json(request)).get("job")
    session.compare_with(None if name is None else offered_job(session, str(name)))
    return JSONResponse(session.record())


async def _reload(request: Request) -> Response:
    session = session_of(request)
    session.reload()
    return JSONResponse(session.record())


async def _undo(request: Request) -> Response:
    session = session_of(request)
    session.steps.undo()
    return JSONResponse(session.record())


async def _redo(request: Request) -> Response:
    session = session_of(request)
    session.steps.redo()
    return JSONResponse(session.record())


async def _shut_down(request: Request) -> Response:
    session = session_of(request)
    session.events.tell("goodbye")
    request.app.state.shut_down()
    return JSONResponse({"goodbye": True})


routes = [
    Route("/api/state", _state),
    Route("/api/events", _events),
    Route("/api/start", _start_page),
    Route("/api/open", _open, methods=["POST"]),
    Route("/api/new-job", _new_job, methods=["POST"]),
    Route("/api/compare", _compare, methods=["POST"]),
    Route("/api/reload", _reload, methods=["POST"]),
    Route("/api/undo", _undo, methods=["POST"]),
    Route("/api/redo", _redo, methods=["POST"]),
    Route("/api/shut-down", _shut_down, methods=["POST"]),
]
