"""Klartext cycles 11 and 26: lengths that are programmed larger or smaller than they are.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Scaling" and "Axis-specific scaling": cycle 11
has one factor about the datum, cycle 26 one for each axis about a centre CCX, CCY, CCZ.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError

__all__ = ["Scaling"]

_AXES = "XYZ"
_RADII = frozenset(("R", "PR", "IPR", "LEN"))


@dataclass(frozen=True)
class Scaling:
    """Factors in force for X, Y and Z, and the places that stay where they are."""

    factor: tuple[float, float, float] = (1.0, 1.0, 1.0)
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def is_identity(self) -> bool:
        """Every length is as programmed."""
        return self.factor == (1.0, 1.0, 1.0)

    def defined(self, text: str, value: Callable[[str], float]) -> Scaling:
        """After a line ``11.1 SCL 0.99`` or ``26.1 X1.4 Y0.6 CCX+15 CCY+20``.

        Raises
        ------
        ProgramError
            The line cannot be read, or a factor is not above zero.
        """
        cycle, _, body = text.partition(".")
        if body.startswith("0"):
            return self
        factor, centre = list(self.factor), list(self.centre)
        if cycle == "11":
            found = re.search(rf"SCL\s*({NUMBER})", body)
            factor, centre = [value(found[1]) if found else 1.0] * 3, [0.0] * 3
        for name, size in re.findall(rf"(CC[XYZ]|[XYZ])\s*({NUMBER})", body[1:]):
            (centre if name[:-1] else factor)[_AXES.index(name[-1])] = value(size)
        if min(factor) <= 0.0:
            raise ProgramError(f"scale factor {min(factor):g}", accepted="above zero")
        return replace(self, factor=tuple(factor), centre=tuple(centre))

    @property
    def of_radii(self) -> float:
        """Factor of a radius in the working plane; raises ProgramError where circles turn oval."""
        if self.factor[0] != self.factor[1]:
            raise ProgramError(
                f"a circle with scale factors {self.factor[0]:g} and {self.factor[1]:g}",
                accepted="one factor for X and Y",
            )
        return self.factor[0]

    def applied(self, words: Mapping[str, float | str | None]) -> dict[str, float | str | None]:
        """Words of a line in the control's lengths."""
        found = dict(words)
        for axis, letter in enumerate(_AXES):
            factor, centre = self.factor[axis], self.centre[axis]
            if letter in words:
                found[letter] = centre + factor * (words[letter] - centre)
            if "I" + letter in words:
                found["I" + letter] = factor * words["I" + letter]
        for letter in _RADII & words.keys():
            found[letter] = self.of_radii * words[letter]
        return found
