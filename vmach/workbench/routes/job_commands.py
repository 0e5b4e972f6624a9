"""Commands on the open job: with what the page knows, and of the files as they are."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vmach.workbench.command_runs import CommandRun, Done, OutOfDate
from vmach.workbench.session import Session, changed_since

__all__ = ["refuse_changed", "start_command"]

#: runs whose result is a file of its own, which says what it was made of
_WRITERS = ("add", "keep", "propose", "check", "rounds")
#: commands that take the control which the program is read for
_OF_CONTROL = ("add", "check", "compensate", "diagnose", "effects", "history", "run")


def start_command(
    session: Session, kind: str, words: Sequence[str], done: Done, *, cut: Done | None = None
) -> CommandRun:
    """Start a command of the open job; `done` and `cut` as `CommandRuns.start` has them.

    Raises
    ------
    InputError
        No job is open, or a command of this kind is at work already.
    """
    _, _, runs = session.need_job()
    checked = done if kind in _WRITERS else _if_of_now(session, kind, done)
    return runs.start(kind, _whole_command(session, words), checked, cut=cut)


def _if_of_now(session: Session, kind: str, done: Done) -> Done:
    """Take a result only where the job's files still are what they were when its run began."""
    before = session.contents()

    async def checked(run: CommandRun) -> dict[str, Any] | None:
        refuse_changed(changed_since(before), kind)
        return await done(run)

    return checked


def refuse_changed(changed: Sequence[Path], work: str) -> None:
    """Refuse a result of files that have changed meanwhile.

    Raises
    ------
    OutOfDate
    """
    if changed:
        names = ", ".join(path.name for path in changed)
        raise OutOfDate(f"{names} changed while {work} was at work: its result is of the files "
                        "before, and is not shown", hint=f"start {work} again")  # fmt: skip


def _whole_command(session: Session, words: Sequence[str]) -> list[str]:
    """A command that reads the job as the page does: with its own effects, for its control."""
    folder, _, _ = session.need_job()
    known = [
        word for path in session.effect_files for word in ("--effect-file", folder.name_of(path))
    ]
    control = ["--control", session.control] if session.control and words[0] in _OF_CONTROL else []
    return [*known, *words, *control]
