"""Workers on this machine: a process for each core, one case at a time.

A worker writes the result of its case itself. One that is killed takes its case with it and no
other: the case is given to a new worker.
"""

from __future__ import annotations

import multiprocessing
import traceback
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from gcode import ProgramError
from stock import StockError
from vmach.base.broken_pipe import live_on_when_the_reader_leaves
from vmach.base.interrupt import interrupts_are_not_for_children
from vmach.errors import VmachError
from vmach.study.case import Case
from vmach.study.results import ResultFolder
from vmach.study.task import Task

__all__ = ["work_here", "work_in_processes", "worked"]

#: a case whose worker dies so often has failed
_TRIES = 2
#: seconds that a worker has to end by itself
_PATIENCE_S = 5.0


def worked(task: Task, case: Case) -> tuple[str, bool]:
    """The result of a case as text, or why there is none, and whether it is one."""
    try:
        return task.result_text(case), True
    except (VmachError, ProgramError, StockError) as error:  # about the files of the case
        return str(error), False
    except SystemExit as error:
        return f"{task.name} ends the program: sys.exit({error.code!r})", False
    except Exception:
        return traceback.format_exc(limit=-3), False


def work_one(task: Task, case: Case, folder: ResultFolder) -> bool:
    """Work on a case and keep what comes of it; whether it has a result."""
    text, is_result = worked(task, case)
    (folder.keep if is_result else folder.keep_failure)(case, text)
    return is_result


def work_here(
    task: Task, cases: Iterable[Case], folder: ResultFolder, tell: Callable[[bool], None]
) -> None:
    """Work on the cases one after the other, in this process."""
    for case in cases:
        tell(work_one(task, case, folder))


def work_in_processes(
    task: Task,
    cases: Iterable[Case],
    folder: ResultFolder,
    tell: Callable[[bool], None],
    *,
    processes: int,
) -> None:
    """Work on the cases in processes of their own.

    Parameters
    ----------
    task : Task
    cases : iterable of Case
    folder : ResultFolder
    tell : callable
        Told of every case whether it has a result.
    processes : int
    """
    waiting = deque(cases)
    team = _Team(task, folder, min(processes, len(waiting)))
    tries: dict[str, int] = {}
    try:
        team.give(waiting)
        while team.busy:
            for case, is_result in team.finished():
                if is_result is not None:
                    tell(is_result)
                    continue
                tries[case.key] = tries.get(case.key, 0) + 1
                if tries[case.key] < _TRIES:
                    waiting.appendleft(case)
                else:
                    folder.keep_failure(case, f"its process ended {_TRIES} times")
                    tell(False)
            team.give(waiting)
    finally:
        team.dismiss()


class _Team:
    """Worker processes, each with the case that it has."""

    def __init__(self, task: Task, folder: ResultFolder, size: int) -> None:
        live_on_when_the_reader_leaves()
        self._told, self._size = (task, folder), size
        self._context = multiprocessing.get_context("spawn")  # forks of threads lock up
        self._idle: list[Connection] = []
        self._process: dict[Connection, BaseProcess] = {}
        self.busy: dict[Connection, Case] = {}

    def hire(self, case: Case) -> None:
        """A new worker, with its first case."""
        mine, theirs = self._context.Pipe()
        process = self._context.Process(target=_live, args=(theirs, *self._told), daemon=True)
        with interrupts_are_not_for_children():
            process.start()
        theirs.close()
        self._process[mine], self.busy[mine] = process, case
        with suppress(OSError):  # it may be dead already, which `finished` finds
            mine.send(case)

    def finished(self) -> list[tuple[Case, bool | None]]:
        """Wait for workers: cases and whether they have a result; None where the worker died."""
        found = []
        for one in wait(list(self.busy)):
            case = self.busy.pop(one)
            try:
                found.append((case, one.recv()))
                self._idle.append(one)
            except (EOFError, OSError):
                found.append((case, None))
                self._process.pop(one).join()
                one.close()
        return found

    def give(self, waiting: deque[Case]) -> None:
        """Cases to those who have none, and new workers for those who died."""
        while waiting and self._idle:
            one, case = self._idle.pop(), waiting.popleft()
            try:
                one.send(case)
                self.busy[one] = case
            except OSError:  # it was killed while it had nothing to do
                waiting.appendleft(case)
                self._process.pop(one).join()
                one.close()
        while waiting and len(self._process) < self._size:
            self.hire(waiting.popleft())

    def dismiss(self) -> None:
        """End all workers, at once those who still work."""
        for one, process in self._process.items():
            if one in self.busy:
                process.terminate()
            one.close()
        for process in self._process.values():
            process.join(_PATIENCE_S)


def _live(door: Connection, task: Task, folder: ResultFolder) -> None:
    """A worker: case after case until nobody is there any more."""
    try:
        while True:
            door.send(work_one(task, door.recv(), folder))
    except (EOFError, OSError):
        return
