"""Expressions of SINUMERIK, read once and worked out as often as their block runs.

SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Flexible NC programming".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import lru_cache
from itertools import accumulate
from typing import Protocol

from gcode.errors import ProgramError

__all__ = ["WORDS", "Memory", "Worked", "expression_at", "whole_expression"]


class Memory(Protocol):
    """What an expression asks for the values of its variables."""

    r: dict[int, float]  #: R parameters, zero where nothing has been said

    def parameter(self, index: float) -> float:
        """An R parameter by an index that is worked out."""

    def variable(self, name: str, indices: tuple[float, ...], text: str) -> float:
        """A variable, or an element of a field; `text` is what its brackets hold."""


Worked = Callable[[Memory], float]

_TOKEN = re.compile(
    r"\s*(\d+\.?\d*(?:EX[+-]?\d+)?|\.\d+|\$?[A-Z_][A-Z0-9_]*|\*\*|==|<>|>=|<=|<<|[-+*/()\[\],<>])"
)
#: numbers that differ by less, relative to them, are equal in every comparison:
#: Programming Manual Job Planning 03/2006, 6FC5398-2BP10-1BA0, page 1-23 (machine data 10280 as
#: delivered)
_EQUAL = 1e-12


def _is_equal(a: float, b: float) -> bool:
    return abs(a - b) <= _EQUAL * max(abs(a), abs(b))


#: operator -> rank and function; comparisons come last of all: NC Programming 12/2019,
#: 6FC5398-2EP40-0BA0, page 444
_TWO: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "==": (0, lambda a, b: float(_is_equal(a, b))),
    "<>": (0, lambda a, b: float(not _is_equal(a, b))),
    ">=": (0, lambda a, b: float(a > b or _is_equal(a, b))),
    "<=": (0, lambda a, b: float(a < b or _is_equal(a, b))),
    ">": (0, lambda a, b: float(a > b and not _is_equal(a, b))),
    "<": (0, lambda a, b: float(a < b and not _is_equal(a, b))),
    "OR": (1, lambda a, b: float(bool(a) or bool(b))),
    "XOR": (2, lambda a, b: float(bool(a) != bool(b))),
    "AND": (3, lambda a, b: float(bool(a) and bool(b))),
    "+": (5, lambda a, b: a + b), "-": (5, lambda a, b: a - b),
    "*": (6, lambda a, b: a * b), "/": (6, lambda a, b: a / b),
    "DIV": (6, lambda a, b: float(math.trunc(a / b))), "MOD": (6, math.fmod),
}  # fmt: skip
_FUNCTIONS: dict[str, Callable[..., float]] = {
    "SIN": lambda v: math.sin(math.radians(v)), "COS": lambda v: math.cos(math.radians(v)),
    "TAN": lambda v: math.tan(math.radians(v)), "ASIN": lambda v: math.degrees(math.asin(v)),
    "ACOS": lambda v: math.degrees(math.acos(v)),
    "ATAN2": lambda a, b: math.degrees(math.atan2(a, b)),
    "SQRT": math.sqrt, "ABS": abs, "POT": lambda v: v * v,
    "TRUNC": lambda v: float(math.trunc(v)),
    "ROUND": lambda v: math.copysign(math.floor(abs(v) + 0.5), v),
    "ROUNDUP": lambda v: math.copysign(math.ceil(abs(v)), v),
    "LN": math.log, "EXP": math.exp, "MINVAL": min, "MAXVAL": max,
    "BOUND": lambda low, high, v: min(max(v, low), high),
}  # fmt: skip
_CONSTANTS = {"TRUE": 1.0, "FALSE": 0.0, "$PI": math.pi}
#: names that are no variables
WORDS = frozenset((*_TWO, *_FUNCTIONS, *_CONSTANTS, "NOT"))


@lru_cache(maxsize=4096)
def whole_expression(text: str) -> Worked:
    """An expression that is all of a text.

    Raises
    ------
    ProgramError
        It cannot be read.
    """
    tokens, position = [], 0
    while position < len(text.rstrip()):
        match = _TOKEN.match(text.upper(), position)
        if match is None:
            raise ProgramError(f"cannot read '{text[position:]}' in '{text}'")
        tokens.append(match[1])
        position = match.end()
    worked = _operation(tokens, 0)
    if tokens:
        raise ProgramError(f"cannot read '{' '.join(tokens)}' in '{text}'")
    return worked


@lru_cache(maxsize=4096)
def expression_at(text: str, position: int) -> tuple[Worked, int]:
    """The expression that begins at a position, and where it ends."""
    tokens, ends, text = [], [], text.upper()
    while (match := _TOKEN.match(text, position)) is not None:
        tokens.append(match[1])
        position = match.end()
        ends.append(position)
    worked = _operation(tokens, 0)
    return worked, ends[len(ends) - len(tokens) - 1]


def _operation(tokens: list[str], lowest: int) -> Worked:
    worked = _operand(tokens)
    while tokens and tokens[0] in _TWO and _TWO[tokens[0]][0] >= lowest:
        name = tokens.pop(0)
        worked = _both(name, worked, _operation(tokens, _TWO[name][0] + 1))
    return worked


def _both(name: str, left: Worked, right: Worked) -> Worked:
    function = _TWO[name][1]

    def worked(memory: Memory) -> float:
        a, b = left(memory), right(memory)
        try:
            return function(a, b)
        except (ZeroDivisionError, ValueError):
            raise ProgramError(f"{a:g} {name} {b:g} has no value") from None

    return worked


def _operand(tokens: list[str]) -> Worked:
    if not tokens:
        raise ProgramError("an expression ends too early")
    token = tokens.pop(0)
    if token == "+":
        return _operand(tokens)
    if token in ("-", "NOT"):
        inner = _operand(tokens)
        return (lambda m: -inner(m)) if token == "-" else (lambda m: float(not inner(m)))
    if token == "(":
        worked = _operation(tokens, 0)
        _expect(tokens, ")")
        return worked
    if token[0] in ".0123456789":
        mantissa, _, power = token.partition("EX")
        return _constant(float(mantissa) * 10.0 ** int(power or 0))
    if token in _CONSTANTS:
        return _constant(_CONSTANTS[token])
    return _call(token, tokens) if token in _FUNCTIONS else _variable(token, tokens)


def _constant(value: float) -> Worked:
    return lambda _: value


def _call(name: str, tokens: list[str]) -> Worked:
    _expect(tokens, "(")
    arguments, function = _list(tokens, ")"), _FUNCTIONS[name]

    def worked(memory: Memory) -> float:
        values = [argument(memory) for argument in arguments]
        try:
            return function(*values)
        except (ValueError, TypeError, OverflowError):
            shown = ", ".join(f"{v:g}" for v in values)
            raise ProgramError(f"{name}({shown}) has no value") from None

    return worked


def _list(tokens: list[str], closing: str) -> list[Worked]:
    found = [_operation(tokens, 0)]
    while tokens and tokens[0] == ",":
        tokens.pop(0)
        found.append(_operation(tokens, 0))
    _expect(tokens, closing)
    return found


def _variable(name: str, tokens: list[str]) -> Worked:
    if re.fullmatch(r"R\d+", name):
        number = int(name[1:])
        return lambda memory: memory.r.get(number, 0.0)
    if tokens[:1] != ["["]:
        return lambda memory: memory.variable(name, (), "")
    tokens.pop(0)
    if name.startswith("$"):  # its index may hold the name of an axis
        deep = list(accumulate(tokens, lambda n, t: n + (t == "[") - (t == "]"), initial=0))
        stop = deep.index(-1) - 1 if -1 in deep else len(tokens)
        text = " ".join(tokens[:stop])
        del tokens[:stop]
        _expect(tokens, "]")
        return lambda memory: memory.variable(name, (), text)
    indices = _list(tokens, "]")
    if name == "R" and len(indices) == 1:
        return lambda memory: memory.parameter(indices[0](memory))
    return lambda memory: memory.variable(name, tuple(i(memory) for i in indices), "")


def _expect(tokens: list[str], wanted: str) -> None:
    if not tokens or tokens.pop(0) != wanted:
        raise ProgramError(f"'{wanted}' is missing in an expression")
