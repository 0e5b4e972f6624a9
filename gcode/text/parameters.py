"""RS274/NGC parameters: numbered #1 ... #5601 and named #<local>, #<_global>."""

from __future__ import annotations

from collections.abc import Callable

from gcode.errors import ProgramError

__all__ = ["FIRST_SYSTEM", "G28_HOME", "G30_HOME", "G92_APPLIED", "Parameters", "system_base"]

_COUNT = 5602  #: numbers below this exist, as in LinuxCNC
_ARGUMENTS = 30  #: #1 ... #30 are the arguments of a subroutine
_READ_ONLY = frozenset((*range(5400, 5414), *range(5420, 5429)))

#: First of the six numbers of the G28 and G30 positions, machine units.
G28_HOME, G30_HOME = 5161, 5181
#: 1 while G92 is applied; the six offsets follow.
G92_APPLIED = 5210
#: Number of the active coordinate system, 1 for G54.
FIRST_SYSTEM = 5220
#: Coordinate systems from this one on are kept where no program of LinuxCNC can look.
_FIRST_FURTHER, _FURTHER = 10, 100_000


def system_base(system: int) -> int:
    """Return the parameter of the X offset of a coordinate system; rotation is 9 further."""
    return 5201 + 20 * system if system < _FIRST_FURTHER else _FURTHER + 20 * system


class Parameters:
    """Values of numbered and named parameters with one level of locals per subroutine call.

    Numbered parameters are shared by all levels except #1 ... #30, which a call saves and
    restores. Offsets are in machine units.
    """

    def __init__(self) -> None:
        self.numbered: dict[int, float] = {FIRST_SYSTEM: 1.0}
        self.globals: dict[str, float] = {"_value": 0.0, "_value_returned": 0.0}
        self.locals: list[dict[str, float]] = [{}]
        self.computed: dict[int | str, Callable[[], float]] = {}

    def get(self, key: int | str) -> float:
        """Read a parameter by number or by name; raises ProgramError for an unknown one."""
        if key in self.computed:
            return self.computed[key]()
        if isinstance(key, int):
            self._check_number(key)
            return self.numbered.get(key, 0.0)
        values = self.globals if key.startswith("_") else self.locals[-1]
        if key not in values:
            raise ProgramError(
                f"named parameter #<{key}> is not defined",
                hint=f"set it first: #<{key}> = ...",
            )
        return values[key]

    def set(self, key: int | str, value: float) -> None:
        """Assign a parameter; raises ProgramError for one that cannot be written."""
        if isinstance(key, str):
            if key in self.computed:
                raise ProgramError(f"named parameter #<{key}> is read only")
            (self.globals if key.startswith("_") else self.locals[-1])[key] = value
            return
        self._check_number(key)
        if key in _READ_ONLY:
            raise ProgramError(f"parameter #{key} is read only")
        self.numbered[key] = value

    def exists(self, key: int | str) -> bool:
        """Tell whether a parameter can be read."""
        if isinstance(key, int):
            return 1 <= key < _COUNT
        known = self.globals if key.startswith("_") else self.locals[-1]
        return key in known or key in self.computed

    def arguments(self) -> list[float]:
        """Return the present #1 ... #30."""
        return [self.numbered.get(index, 0.0) for index in range(1, _ARGUMENTS + 1)]

    def set_arguments(self, values: list[float]) -> None:
        """Put `values` into #1 ... and zero into the rest of the thirty."""
        for index in range(_ARGUMENTS):
            self.numbered[index + 1] = values[index] if index < len(values) else 0.0

    def vector(self, first: int) -> list[float]:
        """Return six consecutive numbered parameters."""
        return [self.numbered.get(first + axis, 0.0) for axis in range(6)]

    def set_vector(self, first: int, values: list[float]) -> None:
        """Assign consecutive numbered parameters."""
        for axis, value in enumerate(values):
            self.numbered[first + axis] = value

    @staticmethod
    def _check_number(key: int) -> None:
        if not 1 <= key < _COUNT:
            raise ProgramError(
                f"parameter number {key} is out of range", accepted=f"#1 to #{_COUNT - 1}"
            )
