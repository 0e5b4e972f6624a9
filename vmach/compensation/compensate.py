"""Fixed-point iteration through the full model: written program in, corrected program out."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gcode import MoveKind, Moves
from vmach.compensation.block_modes import BlockModes, block_modes
from vmach.compensation.expansion import Expanded, prepare_plain
from vmach.compensation.pieces import Piece, split_arc, split_line
from vmach.compensation.rewriting import Rewriter, Target, Written
from vmach.compensation.targets import check_words, target_control
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import Variant
from vmach.path_geometry import move_length_mm, position_at, tangent_at
from vmach.prediction import Effect, displacement_of
from vmach.preparation import Preparation, prepare
from vmach.toolpath import PathStates

__all__ = ["Compensation", "Residual", "compensate"]

#: the iteration ends when the tool is this close, or after so many rounds
_CLOSE_MM = 2e-6
_ROUNDS = 5
#: resolution of the program that is iterated on
_FINE_MM = 1e-7
#: distance of the places where the bend of the error is looked at
_SPACING_MM = 1.0
#: an error smaller than this is none
_NOTHING_MM = 1e-9


@dataclass(frozen=True)
class Residual:
    """Distance of the tool from its nominal path while it cuts, mm.

    Attributes
    ----------
    distance_mm : (P,) float64
        Full vector at programmed points, across the path between them.
    line : (P,) int64
        Line of the original program.
    """

    distance_mm: np.ndarray
    line: np.ndarray

    def told_in(self, expansion: Expanded) -> Residual:
        """The same by the lines of the user's program."""
        return Residual(self.distance_mm, expansion.user_line(self.line))

    @property
    def largest_mm(self) -> float:
        """Largest distance; 0 without any."""
        return float(self.distance_mm.max(initial=0.0))

    @property
    def mean_mm(self) -> float:
        """Mean distance; 0 without any."""
        return float(self.distance_mm.mean()) if len(self.distance_mm) else 0.0


@dataclass(frozen=True)
class Compensation:
    """A compensated program and what re-reading it found.

    Attributes
    ----------
    text : bytes
        The program, at the target's resolution.
    before, unrounded, after : Residual
        Of the original program, of the compensated one before rounding, and of `text`.
    largest_correction_mm : float
    growth : float
        Blocks of `text` over blocks of the original.
    arcs, arcs_kept : int
        Arcs of the program, and those of them that are written as arcs only.
    left_lines : tuple of int
        Lines that stay because their positions are the machine's own (G53, G28, G30).
    swallowed : int
        Words that need no change because the correction is below the resolution.
    expanded_lines : mapping of int to str
        Lines of the program that were written out in plain blocks, and why.
    """

    text: bytes
    before: Residual
    unrounded: Residual
    after: Residual
    largest_correction_mm: float
    growth: float
    arcs: int
    arcs_kept: int
    left_lines: tuple[int, ...]
    swallowed: int
    expanded_lines: Mapping[int, str] = field(default_factory=dict)


def compensate(
    job: Job,
    effects: Sequence[Effect] = (),
    *,
    variant: Variant = Variant.ABBE,
    resolution_mm: float = 1e-3,
    tolerance_mm: float = 8e-5,
    limit_mm: float = 0.5,
    dialect: str | None = None,
) -> Compensation:
    """Move the job's program against the predicted error of the tool tip.

    The position to program is the q of q + e(q) = q_nominal, by fixed-point iteration: every
    round writes the program, reads it back and runs it through the model, so direction memory,
    time and feeds are those of the compensated program itself. The tilt of the tool remains;
    three axes cannot correct it.

    Parameters
    ----------
    job : Job
    effects : sequence of Effect
    variant : Variant
    resolution_mm : float
        Of the target control; in inch programs one decimal more.
    tolerance_mm : float
        Bend of the error from which a point is inserted.
    limit_mm : float
        Largest correction accepted.
    dialect : str, optional
        Target control (`vmach.compensation.targets.CONTROLS`); that of the program by default.

    Raises
    ------
    InputError, gcode.ProgramError
        The program cannot be read or rewritten, a correction exceeds the limit, or the
        compensated program leaves the travel.
    """
    model = _Model(variant, tuple(effects))
    preparation = prepare(job)
    control = target_control(preparation.program, dialect)
    if not _has_errors(preparation, model):
        return _unchanged(preparation, model)
    preparation, expansion = prepare_plain(preparation, floating_tap=control.floating_tap)
    check_words(preparation.program, control)
    modes = block_modes(preparation.program)
    pieces, ends, middles = _plan(preparation, modes, model, tolerance_mm)
    rewriter = Rewriter(preparation.program, modes, expansion.written, control)
    best: tuple[Residual, Target] | None = None
    for _ in range(_ROUNDS):
        target = Target(pieces, _within_travel(preparation, pieces, ends), middles.copy())
        _check_limit(preparation, target, limit_mm, expansion)
        written = rewriter.write(target, _FINE_MM)
        run = _Run.of(preparation, written, pieces, model, expansion)
        found = run.residual()
        if best is None or found.largest_mm < best[0].largest_mm:
            best = found, target
        if found.largest_mm <= _CLOSE_MM:
            break
        ends[run.written] -= run.miss(1.0)
        middles[run.written] -= run.miss(0.5)
    assert best is not None
    unrounded, target = best
    written = rewriter.write(target, resolution_mm)
    after = _Run.of(preparation, written, pieces, model, expansion).residual()
    corrections = np.linalg.norm(target.ends_mm, axis=1)
    arc_moves = {p.move for p in pieces if preparation.path.nodes.moves.kind[p.move] == 2}
    broken = {p.move for p in pieces if not p.is_arc and not p.kept and p.end > p.start}
    return Compensation(
        text=written.text,
        before=_before(preparation, model).told_in(expansion),
        unrounded=unrounded.told_in(expansion),
        after=after.told_in(expansion),
        largest_correction_mm=float(corrections.max(initial=0.0)),
        growth=1.0 + written.inserted / max(len(modes), 1),
        arcs=len(arc_moves),
        arcs_kept=len(arc_moves - broken),
        left_lines=tuple(int(expansion.user_line(k)) for k, mode in modes.items() if mode.left),
        swallowed=written.swallowed,
        expanded_lines=expansion.reasons,
    )


def _has_errors(preparation: Preparation, model: _Model) -> bool:
    nodes = preparation.path.nodes
    error = model.error_at(preparation, nodes.move, nodes.parameter)
    return bool((np.abs(error) > _NOTHING_MM).any())


def _unchanged(preparation: Preparation, model: _Model) -> Compensation:
    """The user's bytes: there is nothing to correct."""
    before = _before(preparation, model)
    arcs = int((preparation.path.nodes.moves.kind == MoveKind.ARC).sum())
    return Compensation(
        text=preparation.program.source.data,
        before=before,
        unrounded=before,
        after=before,
        largest_correction_mm=0.0,
        growth=1.0,
        arcs=arcs,
        arcs_kept=arcs,
        left_lines=(),
        swallowed=0,
    )


@dataclass(frozen=True)
class _Model:
    variant: Variant
    effects: tuple[Effect, ...]

    def error_at(
        self, preparation: Preparation, move: np.ndarray, parameter: np.ndarray
    ) -> np.ndarray:
        """Shift of the tool tip, (P, 3); zero where no tool of the job is in the spindle."""
        nodes = preparation.path.nodes
        error = np.zeros((len(move), 3))
        tool = np.minimum(nodes.moves.tool[move], len(nodes.tool_lengths_mm) - 1)
        held = np.flatnonzero((tool > 0) & np.isfinite(nodes.tool_lengths_mm[tool]))
        states = PathStates(nodes.moves, nodes.tool_lengths_mm, move[held], parameter[held],
                            np.zeros((len(held), 3)))  # fmt: skip
        if len(held):
            error[held] = displacement_of(preparation, states, self.variant, self.effects).shift_mm
        return error


@dataclass(frozen=True)
class _Run:
    """A written program, read back; piece k of `written` is row ``row[k]`` of its moves."""

    original: Preparation
    again: Preparation
    model: _Model
    pieces: list[Piece]
    written: np.ndarray
    row: np.ndarray

    @classmethod
    def of(
        cls, original: Preparation, written: Written, pieces: list[Piece], model: _Model,
        expansion: Expanded,
    ) -> _Run:  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / original.program.path.name
            path.write_bytes(written.text)
            try:
                again = prepare(original.job, program_path=path)
            except ValueError as error:
                line = written.original_line(getattr(error, "line", None))
                raise InputError(
                    f"the compensated program is refused: {getattr(error, 'what', error)}",
                    file=original.program.path,
                    line=None if line is None else int(expansion.user_line(line)),
                ) from None
        moving = np.flatnonzero(again.program.moves.kind != MoveKind.DWELL)
        row_of_line = dict(zip(again.program.moves.line[moving].tolist(), moving, strict=True))
        known = [k for k, line in enumerate(written.line_of_piece) if line in row_of_line]
        rows = np.array([row_of_line[written.line_of_piece[k]] for k in known], np.int64)
        return cls(original, again, model, pieces, np.array(known, np.int64), rows)

    def miss(self, share: float, rows: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Tool minus nominal position at a share of every written piece, (K, 3)."""
        pieces = [self.pieces[k] for k in self.written[rows]]
        parameter = np.full(len(pieces), share)
        there = position_at(self.again.path.nodes.moves, self.row[rows], parameter)
        error = self.model.error_at(self.again, self.row[rows], parameter)
        nominal = position_at(
            self.original.path.nodes.moves,
            np.array([p.move for p in pieces], np.int64),
            np.array([p.start + share * (p.end - p.start) for p in pieces]),
        )
        return there + error - nominal

    def residual(self) -> Residual:
        """Distances at the ends of the pieces that cut, and across the path within them."""
        moves = self.original.path.nodes.moves
        nominal = np.array([self.pieces[k].move for k in self.written], np.int64)
        moving = np.array([self.pieces[k].end > self.pieces[k].start for k in self.written], bool)
        cutting = np.flatnonzero((moves.kind[nominal] != MoveKind.RAPID) & moving)
        found, tangent_share = [], {0.0: True, 0.25: True, 0.5: True, 0.75: True, 1.0: False}
        for share, across in tangent_share.items():
            miss = self.miss(share, cutting)
            if across:
                now = self.again.path.nodes.moves
                tangent = tangent_at(now, self.row[cutting], np.full(len(cutting), share))
                length = np.linalg.norm(tangent, axis=1, keepdims=True)
                unit = tangent / np.maximum(length, _NOTHING_MM)
                miss = miss - np.einsum("ij,ij->i", miss, unit)[:, None] * unit
            found.append(np.linalg.norm(miss, axis=1))
        lines = np.tile(moves.line[nominal[cutting]], len(found))
        return Residual(np.concatenate(found), lines)


def _plan(
    preparation: Preparation, modes: dict[int, BlockModes], model: _Model, tolerance_mm: float
) -> tuple[list[Piece], np.ndarray, np.ndarray]:
    """Pieces of the whole program with first corrections at their ends and middles."""
    moves = preparation.path.nodes.moves
    length = move_length_mm(moves)
    used = [k for k in range(len(moves))
            if moves.kind[k] != MoveKind.DWELL and not modes[int(moves.line[k])].left]  # fmt: skip
    samples = [_parameters(int(moves.kind[k]), length[k]) for k in used]
    counts = [len(s) for s in samples]
    flat = np.concatenate(samples) if samples else np.zeros(0)
    correction = -model.error_at(preparation, np.repeat(used, counts).astype(np.int64), flat)
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(int)
    pieces: list[Piece] = []
    previous = np.zeros(3)
    for index, k in enumerate(used):
        own = correction[starts[index] : starts[index + 1]]
        if max(abs(own).max(), abs(previous).max()) < _NOTHING_MM:
            pieces.append(Piece(k, 0.0, 1.0, kept=True))
        elif moves.kind[k] == MoveKind.RAPID or length[k] == 0:
            pieces.append(Piece(k, 0.0, 1.0, is_arc=moves.kind[k] == MoveKind.ARC))
        else:
            if _across(moves, k, own[0] - previous) > tolerance_mm:
                pieces.append(Piece(k, 0.0, 0.0))
            if moves.kind[k] == MoveKind.ARC:
                pieces += split_arc(moves, k, samples[index], own, tolerance_mm=tolerance_mm)
            else:
                pieces += split_line(k, samples[index], own, tolerance_mm)
        previous = own[-1]
    owner = np.array([p.move for p in pieces], np.int64)
    end = np.array([p.end for p in pieces])
    middle = np.array([0.5 * (p.start + p.end) for p in pieces])
    return (pieces, -model.error_at(preparation, owner, end),
            -model.error_at(preparation, owner, middle))  # fmt: skip


def _parameters(kind: int, length_mm: float) -> np.ndarray:
    if kind == MoveKind.RAPID:
        return np.array([0.0, 1.0])
    fewest = 32 if kind == MoveKind.ARC else 2
    return np.linspace(0.0, 1.0, max(int(np.ceil(length_mm / _SPACING_MM)), fewest) + 1)


def _within_travel(
    preparation: Preparation, pieces: list[Piece], ends_mm: np.ndarray
) -> np.ndarray:
    """Corrections of rapids cut off where the travel ends; those of feed moves stay."""
    moves, (low, high) = preparation.path.nodes.moves, preparation.job.machine.travel_mm
    owner = np.array([p.move for p in pieces], np.int64)
    nominal = position_at(moves, owner, np.array([p.end for p in pieces]))
    inside = np.clip(nominal + ends_mm, low, high) - nominal
    return np.where((moves.kind[owner] == MoveKind.RAPID)[:, None], inside, ends_mm)


def _across(moves: Moves, move: int, step: np.ndarray) -> float:
    """Part of a step of the correction that is across the path at the move's start, mm."""
    tangent = tangent_at(moves, np.array([move]), np.array([0.0]))[0]
    length = np.linalg.norm(tangent)
    along = (step @ tangent) / length if length else 0.0
    return float(np.sqrt(max(step @ step - along**2, 0.0)))


def _before(preparation: Preparation, model: _Model) -> Residual:
    nodes = preparation.path.nodes
    rows = np.flatnonzero(nodes.moves.kind[nodes.move] != MoveKind.RAPID)
    error = model.error_at(preparation, nodes.move[rows], nodes.parameter[rows])
    return Residual(np.linalg.norm(error, axis=1), nodes.line[rows])


def _check_limit(
    preparation: Preparation, target: Target, limit_mm: float, expansion: Expanded
) -> None:
    size = np.linalg.norm(target.ends_mm, axis=1)
    beyond = np.flatnonzero(size > limit_mm)
    if not beyond.size:
        return
    of_move = preparation.path.nodes.moves.line
    found = of_move[[target.pieces[k].move for k in beyond]]
    lines = np.unique(expansion.user_line(found)).tolist()
    shown = ", ".join(map(str, lines[:10])) + (" ..." if len(lines) > 10 else "")
    raise InputError(
        f"corrections up to {1e3 * size.max():.1f} um (lines {shown})",
        file=preparation.program.path,
        line=lines[0],
        accepted=f"at most {1e3 * limit_mm:g} um",
        hint="--limit-um sets the limit",
    )
