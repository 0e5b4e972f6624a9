"""Long work: keep, propose, check, compensate, machine; all of it commands."""

from __future__ import annotations

import contextlib
import json
import re
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from vmach.errors import InputError
from vmach.workbench.command_runs import CommandRun
from vmach.workbench.exchange import read_json, session_of
from vmach.workbench.model.remote import ModelRefused, ModelStopped
from vmach.workbench.results import result_place
from vmach.workbench.routes.job_commands import start_command
from vmach.workbench.session import Session

__all__ = ["routes"]

_FILE_STEM = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
#: letters of the name of an effect
_LONGEST_NAME = 60
#: sizes of a compensation: what the page calls each, and what it may be
_SIZES = {
    "resolution_mm": ("resolution of the control, mm", 1e-6, 0.1),
    "tolerance_um": ("largest residual before rounding, µm", 1e-3, 100.0),
    "limit_um": ("largest correction accepted, µm", 1.0, 10_000.0),
    "residual_limit_um": ("largest residual as written, µm", 0.1, 1000.0),
}
_DIALECTS = ("fanuc", "grbl", "haas", "heidenhain", "linuxcnc", "sinumerik")


async def _keep(request: Request) -> Response:
    """Write what the sliders and the drawn tables say into a job beside the open one."""
    session = session_of(request)
    _, job, _ = session.need_job()
    if not session.changes:
        raise InputError("no slider was moved", hint="move one in What if first")
    words = [word for one in session.changes for word in await _kept(session, one)]

    async def done(run: CommandRun) -> dict[str, Any]:
        found = json.loads(run.output)
        found["is_opened"] = session.open_next(job.parent / Path(found["job"]).name, after=job)
        return found

    return JSONResponse(
        start_command(session, "keep", ["set", job.name, *words, "--json"], done).record()
    )


async def _kept(session: Session, one: dict[str, Any]) -> list[str]:
    """What a change is called on the command line; a drawn table becomes a file."""
    folder, _, _ = session.need_job()
    if "component" not in one:
        place = ":".join(filter(None, (one["effect"], one.get("target"))))
        return [f"{place}.{name}={value:g}" for name, value in one["parameters"].items()]
    name, words = one["component"], []
    if one.get("offset") is not None:
        _, text = await session.ask("drawn_table", wanted=one)
        words.append(f"{name}={folder.name_of(folder.write_new(f'{name}.csv', text))}")
    if one.get("measured_at_mm") is not None:
        words.append(f"{name}.measured_at_mm={','.join(f'{x:g}' for x in one['measured_at_mm'])}")
    return words


async def _propose(request: Request) -> Response:
    """Write a form that was proposed as the file of an effect."""
    session = session_of(request)
    folder, job, _ = session.need_job()
    asked = await read_json(request)
    name, number = asked.get("name"), asked.get("number", 1)
    is_name = isinstance(name, str) and _FILE_STEM.fullmatch(name)
    if not is_name or len(name) > _LONGEST_NAME:
        words = f"lower-case words joined by underscores, up to {_LONGEST_NAME} letters"
        raise InputError(f"name = {str(name)[:80]!r}", accepted=words)
    if not isinstance(number, int) or not 1 <= number <= 99:
        raise InputError(f"number = {number!r}", accepted="1 .. 99")

    async def done(run: CommandRun) -> dict[str, Any]:
        session.know_effect(folder.root / f"{name}.py")
        return {"file": f"{name}.py"}

    words = ["effects", "propose", job.name, "-o", f"{name}.py", "--number", str(number)]
    return JSONResponse(start_command(session, "propose", words, done).record())


async def _check_effect(request: Request) -> Response:
    """What the checker says of an own effect; a good one is known from then on."""
    session = session_of(request)
    folder, job, _ = session.need_job()
    path = folder.existing(str((await read_json(request)).get("file", "")))
    if path.suffix != ".py":
        raise InputError(f"{path.name!r}", accepted="a Python file")

    async def done(run: CommandRun) -> dict[str, Any]:
        session.know_effect(path)
        session.reload()
        return {"said": run.output, "file": folder.name_of(path)}

    is_measured = False
    with contextlib.suppress(ModelRefused, ModelStopped):  # this file may be what is wrong
        is_measured = (await session.ask("about"))[0]["is_measured"]
    words = ["effects", "check", folder.name_of(path)]
    words += ["--job", job.name] if is_measured else []
    return JSONResponse(start_command(session, "check", words, done).record())


async def _drop_effect(request: Request) -> Response:
    """Let the commands know an own effect no more that no job of the chain has."""
    session = session_of(request)
    folder, _, _ = session.need_job()
    session.drop_effect(folder.inside(str((await read_json(request)).get("file", ""))))
    return JSONResponse(session.record())


async def _compensate(request: Request) -> Response:
    session = session_of(request)
    _, job, _ = session.need_job()
    asked = await read_json(request)
    suffix = (await session.ask("about"))[0]["program"].rpartition(".")[2]
    out = result_place(session, f"compensated.{suffix}", is_folder=False)
    report = out.with_name("compensated.html")
    words = ["compensate", job.name, "-o", str(out), "--report", str(report), "--json",
             *_choices(asked)]  # fmt: skip

    async def done(run: CommandRun) -> dict[str, Any]:
        found = {"figures": json.loads(run.output), "program": str(out), "page": str(report)}
        session.show("compensation", found | {"run": run.number}, job, step="compensation")
        return {}

    return JSONResponse(start_command(session, "compensate", words, done).record())


def _choices(asked: dict[str, Any]) -> list[str]:
    """The options of a compensation.

    Raises
    ------
    InputError
        A choice that there is not, or a number out of bounds.
    """
    words: list[str] = []
    for name, accepted in {"model": ("abbe", "htm"), "aim": ("tool", "part"),
                           "dialect": _DIALECTS}.items():  # fmt: skip
        value = asked.get(name)
        if value in (None, ""):
            continue
        if value not in accepted:
            raise InputError(f"{name} = {value!r}", accepted=", ".join(accepted))
        words += [f"--{name}", str(value)]
    for name, (word, low, high) in _SIZES.items():
        value = asked.get(name)
        if value is None:
            continue
        if not isinstance(value, int | float) or not low <= value <= high:
            raise InputError(f"{word}: {value!r}", accepted=f"{low:g} .. {high:g}")
        words += [f"--{name.replace('_', '-')}", f"{value:g}"]
    return words


async def _machine(request: Request) -> Response:
    """Cut the virtual part, and write all results with their one-file report."""
    session = session_of(request)
    _, job, _ = session.need_job()
    out = result_place(session, "run")
    is_cut = (await session.ask("about"))[0]["has_blank"]

    async def done(run: CommandRun) -> dict[str, Any]:
        found = {"page": str(out / "report.html")}
        session.show("machined", found, job, step="machined part")
        return found

    words = ["run", job.name, "--out", str(out), *([] if is_cut else ["--no-solid"])]
    return JSONResponse(start_command(session, "machine", words, done).record())


async def _collisions(request: Request) -> Response:
    """Look for collisions; no part is cut for it."""
    session = session_of(request)
    _, job, _ = session.need_job()

    async def done(run: CommandRun) -> dict[str, Any]:
        session.show("collisions", {"found": json.loads(run.output)["collisions"]}, job)
        return {}

    words = ["check", job.name, "--collisions", "--json"]
    return JSONResponse(start_command(session, "collisions", words, done).record())


async def _stop(request: Request) -> Response:
    _, _, runs = session_of(request).need_job()
    run = runs.of_number(request.path_params["number"])
    runs.stop(run)
    return JSONResponse(run.record())


routes = [
    Route("/api/keep", _keep, methods=["POST"]),
    Route("/api/propose", _propose, methods=["POST"]),
    Route("/api/check-effect", _check_effect, methods=["POST"]),
    Route("/api/drop-effect", _drop_effect, methods=["POST"]),
    Route("/api/compensate", _compensate, methods=["POST"]),
    Route("/api/machine", _machine, methods=["POST"]),
    Route("/api/collisions", _collisions, methods=["POST"]),
    Route("/api/runs/{number:int}/stop", _stop, methods=["POST"]),
]
