"""Klartext cycle 247: a row of the preset table becomes the workpiece zero.

HEIDENHAIN iTNC 530, User's Manual Cycle Programming, "Datum setting (cycle 247)": activating a
preset takes datum shift, mirror image, rotation and scaling away.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.motion.frames import select_system
from gcode.state.controller import WORK_OFFSETS

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.frames import KlartextFrames

__all__ = ["Presets"]

_NAMED = re.compile(r"Q339\s*=\s*\+?(\d+)")
_WITH_CODES = 6  #: presets 1 to 6 are G54 to G59 of the job, 7 is G54.1 P1


class Presets:
    """Which work offset of the job a preset is.

    One preset, whatever its number, is the job's G54. Where the program names several, their
    numbers choose.

    Parameters
    ----------
    frames : KlartextFrames
    """

    def __init__(self, frames: KlartextFrames) -> None:
        self.frames = frames
        lines = frames.reader.lines
        self.named = {int(n) for line in lines for n in _NAMED.findall(line.upper())}
        self.first: int | None = None

    def activate(self, row: float | None) -> None:
        """Activate a row of the preset table.

        Raises
        ------
        ProgramError
            It is not a whole number, or a second row that no literal in the text announced.
        """
        if row is None or row != round(row) or row < 0.0:
            raise ProgramError("cycle 247 without a row of the preset table",
                               accepted="Q339=+1")  # fmt: skip
        number = int(row)
        self.first = number if self.first is None else self.first
        reader = self.frames.reader
        self.frames.cancel()
        if len(self.named) < 2:
            if number != self.first:
                raise ProgramError(f"preset {number} behind preset {self.first}",
                                   accepted="numbers in the text of the program")  # fmt: skip
            reader.noted("CYCL DEF 247", "preset: the work offset of the job")
            return
        code = self._work_offset(number)
        select_system(reader.controller, code)
        reader.noted("CYCL DEF 247", f"preset {number}: {code} of the job")

    @staticmethod
    def _work_offset(number: int) -> str:
        if number == 0:
            raise ProgramError("preset 0 beside others", accepted="presets 1 to 105")
        if number <= _WITH_CODES:
            return WORK_OFFSETS[number - 1]
        return f"G54.1 P{number - _WITH_CODES}"
