"""TRANS, ROT, MIRROR and their additive forms: the programmable frame.

Source: SINUMERIK 840D sl/828D, Programming Manual Fundamentals, "Coordinate transformations
(frames)". TRANS, ROT, SCALE, MIRROR set a frame and take all others away; ATRANS, AROT, AMIRROR act
in the frame that is there. MIRROR mirrors the axes that it names, whatever their values.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.geometry.frame_turn import FrameTurn
from gcode.motion.frames import turn_frame

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["ProgrammableFrame"]


class ProgrammableFrame:
    """The frame in force: a shift, and a turn before it.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.shift, self.turn = [0.0] * 6, FrameTurn()

    def obey(self, name: str, words: Mapping[str, float]) -> None:
        """One of the words with its axes; without axes all frames go.

        Raises
        ------
        ProgramError
            It scales, turns the part over, or names what it does not know.
        """
        kind = name.removeprefix("A") if name.startswith("A") else name
        if not words or name == kind:
            self.shift, self.turn = [0.0] * 6, FrameTurn()
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
        by = self.turn.apply([words.get(axis, 0.0) for axis in "XYZABC"])
        self.shift = [s + b for s, b in zip(self.shift, by, strict=True)]

    def _rotate(self, words: Mapping[str, float]) -> None:
        self._axes("ROT", words, "X Y Z RPL")
        if "RPL" in words and self.reader.controller.plane != 1:
            raise ProgramError("ROT RPL= in G18 or G19 tilts the plane", accepted="G17")
        if words.get("X", 0.0) or words.get("Y", 0.0):
            raise ProgramError("ROT about X or Y tilts the plane", accepted="ROT Z or ROT RPL=")
        angle = words.get("RPL", words.get("Z", 0.0))
        self.turn = self.turn.before(FrameTurn(angle))

    def _mirror(self, words: Mapping[str, float]) -> None:
        self._axes("MIRROR", words, "X Y Z")
        if "Z" in words:
            raise ProgramError("MIRROR Z turns the part over", accepted="MIRROR X0, MIRROR Y0")
        signs = (-1.0 if "X" in words else 1.0, -1.0 if "Y" in words else 1.0)
        self.turn = self.turn.before(FrameTurn(0.0, signs))

    def _scale(self, words: Mapping[str, float]) -> None:
        self._axes("SCALE", words, "X Y Z")
        if any(value != 1.0 for value in words.values()):
            raise ProgramError("SCALE with factors other than 1 is not read", accepted="SCALE X1")
