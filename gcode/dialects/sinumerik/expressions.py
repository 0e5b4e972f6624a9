"""R parameters, user variables and expressions of SINUMERIK.

SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Flexible NC programming".
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable
from functools import lru_cache

from gcode.errors import ProgramError

__all__ = ["Variables"]

_TOKEN = re.compile(
    r"\s*(\d+\.?\d*(?:EX[+-]?\d+)?|\.\d+|\$?[A-Z_][A-Z0-9_]*|\*\*|==|<>|>=|<=|<<|[-+*/()\[\],<>])"
)
_TWO: dict[str, tuple[int, Callable[[float, float], float]]] = {
    "OR": (1, lambda a, b: float(bool(a) or bool(b))),
    "XOR": (2, lambda a, b: float(bool(a) != bool(b))),
    "AND": (3, lambda a, b: float(bool(a) and bool(b))),
    "==": (4, lambda a, b: float(abs(a - b) < 1e-12 * max(1.0, abs(a)))),
    "<>": (4, lambda a, b: float(abs(a - b) >= 1e-12 * max(1.0, abs(a)))),
    ">=": (4, lambda a, b: float(a >= b)), "<=": (4, lambda a, b: float(a <= b)),
    ">": (4, lambda a, b: float(a > b)), "<": (4, lambda a, b: float(a < b)),
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
_MOST_ELEMENTS = 100_000  #: of a field
_CONSTANTS = {"TRUE": 1.0, "FALSE": 0.0, "$PI": math.pi}


@lru_cache(maxsize=4096)
def _scanned(text: str, position: int) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Parts of the expression that begins at a position, and where each ends."""
    tokens, ends, text = [], [], text.upper()
    while (match := _TOKEN.match(text, position)) is not None:
        tokens.append(match[1])
        position = match.end()
        ends.append(position)
    return tuple(tokens), tuple(ends)


class Variables:
    """Values of R parameters and of variables that DEF declares.

    Parameters
    ----------
    system : callable
        Name and index of a system variable -> its value, None for one that is not read.
    """

    def __init__(self, system: Callable[[str, str], float | None] = lambda *_: None) -> None:
        self.r: dict[int, float] = {}
        self.named: dict[str, float] = {}  #: fields by name and indices, as ``A[0,2]``
        self.system = system

    def declare(self, name: str, value: str) -> None:
        """DEF: a variable, or a field with one or two indices; zero where nothing is said."""
        sizes = re.fullmatch(r"(\w+)\s*\[([^\]]*)\]", name)
        if sizes is None:
            self.named[name] = self.value(value) if value else 0.0
            return
        counts = [self._index(self.value(size)) for size in sizes[2].split(",")]
        if len(counts) > 2 or math.prod(counts) > _MOST_ELEMENTS:
            raise ProgramError(f"field {name}", accepted=f"up to {_MOST_ELEMENTS} elements")
        places = [f"{sizes[1]}[{','.join(map(str, place))}]"
                  for place in itertools.product(*map(range, counts))]  # fmt: skip
        listed = re.fullmatch(r"SET\s*\((.*)\)", value, re.IGNORECASE)
        first = [] if listed is None else [self.value(v) for v in listed[1].split(",")]
        each = self.value(value) if value and listed is None else 0.0
        self.named |= dict(itertools.zip_longest(places, first[: len(places)], fillvalue=each))

    def value(self, text: str) -> float:
        """Value of an expression.

        Raises
        ------
        ProgramError
            It cannot be read, or has no value.
        """
        tokens = self.tokens(text)
        result = self._operation(tokens, 0)
        if tokens:
            raise ProgramError(f"cannot read '{' '.join(tokens)}' in '{text}'")
        if not math.isfinite(result):
            raise ProgramError(f"'{text}' has no finite value")
        return result

    def read(self, text: str, position: int) -> tuple[float, int]:
        """Value of the expression that begins at a position, and where it ends."""
        tokens, ends = _scanned(text, position)
        left = list(tokens)
        value = self._operation(left, 0)
        if not math.isfinite(value):
            raise ProgramError(f"'{text}' has no finite value")
        return value, ends[len(tokens) - len(left) - 1]

    @staticmethod
    def tokens(text: str) -> list[str]:
        """An expression in its parts."""
        found, position, text = [], 0, text.upper().rstrip()
        while position < len(text):
            match = _TOKEN.match(text, position)
            if match is None:
                raise ProgramError(f"cannot read '{text[position:]}' in '{text}'")
            found.append(match[1])
            position = match.end()
        return found

    def assign(self, name: str, value: float) -> None:
        """Give a parameter or a declared variable a value."""
        index = re.fullmatch(r"R(?:(\d+)|\[(.*)\])", name)
        if index:
            number = int(index[1]) if index[1] else self._index(self.value(index[2]))
            self.r[number] = value
        elif self._element(name) in self.named:
            self.named[self._element(name)] = value
        else:
            raise ProgramError(f"variable '{name}' is not declared", accepted="DEF REAL NAME, R1")

    def _element(self, name: str) -> str:
        """Name of an element, its indices worked out."""
        field = re.fullmatch(r"(\w+)\s*\[(.*)\]", name)
        if field is None:
            return name
        return (
            f"{field[1]}[{','.join(str(self._index(self.value(v))) for v in field[2].split(','))}]"
        )

    @staticmethod
    def _index(value: float) -> int:
        if value != round(value) or value < 0:
            raise ProgramError(f"index {value:g}", accepted="a whole number")
        return int(value)

    def _operation(self, tokens: list[str], lowest: int) -> float:
        value = self._operand(tokens)
        while tokens and tokens[0] in _TWO and _TWO[tokens[0]][0] >= lowest:
            name = tokens.pop(0)
            rank, function = _TWO[name]
            other = self._operation(tokens, rank + 1)
            try:
                value = function(value, other)
            except (ZeroDivisionError, ValueError):
                raise ProgramError(f"{value:g} {name} {other:g} has no value") from None
        return value

    def _operand(self, tokens: list[str]) -> float:
        if not tokens:
            raise ProgramError("an expression ends too early")
        token = tokens.pop(0)
        if token in "+-":
            return self._operand(tokens) * (-1.0 if token == "-" else 1.0)
        if token == "NOT":
            return float(not self._operand(tokens))
        if token == "(":
            value = self._operation(tokens, 0)
            self._expect(tokens, ")")
            return value
        if token[0] in ".0123456789":
            mantissa, _, power = token.partition("EX")
            return float(mantissa) * 10.0 ** int(power or 0)
        if token in _FUNCTIONS:
            return self._call(token, tokens)
        return self._variable(token, tokens)

    def _call(self, name: str, tokens: list[str]) -> float:
        self._expect(tokens, "(")
        arguments = [self._operation(tokens, 0)]
        while tokens and tokens[0] == ",":
            tokens.pop(0)
            arguments.append(self._operation(tokens, 0))
        self._expect(tokens, ")")
        try:
            return _FUNCTIONS[name](*arguments)
        except (ValueError, TypeError, OverflowError):
            shown = ", ".join(f"{v:g}" for v in arguments)
            raise ProgramError(f"{name}({shown}) has no value") from None

    def _variable(self, name: str, tokens: list[str]) -> float:
        if name == "R" and tokens[:1] == ["["]:
            tokens.pop(0)
            index = self._index(self._operation(tokens, 0))
            self._expect(tokens, "]")
            return self.r.get(index, 0.0)
        if re.fullmatch(r"R\d+", name):
            return self.r.get(int(name[1:]), 0.0)
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        index = ""
        if tokens[:1] == ["["]:
            stop = tokens.index("]") if "]" in tokens else len(tokens)
            index = " ".join(tokens[1:stop])
            del tokens[: stop + 1]
            name_ = self._element(f"{name}[{index}]") if not name.startswith("$") else name
        else:
            name_ = name
        if name_ in self.named:
            return self.named[name_]
        told = self.system(name, index)
        if told is not None:
            return told
        why = "a variable of the system" if name.startswith("$") else "not declared"
        raise ProgramError(
            f"'{name}' is {why} and has no value here", accepted="R parameters, variables of DEF"
        )

    @staticmethod
    def _expect(tokens: list[str], wanted: str) -> None:
        if not tokens or tokens.pop(0) != wanted:
            raise ProgramError(f"'{wanted}' is missing in an expression")
