"""Diagnose, add, add in rounds, and how the error fell; all of it commands."""

from __future__ import annotations

import contextlib
import json
import re
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from vmach.errors import InputError
from vmach.workbench.command_runs import CommandRun
from vmach.workbench.exchange import read_json, session_of
from vmach.workbench.job_chain import job_chain
from vmach.workbench.model.named_files import named_files
from vmach.workbench.results import result_place
from vmach.workbench.routes.job_commands import refuse_changed, start_command
from vmach.workbench.routes.state import offered_job
from vmach.workbench.session import Session, changed_since, contents_of

__all__ = ["evaluate_again", "routes"]

_EFFECT = re.compile(r"[a-z][a-z0-9_]{0,60}(:[A-Za-z0-9]{1,12})?")


async def _diagnose(request: Request) -> Response:
    session = session_of(request)
    _, job, _ = session.need_job()
    out = result_place(session, "diagnosis")

    async def done(run: CommandRun) -> dict[str, Any]:
        found = _found(session, out, run) | {"job": session.folder.name_of(job)}
        session.show("diagnosis", found, job, step="diagnosis")
        return found

    words = ["diagnose", job.name, "--out", str(out)]
    return JSONResponse(start_command(session, "diagnose", words, done).record())


def _found(session: Session, out: Path, run: CommandRun) -> dict[str, Any]:
    """The verdict in a folder of results, with where its page and its program are."""
    found = _json(session, out / "diagnosis.json")
    program = (found.get("next_measurement") or {}).get("program")
    return found | {
        "page": str(out / "diagnosis.html"),
        "run": run.number,
        "program": program and str(out / program),
    }


async def _add_in_rounds(request: Request) -> Response:
    """Add what is shown, diagnose the new job, and so on; all its jobs are one chain."""
    session = session_of(request)
    _, job, _ = session.need_job()
    out = result_place(session, "rounds")
    there = {path.resolve() for path in job.parent.glob("*.toml")}
    before = session.contents()

    def made() -> list[Path]:
        return [s.job for s in job_chain(job) if s.is_later and s.job not in there]

    async def done(run: CommandRun) -> dict[str, Any]:
        jobs = made()
        changed = changed_since(before)  # by others: the rounds write new files alone
        found = {} if changed else _found(session, out / "left" if jobs else out, run)
        run.result = _offered(jobs) | {"is_opened": _opened(session, *jobs, after=job)}
        refuse_changed(changed, "adding in rounds")
        last = jobs[-1] if jobs else job
        session.show("diagnosis", found | {"job": session.folder.name_of(last)}, last)
        return run.result

    async def cut(run: CommandRun) -> dict[str, Any]:
        session.events.tell("job", **session.record())  # its chain goes on now
        return _offered(made())

    words = ["diagnose", job.name, "--add-all", "--out", str(out)]
    return JSONResponse(start_command(session, "rounds", words, done, cut=cut).record())


def _opened(session: Session, *jobs: Path, after: Path) -> bool:
    """Open the last of the jobs that were made, and let the curve have them."""
    is_opened = session.open_next(*jobs, after=after)
    if is_opened:
        with contextlib.suppress(InputError):  # it is evaluated already
            _history(session, session.other_part)
    return is_opened


def _offered(jobs: Sequence[Path]) -> dict[str, Any]:
    """What a run says of the jobs that it made."""
    return {"job": str(jobs[-1]), "jobs": [job.name for job in jobs]} if jobs else {}


async def _add(request: Request) -> Response:
    session = session_of(request)
    _, job, _ = session.need_job()
    effects = (await read_json(request)).get("effects")
    is_list = isinstance(effects, list) and 0 < len(effects) <= 12
    if not is_list or not all(isinstance(e, str) and _EFFECT.fullmatch(e) for e in effects):
        raise InputError(f"effects = {effects!r}", accepted="names such as backlash:Y")

    async def done(run: CommandRun) -> dict[str, Any]:
        found = json.loads(run.output)
        made = job.parent / Path(found["job"]).name
        return found | {"is_opened": _opened(session, made, after=job)}

    words = ["add", job.name, *effects, "--json"]
    return JSONResponse(start_command(session, "add", words, done).record())


async def _history_again(request: Request) -> Response:
    """Evaluate the chain, also on another part from now on, where one is named."""
    session, told = session_of(request), await read_json(request)
    name, other = told.get("other_part"), session.other_part
    if "other_part" in told:
        other = None if name is None else offered_job(session, str(name))
    return JSONResponse(_history(session, other).record())


def evaluate_again(session: Session) -> CommandRun:
    """Evaluate the chain anew, as the other part has changed.

    Raises
    ------
    InputError
        No job is open, or it is evaluated already.
    """
    return _history(session, session.other_part)


def _history(session: Session, other: Path | None) -> CommandRun:
    """Evaluate the chain of jobs anew, on what was fitted, what was held out, and another part."""
    folder, job, _ = session.need_job()
    checked_on = [] if other is None else ["--check-job", folder.name_of(other)]
    picture = result_place(session, "history.png", is_folder=False)
    begun_ns, of_part = time.time_ns(), contents_of([] if other is None else named_files(other))

    async def done(run: CommandRun) -> dict[str, Any]:
        refuse_changed(changed_since(of_part), "history")
        session.check_on(other, since_ns=begun_ns)  # one that cannot be read is not asked for again
        found = {"steps": json.loads(run.output), "other_part": other and str(other)}
        session.show("history", found)
        return found

    words = ["history", job.name, *checked_on, "--json", "--picture", str(picture)]
    return start_command(session, "history", words, done)


def _json(session: Session, name: Path) -> dict[str, Any]:
    folder, _, _ = session.need_job()
    return json.loads(folder.existing(str(name)).read_text(encoding="utf-8"))


routes = [
    Route("/api/diagnose", _diagnose, methods=["POST"]),
    Route("/api/add", _add, methods=["POST"]),
    Route("/api/add-in-rounds", _add_in_rounds, methods=["POST"]),
    Route("/api/history", _history_again, methods=["POST"]),
]
