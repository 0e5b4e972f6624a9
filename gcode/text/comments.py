"""Comments that the controller shows: (MSG,), (DEBUG,), (PRINT,), (LOG,)."""

from __future__ import annotations

import re

from gcode.errors import ProgramError
from gcode.text.expressions import Reader, value_of_key
from gcode.text.lexer import compact
from gcode.text.parameters import Parameters

__all__ = ["expand_comment"]

_PARAMETER = re.compile(r"#(?:<[^>]*>|\d+)|%[a-z]+|%\.\d+f", re.IGNORECASE)


def expand_comment(text: str, parameters: Parameters) -> str:
    """Replace parameters in a comment by their values, as (DEBUG, ) does."""

    def replace(match: re.Match[str]) -> str:
        token = match.group()
        if not token.startswith("#"):
            return token
        reader = Reader(compact(token)[1:])
        try:
            return f"{parameters.get(value_of_key(reader.parameter_name(), parameters)):.6f}"
        except ProgramError:
            return "######"

    return _PARAMETER.sub(replace, text)
