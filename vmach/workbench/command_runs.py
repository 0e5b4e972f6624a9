"""Long work: commands of vmach in processes of their own, with progress, and a way to stop them.

What the page does is what the command line does, with the same files and the same words.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import shlex
import signal
import sys
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vmach.base.progress import PROGRESS_LINES
from vmach.errors import InputError

__all__ = ["CommandRun", "CommandRuns", "Done", "OutOfDate"]

#: runs at a time, and those that are remembered
_MOST_AT_WORK, _MOST_KEPT = 2, 30
#: characters of output that are kept
_MOST_OUTPUT = 4_000_000
#: time that a run has to end when it is told to, before it is killed
_TO_END_S = 10.0


class OutOfDate(InputError):
    """What a run found holds for files that have changed while it was at work."""


Done = Callable[["CommandRun"], Awaitable[dict[str, Any] | None]]


@dataclass
class CommandRun:
    """One command.

    Attributes
    ----------
    number : int
    kind : str
        What the page calls it: "diagnose", "add" ...
    words : tuple of str
        The command line after ``vmach``.
    state : str
        "waiting", "running", "done", "failed" or "stopped".
    stage : str
    share : float or None
        Of the stage that is done, 0 to 1; None where it cannot be told.
    message : str
        Why it failed, as on the terminal.
    result : dict
        What it found, for the page.
    output : str
        What it printed.
    """

    number: int
    kind: str
    words: tuple[str, ...]
    state: str = "waiting"
    stage: str = ""
    share: float | None = None
    message: str = ""
    result: dict[str, Any] = field(default_factory=dict)
    output: str = ""
    process: asyncio.subprocess.Process | None = None

    @property
    def command(self) -> str:
        """As it can be typed."""
        return shlex.join(["vmach", *self.words])

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come of it."""
        return self.state in ("done", "failed", "stopped")

    def record(self) -> dict[str, Any]:
        """For the page."""
        names = ("number", "kind", "state", "stage", "share", "message", "result", "command")
        return {name: getattr(self, name) for name in names}


class CommandRuns:
    """The runs of a workbench, a few at a time, the others waiting.

    Parameters
    ----------
    folder : Path
        Where the commands run.
    tell : callable
        Called with a run whenever it has changed.
    """

    def __init__(self, folder: Path, tell: Callable[[CommandRun], None]) -> None:
        self._folder, self._tell = folder, tell
        self._room = asyncio.Semaphore(_MOST_AT_WORK)
        self._tasks: set[asyncio.Task] = set()
        self.runs: list[CommandRun] = []
        self._count = 0

    def start(
        self, kind: str, words: Sequence[str], done: Done | None = None, *, cut: Done | None = None
    ) -> CommandRun:
        """Start a command; `done` makes the page's result of a run that went well.

        `cut` makes it of one that was stopped, or failed, after it had written something.

        Raises
        ------
        InputError
            A command of this kind is at work already.
        """
        if any(run.kind == kind and not run.is_over for run in self.runs):
            raise InputError(f"{kind} is at work already", hint="wait for it, or stop it")
        self._count += 1
        run = CommandRun(self._count, kind, tuple(words))
        self.runs = [*self.runs, run][-_MOST_KEPT:]
        task = asyncio.get_running_loop().create_task(self._carry_out(run, done, cut))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        self._tell(run)
        return run

    def of_number(self, number: int) -> CommandRun:
        """A run by its number.

        Raises
        ------
        InputError
        """
        for run in self.runs:
            if run.number == number:
                return run
        raise InputError(f"there is no run {number}")

    def stop(self, run: CommandRun) -> None:
        """End a run; whatever it was writing is not there, as after Ctrl-C."""
        if run.is_over:
            return
        run.state, run.message = "stopped", "stopped; no file is half-written"
        if run.process is not None:
            _end(run.process)
        self._tell(run)

    def forget(self, kind: str) -> None:
        """Keep nothing of runs of a kind that are over."""
        self.runs = [run for run in self.runs if run.kind != kind or not run.is_over]

    def close(self) -> None:
        """End everything at once."""
        for run in self.runs:
            if run.process is not None and not run.is_over:
                _signal(run.process, signal.SIGKILL)
        for task in self._tasks:
            task.cancel()

    async def _carry_out(self, run: CommandRun, done: Done | None, cut: Done | None) -> None:
        async with self._room:
            if run.is_over:
                return
            run.state = "running"
            run.process = await asyncio.create_subprocess_exec(
                sys.executable, "-P", "-m", "vmach", *run.words,
                cwd=self._folder, env=os.environ | {PROGRESS_LINES: "1"},
                stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE, start_new_session=True, limit=_MOST_OUTPUT,
            )  # fmt: skip
            if run.is_over:  # it was stopped while its process was started
                _end(run.process)
            self._tell(run)
            assert run.process.stdout is not None and run.process.stderr is not None
            _, complaints = await asyncio.gather(
                self._read_output(run, run.process.stdout),
                self._read_progress(run, run.process.stderr),
            )
            status = await run.process.wait()
        if run.state != "stopped":
            run.state = "done" if status == 0 else "failed"
            said = complaints or f"the command ended with status {status}"
            run.message = "" if status == 0 else said
        work = done if run.state == "done" else cut
        if work is not None:
            await self._finish(run, work)
        run.output = ""  # what the page needs of it is in the result
        self._tell(run)

    async def _finish(self, run: CommandRun, done: Done) -> None:
        try:
            run.result = await done(run) or {}
        except OutOfDate as error:
            run.state, run.message = "failed", str(error)
        except (InputError, OSError, ValueError, KeyError) as error:
            run.state, run.message = "failed", f"its result cannot be read: {error}"

    async def _read_output(self, run: CommandRun, stream: asyncio.StreamReader) -> None:
        while chunk := await stream.read(65536):
            run.output = (run.output + chunk.decode("utf-8", "replace"))[-_MOST_OUTPUT:]

    async def _read_progress(self, run: CommandRun, stream: asyncio.StreamReader) -> str:
        """Follow its progress; returns what else it said."""
        said: list[str] = []
        async for line in stream:
            text = line.decode("utf-8", "replace").rstrip()
            told = _progress(text)
            if told is None:
                said.append(text)
                continue
            run.stage = str(told["stage"])
            total = float(told["total"])
            run.share = None if total <= 1 else float(told["done"]) / total
            self._tell(run)
        return "\n".join(said[-20:]).removeprefix("vmach: ")


def _progress(line: str) -> dict[str, Any] | None:
    if not line.startswith("{"):
        return None
    with contextlib.suppress(ValueError):
        told = json.loads(line)
        if isinstance(told, dict) and {"stage", "done", "total"} <= told.keys():
            return told
    return None


def _end(process: asyncio.subprocess.Process) -> None:
    """Interrupt a command, and kill it where it does not end."""
    _signal(process, signal.SIGINT)
    asyncio.get_running_loop().call_later(_TO_END_S, _signal, process, signal.SIGKILL)


def _signal(process: asyncio.subprocess.Process, number: int) -> None:
    """Tell a command and what it started; nothing where it has ended."""
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, number)
