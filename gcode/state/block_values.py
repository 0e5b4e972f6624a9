"""One block with all its values: what the controller obeys."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gcode.errors import ProgramError
from gcode.state.codes import CODES, code_of
from gcode.text.expressions import Expression, value_of
from gcode.text.lexer import Block
from gcode.text.parameters import Parameters

__all__ = ["Values", "evaluate", "whole"]

_UNITS = "lathe cycles are not read; SINUMERIK and HEIDENHAIN say units with it: is it for them?"
_LATHE, _NO_PLANE = "lathe cycles are not read", "planes of U V W axes do not exist here"
#: Whole number of a code that does not exist here -> why
_HINTS = {70: _UNITS, 71: _UNITS, 72: _LATHE, 17: _NO_PLANE, 18: _NO_PLANE, 19: _NO_PLANE}


@dataclass(slots=True)
class Values:
    """Numbers of a block.

    Attributes
    ----------
    words : dict
        Lower-case letter -> number.
    g, m : dict
        Modal group -> code, as ``G38.2``.
    motion : str or None
        Motion that the block makes, given or carried over from before.
    """

    words: dict[str, float] = field(default_factory=dict)
    g: dict[str, str] = field(default_factory=dict)
    m: dict[str, str] = field(default_factory=dict)
    motion: str | None = None


def whole(value: float, what: str) -> int:
    """Round a number that must be whole; raises ProgramError where it is not."""
    nearest = math.floor(value + 0.5)
    if abs(value - nearest) > 1e-4:
        raise ProgramError(f"{what} {value:g} is not a whole number")
    return nearest


def evaluate(block: Block, parameters: Parameters) -> Values:
    """Give every word its value and sort G and M codes into their groups.

    Raises
    ------
    ProgramError
        Unknown codes, two codes of one group, words out of range.
    """
    values = Values({k: value_of(v, parameters) for k, v in block.words.items()})
    for letter, value in values.words.items():
        if not math.isfinite(value):
            raise ProgramError(f"calculation resulted in {letter.upper()} = {value}, not finite")
    for expression in block.g_codes:
        _add_g(values, value_of(expression, parameters))
    for expression in block.m_codes:
        _add_m(values, expression, parameters)
    _check_signs(values.words)
    return values


def _add_g(values: Values, number: float) -> None:
    tenths = math.floor(10.0 * number + 0.001) if math.isfinite(number) else 0
    if not abs(10.0 * number - tenths) <= 0.0011:
        raise ProgramError(f"G{number:g} is not a G code")
    code = code_of("G", tenths)
    if code is None:
        raise ProgramError(f"unknown G code G{tenths / 10:g}", hint=_HINTS.get(tenths // 10))
    present = values.g.get(code.group)
    if present is not None and "G80" not in (present, code.name):
        raise ProgramError(
            f"{present} and {code.name} are of one modal group", accepted="one of them in a block"
        )
    if present is None or code.name != "G80":
        values.g[code.group] = code.name


def _add_m(values: Values, expression: Expression, parameters: Parameters) -> None:
    number = whole(value_of(expression, parameters), "M code")
    code = code_of("M", 10 * number)
    if code is None:
        known = [code.name for code in CODES.values() if code.name[0] == "M"]
        raise ProgramError(
            f"unknown M code M{number}",
            accepted=" ".join(sorted(known, key=lambda name: int(name[1:]))),
        )
    if code.group in values.m:
        raise ProgramError(
            f"{values.m[code.group]} and {code.name} are of one modal group",
            accepted="one of them in a block",
        )
    values.m[code.group] = code.name


def _check_signs(words: dict[str, float]) -> None:
    for letter, lowest in (("f", 0.0), ("s", 0.0), ("t", 0.0), ("l", 0.0), ("h", -1.0)):
        if words.get(letter, lowest) < lowest:
            raise ProgramError(f"negative {letter.upper()} word {words[letter]:g}")
    for letter in "htl":
        if letter in words:
            words[letter] = float(whole(words[letter], f"{letter.upper()} word"))
