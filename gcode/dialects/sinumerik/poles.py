"""G110 to G112 set a pole; AP and RP say a place about it.

Source: SINUMERIK ONE, NC Programming, Programming Manual 12/2019, 6FC5398-2EP40-0BA0, pages 174 and
175: AP=IC(..) counts from the last angle, RP is always absolute, and both stay stored; they apply
in the plane chosen with G17 to G19. With G2 and G3 the pole is the circle's centre and RP its
radius: SINUMERIK 840Di sl, Fundamentals, Programming Manual 11/2006, 6FC5398-1BP10-2BA0, page 143.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.state.controller import PLANE_AXES, XY, XZ, YZ

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.block_words import Words
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["Poles"]

_PLANES = {17.0: XY, 18.0: XZ, 19.0: YZ}
_POLES = (110.0, 111.0, 112.0)
_ARCS = (2.0, 3.0)
_SAYS_ARC = {"CR", "AR", "I", "J", "K"}


class Poles:
    """The pole of a program, and the polar angle and radius that stay stored.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader, self.plane = reader, XY
        self._forget()

    def _forget(self) -> None:
        self.pole = [0.0, 0.0]
        self.angle_deg: float | None = None  #: AP that was last said
        self.radius: float | None = None  #: RP that was last said

    def obey(self, words: Words, g_codes: list[float], *, is_special: bool = False) -> None:
        """Set a pole, or put the axes of the plane in the place of AP and RP.

        `is_special` says that the block has CIP or CT, whose centre is no pole.
        """
        self._choose_plane(g_codes)
        code = next((code for code in _POLES if code in g_codes), None)
        if code is not None:
            self._set(words, code)
        elif any(letter in ("AP", "RP") for letter, _ in words):
            place = self._place(dict(words), absolute=self.reader.is_absolute(g_codes))
            words[:] = [w for w in words if w[0] not in ("AP", "RP")]
            words += zip(self._letters, place, strict=True)
            if not is_special and self._is_arc(g_codes) and not _SAYS_ARC & dict(words).keys():
                words += self._centre()

    def _is_arc(self, g_codes: list[float]) -> bool:
        said = next((code for code in g_codes if code in (0.0, 1.0, *_ARCS)), None)
        return (
            said in _ARCS if said is not None else (self.reader.controller.motion in ("G2", "G3"))
        )

    def _centre(self) -> Words:
        """I J K of the pole, from the place where the tool stands."""
        from_here = [pole - place for pole, place in zip(self.pole, self._here(), strict=True)]
        first, second, _ = PLANE_AXES[self.plane]
        return list(zip(("IJK"[first], "IJK"[second]), from_here, strict=True))

    def in_mode(self, letter: str, value: float, kind: str, *, absolute: bool) -> float:
        """AP=AC(..) and AP=IC(..): the number that says the same in the mode of the block."""
        if letter == "RP":
            if kind == "IC":
                raise ProgramError("IC with RP", accepted="RP=, which is always absolute")
            return value
        if (kind == "AC") == absolute:
            return value
        return value - self._angle() if kind == "AC" else value + self._angle()

    def _choose_plane(self, g_codes: list[float]) -> None:
        said = next((_PLANES[code] for code in g_codes if code in _PLANES), None)
        plane = self.reader.controller.plane if said is None else said
        if plane != self.plane:
            self.plane = plane
            self._forget()

    @property
    def _letters(self) -> str:
        first, second, _ = PLANE_AXES[self.plane]
        return "XYZ"[first] + "XYZ"[second]

    def _here(self) -> tuple[float, float]:
        first, second, _ = PLANE_AXES[self.plane]
        here = self.reader.here()
        return here[first], here[second]

    def _angle(self) -> float:
        """The last angle; that of the place where the tool stands if none has been said."""
        if self.angle_deg is not None:
            return self.angle_deg
        x, y = self._here()
        return math.degrees(math.atan2(y - self.pole[1], x - self.pole[0]))

    def _set(self, words: Words, code: float) -> None:
        values, letters = dict(words), self._letters
        base = {110.0: self._here(), 111.0: (0.0, 0.0), 112.0: tuple(self.pole)}[code]
        shift = [values.get(letter, 0.0) for letter in letters]
        if {"AP", "RP"} & values.keys():
            angle, size = math.radians(values.get("AP", 0.0)), values.get("RP", 0.0)
            shift[0] += size * math.cos(angle)
            shift[1] += size * math.sin(angle)
        self._forget()
        self.pole = [base[0] + shift[0], base[1] + shift[1]]
        taken = {*letters, "AP", "RP"}
        words[:] = [w for w in words if w != ("G", code) and w[0] not in taken]

    def _place(self, values: dict[str, float], *, absolute: bool) -> tuple[float, float]:
        """Of AP and RP, as the mode of the block counts."""
        here = self._here()
        if "AP" in values:
            self.angle_deg = values["AP"] + (0.0 if absolute else self._angle())
        angle = math.radians(self._angle())
        if "RP" in values:
            self.radius = values["RP"]
        out = self.radius
        if out is None:
            out = math.hypot(here[0] - self.pole[0], here[1] - self.pole[1])
        base = (0.0, 0.0) if absolute else here
        return (self.pole[0] + out * math.cos(angle) - base[0],
                self.pole[1] + out * math.sin(angle) - base[1])  # fmt: skip
