"""One block with all its values: what the controller obeys."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gcode.errors import ProgramError
from gcode.state.codes import G_GROUPS, M_GROUPS, code_name
from gcode.text.expressions import Expression, value_of
from gcode.text.lexer import Block
from gcode.text.parameters import Parameters

__all__ = ["Values", "evaluate", "whole"]


@dataclass(slots=True)
class Values:
    """Numbers of a block.

    Attributes
    ----------
    words : dict
        Lower-case letter -> number.
    g, m : dict
        Modal group -> G code times ten, or M code.
    motion : int or None
        Motion that the block makes, given or carried over from before.
    """

    words: dict[str, float] = field(default_factory=dict)
    g: dict[str, int] = field(default_factory=dict)
    m: dict[str, int] = field(default_factory=dict)
    motion: int | None = None


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
    for value in values.words.values():
        if not math.isfinite(value):
            raise ProgramError("calculation resulted in a value that is not finite")
    for expression in block.g_codes:
        _add_g(values, value_of(expression, parameters))
    for expression in block.m_codes:
        _add_m(values, expression, parameters)
    _check_signs(values.words)
    return values


def _add_g(values: Values, number: float) -> None:
    code = math.floor(10.0 * number + 0.001)
    if not math.isfinite(number) or abs(10.0 * number - code) > 0.0011:
        raise ProgramError(f"G{number:g} is not a G code")
    group = G_GROUPS.get(code)
    if group is None:
        raise ProgramError(f"unknown G code {code_name(code)}", hint=_hint(code))
    present = values.g.get(group)
    if present is not None and 800 not in (present, code):
        raise ProgramError(f"{code_name(present)} and {code_name(code)} are of one modal group",
                           accepted="one of them in a block")
    if present is None or code != 800:
        values.g[group] = code


def _hint(code: int) -> str | None:
    if code in (700, 710, 711, 712, 720, 721, 722):
        return "lathe cycles are not read"
    if code in (171, 181, 191):
        return "planes of U V W axes do not exist here"
    return None


def _add_m(values: Values, expression: Expression, parameters: Parameters) -> None:
    code = whole(value_of(expression, parameters), "M code")
    group = M_GROUPS.get(code)
    if group is None:
        raise ProgramError(f"unknown M code M{code}",
                           accepted="M" + " M".join(str(c) for c in sorted(M_GROUPS)))
    if group in values.m:
        raise ProgramError(f"M{values.m[group]} and M{code} are of one modal group",
                           accepted="one of them in a block")
    values.m[group] = code


def _check_signs(words: dict[str, float]) -> None:
    for letter, lowest in (("f", 0.0), ("s", 0.0), ("t", 0.0), ("l", 0.0), ("h", -1.0)):
        if words.get(letter, lowest) < lowest:
            raise ProgramError(f"negative {letter.upper()} word {words[letter]:g}")
    for letter in "htl":
        if letter in words:
            words[letter] = float(whole(words[letter], f"{letter.upper()} word"))
