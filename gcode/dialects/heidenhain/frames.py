"""Klartext cycles 7, 8, 10, 11 and 26: datum shift, mirror image, rotation, scaling.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Coordinate transformations". The control
applies them in the order in which they are activated; here a datum shift comes first, then mirror
image, then rotation, and a shift with incremental axes behind one of these is refused.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.dialects.heidenhain.presets import Presets
from gcode.dialects.heidenhain.scaling import Scaling
from gcode.errors import ProgramError
from gcode.motion.frames import turn_frame

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextFrames"]


class KlartextFrames:
    """Transformations in force.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.shift = [0.0] * 6
        self.mirrored: frozenset[str] = frozenset()
        self.angle_deg = 0.0
        self.scaling = Scaling()
        self.presets = Presets(self)

    @property
    def _turns(self) -> bool:
        return bool(self.mirrored) or self.angle_deg != 0.0 or not self.scaling.is_identity

    def define(self, cycle: int, text: str) -> None:
        """A line of one of the cycles."""
        body = re.sub(r"^\d+\.\d+\s*", "", text)
        if cycle in (11, 26):
            self.reader.controller.require_no_compensation("change the scaling")
            self.scaling = self.scaling.defined(text, self.reader.parameters.number)
            return
        {7: self._datum_shift, 8: self._mirror, 10: self._rotate}[cycle](body, text)
        self._apply()

    def transform(self, content: str) -> None:
        """TRANS DATUM, MIRROR, ROTATION and SCALE of newer controls: cycles 7, 8, 10 and 11."""
        match = re.fullmatch(r"TRANS\s+(DATUM|MIRROR|ROTATION|SCALE)\s*(?:AXIS\b)?\s*(.*)", content)
        if match is None or "TABLE" in content:
            raise ProgramError(f"cannot read '{content}'",
                               accepted="TRANS DATUM, MIRROR, ROTATION, SCALE")  # fmt: skip
        kind, body = match[1], match[2]
        reset = body == "RESET"
        cycle, nothing = {"DATUM": (7, "X0 Y0 Z0"), "MIRROR": (8, ""), "ROTATION": (10, "ROT0"),
                          "SCALE": (11, "SCL1")}[kind]  # fmt: skip
        self.define(cycle, f"{cycle}.1 {nothing if reset else body}")

    def _datum_shift(self, body: str, text: str) -> None:
        body = re.sub(r"^DATUM SHIFT", "", body).strip() if text.startswith("7.0") else body
        if body.startswith("#"):
            raise ProgramError("datum table of CYCL DEF 7 is not read", accepted="X Y Z")
        if text.startswith("7.0"):
            return
        for name, value in re.findall(rf"(I?[XYZABC])\s*({NUMBER})", body):
            axis, size = "XYZABC".index(name[-1]), self.reader.parameters.number(value)
            level = size + (self.shift[axis] if name[0] == "I" else 0.0)
            if self._turns and level not in (self.shift[axis], 0.0):
                raise ProgramError(
                    "a datum shift behind mirror image, rotation or scaling is not read",
                    accepted="the datum shift first, then CYCL DEF 8, 10, 11 and 26",
                )
            self.shift[axis] = level

    def _mirror(self, body: str, text: str) -> None:
        if text.startswith("8.0"):
            return
        axes = frozenset(body.split())
        if axes - set("XYZ"):
            raise ProgramError(f"cannot read 'CYCL DEF {text}'", accepted="CYCL DEF 8.1 X Y")
        if "Z" in axes:
            raise ProgramError("CYCL DEF 8 with Z turns the part over", accepted="X Y")
        if self.angle_deg and axes != self.mirrored:
            raise ProgramError(
                "mirror image behind a rotation is not read",
                accepted="CYCL DEF 8 before CYCL DEF 10",
            )
        self.mirrored = axes

    def _rotate(self, body: str, text: str) -> None:
        found = re.search(rf"(I?)ROT\s*({NUMBER})", body)
        if found is None:
            if not text.startswith("10.0"):
                raise ProgramError(f"cannot read 'CYCL DEF {text}'", accepted="ROT+30")
            return
        angle = self.reader.parameters.number(found[2])
        self.angle_deg = angle + (self.angle_deg if found[1] else 0.0)

    def cancel(self) -> None:
        """Take all of them away."""
        self.reader.controller.require_no_compensation("activate a preset")
        self.shift, self.mirrored, self.angle_deg = [0.0] * 6, frozenset(), 0.0
        self.scaling = Scaling()
        self._apply()

    def _apply(self) -> None:
        signs = [-1.0 if axis in self.mirrored else 1.0 for axis in "XY"]
        turn_frame(self.reader.controller, self.shift, angle_deg=self.angle_deg, signs=tuple(signs))
