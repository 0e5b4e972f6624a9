"""The model's process seen from the server."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import get_all_start_methods, get_context
from pathlib import Path
from typing import Any

from vmach.base.interrupt import interrupts_are_not_for_children
from vmach.errors import VmachError
from vmach.workbench.model.process import serve

__all__ = ["ModelRefused", "ModelStopped", "RemoteModel"]

_ENDED = "the process that holds the part has ended"
#: a process that has loaded what a model needs, and becomes one in a moment; else each loads it
_METHOD = "forkserver" if "forkserver" in get_all_start_methods() else "spawn"
_LOADED = ["vmach.workbench.model.answers"]


class ModelRefused(VmachError):
    """The model's answer is a message: something in the user's files or arguments is wrong."""


class ModelStopped(VmachError):
    """The process has ended."""


class RemoteModel:
    """A job in a process of its own; questions are answered one after the other.

    The files stay as they are whatever happens to the process: another one reads them again.
    """

    def __init__(self, job: Path, effect_files: Sequence[Path] = (), control: str | None = None):
        context = get_context(_METHOD)
        if _METHOD == "forkserver":
            context.set_forkserver_preload(_LOADED)
        self._pipe, far_end = context.Pipe()
        files = [str(file) for file in effect_files]
        self._process = context.Process(
            target=serve, args=(far_end, str(job), files, control), daemon=True
        )
        with interrupts_are_not_for_children():  # Ctrl-C is the server's, which ends this too
            self._process.start()
        far_end.close()
        self._order = ThreadPoolExecutor(1)  # one question at a time, also where a caller gave up
        self.has_answered = False

    async def ask(self, question: str, **arguments: Any) -> tuple[dict[str, Any], bytes]:
        """The answer: a record and bytes.

        Raises
        ------
        ModelRefused
            With the message of the command line.
        ModelStopped
        """
        loop = asyncio.get_running_loop()
        try:
            waiting = loop.run_in_executor(self._order, self._exchange, question, arguments)
        except RuntimeError:  # it was closed
            raise ModelStopped(_ENDED) from None
        return await waiting

    def _exchange(self, question: str, arguments: dict) -> tuple[dict[str, Any], bytes]:
        try:
            self._pipe.send((question, arguments))
            found = self._pipe.recv()
        except (EOFError, OSError):
            found = None
        # not in the handler: the exception would hold the one of the pipe, with its buffer, until
        # the collector comes, and that cannot close a buffer in use
        if found is None:
            raise ModelStopped(_ENDED)
        self.has_answered = True
        kind, record, content = found
        if kind != "answer":
            raise ModelRefused(record)
        return record, content

    def close(self) -> None:
        """End the process, whatever it does; questions that wait are told that it has stopped."""
        self._process.kill()
        self._process.join()
        self._order.submit(self._pipe.close)  # in its turn: nobody reads a pipe that is closed
        self._order.shutdown(wait=False)
