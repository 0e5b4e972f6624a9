"""From a job to everything that does not depend on the error model: program, path, tools."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gcode import (
    INCREMENT_SYSTEMS,
    WORK_OFFSETS,
    MachineLimits,
    MoveKind,
    Moves,
    Program,
    ToolEntry,
    UnknownToolError,
    read_program,
)
from gcode import Note as ProgramNote
from stock import Tool, compile_ahead
from vmach.base.note import Kind, Note, in_file
from vmach.errors import InputError
from vmach.files.text_file import check_is_file
from vmach.job import Job
from vmach.path.geometry import position_at
from vmach.path.toolpath import NODE_SPACING_MM, Toolpath
from vmach.plausibility import cutting_notes, doubts, machine_notes, tool_notes

__all__ = ["Preparation", "job_doubts", "prepare"]

#: rounding of positions beyond the travel that is not worth a complaint
_TRAVEL_SLACK_MM = 1e-6
#: nodes whose places are looked at in one go: what the processor keeps near
_NODES_AT_ONCE = 20_000


@dataclass(frozen=True)
class Preparation:
    """A job's program, read and split.

    Attributes
    ----------
    job : Job
    program : Program
    path : Toolpath
    zero_mm : (3,) float64
        Workpiece zero in machine coordinates.
    cutters : tuple of stock.Tool
        For the removal engine.
    tool_index : (T,) int64
        Index into `cutters` of tool number k; -1 where the job has no such tool.
    notes : tuple of Note
        What the user should know about how the program was understood, and what is doubtful.
    doubts : tuple of Note
        What is doubtful in machine and tools, as records.
    """

    job: Job
    program: Program
    path: Toolpath
    zero_mm: np.ndarray
    cutters: tuple[Tool, ...]
    tool_index: np.ndarray
    notes: tuple[Note, ...]
    doubts: tuple[Note, ...] = ()


#: what would settle a note of the reader that asks, by what it is about
_SETTLES = {
    "increment": "increment in [control]: " + ", ".join(INCREMENT_SYSTEMS),
    "%": "the whole program, with its end",
    "two motions": "one of them in a block",
}


def prepare(
    job: Job, *, program_path: Path | None = None, spacing_mm: float = NODE_SPACING_MM
) -> Preparation:
    """Read the program as the machine of the job would, and split it into pieces.

    Parameters
    ----------
    job : Job
    program_path : Path, optional
        Another program on the same machine with the same tools.
    spacing_mm : float
        Largest distance of the nodes at which errors are evaluated.

    Raises
    ------
    InputError, gcode.ProgramError
        The program cannot be read or has no motion, cuts with a tool that the job lacks, or
        leaves the travel.
    """
    source = program_path or job.program
    check_is_file(source, what="NC program")
    compile_ahead()
    program = _read(source, job)
    moves, notes = _with_only_tool(program.moves, job, source)
    notes = _assumptions(program) + notes
    _check_tools(job, moves, source)
    _check_no_rotary_motion(moves, source)
    if job.touched_off:
        moves = _with_tool_lengths(moves, job)
    else:
        notes += _offsets_that_differ(job, moves, source)
    path = Toolpath.split(moves, _lengths(job), spacing_mm)
    if len(path.first_node) == 0:
        raise InputError(
            "the program moves no tool",
            file=source,
            hint="a T word with M6 puts one in, or a job with one tool only",
        )
    zero = job.work_offsets_mm[_zero_name(job, moves, source)]
    _check_travel(job, path, source)
    cutting = _cutting_doubts(job, moves)
    notes += job_doubts(job) + in_file(cutting, job.path)
    doubtful = doubts(machine_notes(job.machine)) + tool_notes(job.tools) + cutting
    index = np.full(max(job.tools) + 1, -1)
    index[list(job.tools)] = np.arange(len(job.tools))
    cutters = tuple(tool.cutter for tool in job.tools.values())
    return Preparation(job, program, path, zero, cutters, index, notes, doubtful)


def _read(source: Path, job: Job) -> Program:
    tools = {k: ToolEntry(t.length_mm, t.diameter_mm, name=t.name) for k, t in job.tools.items()}
    try:
        return read_program(
            source,
            work_offsets_mm=job.work_offsets_mm,
            tools=tools,
            offsets=job.offsets,
            limits=_limits(job),
            dialect=job.dialect,
            control=job.control,
        )
    except UnknownToolError as error:
        if error.number is not None:
            keys = "shape, diameter_mm and length_mm"
            error.hint = f"add a table [tools.{error.number}] with {keys} to {job.path.name}"
        raise


def _assumptions(program: Program) -> tuple[Note, ...]:
    """Which control the program was read for, and what that leaves open."""
    read = Note.plain(Kind.CONTROL, f"{program.path.name} is {program.assumed}")
    return (read, *(_about_reading(note) for note in program.notes if note.is_of_reading))


def _about_reading(note: ProgramNote) -> Note:
    said, accepted = f"line {note.line}: {note.meaning}", _SETTLES.get(note.word)
    if accepted is None:
        return Note.plain(Kind.CONTROL, said)
    return Note.question(Kind.CONTROL, said, accepted=accepted)


def job_doubts(job: Job) -> tuple[Note, ...]:
    """What is doubtful in a job's machine and tools, whatever its program does."""
    of_machine = in_file(doubts(machine_notes(job.machine)), job.machine_path)
    return of_machine + in_file(tool_notes(job.tools), job.path)


def _cutting_doubts(job: Job, moves: Moves) -> tuple[Note, ...]:
    """Dimensions of tools that are unlikely for how the program cuts."""
    feeding = moves.at_feed
    return cutting_notes(
        job.tools,
        moves.tool[feeding],
        moves.feed_mm_per_min[feeding],
        moves.spindle_rpm[feeding],
    )


def _limits(job: Job) -> MachineLimits:
    motion = job.machine.motion
    return MachineLimits(
        rapid_mm_per_min=motion.rapid_mm_per_min,
        acceleration_mm_per_s2=motion.acceleration_mm_per_s2,
        tool_change_s=motion.tool_change_s,
    )


def _lengths(job: Job) -> np.ndarray:
    """Length of tool number k at index k; NaN where the job has no such tool."""
    lengths = np.full(max(job.tools) + 1, np.nan)
    for number, tool in job.tools.items():
        lengths[number] = tool.length_mm
    return lengths


def _with_only_tool(moves: Moves, job: Job, source: Path) -> tuple[Moves, tuple[Note, ...]]:
    """A program that never changes tools uses the job's tool, if that has just one."""
    if len(job.tools) != 1 or moves.tool.any() or len(moves) == 0:
        return moves, ()
    number = next(iter(job.tools))
    note = Note.plain(
        Kind.TOOL,
        f"{source.name} changes no tool: T{number} is taken to be in the spindle throughout",
        place=f"tool {number}",
    )
    return replace(moves, tool=np.full(len(moves), number)), (note,)


def _check_tools(job: Job, moves: Moves, source: Path) -> None:
    cutting = (moves.kind != MoveKind.DWELL) & (moves.tool > 0)
    for number in np.unique(moves.tool[cutting]):
        if int(number) not in job.tools:
            line = int(moves.line[cutting & (moves.tool == number)][0])
            known = ", ".join(f"T{k}" for k in job.tools)
            raise InputError(
                f"tool T{number} is not in {job.path.name}",
                file=source,
                line=line,
                accepted=known,
                hint=f"add a table [tools.{number}]",
            )


def _check_no_rotary_motion(moves: Moves, source: Path) -> None:
    turned = np.any((moves.rotary_start_deg != 0) | (moves.rotary_end_deg != 0), axis=1)
    if turned.any():
        row = int(np.argmax(turned))
        turn = np.maximum(abs(moves.rotary_start_deg[row]), abs(moves.rotary_end_deg[row]))
        axis = int(np.argmax(turn))
        raise InputError(
            f"{'ABC'[axis]} turns to {moves.rotary_end_deg[row, axis]:g} degrees",
            file=source,
            line=int(moves.line[row]),
            accepted="three-axis motion: A, B and C stay at 0",
            hint="parts are cut with three axes; errors of rotary axes show in an R-test, "
            'kind = "r_test" of [[measurements]]',
        )


def _with_tool_lengths(moves: Moves, job: Job) -> Moves:
    """The same moves with every tool's length applied instead of the program's tool offsets."""
    lengths = np.nan_to_num(_lengths(job))
    wanted = np.zeros((len(moves), 3))
    wanted[:, 2] = lengths[np.minimum(moves.tool, len(lengths) - 1)]
    shift = wanted - moves.tool_offset_mm
    arc = (moves.kind == MoveKind.ARC)[:, None]
    return replace(
        moves,
        start_mm=moves.start_mm + shift,
        end_mm=moves.end_mm + shift,
        centre_mm=np.where(arc, moves.centre_mm + shift, 0.0),
        tool_offset_mm=wanted,
    )


def _offsets_that_differ(job: Job, moves: Moves, source: Path) -> tuple[Note, ...]:
    """One note for every tool that cuts with an offset other than its length."""
    notes = []
    feeding = moves.at_feed
    for number, tool in job.tools.items():
        offset = moves.tool_offset_mm[:, 2]
        wrong = feeding & (moves.tool == number) & (np.abs(offset - tool.length_mm) > 1e-6)
        if wrong.any():
            first = int(np.argmax(wrong))
            higher_mm = float(offset[first] - tool.length_mm)
            said = (
                f"tool {number} is {tool.length_mm:g} mm long but cuts with a length offset of "
                f"{offset[first]:g} mm: its tip is {higher_mm:+g} mm from the programmed height. "
                'If the offsets hold for the tip, set tool_offsets = "touched off" in the job'
            )
            note = Note.question(Kind.TOOL_OFFSET, said, higher_mm, "mm", place=f"tool {number}")
            notes += in_file([note], source, int(moves.line[first]))
    return tuple(notes)


def _check_travel(job: Job, path: Toolpath, source: Path) -> None:
    nodes = path.nodes
    low, high = job.machine.travel_mm
    for begin in range(0, len(nodes), _NODES_AT_ONCE):
        block = slice(begin, begin + _NODES_AT_ONCE)
        nose = position_at(nodes.moves, nodes.move[block], nodes.parameter[block])
        outside = (nose < low - _TRAVEL_SLACK_MM) | (nose > high + _TRAVEL_SLACK_MM)
        if outside.any():
            row, axis = np.argwhere(outside)[0]
            break
    else:
        return
    node, beyond_mm = begin + row, nose[row, axis]
    same = nodes.move == nodes.move[node]
    along = position_at(nodes.moves, nodes.move[same], nodes.parameter[same])[:, axis]
    farthest = along.max() if beyond_mm > high[axis] else along.min()
    raise InputError(
        f"{'XYZ'[axis]} goes to {farthest:.3f} mm in machine coordinates, outside the travel",
        file=source,
        line=int(path.nodes.line[node]),
        accepted=f"{low[axis]:g} .. {high[axis]:g} mm",
        hint="check work_offsets_mm and the tool's length_mm in the job",
    )


def _zero_name(job: Job, moves: Moves, source: Path) -> str:
    """The work offset that is the workpiece zero."""
    if job.workpiece_zero is not None:
        return job.workpiece_zero
    feeding = moves.at_feed
    used = [WORK_OFFSETS[k - 1] for k in np.unique(moves.work_offset[feeding])]
    known = ", ".join(job.work_offsets_mm)
    if len(used) > 1:
        raise InputError(
            f"the program cuts in {' and '.join(used)}; which one the part's CAD refers to is "
            "not said",
            file=job.path,
            accepted=f"workpiece_zero = one of {known}",
        )
    if used and used[0] not in job.work_offsets_mm:
        line = int(moves.line[feeding][0])
        raise InputError(
            f"the program cuts in {used[0]}, which [work_offsets_mm] of {job.path.name} lacks",
            file=source,
            line=line,
            accepted=known,
        )
    return used[0] if used else next(iter(job.work_offsets_mm))
