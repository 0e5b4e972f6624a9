"""TRANS, ROT, MIRROR and their additive forms: the programmable frame.

Source: SINUMERIK 840D sl/828D, Programming Manual Fundamentals, "Coordinate transformations
(frames)". TRANS, ROT, SCALE, MIRROR set a frame and take all others away; ATRANS, AROT, ASCALE,
AMIRROR act in the frame that is there. MIRROR mirrors the axes it names, whatever their values.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.block_words import split_arguments
from gcode.errors import ProgramError
from gcode.geometry.frame_turn import FrameTurn
from gcode.language.translate import number
from gcode.motion.frames import store_system, turn_frame
from gcode.state.controller import WORK_OFFSETS
from gcode.text.parameters import system_base

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["SETTABLE", "ProgrammableFrame", "settable_frame", "work_system"]

#: ``$P_UIFR[1,X,TR]=10`` and ``$P_UIFR[1]=CTRANS(X,10,Y,5)``
SETTABLE = re.compile(
    r"\$P_UIFR\[((?:[^\[\],]|\[[^\[\]]*\])+)(?:,\s*([XYZABC])\s*,\s*TR\s*)?\]\s*=(?!=)\s*(.*)",
    re.IGNORECASE,
)
_LENGTH = re.compile(r"(?<![a-z])([xyzijkr])(-?\d+\.?\d*|-?\.\d+)")
_ARC = re.compile(r"g0?[23](?![\d.])")
#: blocks whose numbers are the machine's
_OF_MACHINE = re.compile(r"g(?:53|10)(?![\d.])")
_UNIT = (1.0, 1.0, 1.0)


class ProgrammableFrame:
    """The frame in force: a shift, a turn before it, and a scale before that.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.shift, self.turn, self.scale = [0.0] * 6, FrameTurn(), _UNIT

    def obey(self, name: str, words: Mapping[str, float]) -> None:
        """One of the words with its axes; without axes all frames go.

        Raises
        ------
        ProgramError
            It turns the part over, scales behind a turn, or names what it does not know.
        """
        kind = name.removeprefix("A") if name.startswith("A") else name
        if not words or name == kind:
            self.shift, self.turn, self.scale = [0.0] * 6, FrameTurn(), _UNIT
        if words:
            {
                "TRANS": self._move,
                "ROT": self._rotate,
                "MIRROR": self._mirror,
                "SCALE": self._scale,
            }[kind](words)
        turn_frame(
            self.reader.controller, self.shift, angle_deg=self.turn.angle_deg, signs=self.turn.signs
        )

    def _axes(self, name: str, words: Mapping[str, float], accepted: str) -> None:
        unknown = sorted(words.keys() - set(accepted.split()))
        if unknown:
            raise ProgramError(f"{name} with {unknown[0]}", accepted=accepted)

    def _move(self, words: Mapping[str, float]) -> None:
        self._axes("TRANS", words, "X Y Z A B C")
        sizes = (*self.scale, 1.0, 1.0, 1.0)
        by = [words.get(axis, 0.0) * size for axis, size in zip("XYZABC", sizes, strict=True)]
        by = self.turn.apply(by)
        self.shift = [s + b for s, b in zip(self.shift, by, strict=True)]

    def _rotate(self, words: Mapping[str, float]) -> None:
        self._axes("ROT", words, "X Y Z RPL")
        if "RPL" in words and self.reader.controller.plane != 1:
            raise ProgramError("ROT RPL= in G18 or G19 tilts the plane", accepted="G17")
        if words.get("X", 0.0) or words.get("Y", 0.0):
            raise ProgramError("ROT about X or Y tilts the plane", accepted="ROT Z or ROT RPL=")
        angle = words.get("RPL", words.get("Z", 0.0))
        if angle and self.scale[0] != self.scale[1]:
            raise ProgramError("AROT behind SCALE with different factors for X and Y",
                               accepted="one factor")  # fmt: skip
        self.turn = self.turn.before(FrameTurn(angle))

    def _mirror(self, words: Mapping[str, float]) -> None:
        self._axes("MIRROR", words, "X Y Z")
        if "Z" in words:
            raise ProgramError("MIRROR Z turns the part over", accepted="MIRROR X0, MIRROR Y0")
        signs = (-1.0 if "X" in words else 1.0, -1.0 if "Y" in words else 1.0)
        self.turn = self.turn.before(FrameTurn(0.0, signs))

    def _scale(self, words: Mapping[str, float]) -> None:
        self._axes("SCALE", words, "X Y Z")
        if min(words.values()) <= 0.0:
            raise ProgramError(f"scale factor {min(words.values()):g}", accepted="above zero")
        self.scale = tuple(
            size * words.get(axis, 1.0) for axis, size in zip("XYZ", self.scale, strict=True)
        )

    @property
    def is_full_size(self) -> bool:
        """Nothing is scaled."""
        return self.scale == _UNIT

    def unscaled(self, place: list[float]) -> list[float]:
        """A place of the control in programmed lengths."""
        if self.scale == _UNIT:
            return place
        return [p / s for p, s in zip(place[:3], self.scale, strict=True)] + place[3:]

    def scaled(self, block: str) -> str:
        """A block of RS274/NGC in programmed lengths, in those of the control.

        Raises
        ------
        ProgramError
            An arc would turn oval.
        """
        if self.scale == _UNIT or _OF_MACHINE.search(block):
            return block
        modal = self.reader.controller.motion in ("G2", "G3") and not re.search(r"g[01]\b", block)
        if self.scale[0] != self.scale[1] and (_ARC.search(block) or modal):
            raise ProgramError(
                f"an arc with scale factors {self.scale[0]:g} and {self.scale[1]:g}",
                accepted="one factor for X and Y",
            )
        self.reader.keep("scaling")
        sizes = dict(zip("xyzijkr", (*self.scale, *self.scale, self.scale[0]), strict=True))
        return _LENGTH.sub(lambda m: f"{m[1]}{number(float(m[2]) * sizes[m[1]])}", block)


def work_system(frame: int) -> int:
    """Work system that holds a settable frame: G500 is 0, G54 to G57 are 1 to 4, G505 is 5."""
    if not 0 <= frame <= 99:
        raise ProgramError(f"$P_UIFR[{frame}]", accepted="0 to 99")
    return frame if 1 <= frame <= 4 else WORK_OFFSETS.index(f"G54.1 P{max(frame, 1)}") + 1


def settable_frame(reader: SinumerikReader, match: re.Match) -> None:
    """Set a work offset as `SETTABLE` says it."""
    index, axis, value = reader.variables.value(match[1].strip()), match[2], match[3].strip()
    if index != round(index):
        raise ProgramError(f"$P_UIFR[{index:g}]", accepted="0 to 99")
    frame = int(index)
    system, c = work_system(frame), reader.controller
    offset = c.to_program(c.parameters.vector(system_base(system)))
    if axis is not None:
        said = {axis.upper(): value}
    else:
        chained = re.fullmatch(r"CTRANS\s*\((.*)\)", value, re.IGNORECASE)
        if chained is None:
            raise ProgramError(f"cannot read '$P_UIFR[{frame}]={value}'",
                               accepted="$P_UIFR[1]=CTRANS(X,10,Y,5,Z,0)")  # fmt: skip
        pieces = [piece.strip() for piece in split_arguments(chained[1])]
        said = {a.upper(): v for a, v in zip(pieces[::2], pieces[1::2], strict=False)}
        offset = [0.0] * len(offset)
    for k, name in enumerate("XYZABC"):
        if name in said:
            value = reader.variables.value(said[name])
            offset[k] = reader.units.read(value) if k < 3 else value
    store_system(c, system, offset)
