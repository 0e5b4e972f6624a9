"""A written program, read back and run through the model.

Source: the equations of `vmach.machine.displacement` and the effects of the job.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from gcode import MoveKind
from vmach.base.memory import give_back_free_memory
from vmach.compensation.aim.path_shift import PathShift
from vmach.compensation.model import TipModel
from vmach.compensation.pieces.plan import Plan
from vmach.compensation.pieces.reversals import TAKE_UP_MM, is_taken_up, settled
from vmach.compensation.residual import Residual
from vmach.errors import InputError
from vmach.path.geometry import across, move_length_mm, position_at, tangent_at
from vmach.path.preparation import Preparation, prepare
from vmach.program_text import Expanded, Written, job_of_control

__all__ = ["LONG", "WrittenRun"]

#: distance of the places at which the tool is compared with the nominal path
_SPACING_MM = 0.5
#: of every piece, most and fewest; of moves without points
_MOST_INSIDE, _FEWEST_INSIDE = 400, 4
_ON_RAPIDS = 9
#: how much farther off than before such a move may be: rounding. Also the least lost motion
#: behind the begin of a piece that gets a step: a block at the usual resolution
_SLACK_MM = 1e-3
#: the end of a move belongs to its last piece, and a step has no way
_INSIDE = 1.0 - 1e-9
_NO_SPAN = 1e-12
#: programs of more blocks are not kept read while they wait
LONG = 200_000
#: places that are compared at once
_AT_ONCE = 1 << 18


@dataclass(frozen=True)
class WrittenRun:
    """What the model makes of a written program.

    Attributes
    ----------
    original : Preparation
        The nominal program.
    read_back : callable
        Reads the written program.
    model : TipModel
    plan : Plan
        K pieces.
    written : (W,) int64
        Pieces that rounding has left a block.
    row : (W,) int64
        Their moves in `again`.
    programmed : (M, 3) bool
    unknown_start : (M,) bool
        Of the nominal moves, as `programmed_axes` finds them.
    stuck : (M, 3) bool
        Axes of the nominal moves that have no word and may not get one.
    shift : PathShift, optional
        Where the tool shall be beside its nominal path.
    """

    original: Preparation
    read_back: Callable[[], Preparation]
    model: TipModel
    plan: Plan
    written: np.ndarray
    row: np.ndarray
    programmed: np.ndarray
    unknown_start: np.ndarray
    stuck: np.ndarray
    shift: PathShift | None = None

    @classmethod
    def of(
        cls, original: Preparation, written: Written, plan: Plan, *, model: TipModel,
        expansion: Expanded, programmed: np.ndarray, unknown_start: np.ndarray,
        stuck: np.ndarray, shift: PathShift | None = None,
    ) -> WrittenRun:  # fmt: skip
        """Read a program back; arrays of the nominal moves as in the attributes.

        The tool shall be where `shift` asks for, beside its nominal path.

        Raises
        ------
        InputError
            It is refused, by the line of the user's program.
        """

        def read_back() -> Preparation:
            return _read_back(original, written, expansion)

        again = read_back()
        moves = again.path.nodes.moves
        moving = np.flatnonzero(moves.kind != MoveKind.DWELL)
        lines = written.line_of_piece
        order = np.argsort(moves.line[moving], kind="stable")
        sorted_lines = moves.line[moving][order]
        place = np.minimum(np.searchsorted(sorted_lines, lines), len(sorted_lines) - 1)
        known = np.flatnonzero(sorted_lines[place] == lines)
        found = cls(original, read_back, model, plan, known, moving[order[place[known]]],
                    programmed, unknown_start, stuck, shift)  # fmt: skip
        vars(found)["again"] = again
        return found

    @cached_property
    def again(self) -> Preparation:
        """The written program as it was read back."""
        return self.read_back()

    def set_aside(self) -> None:
        """Keep a long program as its text alone until it is asked about again.

        The text of another dialect than LinuxCNC is read too slowly for that.
        """
        if len(self.row) > LONG and self.original.program.dialect == "linuxcnc":
            for name in ("again", "_left", "residual_of_pieces"):
                vars(self).pop(name, None)
            give_back_free_memory()

    def miss(self, share: float | np.ndarray, rows: np.ndarray | None = None) -> np.ndarray:
        """Tool minus the place where it shall be at shares of the written pieces, (K, 3) mm.

        Zero along axes whose place the program does not say (`programmed_axes`).

        Parameters
        ----------
        share : float or (K,) float64
        rows : (K,) int64, optional
            Indices into `written`; all of it by default.
        """
        if rows is None:
            rows = np.arange(len(self.written))
        share = np.broadcast_to(np.asarray(share, np.float64), rows.shape)
        found = np.empty((len(rows), 3))
        at_once = max(_AT_ONCE, len(self.row))  # directions are looked for along all moves
        for first in range(0, len(rows), at_once):
            part = slice(first, first + at_once)
            found[part] = self._miss(share[part].copy(), rows[part])
        return found

    def _miss(self, share: np.ndarray, rows: np.ndarray) -> np.ndarray:
        there = position_at(self.again.path.nodes.moves, self.row[rows], share)
        error = self.model.error_at(self.again, self.row[rows], share)
        start, end = self.plan.first, self.plan.last
        pieces = self.written[rows]
        parameter = start[pieces] + share * (end - start)[pieces]
        move = self.plan.move[pieces]
        wanted = position_at(self.original.path.nodes.moves, move, parameter)
        if self.shift is not None:
            wanted = wanted + self.shift.at(move, parameter)
        return (there + error - wanted) * self.programmed[move]

    def miss_at(self, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Tool minus the place where it shall be at places of the nominal moves, (P, 3) mm.

        Zero where rounding has swallowed the block.
        """
        start, end = self.plan.first, self.plan.last
        place = move + np.minimum(parameter, _INSIDE)
        piece = np.searchsorted(self.plan.move + start, place, side="right") - 1
        rows = np.searchsorted(self.written, piece)
        rows = np.minimum(rows, len(self.written) - 1)
        there = np.flatnonzero(self.written[rows] == piece)
        piece = piece[there]
        span = np.maximum(end - start, _NO_SPAN)[piece]
        found = np.zeros((len(move), 3))
        found[there] = self.miss((parameter[there] - start[piece]) / span, rows[there])
        return found

    def miss_of_middles(self) -> np.ndarray:
        """Tool minus nominal path across it, in the middle of the written pieces, (K, 3) mm."""
        rows = np.arange(len(self.written))
        return self._across(np.full(len(rows), 0.5), rows, np.ones((len(rows), 3), bool))

    @cached_property
    def cuts(self) -> np.ndarray:
        """Written pieces at feed from a known place, (C,) indices into `written`."""
        move = self.plan.move[self.written]
        kind = self.original.path.nodes.moves.kind[move]
        return np.flatnonzero((kind != MoveKind.RAPID) & ~self.unknown_start[move])

    @property
    def residual(self) -> Residual:
        """Distances at programmed ends of moves that cut, and across the path all along them."""
        return self._left[0]

    @cached_property
    def _left(self) -> tuple[Residual, np.ndarray]:
        return self._left_in(np.ones((len(self.written), 3), bool))

    def _left_in(self, counts: np.ndarray) -> tuple[Residual, np.ndarray]:
        """What is left in the axes that count, and the largest of every piece, (K,), once settled.

        In a step the axes take up their play; the piece after it tells what is left, also where
        the error is not yet there in full: this more pieces could not mend.
        """
        distance, rows, settled = self._distances(counts)
        piece = self.written[rows]
        largest = np.zeros(len(self.plan.pieces))
        np.maximum.at(largest, piece[settled], distance[settled])
        line = self.original.path.nodes.moves.line[self.plan.move[piece]]
        return Residual.of(distance, line), largest

    def worse_moves(self, limit_mm: float) -> Residual:
        """Moves without points that are farther off their path than a limit and than before.

        Those that the travel's end holds back stay as far off as they were.
        """
        moves, nominal = self.again.path.nodes.moves, self.original.path.nodes.moves
        others = np.setdiff1d(np.arange(len(self.written)), self.cuts)
        rows = np.repeat(others, _ON_RAPIDS)
        share = np.tile(np.linspace(0, 1, _ON_RAPIDS), len(others))
        tangent = tangent_at(moves, self.row[rows], share)
        now = np.linalg.norm(across(self.miss(share, rows), tangent), axis=1)
        move = self.plan.move[self.written[rows]]
        before = np.linalg.norm(self.model.error_at(self.original, move, share), axis=1)
        before = np.repeat(before.reshape(-1, _ON_RAPIDS).max(axis=1), _ON_RAPIDS)
        worse = now > np.maximum(limit_mm, before + _SLACK_MM)
        return Residual.of(now[worse], nominal.line[move[worse]])

    @cached_property
    def residual_of_pieces(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What more pieces could mend of K pieces.

        Axes that are stuck do not count.

        Returns
        -------
        largest : (K,) float64
            Largest distance of every piece.
        at_start : (K, 3) float64
            Across the path where it begins. Where lost motion is taken up behind its begin, the
            same where that is done.
        ready : (K,) float64
            Share of the piece at which that is; 0 where it begins.
        """
        free = ~self.stuck[self.plan.move[self.written]]
        largest = (self._left if free.all() else self._left_in(free))[1]
        at_start, ready = np.zeros((len(self.plan.pieces), 3)), np.zeros(len(self.plan.pieces))
        piece = self.written[self.cuts]
        at_start[piece], ready[piece] = self._at_starts(free)
        return largest, at_start, ready

    def _at_starts(self, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tool minus nominal position across the path at starts of pieces that cut, as above."""
        cuts, moves = self.cuts, self.again.path.nodes.moves

        def there(share: np.ndarray) -> np.ndarray:
            return self._across(share, cuts, counts)

        begin = np.zeros(len(cuts))
        at_begin = there(begin)
        way = position_at(moves, self.row[cuts], begin + 0.5)
        way -= position_at(moves, self.row[cuts], begin)
        length = move_length_mm(moves)[self.row[cuts]]
        goes = np.abs(way) >= TAKE_UP_MM
        later = settled(moves, self.row[cuts], begin, goes, length_mm=length)
        in_full = there(later)
        grows = is_taken_up(at_begin, there(0.5 * later), in_full, there(2.0 * later),
                            least_mm=_SLACK_MM)  # fmt: skip
        return np.where(grows[:, None], in_full, at_begin), np.where(grows, later, begin)

    def _distances(self, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distances where axes count, row of `written`, and whether it is settled; (P,) each."""
        cuts, moves = self.cuts, self.again.path.nodes.moves
        span = self.plan.last - self.plan.first
        cutting = cuts[span[self.written[cuts]] > 0]
        tangent = tangent_at(moves, self.row[cutting], np.zeros(len(cutting)))
        length = np.linalg.norm(tangent, axis=1)
        count = np.clip(np.ceil(length / _SPACING_MM), _FEWEST_INSIDE, _MOST_INSIDE).astype(int)
        rows = np.repeat(cutting, count)
        first = np.cumsum(count) - count
        share = (np.arange(len(rows)) - np.repeat(first, count)) / np.repeat(count, count)
        settled = share >= self.plan.ready[self.written[rows]]
        inside, at_once = np.empty(len(rows)), max(_AT_ONCE, len(self.row))
        for begin in range(0, len(rows), at_once):
            part = slice(begin, begin + at_once)
            inside[part] = np.linalg.norm(self._across(share[part], rows[part], counts), axis=1)
        last = np.ones(len(cutting))
        programmed = self.plan.last[self.written[cutting]] == 1.0
        miss = self.miss(last, cutting)
        whole = miss[programmed] * counts[cutting[programmed]]
        miss = self._sideways(miss, last, cutting, counts)
        miss[programmed] = whole
        ends = np.linalg.norm(miss, axis=1)
        return (np.concatenate([inside, ends]), np.concatenate([rows, cutting]),
                np.concatenate([settled, np.ones(len(ends), bool)]))  # fmt: skip

    def _across(self, share: np.ndarray, rows: np.ndarray, counts: np.ndarray) -> np.ndarray:
        """Tool minus nominal position across the path, (K, 3) mm."""
        return self._sideways(self.miss(share, rows), share, rows, counts)

    def _sideways(
        self, miss: np.ndarray, share: np.ndarray, rows: np.ndarray, counts: np.ndarray
    ) -> np.ndarray:
        """What of a `miss`, (K, 3) mm, is across the path; written over it."""
        for first in range(0, len(rows), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            tangent = tangent_at(self.again.path.nodes.moves, self.row[rows[part]], share[part])
            miss[part] = across(miss[part] * counts[rows[part]], tangent)
        return miss


def _read_back(original: Preparation, written: Written, expansion: Expanded) -> Preparation:
    """The written program; refused by the line of the user's program."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / original.program.path.name
        path.write_bytes(written.text)
        try:
            found = prepare(job_of_control(original), program_path=path)
        except ValueError as error:
            line = written.original_line(getattr(error, "line", None))
            raise InputError(
                f"the compensated program is refused: {getattr(error, 'what', error)}",
                file=original.program.path,
                line=None if line is None else int(expansion.user_line(line)),
            ) from None
    return replace(found, program=found.program.moves_alone())
