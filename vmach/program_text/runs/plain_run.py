"""Straight moves of plain lines written anew in compiled code.

The counterpart of `vmach.program_text.blocks.move_writer` for one piece a move, absolute numbers
and words that the line already has. It stops before a move that needs more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["LONGEST", "Run", "RunState", "write_run"]

#: a number has no more characters than this
LONGEST = 24
#: corrections that change no word count as swallowed above this, program units
_NOTHING = 1e-9
#: where the next digit is so near to a half, in the last place, its text decides
_UNSURE = 1e-3
_LARGEST = 1e14


class Run(NamedTuple):
    """Moves of a program and what they shall become; M moves, K pieces.

    Attributes
    ----------
    piece : (M,) int64
        The move's only piece; -1 where the move is not written here.
    code : (M,) int64
        Its G code.
    motion : (M,) int64
        G code that its line says, -1 for none.
    unit_mm : (M,) float64
    decimals : (M,) int64
    step : (M,) float64
        Resolution, program units.
    programmed : (M, 3) bool
        Axes that may get a word.
    start_mm, end_mm : (M, 3) float64
        Nominal places, program coordinates.
    wanted_mm : (K, 3) float64
        Where the pieces shall end.
    first, last, value, fill : (M, 3)
        Span, value and decimals of every number; -1 for no word.
    is_bare, has_plus : (M, 3) bool
        How it is written: without a zero before the point; with a plus sign.
    """

    piece: np.ndarray
    code: np.ndarray
    motion: np.ndarray
    unit_mm: np.ndarray
    decimals: np.ndarray
    step: np.ndarray
    programmed: np.ndarray
    start_mm: np.ndarray
    end_mm: np.ndarray
    wanted_mm: np.ndarray
    first: np.ndarray
    last: np.ndarray
    value: np.ndarray
    fill: np.ndarray
    is_bare: np.ndarray
    has_plus: np.ndarray


class RunState(NamedTuple):
    """What goes from move to move, and what has been written.

    Attributes
    ----------
    carried_mm, aimed_mm : (3,) float64
        As in `BlockState`.
    motion : (1,) int64
        G code in force.
    count : (2,) int64
        Numbers written, and corrections swallowed.
    start, stop, text, length : arrays
        As in `vmach.program_text.runs.splicing.Edits`.
    """

    carried_mm: np.ndarray
    aimed_mm: np.ndarray
    motion: np.ndarray
    count: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    text: np.ndarray
    length: np.ndarray


@njit(cache=True)
def _put_number(text, mantissa, decimals, fill, negative, bare, plus):  # pragma: no cover
    """Write a number from the left; returns how many characters it has."""
    at = 0
    if mantissa != 0 and negative:
        text[at] = 45
        at += 1
    elif plus:
        text[at] = 43
        at += 1
    power = np.int64(1)
    for _ in range(decimals):
        power *= 10
    whole, fraction, shown = mantissa // power, mantissa % power, decimals
    while shown > fill and fraction % 10 == 0:
        fraction //= 10
        shown -= 1
    digits = 1
    while whole // np.int64(10) ** digits > 0:
        digits += 1
    if not (bare and whole == 0 and shown > 0):
        for place in range(digits - 1, -1, -1):
            text[at] = 48 + whole // np.int64(10) ** place % 10
            at += 1
    text[at] = 46
    at += 1
    for place in range(shown - 1, -1, -1):
        text[at] = 48 + fraction // np.int64(10) ** place % 10
        at += 1
    return at


@njit(cache=True)
def _write_move(run, state, move, reached, aimed):  # pragma: no cover - compiled
    """Write one move; tells whether that was possible."""
    piece, unit = run.piece[move], run.unit_mm[move]
    edits, swallowed = state.count[0], state.count[1]
    power = 10.0 ** run.decimals[move]
    for axis in range(3):
        before = run.start_mm[move, axis] + state.carried_mm[axis]
        reached[axis] = aimed[axis] = before
        named = run.first[move, axis] >= 0
        if not named and not run.programmed[move, axis]:
            continue
        wanted = run.wanted_mm[piece, axis]
        aimed[axis] = wanted
        value = wanted / unit
        old = run.value[move, axis] if named else before / unit
        if abs(value - old) < 0.5 * run.step[move]:
            swallowed += abs(value - old) > _NOTHING
            reached[axis] = 0.0 + old * unit
            continue
        scaled = abs(value) * power
        mantissa = np.floor(scaled + 0.5)
        if not named or scaled > _LARGEST or abs(scaled - np.floor(scaled) - 0.5) < _UNSURE:
            return False
        new = mantissa / power * (-1.0 if value < 0.0 and mantissa != 0.0 else 1.0)
        reached[axis] = 0.0 + new * unit
        state.start[edits], state.stop[edits] = run.first[move, axis], run.last[move, axis]
        state.length[edits] = _put_number(
            state.text[edits], np.int64(mantissa), run.decimals[move], run.fill[move, axis],
            value < 0.0, run.is_bare[move, axis], run.has_plus[move, axis],
        )  # fmt: skip
        edits += 1
    state.count[0], state.count[1] = edits, swallowed
    return True


@njit(cache=True)
def write_run(run, state, moving, index, as_programmed):  # pragma: no cover - compiled
    """Write moves from one on, as far as possible.

    Parameters
    ----------
    run : Run
    state : RunState
        Changed in place.
    moving : (N,) int64
        Moves in order.
    index : int
        Of the first.
    as_programmed : int
        What `RunState.motion` is where the G code in force is that of the program.

    Returns
    -------
    int
        Index of the first move that was not written.
    """
    reached, aimed = np.zeros(3), np.zeros(3)
    while index < len(moving):
        move = moving[index]
        if run.piece[move] < 0:
            break
        in_force, code = state.motion[0], run.code[move]
        if run.motion[move] < 0 and in_force != as_programmed and in_force != code:
            break
        if not _write_move(run, state, move, reached, aimed):
            break
        for axis in range(3):
            state.carried_mm[axis] = reached[axis] - run.end_mm[move, axis]
            state.aimed_mm[axis] = aimed[axis] - run.end_mm[move, axis]
        state.motion[0] = code
        index += 1
    return index
