"""Q parameters: FN functions and formulas.

HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Programming Q parameters".
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping

from gcode.errors import ProgramError
from gcode.text.expressions import square_root

__all__ = ["NUMBER", "QParameters"]

#: a number, or a Q parameter, with an optional sign
NUMBER = r"[+-]?\s*(?:Q[LR]?\d+|\d+\.?\d*|\.\d+)"
_TOKEN = re.compile(r"\s*(Q[LR]?\d+|\d+\.?\d*|\.\d+|[A-Z]+|[-+*/^%()])")
_ASSIGNED = re.compile(r"Q([LR]?\d+)\s*=\s*(.*)")
_NAMED = re.compile(r"Q([LR]?\d+)")
_TWO: dict[str, Callable[[float, float], float]] = {
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "LEN": math.hypot, "ANG": lambda a, b: math.degrees(math.atan2(a, b)),
}  # fmt: skip
_IF = re.compile(
    rf"IF\s*({NUMBER})\s*(EQU|NE|GT|LT)\s*({NUMBER})\s*GOTO\s*LBL\s*(\d+|\"[^\"]*\"|Q\w+)"
)
_TESTS = {"EQU": lambda a, b: abs(a - b) < 1e-9, "NE": lambda a, b: abs(a - b) >= 1e-9,
          "GT": lambda a, b: a > b, "LT": lambda a, b: a < b}  # fmt: skip


def _divided(a: float, b: float) -> float:
    if b == 0.0:
        raise ProgramError("division by zero in a Q parameter")
    return a / b


_TWO["DIV"] = _TWO["/"] = _divided
_ONE: dict[str, Callable[[float], float]] = {
    "SIN": lambda v: math.sin(math.radians(v)), "COS": lambda v: math.cos(math.radians(v)),
    "TAN": lambda v: math.tan(math.radians(v)), "ASIN": lambda v: math.degrees(math.asin(v)),
    "ACOS": lambda v: math.degrees(math.acos(v)), "ATAN": lambda v: math.degrees(math.atan(v)),
    "SQ": lambda v: v * v, "SQRT": square_root, "LN": math.log, "LOG": math.log10, "EXP": math.exp,
    "NEG": lambda v: -v, "INT": lambda v: float(math.trunc(v)), "ABS": abs,
    "FRAC": lambda v: v - math.trunc(v), "SGN": lambda v: float((v > 0) - (v < 0)),
}  # fmt: skip
_RANK = {"+": 1, "-": 1, "*": 2, "/": 2, "%": 2, "^": 3}


class QParameters:
    """Values of Q, QL and QR by name, as ``12`` or ``L3``."""

    def __init__(self) -> None:
        self.values: dict[str, float] = {}
        self.computed: dict[str, Callable[[], float]] = {}
        #: answers FN 18 where the job says what is asked, otherwise None
        self.tool_data: Callable[[str], float | None] = lambda _: None

    def get(self, name: str) -> float:
        """A parameter's value; raises ProgramError where it was never set."""
        if name in self.values:
            return self.values[name]
        if name in self.computed:
            return self.computed[name]()
        raise ProgramError(
            f"Q{name} was never set",
            accepted=f"Q{name} = ... in the program, or variables = {{ 'Q{name}' = ... }} in "
            "[control] where it stands in the control's memory",
        )

    def remember(self, given: Mapping[str, float]) -> None:
        """Values that stand in the control's memory before the program, as ``QR20``."""
        named = ((_NAMED.fullmatch(name.strip().upper()), value) for name, value in given.items())
        self.values |= {match[1]: float(value) for match, value in named if match is not None}

    def number(self, text: str) -> float:
        """A number or a parameter with its sign."""
        bare = re.sub(r"\s", "", text)
        sign = -1.0 if bare.startswith("-") else 1.0
        bare = bare.lstrip("+-")
        return sign * (self.get(bare[1:]) if bare.startswith("Q") else float(bare))

    def assign(self, text: str) -> bool:
        """Obey ``Q1 = formula``; tells whether it is one."""
        match = _ASSIGNED.fullmatch(text)
        if match is None:
            return False
        self.values[match[1]] = self.formula(match[2])
        return True

    def function(self, number: int, text: str) -> str | None:
        """Obey FN 0 to FN 13; gives the label of a branch that is taken.

        Raises
        ------
        ProgramError
            Functions that ask the machine, or that cannot be read.
        """
        if number in (9, 10, 11, 12):
            match = _IF.fullmatch(text)
            if match is None:
                raise ProgramError(f"cannot read FN {number}: {text}")
            taken = _TESTS[match[2]](self.number(match[1]), self.number(match[3]))
            return match[4] if taken else None
        if number == 18:
            self._asks(text)
            return None
        if number > 8 and number != 13:
            raise ProgramError(
                f"FN {number} asks or tells the machine and is not read",
                accepted="FN 0 to FN 13, FN 18",
            )
        match = _ASSIGNED.fullmatch(text)
        if match is None:
            raise ProgramError(f"cannot read FN {number}: {text}")
        self.values[match[1]] = self._of_function(match[2])
        return None

    def _asks(self, text: str) -> None:
        """FN 18 asks the machine: but for tools, whoever reads the answer is refused."""
        match = re.match(r"(?:SYSREAD\s+)?Q([LR]?\d+)\s*=\s*((?:SYSREAD\s+)?ID.*)", text)
        if match is None:
            raise ProgramError(f"cannot read FN 18: {text}")
        known = self.tool_data(match[2])
        if known is not None:
            self.values[match[1]] = known
            return

        def answer() -> float:
            raise ProgramError(
                f"Q{match[1]} holds what FN 18 asked the machine: {match[2]}",
                hint="the path must not depend on it",
            )

        self.values.pop(match[1], None)
        self.computed[match[1]] = answer

    def _of_function(self, text: str) -> float:
        two = re.fullmatch(rf"({NUMBER})\s*(\+|-|\*|DIV|/|LEN|ANG)\s*({NUMBER})", text)
        if two:
            return _TWO[two[2]](self.number(two[1]), self.number(two[3]))
        one = re.fullmatch(rf"(SQRT|SIN|COS)\s*({NUMBER})", text)
        if one:
            return _ONE[one[1]](self.number(one[2]))
        if re.fullmatch(NUMBER, text):
            return self.number(text)
        return self.formula(text)

    # formulas

    def formula(self, text: str) -> float:
        """Value of a formula."""
        tokens, position = [], 0
        text = text.strip()
        while position < len(text):
            match = _TOKEN.match(text, position)
            if match is None:
                raise ProgramError(f"cannot read '{text[position:]}' in a formula")
            tokens.append(match[1])
            position = match.end()
        value = self._operation(tokens, 0)
        if tokens:
            raise ProgramError(f"cannot read '{' '.join(tokens)}' in a formula")
        if not math.isfinite(value):
            raise ProgramError(f"the formula '{text}' has no finite value")
        return value

    def _operation(self, tokens: list[str], lowest: int) -> float:
        value = self._operand(tokens)
        while tokens and _RANK.get(tokens[0], -1) >= max(lowest, 1):
            name = tokens.pop(0)
            other = self._operation(tokens, _RANK[name] + (name != "^"))
            value = self._applied(name, value, other)
        return value

    @staticmethod
    def _applied(name: str, value: float, other: float) -> float:
        try:
            if name == "^":
                return float(value**other)
            if name == "%":
                return math.fmod(value, other)
            return _TWO[name](value, other)
        except (ValueError, ZeroDivisionError, TypeError):
            raise ProgramError(f"{value:g} {name} {other:g} has no value") from None

    def _operand(self, tokens: list[str]) -> float:
        if not tokens:
            raise ProgramError("a formula ends too early")
        token = tokens.pop(0)
        if token in "+-":
            value = self._operand(tokens)
            return -value if token == "-" else value
        if token == "(":
            value = self._operation(tokens, 0)
            if not tokens or tokens.pop(0) != ")":
                raise ProgramError("a bracket of a formula is not closed")
            return value
        if token == "PI":
            return math.pi
        if token in _ONE:
            operand = self._operand(tokens)
            try:
                return _ONE[token](operand)
            except ValueError:
                raise ProgramError(f"{token} of {operand:g}") from None
        if token[0] in "Q.0123456789" and not token[1:2].isalpha() | (token == "Q"):
            return self.number(token)
        if re.fullmatch(r"Q[LR]\d+", token):
            return self.number(token)
        raise ProgramError(f"'{token}' in a formula is not read")
