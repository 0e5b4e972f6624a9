"""LinuxCNC's path of a compensated text beside the intended one, which was never rounded.

The intended path is LinuxCNC's own path of the original program, moved by the corrections as
they were found, before any of them is rounded. What the text may be off by comes from the
resolution alone:

* The end of a piece is one of the four grid points around a place of the path, across its main
  axis, that is at most one and a half steps ahead or behind: 2.5 steps in each axis. Half a step
  more is left where the user's own word stays, or counts on from where he stands. From the grid
  point that was chosen the text is off by no more than that, and by half a step beside it.
* An arc is about a centre that is no worse than the nearest one on the grid. That is off by d,
  sqrt(2)/2 steps at most, and leaves d (1 - cos(t/2)) at its middle, t the angle it turns, or
  half a difference of radii of d sin(t/2), beside what its ends are off.
"""

from dataclasses import dataclass, field

import numpy as np

from tests.oracle.linuxcnc_interpreter import ARC, LINE, RAPID

__all__ = ["Comparison", "compared", "intended_pieces"]

INCH_MM = 25.4
#: decimals of an inch beyond those of a mm in a text for LinuxCNC
INCH_DECIMALS = 2
END_STEPS = 3.0
CHOSEN_STEPS = 1.0
#: how far LinuxCNC and the reader may differ over the nominal path
SLACK_MM = 2e-6
KINDS = {0: RAPID, 1: LINE, 2: ARC}


@dataclass
class Comparison:
    """Distances of two paths.

    Attributes
    ----------
    ends_mm, middles_mm : list of float
        Of the ends of all pieces, and across the path of the middles of arcs.
    end_ratios, middle_ratios : list of float
        The same over what rounding may leave; ends by their worst axis.
    wrong : list of str
        Moves that differ in more.
    """

    ends_mm: list[float] = field(default_factory=list)
    middles_mm: list[float] = field(default_factory=list)
    end_ratios: list[float] = field(default_factory=list)
    middle_ratios: list[float] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)

    @property
    def worst_mm(self):
        return max([*self.ends_mm, *self.middles_mm], default=0.0)

    @property
    def worst_ratio(self):
        return max([*self.end_ratios, *self.middle_ratios], default=0.0)


@dataclass(frozen=True)
class Intended:
    """One piece as it was asked for, and the line of the new text that is said to have it."""

    line: int
    move: int
    start: float
    end: float
    is_arc: bool
    correction_mm: np.ndarray
    chosen_mm: np.ndarray
    middle_mm: np.ndarray
    may_correct: np.ndarray
    angle_rad: float
    axis: np.ndarray
    step_mm: float


@dataclass(frozen=True)
class Intention:
    """All pieces, and the nominal moves as the reader has them."""

    pieces: list
    going: list
    kind: np.ndarray
    numbers_only: bool


def intended_pieces(kept, *, numbers_only):
    """What was asked of the text.

    Parameters
    ----------
    kept : dict
        Plan, target before rounding, resolution, and what was written of them.
    numbers_only : bool
        The corrections hold for the numbers in the program and not for places.
    """
    rewriter, target, moves = kept["rewriter"], kept["target"], kept["rewriter"].moves
    decimals = round(-np.log10(kept["resolution_mm"]))
    pieces = []
    for index, piece in enumerate(kept["plan"].pieces):
        unit = rewriter.modes[int(moves.line[piece.move])].unit_mm
        more = INCH_DECIMALS if unit == INCH_MM else 0
        pieces.append(
            Intended(
                kept["written"].line_of_piece[index], piece.move, piece.start, piece.end,
                piece.is_arc, target.ends_mm[index] * (not piece.kept),
                kept["chosen_mm"][index] * (not piece.kept), target.middles_mm[index],
                rewriter.programmed[piece.move], float(rewriter.angle[piece.move]),
                moves.axis[piece.move], unit * 10.0 ** -(decimals + more),
            )
        )  # fmt: skip
    going = _going(moves.kind, moves.start_mm, moves.end_mm)
    return Intention(pieces, going, moves.kind, numbers_only)


def _going(kind, start, end):
    """Rows that go anywhere."""
    far = [np.abs(b - a).max() > 1e-7 for a, b in zip(start, end, strict=True)]
    return [r for r, k in enumerate(kind) if k == ARC or (k < ARC and far[r])]


def compared(before, after, intention):
    """LinuxCNC's paths of the original and of the text against what was intended."""
    found = Comparison()
    row_of_move = _row_of_move(found, before, intention)
    rows_of_line = {}
    for row, line in enumerate(after.line):
        rows_of_line.setdefault(line, []).append(row)
    here, claimed = None, set()
    for piece in intention.pieces:
        own = rows_of_line.get(piece.line, [])
        claimed.update(own)
        if piece.move not in row_of_move:
            continue
        if piece.line == 0:  # rounding left nothing to do: the tool stays where it is
            if here is not None and not intention.numbers_only:
                _compare_end(found, piece, here - _wanted(before, row_of_move, piece), "no line")
            continue
        if len(own) != 1:
            found.wrong.append(f"line {piece.line}: {len(own)} moves")
            continue
        here = after.end[own[0]]
        _compare_piece(found, (before, row_of_move), (after, own[0]), piece, intention)
    planned = {piece.move for piece in intention.pieces}
    left = [row_of_move[m] for m in row_of_move if m not in planned]
    others = set(_going(after.kind, after.start, after.end)) - claimed
    if len(others) > len(left) + 1:
        found.wrong.append(f"{len(others)} moves that nobody asked for, {len(left)} were to stay")
    return found


def _row_of_move(found, before, intention):
    """LinuxCNC's row of every nominal move."""
    moving = np.flatnonzero(intention.kind <= ARC).tolist()
    if len(moving) == len(before):
        return dict(zip(moving, range(len(before)), strict=True))
    rows = _going(before.kind, before.start, before.end)
    if abs(len(rows) - len(intention.going)) > 1:  # the first may start where it ends
        found.wrong.append(f"{len(rows)} moves by LinuxCNC, {len(intention.going)} by vmach")
    return dict(zip(intention.going[::-1], rows[::-1], strict=False))


def _wanted(before, row_of_move, piece):
    return before.at(row_of_move[piece.move], piece.end) + piece.correction_mm


def _compare_piece(found, nominal, written, piece, intention):
    (before, row_of_move), (after, row) = nominal, written
    kind, expected = after.kind[row], KINDS[int(intention.kind[piece.move])]
    if kind != expected and (expected, kind) != (ARC, LINE):
        found.wrong.append(f"line {piece.line}: kind {kind}, wanted {expected}")
        return
    if intention.numbers_only:
        return
    end = after.end[row] - _wanted(before, row_of_move, piece)
    _compare_end(found, piece, end, f"line {piece.line}")
    if piece.is_arc:
        share = 0.5 * (piece.start + piece.end)
        middle = before.at(row_of_move[piece.move], share) + piece.middle_mm
        _compare_middle(found, (after, row), piece, middle, end)


def _compare_end(found, piece, off, name):
    """The end of a piece by its axes in the program: off the path, and off the chosen point."""
    turned = _in_program(piece, off)
    chosen = _in_program(piece, off + piece.correction_mm - piece.chosen_mm)
    ratio = max(
        (np.abs(distance).max() - SLACK_MM) / (steps * piece.step_mm)
        for distance, steps in ((turned, END_STEPS), (chosen, CHOSEN_STEPS))
    )
    found.ends_mm.append(float(np.linalg.norm(turned)))
    found.end_ratios.append(float(ratio))
    if ratio > 1.0:
        found.wrong.append(f"{name}: end {np.round(1e3 * turned, 3).tolist()} um off")


def _in_program(piece, off):
    """A distance in the program's axes, of those that may be corrected."""
    cos, sin = np.cos(piece.angle_rad), np.sin(piece.angle_rad)
    turned = np.array([cos * off[0] + sin * off[1], cos * off[1] - sin * off[0], off[2]])
    return np.where(piece.may_correct, turned, 0.0)


def _compare_middle(found, written, piece, wanted, end):
    """The middle of an arc in its plane, across the path: heights follow from the ends."""
    after, row = written
    axis = piece.axis
    along = after.at(row, 0.51) - after.at(row, 0.49)
    side = np.cross(axis, along)
    off = np.where(piece.may_correct, after.at(row, 0.5) - wanted, 0.0)
    distance = abs(off @ side) / max(np.linalg.norm(side), 1e-12)
    turn = 0.0
    if after.arc[row] is not None:
        out = [p - after.arc[row][0] for p in (after.start[row], after.at(row, 0.5))]
        out = [v - (v @ axis) * axis for v in out]
        turn = np.arccos(np.clip(out[0] @ out[1] / np.prod(np.linalg.norm(out, axis=1)), -1, 1))
    at_ends = max(np.linalg.norm(end), END_STEPS * piece.step_mm)
    centre_mm = 0.5**0.5 * piece.step_mm * max(1.0 - np.cos(turn), np.sin(turn))
    ratio = (distance - SLACK_MM) / (at_ends + centre_mm)
    found.middles_mm.append(float(distance))
    found.middle_ratios.append(float(ratio))
    if ratio > 1.0:
        found.wrong.append(f"line {piece.line}: middle {1e3 * distance:.3f} um off")
