"""Motion of SINUMERIK that RS274/NGC has no word for: CIP, CT, AR, fixed points, tapping.

Source: SINUMERIK 840D sl/828D, Programming Manual Fundamentals, "Motion commands".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.geometry.three_points import centre_of_three
from gcode.language.translate import number, xy_words
from gcode.motion.tangent import tangent_centre

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.block_words import Words
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["SinumerikMotion"]


class SinumerikMotion:
    """Motion of a program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader

    def end(self, words: Words, g_codes: list[float]) -> tuple[float, float, float]:
        """Programmed end X Y Z of a block."""
        here, values = self.reader.here(), dict(words)
        absolute = self.reader.is_absolute(g_codes)
        return tuple(
            values.get(a, h if absolute else 0.0) + (0.0 if absolute else h)
            for a, h in zip("XYZ", here, strict=False)
        )

    def special_arc(self, kind: str, words: Words) -> None:
        """CIP over a point I1 J1, CT as a continuation."""
        reader = self.reader
        g_codes = [v for letter, v in words if letter == "G"]
        start, end = reader.here(), self.end(words, g_codes)
        others = [w for w in words if w[0] not in ("X", "Y", "Z", "I1", "J1", "K1")]
        reader.only_in_xy(kind)
        c = reader.controller
        if kind == "CT":
            if c.side:
                raise ProgramError("CT with cutter compensation is not read", accepted="G40")
            if not reader.frame.is_full_size:
                raise ProgramError("CT with SCALE is not read", accepted="G2 and G3")
            x, y, sense = tangent_centre(c.record, start, end, c.unit_mm)
        else:
            x, y, sense = self._through(dict(words), start, end, g_codes)
        reader.execute(reader.words.text(others))
        reader.absolutely(
            f"g{3 if sense > 0 else 2}{xy_words(end[0], end[1])}"
            f"z{number(end[2])}i{number(x - start[0])}j{number(y - start[1])}"
        )

    def _through(
        self, values: dict[str, float], start: list[float], end: tuple, g_codes: list[float]
    ) -> tuple[float, float, float]:
        """Centre and sense of CIP."""
        absolute = self.reader.is_absolute(g_codes)
        via = [
            values.get(k, h if absolute else 0.0) + (0.0 if absolute else h)
            for k, h in zip(("I1", "J1"), start, strict=False)
        ]
        first = via[0] - start[0], via[1] - start[1]
        second = end[0] - start[0], end[1] - start[1]
        sense = first[0] * second[1] - first[1] * second[0]
        return *centre_of_three(start[:2], via, end[:2]), sense

    def opening_angle(self, words: Words, g_codes: list[float]) -> None:
        """AR: an arc by its opening angle and its end, or its centre."""
        values, reader = dict(words), self.reader
        if "AR" not in values:
            return
        reader.only_in_xy("AR")
        code = next((v for v in g_codes if v in (2.0, 3.0)), None)
        modal = {"G2": 2.0, "G3": 3.0}.get(reader.controller.motion)
        code = modal if code is None else code
        angle = math.radians(values["AR"])
        if code is None or not 0.0 < angle < math.tau:
            raise ProgramError("AR without G2 or G3, or not between 0 and 360 degrees")
        words[:] = [w for w in words if w[0] != "AR"]
        here, sense = reader.here(), 1.0 if code == 3.0 else -1.0
        if {"I", "J"} & values.keys():
            centre = values.get("I", 0.0), values.get("J", 0.0)
            self._turned(words, g_codes, centre, sense * angle)
            return
        end = self.end(words, g_codes)
        x, y = end[0] - here[0], end[1] - here[1]
        rise = sense / (2.0 * math.tan(angle / 2.0))
        words += [("I", x / 2.0 - y * rise), ("J", y / 2.0 + x * rise)]

    def _turned(
        self, words: Words, g_codes: list[float], centre: tuple[float, float], angle: float
    ) -> None:
        """The end of an arc about a centre, both relative to the start."""
        cosine, sine = math.cos(angle), math.sin(angle)
        here = self.reader.here() if self.reader.is_absolute(g_codes) else (0.0, 0.0)
        words += [
            ("X", here[0] + centre[0] - centre[0] * cosine + centre[1] * sine),
            ("Y", here[1] + centre[1] - centre[0] * sine - centre[1] * cosine),
        ]

    def fixed_point(self, words: Words) -> None:
        """G74, G75: rapid to the reference or fixed point of the named axes."""
        reader = self.reader
        reader.corners.finish()
        axes = "".join(f"{letter.lower()}0" for letter, _ in words if letter in "XYZ")
        reader.controller.note("G74, G75", "fixed point of the machine: machine zero is taken")
        modal = reader.controller.motion
        if axes:
            reader.keep("a fixed point of the machine")
            reader.execute(f"g53g0{axes}")
        reader.controller.motion = modal

    def rigid_tap(self, words: Words) -> tuple[Words, list[float]]:
        """G331 into the thread and G332 out of it: pitch I, J or K times the speed is the feed."""
        reader, values = self.reader, dict(words)
        pitch = next((abs(v) for letter, v in words if letter in ("I", "J", "K")), 0.0)
        if "S" in values:
            reader.execute(f"s{number(values['S'])}")
        feed = reader.units.said(pitch * reader.controller.speed)
        if not feed > 0.0:
            raise ProgramError("G331 and G332 need a pitch I, J or K, and S")
        reader.keep("tapping by G331 and G332")
        left = [w for w in words if w[0] not in ("I", "J", "K", "S") and w[0] != "G"]
        codes = [1.0 if v in (331.0, 332.0) else v for letter, v in words if letter == "G"]
        return [*(("G", v) for v in codes), *left, ("F", feed)], codes

    def dwell(self, words: Words) -> None:
        """G4 F is a time in seconds, G4 S a number of revolutions."""
        values, reader = {k: v for k, v in words if k != "N"}, self.reader
        if set(values) == {"G", "F"}:
            reader.execute(f"g4p{number(values['F'])}")
        elif set(values) == {"G", "S"} and reader.controller.speed > 0.0:
            reader.execute(f"g4p{number(values['S'] * 60.0 / reader.controller.speed)}")
        else:
            raise ProgramError("G4 takes F (seconds) or S (revolutions) alone in its block")
