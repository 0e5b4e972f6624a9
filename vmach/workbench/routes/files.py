"""Files of the opened folder: results to look at and to take along, files that the page sends."""

from __future__ import annotations

import asyncio
import difflib
import itertools
from pathlib import Path
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from gcode import Source, readable
from vmach.errors import InputError, VmachError
from vmach.files.atomic import write_under_free_name
from vmach.files.job_name import free_job_name
from vmach.workbench.added_readings import job_with_readings
from vmach.workbench.exchange import read_content, read_json, session_of
from vmach.workbench.opened_folder import MOST_UPLOADED, OpenedFolder
from vmach.workbench.session import RESULTS, Session
from vmach.workbench.steps_back import Step

__all__ = ["routes"]

#: what is shown in the page: reports with their own scripts, shut off from everything else
_REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:; frame-ancestors 'self'"
)
_SHOWN = {".html": "text/html", ".png": "image/png"}
#: characters of a text that the editor and the difference of two take
_MOST_TEXT = 4_000_000
#: changed places of a difference that are sent, and lines around each
_MOST_HUNKS, _AROUND = 400, 2
#: lines of programs that are compared in the page: the time grows with their square
_MOST_LINES = 20_000


def _folder(request: Request) -> OpenedFolder:
    folder = session_of(request).folder
    if folder is None:
        raise InputError("no folder is open", hint="open a job first")
    return folder


async def _show(request: Request) -> Response:
    """A report or a picture."""
    path = _folder(request).existing(request.path_params["name"])
    kind = _SHOWN.get(path.suffix)
    if kind is None:
        raise InputError(f"{path.name!r} is not shown", accepted=", ".join(_SHOWN))
    headers = {"content-security-policy": _REPORT_POLICY}
    return Response(path.read_bytes(), media_type=kind, headers=headers)


async def _download(request: Request) -> Response:
    folder = _folder(request)
    path = folder.existing(request.path_params["name"])
    name = _name_outside(folder, path)
    plain = name.replace('"', "").encode("ascii", "replace").decode()
    said = f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name, safe='')}"
    headers = {"content-disposition": said}
    return Response(path.read_bytes(), media_type="application/octet-stream", headers=headers)


def _name_outside(folder: OpenedFolder, path: Path) -> str:
    """The name of a file beside those of other jobs: a result carries the name of its job."""
    inside = path.relative_to(folder.root).parts
    is_result = len(inside) > 2 and inside[0] == RESULTS
    return f"{inside[1]}-{path.name}" if is_result else path.name


async def _upload(request: Request) -> Response:
    """Take a file into the folder; one that vmach did not write is never replaced."""
    folder = _folder(request)
    name = request.path_params["name"]
    folder.check_new(name)
    content = await read_content(request, MOST_UPLOADED)
    path = folder.write(name, content)
    return JSONResponse({"file": folder.name_of(path), "bytes": len(content)})


async def _instruments(request: Request) -> Response:
    return JSONResponse((await session_of(request).ask("instruments"))[0])


async def _readings(request: Request) -> Response:
    """A new job that names readings which lie in the folder; refused where they cannot be read."""
    session = session_of(request)
    folder, job, _ = session.need_job()
    asked = await read_json(request)
    file, settings = folder.existing(str(asked.get("file", ""))), asked.get("settings")
    if not isinstance(settings, dict) or not isinstance(settings.get("kind"), str):
        raise InputError("settings", accepted="the kind of instrument, and what its section takes")
    if not all(_is_plain(value) for value in settings.values()):
        raise InputError("settings", accepted="numbers, lists of numbers and words")
    text = job_with_readings(job.read_text(encoding="utf-8"), job.name, file.name, settings)
    name = write_under_free_name(lambda: free_job_name(job), text.encode())
    try:
        await session.ask("check_job", job=str(name))
    except VmachError:
        name.unlink()
        raise
    is_opened = session.open_next(name, after=job)
    return JSONResponse(session.record() | {"made": name.name, "is_opened": is_opened})


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return len(value) <= 6 and all(isinstance(one, int | float) for one in value)
    return isinstance(value, int | float | str) and len(str(value)) <= 200


async def _read_text(request: Request) -> Response:
    folder = _folder(request)
    path = folder.existing(str(request.query_params.get("file", "")))
    return JSONResponse({"file": folder.name_of(path), "text": _text(path)})


async def _write_effect(request: Request) -> Response:
    """Save the file of an own effect from the editor."""
    session, folder, asked = session_of(request), _folder(request), await read_json(request)
    name, text = asked.get("file"), asked.get("text")
    if not isinstance(name, str) or not name.endswith(".py") or not isinstance(text, str):
        raise InputError("file and text", accepted="a Python file and its text")
    path = folder.inside(name)
    before = _text(path) if path.is_file() else None
    _put_text(session, path, text)
    if before is not None and before != text:
        session.steps.did(Step(
            f"text of {path.name}", lambda: _bring_back(session, path, before, after=text),
            lambda: _bring_back(session, path, text, after=before),
        ))  # fmt: skip
    return JSONResponse({"file": folder.name_of(path)})


def _put_text(session: Session, path: Path, text: str) -> None:
    """Write the file of an own effect: a known one is the user's to change, another is new."""
    if path in session.effect_files:
        path.write_text(text, encoding="utf-8")
    else:
        folder = session.need_job()[0]
        folder.write(folder.name_of(path), text.encode())


def _bring_back(session: Session, path: Path, text: str, *, after: str) -> None:
    """Bring back a text of an own effect where `after` stands; tabs that show it read it again."""
    if path.is_file() and _text(path) != after:
        raise InputError(
            "was changed outside the page", file=path.name, hint="its text would be lost: copy it"
        )
    _put_text(session, path, text)
    session.forget_check()
    session.events.tell("effect-text", file=session.need_job()[0].name_of(path))


async def _difference(request: Request) -> Response:
    """The lines in which a written program differs from the job's."""
    session, folder = session_of(request), _folder(request)
    about, _ = await session.ask("about")
    program = next(file for file in about["files"] if file.endswith(about["program"]))
    written = folder.existing(str(request.query_params.get("file", "")))
    before, after = (_program_lines(Path(path)) for path in (program, written))
    is_long = max(len(before), len(after)) > _MOST_LINES
    hunks = [] if is_long else await asyncio.to_thread(_first_hunks, before, after)
    marks = [mark for hunk in hunks for mark, _ in hunk["rows"]]
    return JSONResponse({
        "hunks": hunks[:_MOST_HUNKS],
        "is_cut": len(hunks) > _MOST_HUNKS,
        "is_long": is_long,
        "removed": marks.count("-"),
        "added": marks.count("+"),
        "before": len(before),
        "after": len(after),
    })  # fmt: skip


def _first_hunks(before: list[str], after: list[str]) -> list[dict]:
    return list(itertools.islice(_hunks(before, after), _MOST_HUNKS + 1))


def _hunks(before: list[str], after: list[str]):
    """Changed places: their first lines in both texts, and rows of (" ", "-" or "+", text)."""
    # one line of the program becomes one or several: without the search for repeated lines
    match = difflib.SequenceMatcher(None, before, after, autojunk=False)
    for group in match.get_grouped_opcodes(_AROUND):
        rows: list[tuple[str, str]] = []
        for tag, low, high, new_low, new_high in group:
            if tag == "equal":
                rows += [(" ", text) for text in before[low:high]]
            else:
                rows += [("-", text) for text in before[low:high]]
                rows += [("+", text) for text in after[new_low:new_high]]
        yield {"line": group[0][1] + 1, "new_line": group[0][3] + 1, "rows": rows}


def _program_lines(path: Path) -> list[str]:
    """Lines of a program as people wrote them, where it is not too long for the page."""
    _check_size(path)
    return [readable(line) for line in Source.read(path).lines]


def _check_size(path: Path) -> None:
    if path.stat().st_size > _MOST_TEXT:
        raise InputError(f"{path.name} has {path.stat().st_size} bytes",
                         accepted=f"up to {_MOST_TEXT} in the page")  # fmt: skip


def _text(path: Path) -> str:
    _check_size(path)
    return path.read_text(encoding="utf-8", errors="replace")


routes = [
    Route("/show/{name:path}", _show),
    Route("/download/{name:path}", _download),
    Route("/api/files/{name:path}", _upload, methods=["PUT"]),
    Route("/api/instruments", _instruments),
    Route("/api/readings", _readings, methods=["POST"]),
    Route("/api/text", _read_text),
    Route("/api/effect-file", _write_effect, methods=["PUT"]),
    Route("/api/difference", _difference),
]
