"""Where a line leaves the tool and the control, beside where the user's program has them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gcode import AS_PROGRAMMED, Step
from vmach.program_text.frame_shift import FrameShift

__all__ = ["BlockState"]


@dataclass(frozen=True)
class BlockState:
    """What one line leaves to the next.

    Attributes
    ----------
    carried_mm, aimed_mm : (3,) float64
        Written and wanted minus nominal place, machine axes.
    motion : int
        G code in force.
    frame : FrameShift
        Zeros that went along with a corrected tool.
    """

    carried_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    aimed_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    motion: int = AS_PROGRAMMED
    frame: FrameShift = field(default_factory=FrameShift)

    def after_zero(self, step: Step, angle_rad: float) -> BlockState:
        """After a line that sets or chooses a zero, see `FrameShift.after`."""
        return replace(self, frame=self.frame.after(step, self.carried_mm, angle_rad))

    def after_user_line(self, named: set[str], *, says_motion: bool) -> BlockState:
        """After a line that stays: the axes that it names are where the program has them.

        A line without any leads all axes there: a cycle, a reference point.
        """
        still = [bool(named) and axis not in named for axis in "XYZ"]
        return replace(
            self,
            carried_mm=np.where(still, self.carried_mm, 0.0),
            aimed_mm=np.where(still, self.aimed_mm, 0.0),
            motion=AS_PROGRAMMED if says_motion else self.motion,
        )
