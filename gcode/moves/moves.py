"""Resolved moves: what a program makes the machine do, one row a move.

Source: ISO 841 (axes and signs).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np

__all__ = ["MoveKind", "Moves"]


class MoveKind(IntEnum):
    """What the axes do during a move."""

    RAPID = 0  #: G0, straight
    LINE = 1  #: G1, straight, at feed
    ARC = 2  #: G2/G3, circle, helix or spiral, at feed
    DWELL = 3  #: axes stand still: G4, tool change


#: field name -> (numpy dtype, trailing shape)
_COLUMNS: dict[str, tuple[type, tuple[int, ...]]] = {
    "kind": (np.int8, ()),
    "line": (np.int32, ()),
    "start_mm": (np.float64, (3,)),
    "end_mm": (np.float64, (3,)),
    "centre_mm": (np.float64, (3,)),
    "axis": (np.float64, (3,)),
    "sweep_rad": (np.float64, ()),
    "rotary_start_deg": (np.float64, (3,)),
    "rotary_end_deg": (np.float64, (3,)),
    "feed_mm_per_min": (np.float64, ()),
    "spindle_rpm": (np.float64, ()),
    "tool": (np.int32, ()),
    "tool_offset_mm": (np.float64, (3,)),
    "work_offset": (np.int8, ()),
    "exact_stop": (np.bool_, ()),
    "start_s": (np.float64, ()),
    "duration_s": (np.float64, ()),
}


@dataclass(frozen=True)
class Moves:
    """The moves of one program in the order in which the machine makes them.

    All positions are machine coordinates of the spindle nose in mm, that is the controlled
    point with work offsets, rotation and tool offset added: machine = R (program + G92) + G5x
    + tool offset. N is the number of moves. Arrays are read-only.

    Attributes
    ----------
    kind : (N,) int8
        A `MoveKind`.
    line : (N,) int32
        1-based line of the program's text that caused the move.
    start_mm, end_mm : (N, 3) float64
        Position before and after; ``end_mm[i] == start_mm[i + 1]``.
    centre_mm : (N, 3) float64
        Arc: centre of the circle at the height of the start; zero otherwise.
    axis : (N, 3) float64
        Arc: unit vector that the motion turns about, right-handed; zero otherwise.
    sweep_rad : (N,) float64
        Arc: signed angle turned about `axis` (positive counter-clockwise seen from its tip),
        beyond 2 pi for several turns; zero otherwise. The axial coordinate and the radius
        change linearly with the angle.
    rotary_start_deg, rotary_end_deg : (N, 3) float64
        A, B, C axis positions.
    feed_mm_per_min : (N,) float64
        Feed along the path that the program asks for; the machine's rapid for `RAPID`; 0 for
        `DWELL`.
    spindle_rpm : (N,) float64
        Positive clockwise (M3), negative M4, zero standing.
    tool : (N,) int32
        Number of the tool in the spindle, 0 for none.
    tool_offset_mm : (N, 3) float64
        Tool offset in force (G43), nose minus controlled point.
    work_offset : (N,) int8
        1 for G54 ... 9 for G59.3.
    exact_stop : (N,) bool
        The axes come to rest at the end of this move (G61.1, G9).
    start_s, duration_s : (N,) float64
        Clock: seconds since the program's start, and how long the move takes.
    """

    kind: np.ndarray
    line: np.ndarray
    start_mm: np.ndarray
    end_mm: np.ndarray
    centre_mm: np.ndarray
    axis: np.ndarray
    sweep_rad: np.ndarray
    rotary_start_deg: np.ndarray
    rotary_end_deg: np.ndarray
    feed_mm_per_min: np.ndarray
    spindle_rpm: np.ndarray
    tool: np.ndarray
    tool_offset_mm: np.ndarray
    work_offset: np.ndarray
    exact_stop: np.ndarray
    start_s: np.ndarray
    duration_s: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.kind)
        for field in fields(self):
            dtype, tail = _COLUMNS[field.name]
            array = np.ascontiguousarray(getattr(self, field.name), dtype=dtype)
            if array.shape != (count, *tail):
                raise ValueError(
                    f"Moves.{field.name} has shape {array.shape}; expected {(count, *tail)}"
                )
            if dtype is np.float64 and not np.isfinite(array).all():
                raise ValueError(f"Moves.{field.name} holds values that are not finite")
            if not array.any():  # memory that nobody writes to takes no room
                array = np.zeros(array.shape, dtype)
            array.setflags(write=False)
            object.__setattr__(self, field.name, array)

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def at_feed(self) -> np.ndarray:
        """Moves in which the tool may cut, (N,) bool: neither rapids nor pauses."""
        return (self.kind == MoveKind.LINE) | (self.kind == MoveKind.ARC)
