"""Lines and arcs of plain lines written anew in compiled code.

The counterpart of `vmach.program_text.blocks.move_writer` for one piece a move, absolute numbers
and words that the line already has. It stops before a move that needs more.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel
from vmach.program_text.blocks.written_arc import LINE, RADIUS, fit_arc
from vmach.program_text.runs.axis_words import LETTERS
from vmach.program_text.runs.axis_words import RADIUS as R

__all__ = ["LONGEST", "Run", "RunState", "write_run"]

#: a number has no more characters than this
LONGEST = 32
#: corrections that change no word count as swallowed above this, program units
_NOTHING = 1e-9
#: relative error of a scaled number, twice the rounding of one product: nearer to a half, in the
#: last place, its text decides
_PRODUCT = 2.3e-16
_LARGEST = 1e14
_LETTERS = np.frombuffer(LETTERS.encode(), np.uint8)
_BLANK = ord(" ")
_TO_LOWER = ord("a") - ord("A")


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
    wanted_mm, middle_mm : (K, 3) float64
        Where the pieces shall end, and where their middles shall be.
    side : (M, 2) int8
        First and second axis of the plane.
    absolute_centre : (M,) bool
    tolerance : (M, 3) float64
        Of the radii of arcs, see `fit_arc`.
    first, last, fill : (M, 7)
        Span and decimals of every number; -1 for no word.
    value : (M, 3) float64
    is_bare, has_plus : (M, 7) bool
        How it is written: without a zero before the point; with a plus sign.
    behind : (M,) int64
        Where words go that the line lacks.
    own : (M,) bool
        The numbers of its line are not the user's, and all are written anew.
    habits : (6,) int64
        Of these: blanks before the letter and before the number, whether the letter is small;
        fewest decimals, is_bare, has_plus.
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
    middle_mm: np.ndarray
    side: np.ndarray
    absolute_centre: np.ndarray
    tolerance: np.ndarray
    first: np.ndarray
    last: np.ndarray
    fill: np.ndarray
    value: np.ndarray
    is_bare: np.ndarray
    has_plus: np.ndarray
    behind: np.ndarray
    own: np.ndarray
    habits: np.ndarray


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


@njit_inlined()
def _put_number(text, at, mantissa, digits):
    """Write a number into a text from a place on; where it ends."""
    decimals, fill, negative, bare, plus = digits
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
    if not (bare and whole == 0 and shown > 0):
        at = _put_digits(text, at, whole, _count_digits(whole))
    text[at] = 46
    return _put_digits(text, at + 1, fraction, shown)


@njit_inlined()
def _count_digits(whole):
    """Digits of a whole number."""
    count, rest = 1, whole // 10
    while rest > 0:
        rest //= 10
        count += 1
    return count


@njit_inlined()
def _put_digits(text, at, whole, count):
    """Write so many digits from a place on; where they end."""
    for place in range(at + count - 1, at - 1, -1):
        text[place] = 48 + whole % 10
        whole //= 10
    return at + count


@njit_inlined()
def _edit(run, state, move, letter, value):
    """Put a number in the place of a word's, or add a word.

    Tells whether its digits are sure, and what it says.
    """
    decimals = run.decimals[move]
    scaled = abs(value) * 10.0**decimals
    mantissa = np.floor(scaled + 0.5)
    if scaled > _LARGEST or abs(scaled - np.floor(scaled) - 0.5) <= _PRODUCT * scaled:
        return False, 0.0
    edit = state.count[0]
    text, at = state.text[edit], 0
    fill, is_bare, has_plus = (
        run.fill[move, letter],
        run.is_bare[move, letter],
        run.has_plus[move, letter],
    )
    if run.first[move, letter] >= 0:
        state.start[edit], state.stop[edit] = run.first[move, letter], run.last[move, letter]
    else:
        state.start[edit] = state.stop[edit] = run.behind[move]
        before, between, is_lower, fill = run.habits[0], run.habits[1], run.habits[2], run.habits[3]
        is_bare, has_plus, fill = run.habits[4] > 0, run.habits[5] > 0, max(min(fill, decimals), 0)
        text[: before + 1 + between] = _BLANK
        text[before] = _LETTERS[letter] + (_TO_LOWER if is_lower else 0)
        at = before + 1 + between
    digits = decimals, fill, value < 0.0, is_bare, has_plus
    state.length[edit] = _put_number(text, at, np.int64(mantissa), digits)
    state.count[0] = edit + 1
    new = mantissa / 10.0 ** run.decimals[move]
    return True, new * (-1.0 if value < 0.0 and mantissa != 0.0 else 1.0)


@njit_inlined()
def _write_ends(run, state, move, reached, aimed):
    """Write X Y Z of one move; tells whether that was possible."""
    piece, unit = run.piece[move], run.unit_mm[move]
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
        if abs(value - old) < 0.5 * run.step[move] and not (named and run.own[move]):
            state.count[1] += abs(value - old) > _NOTHING
            reached[axis] = 0.0 + old * unit
            continue
        is_sure, new = _edit(run, state, move, axis, value)
        if not is_sure:
            return False
        reached[axis] = 0.0 + new * unit
    return True


@njit_inlined()
def _write_arc(run, state, move, reached, room):
    """Write I J K or R of one arc whose ends are written; tells whether that was possible."""
    arc, origin = room
    piece, unit = run.piece[move], run.unit_mm[move]
    for k in range(2):
        axis = run.side[move, k]
        start = run.start_mm[move, axis]
        arc[0, k] = (start + state.aimed_mm[axis]) / unit
        arc[1, k] = run.middle_mm[piece, axis] / unit
        arc[2, k] = run.wanted_mm[piece, axis] / unit
        arc[3, k] = (start + state.carried_mm[axis]) / unit
        arc[4, k] = reached[axis] / unit
        origin[k] = 0.0 if run.absolute_centre[move] else arc[3, k]
    by_radius = run.first[move, R] >= 0
    how, turns, first, second = fit_arc(arc, origin, run.step[move], run.tolerance[move], by_radius)
    if how == LINE or by_radius != (how == RADIUS) or run.code[move] != (3 if turns else 2):
        return False
    for k in range(1 if by_radius else 2):
        letter = R if by_radius else 3 + run.side[move, k]
        if not _edit(run, state, move, letter, second if k else first)[0]:
            return False
    return True


def write_run(run, state, moving, index, as_programmed):
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
    room = np.zeros(3), np.zeros(3), (np.zeros((5, 2)), np.zeros(2))
    return _write_run(run, state, moving, (index, as_programmed), room)


@njit_kernel()
def _write_run(run, state, moving, begin, room):
    """`write_run`, with room to work in."""
    (index, as_programmed), (reached, aimed, arc) = begin, room
    while index < len(moving):
        move = moving[index]
        if run.piece[move] < 0:
            break
        in_force, code = state.motion[0], run.code[move]
        if run.motion[move] < 0 and in_force != as_programmed and in_force != code:
            break
        edits, swallowed = state.count[0], state.count[1]
        is_written = _write_ends(run, state, move, reached, aimed)
        if not is_written or (code > 1 and not _write_arc(run, state, move, reached, arc)):
            state.count[0], state.count[1] = edits, swallowed
            break
        for axis in range(3):
            state.carried_mm[axis] = reached[axis] - run.end_mm[move, axis]
            state.aimed_mm[axis] = aimed[axis] - run.end_mm[move, axis]
        state.motion[0] = code
        index += 1
    return index
