"""Custom macro B: expressions and conditions with variables that may be empty.

A variable that was never set is <null>. It is NaN here: alone it stays so, an operation takes it
for zero, EQ and NE tell it from zero (B-64484EN, "Custom macro", undefined variable).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Protocol

from gcode.errors import ProgramError
from gcode.text.expressions import Expression, Reader

__all__ = ["MacroReader", "Variables", "is_null", "whole_expression"]

#: numbers that differ by less are equal: what is left of the digits of the control
_EQUAL = 1e-8


class Variables(Protocol):
    """What an expression asks for values."""

    def get(self, key: int | str) -> float:
        """The value of a variable, NaN for <null>."""


def is_null(value: float) -> bool:
    """Whether a value is <null>."""
    return math.isnan(value)


def _filled(value: float) -> float:
    return 0.0 if math.isnan(value) else value


def _quotient(a: float, b: float) -> float:
    if b == 0.0:
        raise ProgramError("attempt to divide by zero")
    return a / b


def _remainder(a: float, b: float) -> float:
    if b == 0.0:
        raise ProgramError("MOD by zero")
    return math.fmod(a, b)


def _bits(function: Callable[[int, int], int]) -> Callable[[float, float], float]:
    return lambda a, b: float(function(round(a), round(b)))


def _is_equal(a: float, b: float) -> bool:
    if math.isnan(a) or math.isnan(b):
        return math.isnan(a) and math.isnan(b)
    return abs(a - b) <= _EQUAL * max(1.0, abs(a), abs(b))


#: operator -> precedence and function; EQ and NE alone see <null>
_OPERATORS: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "and": (4, _bits(lambda a, b: a & b)),
    "or": (3, _bits(lambda a, b: a | b)),
    "xor": (3, _bits(lambda a, b: a ^ b)),
    "eq": (0, lambda a, b: float(_is_equal(a, b))),
    "ne": (0, lambda a, b: float(not _is_equal(a, b))),
    "lt": (0, lambda a, b: float(a < b)),
    "le": (0, lambda a, b: float(a <= b)),
    "ge": (0, lambda a, b: float(a >= b)),
    "gt": (0, lambda a, b: float(a > b)),
    "mod": (4, _remainder),
    "+": (3, lambda a, b: a + b),
    "-": (3, lambda a, b: a - b),
    "*": (4, lambda a, b: a * b),
    "/": (4, _quotient),
}


def _from_bcd(value: float) -> float:
    """Value of a number whose bytes hold decimal digits."""
    digits = f"{int(value):x}"
    if not digits.isdigit():
        raise ProgramError(
            f"BIN[{value:g}] is no BCD number", accepted="digits 0 to 9 in four bits"
        )
    return float(digits)


def _checked(name: str, low: float, high: float, function: Callable[[float], float]):
    def call(value: float) -> float:
        if not low <= value <= high:
            raise ProgramError(f"{name} of {value:g}", accepted=f"{low:g} to {high:g}")
        return function(value)

    return call


#: parameter 6004#0 NAT = 0: ASIN gives 270 to 90 degrees, ATAN 0 to 360
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "asin": _checked("ASIN", -1, 1, lambda v: math.degrees(math.asin(v)) % 360.0),
    "acos": _checked("ACOS", -1, 1, lambda v: math.degrees(math.acos(v))),
    "sin": lambda v: math.sin(math.radians(v)),
    "cos": lambda v: math.cos(math.radians(v)),
    "tan": lambda v: math.tan(math.radians(v)),
    "sqrt": _checked("SQRT", 0, math.inf, math.sqrt),
    "sqr": _checked("SQRT", 0, math.inf, math.sqrt),
    "abs": abs,
    "ln": _checked("LN", 1e-300, math.inf, math.log),
    "exp": math.exp,
    "round": lambda v: math.copysign(math.floor(abs(v) + 0.5), v),
    "rnd": lambda v: math.copysign(math.floor(abs(v) + 0.5), v),
    "fix": lambda v: float(math.trunc(v)),
    "fup": lambda v: math.copysign(math.ceil(abs(v)), v),
    "adp": lambda v: v,
    "bcd": _checked("BCD", 0, 99_999_999, lambda v: float(int(str(int(v)), 16))),
    "bin": _checked("BIN", 0, 0x99_999_999, _from_bcd),
}  # fmt: skip


class MacroReader(Reader):
    """Cursor over one line of a Fanuc program, without blanks and in lower case."""

    def bracket(self) -> Expression:
        """Read ``[...]``: functions, then * / AND MOD, then + - OR XOR, then comparisons."""
        self.expect("[", "before an expression")
        value = self._operation(0)
        self.expect("]", "after an expression")
        return value

    def parameter_value(self) -> Expression:
        """Read ``#3``, ``##3`` or ``#[...]`` as a value."""
        self.expect("#", "before a variable")
        index = self.value()
        return lambda v: v.get(_index(_value(index, v)))

    def _operation(self, lowest: int) -> Expression:
        left = self.value()
        while True:
            start = self.position
            name = next((name for name in _OPERATORS if self.accept(name)), None)
            if name is None or _OPERATORS[name][0] < lowest:
                self.position = start
                return left
            left = _two(name, left, self._operation(_OPERATORS[name][0] + 1))

    def _function(self) -> Expression:
        if self.accept("atan"):
            return self._two_values("ATAN", lambda a, b: math.degrees(math.atan2(a, b)) % 360.0)
        if self.accept("pow"):
            return self._two_values("POW", lambda a, b: a**b)
        for name, function in _FUNCTIONS.items():
            if self.accept(name):
                operand = self.bracket()
                return lambda v: function(_filled(_value(operand, v)))
        found = self.text[self.position : self.position + 8]
        raise ProgramError(
            f"unknown word or function at '{found}'",
            accepted=" ".join(sorted(n.upper() for n in _FUNCTIONS)) + " ATAN POW",
        )

    def _two_values(self, name: str, function: Callable[[float, float], float]) -> Expression:
        """``ATAN[a]/[b]``, ``ATAN[a,b]``, and ``ATAN[a]`` alone."""
        self.expect("[", f"after {name}")
        first, second = self._operation(0), 1.0
        if self.accept(","):
            second = self._operation(0)
            self.expect("]", f"after {name}")
        else:
            self.expect("]", f"after {name}")
            if self.accept("/"):
                second = self.bracket()
            elif name == "ATAN":
                return lambda v: math.degrees(math.atan(_filled(_value(first, v))))
        return lambda v: function(_filled(_value(first, v)), _filled(_value(second, v)))


@lru_cache(maxsize=4096)
def whole_expression(text: str) -> Expression:
    """An expression that is all of a text, to be worked out as often as its block runs."""
    reader = MacroReader(f"[{text}]")
    found = reader.bracket()
    if reader.position != len(reader.text):
        raise ProgramError(f"cannot read '{reader.text[reader.position :]}' in an expression")
    return found


def _index(value: float) -> int:
    """Number of a variable."""
    nearest = math.floor(_filled(value) + 0.5)
    if abs(_filled(value) - nearest) > 1e-4:
        raise ProgramError(f"variable number {value:g} is not a whole number")
    return nearest


def _value(expression: Expression, variables: Variables) -> float:
    return expression(variables) if callable(expression) else expression


def _two(name: str, left: Expression, right: Expression) -> Expression:
    function = _OPERATORS[name][1]
    if name in ("eq", "ne"):
        return lambda v: function(_value(left, v), _value(right, v))
    return lambda v: function(_filled(_value(left, v)), _filled(_value(right, v)))
