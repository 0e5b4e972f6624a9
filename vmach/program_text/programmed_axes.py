"""Axes whose place the program itself says."""

from __future__ import annotations

import numpy as np
from numba import njit

from gcode import BlockText, MoveKind, Program
from vmach.program_text.blocks.line_modes import LineModes
from vmach.program_text.frame_shift import rotation_of_moves
from vmach.program_text.runs.axis_words import AxisWords

__all__ = ["programmed_axes"]

#: what makes the place of axes uncertain, where it says something new or (these) in any case
_FRAMES = {"set_g5x_offset": (True, True, True), "set_xy_rotation": (True, True, False)}
#: a programmable frame, which turns or mirrors X and Y
_TURN = "set_turn"
#: an axis that goes no farther stands
_MOVES_MM = 1e-9
#: an arc turns about an axis with a larger share of its direction
_ACROSS = 0.5
_ANYWAY = {"tool_offset": (False, False, True), "change_tool": (True, True, True)}


def programmed_axes(
    program: Program, modes: LineModes, text: BlockText, words: AxisWords
) -> tuple[np.ndarray, np.ndarray]:
    """Axes that have had a word in the frame that a move is made in.

    Only these may get a word that the user's block lacks. Where the others stand is a matter of
    the control's work offsets, tool lengths, tool changer and reference points, which the job
    need not have right: a word for them could move the machine by any distance. A distance (G91)
    is safe. A block that may be skipped says nothing.

    Parameters
    ----------
    program : Program
        In plain blocks.
    modes : LineModes
    text : BlockText
        The program's words.
    words : AxisWords
        Those of the lines of the moves, as far as they are plain.

    Returns
    -------
    programmed : (N, 3) bool
        Of every move, its own words included.
    unknown_start : (N,) bool
        Moves along an axis that had none before: they begin wherever the tool is, so that no
        point between their start and their end can be told.
    """
    moves = program.moves
    lost, mixed = _lost(program)
    turned = rotation_of_moves(program) != 0.0
    moving = moves.kind != MoveKind.DWELL
    said, left = _said(moves.line, moving, modes, text, words)
    counts_on = modes.column("incremental", moves.line, other=False)
    along = np.abs(moves.end_mm - moves.start_mm) > _MOVES_MM
    along |= (moves.kind == MoveKind.ARC)[:, None] & (np.abs(moves.axis) < _ACROSS)
    return _known_axes(moving, lost, mixed, turned, said, left, counts_on, along)


def _said(
    line: np.ndarray, moving: np.ndarray, modes: LineModes, text: BlockText,
    words: AxisWords,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Axes that the line of every move says, and those that it leaves anywhere, (N, 3) bool."""
    said, left = words.start[:, :3] >= 0, np.zeros((len(line), 3), bool)
    plain = words.is_plain & ~np.isin(line, modes.left_lines())
    said[~plain] = False
    for move in np.flatnonzero(moving & ~plain).tolist():
        number = int(line[move])
        own = [w for w in text.words(number) if w.letter in "XYZ"]
        if modes[number].left:
            left[move] = [a in {w.letter for w in own} for a in "XYZ"] if own else True
        elif not text.may_be_skipped(number):
            named = {w.letter for w in own if not text.is_incremental(w)}
            said[move] = [a in named for a in "XYZ"]
    return said, left


@njit(cache=True)
def _known_axes(
    moving, lost, mixed, turned, said, left, counts_on, along
):  # pragma: no cover - compiled
    """Go through the moves and keep which axes have had a word."""
    count = len(moving)
    found, unknown_start = np.zeros((count, 3), np.bool_), np.zeros(count, np.bool_)
    known, before = np.zeros(3, np.bool_), np.zeros(3, np.bool_)
    for move in range(count):
        for axis in range(3):
            known[axis] &= not lost[move, axis]
        if mixed[move]:  # a place along the turned axes follows from both
            known[:2] = known[0] and known[1]
        for axis in range(3):
            before[axis] = known[axis] or counts_on[move]
        if not moving[move]:
            continue
        for axis in range(3):
            known[axis] &= not left[move, axis]
            known[axis] |= said[move, axis] and not counts_on[move]
            found[move, axis] = known[axis] or counts_on[move]
        if turned[move]:  # each of them moves both axes of the machine
            found[move, :2] = found[move, 0] and found[move, 1]
            before[:2] = before[0] and before[1]
        for axis in range(3):
            unknown_start[move] |= along[move, axis] and not before[axis]
    return found, unknown_start


def _lost(program: Program) -> tuple[np.ndarray, np.ndarray]:
    """Axes whose frame changes before a move, (N + 1, 3) bool; X and Y turned there, (N + 1,).

    By how much a programmable frame turns, the program says itself.
    """
    lost = np.zeros((len(program.moves) + 1, 3), bool)
    mixed = np.zeros(len(lost), bool)
    told: dict[str, list] = {}
    events = program.record.said_events(_ANYWAY.keys() | _FRAMES.keys() | {_TURN})
    for row, which in zip(events.row.tolist(), events.which.tolist(), strict=True):
        name, *values = events.told[which]
        if name in _ANYWAY:
            lost[row] |= _ANYWAY[name]
        elif name == _TURN:
            mixed[row] = True
        else:
            if told.get(name, values) != values:
                lost[row] |= _FRAMES[name]
            told[name] = values
    return lost, mixed
