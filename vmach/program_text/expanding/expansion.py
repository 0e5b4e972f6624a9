"""Programs in plain blocks: what cannot be rewritten word by word is written out first."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from gcode import MoveKind, Moves, Program, ProgramError, Source, read_program
from vmach.errors import InputError
from vmach.job import Job
from vmach.path.geometry import position_at
from vmach.path.preparation import Preparation, prepare
from vmach.program_text.expanding.expanded_text import Expanded
from vmach.program_text.expanding.plain_lines import plain_lines
from vmach.program_text.expanding.plain_motion import plain
from vmach.program_text.expanding.unrolling import unrolled
from vmach.program_text.frame_shift import mirrored_moves

__all__ = ["Expanded", "expanded", "job_of_control", "prepare_plain"]

#: two readings of one path differ by no more
_SAME_MM = 1e-9
_SAME_FEED = 1e-5
#: controls that count milliseconds round a pause
_SAME_PAUSE_S = 1e-3
#: lines that a message names
_MOST_TOLD = 10


def expanded(program: Program, *, floating_tap: bool = True) -> tuple[Program, Expanded]:
    """Write out control flow, expressions, cycles and cutter compensation, and read it again.

    Only what needs it is written out; the rest stays byte for byte.

    Parameters
    ----------
    program : Program
    floating_tap : bool
        See `vmach.program_text.expanding.plain_motion.plain`.

    Returns
    -------
    Program
        The program of the new text; the same object where nothing was written out.
    Expanded
        The text, where its lines come from and why.

    Raises
    ------
    InputError
        Something cannot be written out, or the new text makes another path.
    """
    _check_not_mirrored(program)
    whole = Expanded.unchanged(program)
    for expand in (unrolled, lambda p: plain(p, floating_tap=floating_tap), plain_lines):
        step = expand(program)
        if step is not None:
            again = _read_again(program, step)
            _check_same_path(program, again, step)
            program, whole = again, whole.then(step)
    return program, whole


def prepare_plain(
    preparation: Preparation, *, floating_tap: bool = True
) -> tuple[Preparation, Expanded]:
    """The job's program in plain blocks, prepared like any other; arguments as `expanded`.

    Raises
    ------
    InputError, gcode.ProgramError
        As `expanded` and `vmach.path.preparation.prepare`.
    """
    program, expansion = expanded(preparation.program, floating_tap=floating_tap)
    if program is preparation.program:
        return preparation, expansion
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / program.path.name
        path.write_bytes(program.source.data)
        again = prepare(job_of_control(preparation), program_path=path)
    named = again.program.with_text(Source(program.source.data, program.path))
    return replace(again, program=named, notes=preparation.notes), expansion  # the user's lines


def job_of_control(preparation: Preparation) -> Job:
    """The job, with the control said whose words a written text may have lost."""
    program = preparation.program
    if program.language.is_rs274:
        return preparation.job
    return replace(preparation.job, dialect=program.dialect)


def _check_not_mirrored(program: Program) -> None:
    """Refuse mirror images: their words and the senses of their arcs are not written anew."""
    moves = program.moves
    lines = np.unique(moves.line[mirrored_moves(program) & (moves.kind != MoveKind.DWELL)])
    if not lines.size:
        return
    told = ", ".join(map(str, lines[:_MOST_TOLD].tolist()))
    told += " ..." if lines.size > _MOST_TOLD else ""
    raise InputError(
        f"mirror image cannot be compensated (lines {told})",
        file=program.path,
        line=int(lines[0]),
        accepted="shifts and rotations",
        hint="post the program without the mirror image",
    )


def _read_again(program: Program, step: Expanded) -> Program:
    options = dict(program.options, dialect=program.dialect)
    try:
        return read_program(step.source, **options)
    except ProgramError as error:
        line = int(step.origin[error.line - 1]) if error.line else None
        raise InputError(
            f"written out, the program is refused: {error.what}", file=program.path, line=line
        ) from None


def _check_same_path(program: Program, again: Program, step: Expanded) -> None:
    old, new = _places(program.moves), _places(again.moves)
    same = len(old.kind) == len(new.kind)
    if same:
        wrong = _different(old, new)
        if not wrong.any():
            return
        line = int(step.origin[new.line[np.argmax(wrong)] - 1])
    else:
        line = min(step.reasons)
    raise InputError(
        "written out, the program would follow another path or pause for another time",
        file=program.path,
        line=line,
        hint="post the program without cycles, subprograms and cutter compensation",
    )


def _places(moves: Moves) -> Moves:
    """Rows that go anywhere or pause."""
    far = np.abs(moves.end_mm - moves.start_mm).max(axis=1, initial=0.0) > _SAME_MM
    turned = (moves.rotary_end_deg != moves.rotary_start_deg).any(axis=1)
    dwell = (moves.kind == MoveKind.DWELL) & (moves.duration_s > 0)
    kept = far | turned | dwell | (moves.kind == MoveKind.ARC)
    names = moves.__dataclass_fields__
    return replace(moves, **{name: getattr(moves, name)[kept] for name in names})


def _different(old: Moves, new: Moves) -> np.ndarray:
    """Rows that are not the same move, (N,) bool."""
    wrong = (old.kind != new.kind) | (old.tool != new.tool) | (old.work_offset != new.work_offset)
    rows = np.arange(len(old.kind))
    for name in ("axis", "rotary_end_deg", "tool_offset_mm"):
        wrong |= (np.abs(getattr(old, name) - getattr(new, name)) > _SAME_MM).any(axis=1)
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        places = [position_at(moves, rows, np.full(len(rows), share)) for moves in (old, new)]
        wrong |= (np.abs(places[0] - places[1]) > _SAME_MM).any(axis=1)
    pauses = np.abs(old.duration_s - new.duration_s) > _SAME_PAUSE_S
    wrong |= pauses & (old.kind == MoveKind.DWELL)
    feeds = np.abs(old.feed_mm_per_min - new.feed_mm_per_min)
    return wrong | (feeds > _SAME_FEED * np.maximum(old.feed_mm_per_min, 1.0))
