"""Running a program in whatever dialect it is written."""

from __future__ import annotations

from dataclasses import replace

from gcode.errors import ProgramError
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["run_program"]


def run_program(
    controller: Controller, source: Source, dialect: type[Dialect], options: RunOptions
) -> None:
    """Run a program to its end.

    Parameters
    ----------
    controller : Controller
        State at the start; holds the record afterwards.
    source : Source
        The program.
    dialect : type of Dialect
    options : RunOptions
        `max_blocks` counts those beyond one for every line.

    Raises
    ------
    ProgramError
        With the line at which the program cannot go on.
    """
    try:
        dialect.run(controller, source,
                    replace(options, max_blocks=options.max_blocks + len(source)))  # fmt: skip
    except ProgramError as error:
        raise error.located(file=None, line=controller.line) from None
    except RecursionError:
        raise ProgramError("expression is nested too deeply", line=controller.line) from None
    except OverflowError:
        raise ProgramError("number too large", line=controller.line) from None
