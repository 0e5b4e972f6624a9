"""RND, RNDM, CHF and CHR: a line waits for the next one, and their corner is broken.

Source: SINUMERIK 840D sl/828D, Programming Manual Fundamentals, "Chamfer, rounding (CHF, CHR, RND,
RNDM)": RND a radius, CHR a length along each line, CHF the length of the chamfer itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.geometry.corners import broken_corner
from gcode.language.translate import number

__all__ = ["CORNERS", "WaitingLine"]

CORNERS = ("RND", "CHF", "CHR")


@dataclass(frozen=True)
class WaitingLine:
    """A line at feed and what is to become of its end.

    Attributes
    ----------
    start, end : tuple of float
        X Y Z.
    kind : str
        One of `CORNERS`.
    size : float
    head : str
        The other words of its block, as RS274/NGC.
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    kind: str
    size: float
    head: str

    def blocks(self, following: tuple[float, float, float]) -> list[str]:
        """The line and its corner, for a line that goes on to `following`.

        Raises
        ------
        ProgramError
            The corner does not fit.
        """
        size = self._along_lines(following)
        broken = broken_corner(
            self.start[:2], self.end[:2], following[:2], size, chamfer=self.kind != "RND"
        )
        first, second, sense = broken or (self.end[:2], self.end[:2], 0)
        level = "" if self.end[2] == self.start[2] else f"z{number(self.end[2])}"
        found = [f"{self.head}g90g1x{number(first[0])}y{number(first[1])}{level}"]
        if sense and self.kind == "RND":
            found.append(
                f"g{3 if sense > 0 else 2}x{number(second[0])}y{number(second[1])}"
                f"r{number(self.size)}"
            )
        elif sense:
            found.append(f"g1x{number(second[0])}y{number(second[1])}")
        return found

    def _along_lines(self, following: tuple[float, float, float]) -> float:
        if self.kind != "CHF":
            return self.size
        back = [s - e for s, e in zip(self.start[:2], self.end[:2], strict=True)]
        ahead = [f - e for f, e in zip(following[:2], self.end[:2], strict=True)]
        if not any(back) or not any(ahead):
            raise ProgramError("a corner beside a line of no length")
        angle = math.atan2(*reversed(back)) - math.atan2(*reversed(ahead))
        half = abs(math.sin(angle / 2.0))
        return self.size / (2.0 * half) if half > 0.0 else self.size
