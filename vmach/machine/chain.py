"""The kinematic chain of a machine, read from its ISO 10791-1 string.

Source: ISO 10791-1 (designation of the chain); ISO 841 (a prime marks an axis that carries the
workpiece).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.errors import InputError

__all__ = ["LINEAR_AXES", "ROTARY_AXES", "Chain"]

LINEAR_AXES = ("X", "Y", "Z")
ROTARY_AXES = ("A", "B", "C")


@dataclass(frozen=True)
class Chain:
    """Order of the three linear axes, and of rotary ones, between tool and workpiece.

    Attributes
    ----------
    tool_side : tuple of str
        Axes that carry the tool, from the tool to the bed.
    work_side : tuple of str
        Axes that carry the workpiece, from the bed to the workpiece.
    """

    tool_side: tuple[str, ...]
    work_side: tuple[str, ...]

    def __post_init__(self) -> None:
        axes = self.tool_side + self.work_side
        linear = [axis for axis in axes if axis not in ROTARY_AXES]
        if sorted(linear) != sorted(LINEAR_AXES):
            raise InputError(
                f"the chain has the linear axes {' '.join(linear) or 'none'}",
                accepted="X, Y and Z, each once",
            )
        if len(set(axes)) < len(axes):
            raise InputError(
                f"the chain has the axes {' '.join(axes)}", accepted="A, B and C at most once"
            )

    @classmethod
    def parse(cls, text: str) -> Chain:
        """Read a chain such as ``t (C) Z Y b X' w`` or ``t (C1) B Z Y b X' C' w``.

        Either end may come first.

        The spindle in brackets is skipped; a prime marks an axis that carries the workpiece and
        may be left out, since the side of the bed ``b`` says the same.

        Raises
        ------
        InputError
            Ends or bed missing, an unknown or repeated axis, a prime on the tool side.
        """
        words = [word for word in text.split() if not word.startswith("(")]
        if words and words[0] == "w":
            words.reverse()
        accepted = "t (C) Z Y b X' w: tool t, bed b, workpiece w, a prime on work-side axes"
        if len(words) < 3 or words[0] != "t" or words[-1] != "w" or words.count("b") != 1:
            raise InputError(f"chain '{text}' does not lead from t over b to w", accepted=accepted)
        bed = words.index("b")
        tool_side, work_side = words[1:bed], words[bed + 1 : -1]
        for axis in tool_side:
            if axis.endswith("'"):
                raise InputError(
                    f"chain '{text}': axis {axis} stands on the tool side but has a prime",
                    accepted=accepted,
                )
        work_side = [axis.removesuffix("'") for axis in work_side]
        for axis in tool_side + work_side:
            if axis not in (*LINEAR_AXES, *ROTARY_AXES):
                raise InputError(
                    f"chain '{text}': '{axis}' is no axis",
                    accepted="X, Y, Z, each once, and A, B, C",
                )
        try:
            return cls(tuple(tool_side), tuple(work_side))
        except InputError as error:
            raise InputError(f"chain '{text}': {error.what}", accepted=error.accepted) from None

    @property
    def rotary_axes(self) -> tuple[str, ...]:
        """The rotary axes of the chain, from the tool to the workpiece."""
        axes = self.tool_side + self.work_side
        return tuple(axis for axis in axes if axis in ROTARY_AXES)

    def carries_tool(self, axis: str) -> bool:
        """Whether the axis is between bed and tool."""
        return axis in self.tool_side

    @cached_property
    def arm_masks(self) -> np.ndarray:
        """Coordinates that make up each axis' arm, (3, 3) float64 of 0 and 1.

        The arm of axis j, from the origin of the body that it carries to the tool tip, is
        ``r_j = T + arm_masks[j] * q`` with T the vector from spindle nose to tip. Row order
        X, Y, Z. The origin of every body's frame is the spindle nose with all axes at home.

        A tool-side axis has the coordinates of the axes nearer the tool, its own excluded; a
        work-side axis has those of all tool-side axes and of the work-side axes from the bed up
        to itself, its own included: the table moves under the tip. Rotary axes stand at zero.
        """
        masks = np.zeros((3, 3))
        index = {axis: k for k, axis in enumerate(LINEAR_AXES)}
        tool_side = [axis for axis in self.tool_side if axis in index]
        work_side = [axis for axis in self.work_side if axis in index]
        for place, axis in enumerate(tool_side):
            for nearer in tool_side[:place]:
                masks[index[axis], index[nearer]] = 1.0
        for place, axis in enumerate(work_side):
            for other in (*tool_side, *work_side[: place + 1]):
                masks[index[axis], index[other]] = 1.0
        masks.setflags(write=False)
        return masks

    def __str__(self) -> str:
        work = " ".join(f"{axis}'" for axis in self.work_side)
        return " ".join(part for part in ("t (C)", *self.tool_side, "b", work, "w") if part)
