"""R parameters, user variables and variables of the system: their values in a program.

SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Flexible NC programming".
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Mapping

from gcode.dialects.sinumerik.block_words import split_arguments
from gcode.dialects.sinumerik.values.expressions import Worked, expression_at, whole_expression
from gcode.errors import ProgramError

__all__ = ["Variables"]

_MOST_ELEMENTS = 100_000  #: of a field
#: variables of the channel that the program may write and read again
_CELLS = ("$AC_MARKER[", "$AC_PARAM[")
#: what a program tells the machine, which moves nothing
_OUTPUTS = ("$A_OUT[", "$A_OUTA[", "$A_DBB[", "$A_DBW[", "$A_DBD[", "$A_DBR[", "$AC_TIMER[")


class Variables:
    """Values of R parameters and of variables that DEF declares.

    Parameters
    ----------
    system : callable
        Name and index of a system variable -> its value, None for one that is not read.
    given : mapping of str to float
        Variables of the machine that the job says, see `gcode.language.options`.
    unknown : callable
        Name of a variable that nobody said -> error.
    note : callable
        Word and meaning of what is noted.
    """

    def __init__(
        self,
        system: Callable[[str, str], float | None],
        given: Mapping[str, float],
        unknown: Callable[[str], ProgramError],
        note: Callable[[str, str], None],
    ) -> None:
        self.r: dict[int, float] = {}
        self.named: dict[str, float] = {}  #: fields by name and indices, as ``A[0,2]``
        #: of every program of the machine (GUD), machine data, and those of the channel
        self.shared = {re.sub(r"\s", "", name).upper(): value for name, value in given.items()}
        self.system, self.unknown, self.note = system, unknown, note

    @property
    def has_letters(self) -> bool:
        """Whether a variable is called as an axis might be."""
        return any(len(name) == 1 for name in self.named)

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
        listed = re.fullmatch(r"(?:SET\s*)?\((.*)\)", value, re.IGNORECASE)
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
        return self.worked_out(whole_expression(text), text)

    def read(self, text: str, position: int) -> tuple[float, int]:
        """Value of the expression that begins at a position, and where it ends."""
        worked, end = expression_at(text, position)
        return self.worked_out(worked, text), end

    def worked_out(self, worked: Worked, text: str) -> float:
        """Value of an expression of a text."""
        value = worked(self)
        if not math.isfinite(value):
            raise ProgramError(f"'{text}' has no finite value")
        return value

    def parameter(self, index: float) -> float:
        """An R parameter, zero where nothing has been said."""
        return self.r.get(self._index(index), 0.0)

    def variable(self, name: str, indices: tuple[float, ...], text: str) -> float:
        """A variable of DEF, an element of its fields, or a variable of the system."""
        if indices:
            name = f"{name}[{','.join(str(self._index(i)) for i in indices)}]"
        if name in self.named:
            return self.named[name]
        whole = self._element(f"{name}[{text}]") if text else name
        if whole in self.shared:
            return self.shared[whole]
        told = self.system(name, text)
        if told is None:
            raise self.unknown(whole)
        return told

    def knows(self, name: str) -> bool:
        """Whether a variable has a value, by its name with indices."""
        bare, _, index = name.partition("[")
        # what lists all that is unknown asks here: an unknown index must not have it list again
        told, self.unknown = self.unknown, ProgramError
        try:
            whole = self._element(name)
            return (
                whole in self.named
                or whole in self.shared
                or self.system(bare, index.rstrip("]")) is not None
            )
        except ProgramError:
            return False
        finally:
            self.unknown = told

    def assign(self, name: str, value: float) -> None:
        """Give a parameter or a declared variable a value."""
        index = re.fullmatch(r"R(?:(\d+)|\[(.*)\])", name)
        if index:
            number = int(index[1]) if index[1] else self._index(self.value(index[2]))
            self.r[number] = value
        else:
            self._assign(self._element(name), value)

    def _assign(self, name: str, value: float) -> None:
        if name in self.named:
            self.named[name] = value
        elif name in self.shared or name.startswith(_CELLS):
            self.shared[name] = value
        elif name.startswith(_OUTPUTS):
            self.note(name.partition("[")[0], "output to the machine")
        elif name.startswith("_"):
            self.note(name, "not declared in this file: taken for a real variable of the builder")
            self.shared[name] = value
        else:
            raise self.unknown(name)

    def _element(self, name: str) -> str:
        """Name of an element, its indices worked out."""
        field = re.fullmatch(r"(\$?\w+)\s*\[(.*)\]", name)
        if field is None:
            return name
        places = (re.sub(r"\s", "", place) for place in split_arguments(field[2]))
        return f"{field[1]}[{','.join(self._place(p, field[1][0] == '$') for p in places)}]"

    def _place(self, text: str, may_name: bool) -> str:
        """One index; those of system variables may be names of axes and words."""
        is_axis = text in tuple("XYZABC") and text not in self.named
        if is_axis or (
            may_name and re.fullmatch(r"[A-Z]\w*", text) and not re.fullmatch(r"R\d+", text)
        ):
            return text
        return str(self._index(self.value(text)))

    @staticmethod
    def _index(value: float) -> int:
        if value != round(value) or value < 0:
            raise ProgramError(f"index {value:g}", accepted="a whole number")
        return int(value)
