"""Results in several places that belong together: they change as one, or not at all."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Protocol

from vmach.errors import InputError
from vmach.files.workplace import nearest_existing

__all__ = ["Result", "put_in_place", "together"]


class Result(Protocol):
    """A file or a folder that is ready, beside the place that it goes to."""

    @property
    def place(self) -> Path:
        """Where it goes."""

    @property
    def is_folder(self) -> bool:
        """Whether its place may hold files of a user."""

    def prepare(self, coming: Collection[Path]) -> None:
        """Do what takes time or may fail; `coming` are the places of all that come with it."""

    def set_aside(self) -> None:
        """Move away the file that is in the place."""

    def put_back(self) -> None:
        """Undo `set_aside`."""

    def put(self) -> None:
        """Move the result to its place, in one step."""

    def finish(self) -> None:
        """Do what is left when all are in place."""


#: results that wait for the end of their block, and what holds the folders that they wait in
_WAITING: ContextVar[tuple[list[Result], ExitStack] | None] = ContextVar("waiting", default=None)


@contextmanager
def together() -> Iterator[None]:
    """Let every result that the block makes take its place at its end, or none of them.

    Two names cannot change in one step. So the old files go before the first new one comes. A kill
    at any moment leaves old results or new ones. Some may be missing, but they never mix.
    """
    with ExitStack() as rooms:
        results: list[Result] = []
        token = _WAITING.set((results, rooms))
        try:
            yield
        finally:
            _WAITING.reset(token)
        _put_all(results)


def put_in_place(result: Result, room: ExitStack) -> None:
    """Put a result in its place, now or at the end of the block of `together` that it is made in.

    Parameters
    ----------
    result : Result
    room : ExitStack
        What holds the folder that the result waits in; taken over where it has to wait.
    """
    waiting = _WAITING.get()
    if waiting is None:
        _put_all([result])
        return
    results, rooms = waiting
    results.append(result)
    rooms.push(room.pop_all())


def _put_all(results: list[Result]) -> None:
    """Put them in their places while no other run does so in the same folders."""
    with _held({nearest_existing(result.place.parent) for result in results}):
        _exchange_all(sorted(results, key=lambda result: not result.is_folder))


@contextmanager
def _held(folders: Collection[Path]) -> Iterator[None]:
    """Lock folders, in an order that all runs share; not where the file system has no locks."""
    with ExitStack() as locks:
        for folder in sorted(folders):
            lock = os.open(folder, os.O_RDONLY)
            locks.callback(os.close, lock)
            with suppress(OSError):
                fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _exchange_all(results: Sequence[Result]) -> None:
    """Exchange the first in one step, while nothing is in the places of the others."""
    for result in results:
        result.prepare([other.place for other in results])
    try:
        for result in results[1:]:
            result.set_aside()
        for result in results[:1]:
            result.put()
    except (OSError, InputError):
        for result in results[1:]:
            result.put_back()
        raise
    for result in results[1:]:
        result.put()
    for result in results:
        result.finish()
