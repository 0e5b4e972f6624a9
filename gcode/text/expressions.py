"""RS274/NGC expressions: numbers, parameters, operators and functions of one value."""

from __future__ import annotations

import math
from collections.abc import Callable

from gcode.errors import ProgramError
from gcode.text.parameters import Parameters

__all__ = ["Expression", "Reader", "square_root", "value_of", "value_of_key"]

#: A constant, or a function of the parameters' present values.
Expression = float | Callable[[Parameters], float]

#: Numbers closer than this compare equal in EQ and NE.
_EQUAL = 1e-4


def value_of(expression: Expression, parameters: Parameters) -> float:
    """Evaluate an expression with the parameters' present values."""
    return expression(parameters) if callable(expression) else expression


def _divide(a: float, b: float) -> float:
    if b == 0.0:
        raise ProgramError(f"attempt to divide by zero, {a:g} / 0")
    return a / b


def _modulo(a: float, b: float) -> float:
    if b == 0.0:
        raise ProgramError(f"MOD by zero, {a:g} MOD 0")
    remainder = math.fmod(a, b)
    return remainder + abs(b) if remainder < 0.0 else remainder


def _power(a: float, b: float) -> float:
    if a < 0.0 and math.floor(b) != b:
        raise ProgramError(f"attempt to raise the negative number {a:g} to the power {b:g}")
    if a == 0.0 and b < 0.0:
        raise ProgramError(f"attempt to raise zero to the negative power {b:g}")
    return a**b


#: operator -> (precedence, function); higher binds tighter, equal ones from left to right.
_BINARY: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "and": (2, lambda a, b: float(a != 0.0 and b != 0.0)),
    "or": (2, lambda a, b: float(a != 0.0 or b != 0.0)),
    "xor": (2, lambda a, b: float((a != 0.0) != (b != 0.0))),
    "lt": (3, lambda a, b: float(a < b)),
    "eq": (3, lambda a, b: float(abs(a - b) < _EQUAL)),
    "ne": (3, lambda a, b: float(abs(a - b) >= _EQUAL)),
    "le": (3, lambda a, b: float(a <= b)),
    "ge": (3, lambda a, b: float(a >= b)),
    "gt": (3, lambda a, b: float(a > b)),
    "-": (4, lambda a, b: a - b),
    "+": (4, lambda a, b: a + b),
    "/": (5, _divide),
    "*": (5, lambda a, b: a * b),
    "mod": (5, _modulo),
    "**": (6, _power),
}


def _arc_cosine(value: float) -> float:
    if abs(value) > 1.0:
        raise ProgramError(f"ACOS of {value:g}", accepted="-1 to 1")
    return math.degrees(math.acos(value))


def _arc_sine(value: float) -> float:
    if abs(value) > 1.0:
        raise ProgramError(f"ASIN of {value:g}", accepted="-1 to 1")
    return math.degrees(math.asin(value))


def _logarithm(value: float) -> float:
    if value <= 0.0:
        raise ProgramError(f"LN of {value:g}", accepted="a positive number")
    return math.log(value)


def _round(value: float) -> float:
    if not abs(value) < 2**31:
        raise ProgramError(f"ROUND of {value:g}", accepted="a number that fits 32 bits")
    return float(int(value + (-0.5 if value < 0.0 else 0.5)))


def square_root(value: float) -> float:
    """The root of a number; raises ProgramError for a negative one."""
    if value < 0.0:
        raise ProgramError(f"SQRT of the negative number {value:g}")
    return math.sqrt(value)


_UNARY: dict[str, Callable[[float], float]] = {
    "abs": abs,
    "acos": _arc_cosine,
    "asin": _arc_sine,
    "cos": lambda value: math.cos(math.radians(value)),
    "exp": math.exp,
    "fix": lambda value: float(math.floor(value)),
    "fup": lambda value: float(math.ceil(value)),
    "ln": _logarithm,
    "round": _round,
    "sin": lambda value: math.sin(math.radians(value)),
    "sqrt": square_root,
    "tan": lambda value: math.tan(math.radians(value)),
}

_DIGITS = frozenset("0123456789")


class Reader:
    """Cursor over one line without white space, in lower case.

    Parameters
    ----------
    text : str
        The line.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.position = 0

    def peek(self) -> str:
        """Return the next character, or an empty string at the end."""
        return self.text[self.position : self.position + 1]

    def accept(self, literal: str) -> bool:
        """Step over `literal` if it comes next."""
        if not self.text.startswith(literal, self.position):
            return False
        self.position += len(literal)
        return True

    def expect(self, literal: str, what: str) -> None:
        """Step over `literal`; raises ProgramError where it does not come next."""
        if not self.accept(literal):
            found = self.text[self.position : self.position + 8] or "end of line"
            raise ProgramError(f"expected '{literal}' {what}, found '{found}'")

    def number(self) -> float:
        """Read a plain decimal number with an optional sign; exponents do not exist."""
        start, text = self.position, self.text
        if self.peek() in ("+", "-"):
            self.position += 1
        digits = self.position
        while self.peek() in _DIGITS and self.peek():
            self.position += 1
        if self.accept("."):
            while self.peek() in _DIGITS and self.peek():
                self.position += 1
        if self.position - digits - ("." in text[digits : self.position]) < 1:
            self.position = start
            raise ProgramError(f"bad number at '{text[start : start + 8] or 'end of line'}'")
        return float(text[start : self.position])

    def value(self) -> Expression:
        """Read a real value: number, parameter, bracketed expression, or function."""
        first = self.peek()
        if first == "[":
            return self.bracket()
        if first == "#":
            return self.parameter_value()
        if first in ("+", "-"):
            following = self.text[self.position + 1 : self.position + 2]
            if following and following not in _DIGITS and following != ".":
                self.position += 1
                operand = self.value()
                return operand if first == "+" else _apply(lambda a: -a, operand)
        if first.isalpha():
            return self._function()
        return self.number()

    def bracket(self) -> Expression:
        """Read ``[...]``, operators of equal precedence from left to right."""
        self.expect("[", "before an expression")
        values, operators = [self.value()], []
        while not self.accept("]"):
            operator = self._operator()
            while operators and _BINARY[operators[-1]][0] >= _BINARY[operator][0]:
                _reduce(values, operators)
            operators.append(operator)
            values.append(self.value())
        while operators:
            _reduce(values, operators)
        return values[0]

    def _operator(self) -> str:
        for operator in (
            "**",
            "and",
            "mod",
            "xor",
            "or",
            *"+-*/",
            "lt",
            "eq",
            "ne",
            "le",
            "ge",
            "gt",
        ):
            if self.accept(operator):
                return operator
        found = self.text[self.position : self.position + 8] or "end of line"
        raise ProgramError(
            f"unknown operation at '{found}' in an expression",
            accepted="+ - * / ** MOD AND OR XOR EQ NE GT GE LT LE ]",
        )

    def _function(self) -> Expression:
        if self.accept("atan"):
            above = self.bracket()
            self.expect("/", "between the two brackets of ATAN")
            return _apply(lambda a, b: math.degrees(math.atan2(a, b)), above, self.bracket())
        if self.accept("exists"):
            self.expect("[", "after EXISTS")
            self.expect("#", "in EXISTS")
            name = self.parameter_name()
            self.expect("]", "after EXISTS")
            return lambda parameters: float(parameters.exists(value_of_key(name, parameters)))
        for name, function in _UNARY.items():
            if self.accept(name):
                return _apply(function, self.bracket())
        found = self.text[self.position : self.position + 8]
        raise ProgramError(
            f"unknown word or function at '{found}'",
            accepted="ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN",
        )

    def parameter_value(self) -> Expression:
        """Read ``#3``, ``#<name>``, ``##3`` or ``#[...]`` as a value."""
        self.expect("#", "before a parameter")
        name = self.parameter_name()
        return lambda parameters: parameters.get(value_of_key(name, parameters))

    def parameter_name(self) -> str | Expression:
        """Read what follows ``#``: a name in angle brackets or an expression for the index."""
        if self.accept("<"):
            stop = self.text.find(">", self.position)
            if stop < 0:
                raise ProgramError("named parameter is not closed", hint="write #<name>")
            name = self.text[self.position : stop]
            self.position = stop + 1
            return name
        return self.value()


def value_of_key(name: str | Expression, parameters: Parameters) -> str | int:
    """Return the name, or the whole number that an index expression gives."""
    if isinstance(name, str):
        return name
    value = value_of(name, parameters)
    index = math.floor(value + 0.5)
    if abs(value - index) > 1e-4:
        raise ProgramError(f"parameter number {value:g} is not a whole number")
    return index


def _apply(function: Callable[..., float], *operands: Expression) -> Expression:
    if len(operands) == 1:
        operand = operands[0]
        if callable(operand):
            return lambda parameters: function(operand(parameters))
        return function(operand)
    left, right = operands
    if not callable(left) and not callable(right):
        return function(left, right)
    return lambda parameters: function(value_of(left, parameters), value_of(right, parameters))


def _reduce(values: list[Expression], operators: list[str]) -> None:
    right, left = values.pop(), values.pop()
    values.append(_apply(_BINARY[operators.pop()][1], left, right))
