"""The model's process: it reads a job, then answers until nobody asks any more."""

from __future__ import annotations

import traceback
from collections.abc import Sequence
from multiprocessing.connection import Connection
from pathlib import Path

__all__ = ["serve"]


def serve(pipe: Connection, job: str, effect_files: Sequence[str], control: str | None) -> None:
    """Answer questions ``(name, arguments)`` with ``("answer", record, bytes)``.

    What goes wrong is answered with ``("refused", message, {})`` where the user's files are to
    blame, in the words of the command line, and with ``("fault", message, {})`` otherwise.
    """
    answers, trouble = None, None
    try:
        _prepare(control)
        from vmach.workbench.model.answers import Answers

        answers = Answers(job, effect_files)
    except Exception as error:
        trouble = _told(error)
    while True:
        try:
            name, arguments = pipe.recv()
            pipe.send(trouble or _answer(answers, name, arguments))
        except (EOFError, OSError):  # nobody asks any more, or waits for the answer
            return


def _prepare(control: str | None) -> None:
    from vmach.base.kernel_cache import (
        collect_less_often,
        find_room_for_kernels,
        forget_stale_kernels,
    )

    find_room_for_kernels()
    forget_stale_kernels()
    collect_less_often()
    if control is not None:
        from vmach.job.control import tell_control

        tell_control(control)


def _answer(answers, name: str, arguments: dict) -> tuple:
    from vmach.workbench.model.answers import QUESTIONS

    try:
        return ("answer", *QUESTIONS[name](answers, **arguments))
    except Exception as error:
        return _told(error)


def _told(error: Exception) -> tuple[str, str, dict]:
    from gcode import ProgramError
    from stock import StockError
    from vmach.errors import VmachError

    if isinstance(error, VmachError | ProgramError | StockError):
        return "refused", str(error), {}
    if isinstance(error, OSError):
        return "refused", f"{error.filename}: {error.strerror}", {}
    place = traceback.extract_tb(error.__traceback__)[-1]
    what = f"{type(error).__name__}: {' '.join(str(error).split())}"
    where = f"{Path(place.filename).name}:{place.lineno}"
    return "fault", f"a fault of the program itself: {what} ({where})", {}
