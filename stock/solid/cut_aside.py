"""A part that is cut in a process of its own, while this one looks at its surface.

The set operations keep the interpreter's lock, so a thread would not do. The other process does
the same work on the same arrays: the part has the same bits. If that process dies or fails, the
part is cut here, and what is wrong is raised here.

Source: the set operations are those of the library manifold3d.
"""

from __future__ import annotations

import contextlib
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from queue import SimpleQueue
from threading import Thread
from types import SimpleNamespace
from typing import Any, BinaryIO

from stock.child_process import children_may_die, isolated_python
from stock.compile_ahead import one_stroke
from stock.solid.solid import VirtualPart, cut_part
from stock.sweeps import Sweeps
from stock.threads import cores_to_use
from stock.tools import Tool

__all__ = ["CutAside", "cutter_at_hand"]

#: fewer sweeps are cut before another process has begun
_WORTHWHILE_SWEEPS = 500
#: the process of `cutter_at_hand` until it is needed
_at_hand: list[subprocess.Popen] = []


@contextlib.contextmanager
def cutter_at_hand() -> Iterator[None]:
    """Let a process get ready to cut within the block, while this one finds out what.

    The first `CutAside` takes it; nobody needs to.
    """
    if cores_to_use() > 1 and sys.executable:
        with contextlib.suppress(OSError):  # the process is started when it is needed
            _at_hand.append(_started())
    try:
        yield
    finally:
        while _at_hand:
            _end(_at_hand.pop())


def _started() -> subprocess.Popen:
    return subprocess.Popen(isolated_python(__name__), stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)  # fmt: skip


def _end(process: subprocess.Popen) -> None:
    """End a process and close its pipes."""
    process.kill()
    with process:
        pass


class CutAside(contextlib.AbstractContextManager):
    """A part that is being cut; the end of the ``with`` block ends that.

    Parameters
    ----------
    sweeps, tools, blank
        As of `stock.cut_part`.
    """

    def __init__(self, sweeps: Sweeps, tools: Sequence[Tool], blank: Any) -> None:
        self._asked = (sweeps, tools, blank)
        self._told: SimpleQueue[tuple[int, int] | VirtualPart | None] = SimpleQueue()
        self._process: subprocess.Popen | None = None
        self._thread: Thread | None = None
        self._while_open = contextlib.ExitStack()

    def __enter__(self) -> CutAside:
        self._while_open.enter_context(children_may_die())
        if cores_to_use() > 1 and len(self._asked[0]) >= _WORTHWHILE_SWEEPS and sys.executable:
            with contextlib.suppress(OSError):
                self._process = _at_hand.pop() if _at_hand else _started()
        if self._process is not None:
            self._thread = Thread(target=self._talk, args=(self._process,), daemon=True)
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None and self._thread is not None:
            self._process.kill()  # so that the thread ends, which writes and reads
            self._thread.join()
            _end(self._process)
        self._while_open.close()

    def part(self, progress: Callable[[int, int], None] | None = None) -> VirtualPart:
        """The part, when it is ready; arguments and errors as of `stock.cut_part`."""
        while self._thread is not None:
            told = self._told.get()
            if isinstance(told, VirtualPart):
                return replace(told)  # made anew, its arrays are read-only again
            if told is None:  # it has died
                break
            if progress:
                progress(*told)
        return cut_part(*self._asked, progress=progress)

    def _talk(self, process: subprocess.Popen) -> None:
        """Ask the other process, and pass on what it says."""
        sweeps, tools, blank = self._asked
        if hasattr(blank, "vertices"):
            blank = SimpleNamespace(vertices=blank.vertices, faces=blank.faces)
        with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError):
            pickle.dump((sweeps, tools, blank), process.stdin, pickle.HIGHEST_PROTOCOL)
            process.stdin.flush()
            while True:
                self._told.put(pickle.load(process.stdout))
        self._told.put(None)


def _live(door: BinaryIO, answers: BinaryIO) -> None:
    """The other process: cut one part, and say on the way how far it is."""

    def answer(*what: object) -> None:
        pickle.dump(what if len(what) > 1 else what[0], answers, pickle.HIGHEST_PROTOCOL)
        answers.flush()

    with contextlib.suppress(KeyboardInterrupt, BrokenPipeError, EOFError):
        cut_part(*one_stroke())  # all that is loaded on the first call
        sweeps, tools, blank = pickle.load(door)
        answer(cut_part(sweeps, tools, blank, progress=answer))


if __name__ == "__main__":
    from stock.solid import cut_aside as _own  # classes of the package, not of ``__main__``

    _own._live(sys.stdin.buffer, sys.stdout.buffer)
