"""The control that a compensated program is written for."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from gcode import Dialect, Program, ProgramError, dialect_called, dialect_names
from vmach.errors import InputError

__all__ = ["check_meaning", "check_words", "target_control"]


def target_control(own: str, name: str | None, *, file: Path) -> type[Dialect]:
    """The control asked for, or the one whose dialect the program is written in.

    Parameters
    ----------
    own : str
        Dialect of the program.
    name : str or None
        The control asked for; None or ``auto`` for that dialect.
    file : Path
        The program, for messages.

    Raises
    ------
    InputError
        There is no such control, or it does not read the program's text.
    """
    try:
        control = dialect_called(own if name in (None, "auto") else name)
    except ProgramError:
        written = (known for known in dialect_names() if dialect_called(known).is_written)
        raise InputError(f"--dialect {name}", accepted=", ".join(written)) from None
    if not dialect_called(own).is_written:
        raise InputError(
            f"programs in {dialect_called(own).title} are read, not written back",
            file=file,
            hint="post it in another language of the control",
        )
    if own not in (control.name, *control.reads):
        raise InputError(
            f"a {own} program cannot be written for {control.name}: "
            "words are corrected, not translated",
            file=file,
            accepted=f"--dialect {own}",
        )
    return control


def check_meaning(program: Program, control: type[Dialect]) -> None:
    """Refuse words that the control reads otherwise than the one the program was read for.

    Raises
    ------
    InputError
        With the first such line.
    """
    own = program.language
    for line, word in _words_of(program, control, own.unlike):
        raise InputError(
            f"'{word}' means another thing on {control.name} than on {own.name}, which the "
            "program was read for",
            file=program.path,
            line=line,
            accepted=f"--control {control.name}, or [control] name in the job",
        )


def check_words(program: Program, control: type[Dialect]) -> None:
    """Refuse words that the control does not know.

    Raises
    ------
    InputError
        With the first such line.
    """
    own = program.language
    for line, word in _words_of(program, control, own.own_words):
        raise InputError(
            f"'{word}' is {own.title}'s own and no word of {control.name}",
            file=program.path,
            line=line,
            accepted=f"--dialect {own.name}",
        )


def _words_of(
    program: Program, control: type[Dialect], pattern: re.Pattern[str] | None
) -> Iterator[tuple[int, str]]:
    """Lines of a program for another control with a word of a pattern, comments left out."""
    if program.language is control or pattern is None:
        return
    for line, text in enumerate(program.source.lines, 1):
        if found := pattern.search(re.sub(r"\([^)]*\)|;.*", "", text)):
            yield line, found.group().strip()
