"""Axes whose place the program itself says."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gcode import BlockText, MoveKind, Program
from vmach.program_text.blocks.block_modes import BlockModes

__all__ = ["programmed_axes"]

#: what makes the place of axes uncertain, where it says something new or (these) in any case
_FRAMES = {"set_g5x_offset": (True, True, True), "set_xy_rotation": (True, True, False)}
#: an axis that goes no farther stands
_MOVES_MM = 1e-9
_ANYWAY = {"tool_offset": (False, False, True), "change_tool": (True, True, True)}


def programmed_axes(
    program: Program, modes: Mapping[int, BlockModes], text: BlockText
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
    modes : mapping of line to BlockModes
    text : BlockText
        The program's words.

    Returns
    -------
    programmed : (N, 3) bool
        Of every move, its own words included.
    unknown_start : (N,) bool
        Moves along an axis that had none before: they begin wherever the tool is, so that no
        point between their start and their end can be told.
    """
    moves = program.moves
    lost, turned = _lost(program)
    known, found = np.zeros(3, bool), np.zeros((len(moves), 3), bool)
    unknown_start = np.zeros(len(moves), bool)
    for move in range(len(moves)):
        known &= ~lost[move]
        if moves.kind[move] == MoveKind.DWELL:
            continue
        line = int(moves.line[move])
        mode, before = modes[line], known | modes[line].incremental
        words = [w for w in text.words(line) if w.letter in "XYZ"]
        if mode.left:
            named = [a in {w.letter for w in words} for a in "XYZ"] if words else [True] * 3
            known &= ~np.array(named)
        elif not mode.incremental and not text.may_be_skipped(line):
            said = {w.letter for w in words if not text.is_incremental(w)}
            known = known | [a in said for a in "XYZ"]
        found[move] = known | mode.incremental
        if turned[move]:  # each of them moves both axes of the machine
            found[move, :2] = found[move, :2].all()
            before[:2] = before[:2].all()
        along = np.abs(moves.end_mm[move] - moves.start_mm[move]) > _MOVES_MM
        if moves.kind[move] == MoveKind.ARC:
            along |= np.abs(moves.axis[move]) < 0.5
        unknown_start[move] = (along & ~before).any()
    return found, unknown_start


def _lost(program: Program) -> tuple[np.ndarray, np.ndarray]:
    """Axes whose frame changes before a move, (N + 1, 3) bool; frames that are turned, (N + 1,)."""
    lost = np.zeros((len(program.moves) + 1, 3), bool)
    turned = np.zeros(len(lost), bool)
    told: dict[str, list] = {}
    for row, _, name, *values in program.record.events:
        if name in _ANYWAY:
            lost[row] |= _ANYWAY[name]
        elif name in _FRAMES:
            if told.get(name, values) != values:
                lost[row] |= _FRAMES[name]
            told[name] = values
        if name == "set_xy_rotation":
            turned[row:] = values[0] != 0.0
    return lost, turned
