"""Running a program in whatever dialect it is written."""

from __future__ import annotations

from gcode.control.flow import run_rs274
from gcode.dialects.fanuc import Fanuc
from gcode.dialects.heidenhain import Heidenhain
from gcode.dialects.sinumerik import Sinumerik
from gcode.errors import ProgramError
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["run_program"]

_TRANSLATED = {"fanuc": Fanuc, "haas": Fanuc, "heidenhain": Heidenhain, "sinumerik": Sinumerik}


def run_program(
    controller: Controller, source: Source, *, dialect: str, block_delete: bool, max_blocks: int,
    fast: bool,
) -> None:  # fmt: skip
    """Run a program to its end.

    Parameters
    ----------
    controller : Controller
        State at the start; holds the record afterwards.
    source : Source
        The program.
    dialect : str
        One of `gcode.dialects.DIALECTS`.
    block_delete : bool
        Skip lines that begin with a slash (RS274/NGC).
    max_blocks : int
        Give up after so many blocks more than the program has lines.
    fast : bool
        Use the compiled reader for plain motion (RS274/NGC).

    Raises
    ------
    ProgramError
        With the line at which the program cannot go on.
    """
    max_blocks += len(source)
    try:
        if dialect == "linuxcnc":
            run_rs274(controller, source, block_delete=block_delete, max_blocks=max_blocks,
                      fast=fast)  # fmt: skip
        else:
            _TRANSLATED[dialect](controller, source.lines, max_blocks=max_blocks).run()
    except ProgramError as error:
        raise error.located(file=None, line=controller.line) from None
    except RecursionError:
        raise ProgramError("expression is nested too deeply", line=controller.line) from None
    except OverflowError:
        raise ProgramError("number too large", line=controller.line) from None
