"""What is modally in force in every block of a program, and which blocks cannot be rewritten."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from gcode import Program
from vmach.errors import InputError

__all__ = ["BlockModes", "block_modes"]

#: G codes in tenths whose motion has no one-to-one relation to the block's words
_REFUSED = {
    50: "spline", 51: "spline", 52: "spline", 70: "diameter mode", 160: "polar coordinates",
    330: "threading", 331: "tapping", 382: "probing", 383: "probing", 384: "probing",
    385: "probing", 410: "cutter compensation", 411: "cutter compensation",
    420: "cutter compensation", 421: "cutter compensation", 510: "scaling", 680: "rotation",
    730: "canned cycle", 740: "canned cycle", 760: "canned cycle",
} | {code: "canned cycle" for code in range(810, 900, 10)}  # fmt: skip
_UNIT_MM = {200: 25.4, 210: 1.0}
#: machine coordinates and reference points: left as they stand
_LEFT = {280, 300, 530}
#: M codes that act when the block's motion has ended
_ENDING = {0, 1, 2, 5, 9, 30, 60}


@dataclass(frozen=True)
class BlockModes:
    """Modes of one block that moves the axes.

    Attributes
    ----------
    unit_mm : float
    incremental : bool
        G91.
    absolute_centre : bool
        G90.1.
    left : bool
        The block's position is none of the part's (G53, G28, G30) and stays.
    whole : bool
        No points may be inserted: inverse-time feed, or an M code acts at the block's end.
    """

    unit_mm: float
    incremental: bool
    absolute_centre: bool
    left: bool
    whole: bool


def block_modes(program: Program) -> dict[int, BlockModes]:
    """Modes of every line that moves the axes, by 1-based line.

    Raises
    ------
    InputError
        Motion comes from cycles, cutter compensation, loops, subprograms or expressions; all
        such lines are named.
    """
    if program.dialect not in ("rs274", "fanuc"):
        raise InputError(
            f"{program.dialect} programs cannot be compensated",
            file=program.path,
            accepted="rs274, fanuc",
        )
    rows = Counter(program.moves.line[program.moves.kind != 3].tolist())
    refused: dict[int, str] = {}
    modes: dict[int, BlockModes] = {}
    unit_mm, incremental, absolute_centre, inverse_time = 1.0, False, False, False
    for line in range(1, len(program.source) + 1):
        words = program.source.words(line)
        codes = {round(10 * w.value) for w in words if w.letter == "G" and w.value is not None}
        unit_mm = next((_UNIT_MM[c] for c in codes if c in _UNIT_MM), unit_mm)
        incremental = 910 in codes or (incremental and 900 not in codes)
        absolute_centre = 901 in codes or (absolute_centre and 911 not in codes)
        inverse_time = 930 in codes or (inverse_time and not codes & {940, 950})
        for code in codes & _REFUSED.keys():
            refused[line] = _REFUSED[code]
        if line not in rows:
            continue
        left = bool(codes & _LEFT)
        moving = [w for w in words if w.letter in "XYZIJKR"]
        if not left and rows[line] > 1:
            refused.setdefault(line, "several motions of one block (loop, subprogram or cycle)")
        elif not left and (not moving or any(w.value is None for w in moving)):
            refused.setdefault(line, "motion without plain numbers")
        ending = any(w.letter == "M" and w.value in _ENDING for w in words)
        whole = inverse_time or ending
        modes[line] = BlockModes(unit_mm, incremental, absolute_centre, left, whole)
    order = program.moves.line[np.isin(program.moves.line, list(rows))]
    for line in order[1:][np.diff(order) < 0].tolist():
        refused.setdefault(line, "motion out of the order of the lines")
    _refuse(program, refused)
    return modes


def _refuse(program: Program, refused: dict[int, str]) -> None:
    if not refused:
        return
    first = min(refused)
    lines = ", ".join(map(str, sorted(refused)[:10])) + (" ..." if len(refused) > 10 else "")
    raise InputError(
        f"{refused[first]} cannot be compensated (lines {lines})",
        file=program.path,
        line=first,
        accepted="G0, G1, G2, G3 with plain numbers, each block run once",
        hint="post the program without cycles, subprograms and G41/G42",
    )
