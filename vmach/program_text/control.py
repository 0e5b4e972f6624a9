"""The control that a compensated program is written for."""

from __future__ import annotations

import re
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
        raise InputError(f"--dialect {name}", accepted=", ".join(dialect_names())) from None
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
    if own is control or own.unlike is None:
        return
    for line, text in enumerate(program.source.lines, 1):
        found = own.unlike.search(re.sub(r"\([^)]*\)|;.*", "", text))
        if found:
            raise InputError(
                f"'{found.group().strip()}' means another thing on {control.name} than on "
                f"{own.name}, which the program was read for",
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
    if own is control or own.own_words is None:
        return
    for line, text in enumerate(program.source.lines, 1):
        code = re.sub(r"\([^)]*\)|;.*", "", text)
        found = own.own_words.search(code)
        if found:
            raise InputError(
                f"'{found.group().strip()}' is {own.title}'s own and no word of {control.name}",
                file=program.path,
                line=line,
                accepted=f"--dialect {own.name}",
            )
