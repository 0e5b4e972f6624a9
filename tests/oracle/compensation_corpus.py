"""Any 3-axis program as a job, compensated, and its text judged by LinuxCNC's interpreter."""

import re
import sys
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from unittest import mock

import numpy as np

from gcode import ToolEntry, read_program, read_tool_table
from tests.oracle.compensation_paths import Comparison, compared, intended_pieces
from tests.oracle.linuxcnc_interpreter import judge
from vmach.compensation import compensate
from vmach.effects import read_effects
from vmach.job import read_job
from vmach.path.geometry import position_at
from vmach.program_text import Target

__all__ = ["Outcome", "compensated", "corpus_programs", "judged", "straight_machine",
           "write_job"]  # fmt: skip

module = sys.modules["vmach.compensation.compensate"]
TRAVEL_MM = 5000.0
#: the tool's length is set where it stands, with the correction that it has there
_SHIFTS = re.compile(rb"(?i)G\s*10\s*L\s*1[01]")
_TOOL = re.compile(rb"(?<![A-Za-z_<])(?:[Tt]|TOOL CALL)\s*[\d#[]")
_NUMBER = re.compile(rb"(?:[Tt]|TOOL CALL)\s*(\d+)")
OFFSET_MM = (0.0, 0.0, 0.0)  #: so that axes without a word yet stand where LinuxCNC has them
NO_PROGRAM = {".canon17", ".canon", ".reject", ".tbl", ".md", ".tsv", ".py", ".sh", ".camotics"}

ERRORS = """[errors.EYX]
table = "EYX.csv"
measured_at_mm = [0.0, 0.0, -200.0]
[errors.EXY]
table = "EXY.csv"
measured_at_mm = [0.0, 0.0, -200.0]
[errors.EZX]
table = "EZX.csv"
measured_at_mm = [0.0, 0.0, -200.0]
[errors.EBX]
table = "EBX.csv"
[squareness]
EC0Y = 18.0
EB0X = -9.0
EA0Y = 12.0
"""

EFFECTS = """[effects.scale.X]
scale_ppm = 35.0
[effects.scale.Y]
scale_ppm = -22.0
[effects.scale.Z]
scale_ppm = 14.0
[effects.cyclic_pitch.X]
amplitude_um = 1.5
pitch_mm = 10.0
phase_rad = 0.4
[effects.cyclic_pitch.Y]
amplitude_um = 1.0
pitch_mm = 12.0
phase_rad = 1.1
"""


def straight_machine(travel_mm):
    """Text of a machine file without errors, axes travelling as far to either side of zero."""
    return f"""schema = 1
name = "straight"
chain = "t (C) Z b Y' X' w"
[convention]
origin = "spindle nose with every axis at home; axes as in ISO 841"
sign = "displacement of the tool relative to the workpiece, rotations right-handed"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 24000
tool_change_s = 6
[axes.X]
travel_mm = [-{travel_mm}, {travel_mm}]
[axes.Y]
travel_mm = [-{travel_mm}, {travel_mm}]
[axes.Z]
travel_mm = [-{travel_mm}, {travel_mm}]
"""


def corpus_programs(folder):
    """Programs of a folder beside which LinuxCNC's calls lie, so that it accepts them."""
    found = (p for p in sorted(Path(folder).iterdir()) if p.suffix not in NO_PROGRAM)
    beside = ((p, p.with_name(p.name + ".canon17"), p.with_suffix(".canon")) for p in found)
    return [p for p, *calls in beside if any(c.exists() for c in calls)]


def _tools(path, text):
    """Tools (number, length, diameter) of the table beside a program, or one for all of it."""
    if not _TOOL.search(re.sub(rb"\([^)\n]*\)|;[^\n]*", b"", text)):
        return [(1, 50.0, 6.0)]
    own, common = path.with_name(path.name + ".tbl"), path.with_name("tool.tbl")
    table = next((t for t in (own, common) if t.exists()), None)
    rows = read_tool_table(table, unit_mm=25.4) if table else {}
    known = {n: (n, e.length_mm or 50.0, abs(e.diameter_mm) or 0.001) for n, e in rows.items()}
    for number in set(map(int, _NUMBER.findall(text))) - known.keys() - {0}:
        known[number] = (number, 50.0, 6.0)
    return sorted(known.values())


def measured_machine(folder, machine):
    """Copy a measured machine; returns the middle of its travel."""
    text = machine.read_text(encoding="utf-8")
    (folder / "machine.toml").write_text(text, encoding="utf-8")
    for name in re.findall(r'(?m)^table = "(.*)"', text):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes((machine.parent / name).read_bytes())
    travel = re.findall(r"travel_mm = \[(.*)\]", text)[:3]
    return np.array([np.mean([float(end) for end in ends.split(",")]) for ends in travel])


def _centred(path, tools, middle_mm):
    """The zero that brings the middle of a program's path to the middle of the travel."""
    entries = {n: ToolEntry(length, diameter) for n, length, diameter in tools}
    moves = read_program(path, tools=entries).moves
    if not len(moves):
        return OFFSET_MM
    rows = np.repeat(np.arange(len(moves)), 13)
    places = position_at(moves, rows, np.tile(np.linspace(0.0, 1.0, 13), len(moves)))
    box_middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    return tuple((middle_mm - box_middle).round(3).tolist())


def write_job(folder, path, *, effects=EFFECTS, errors=True, machine=None):
    """Write a job that machines a program with bent axes; returns its tools and zero."""
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    text = path.read_bytes()
    (folder / path.name).write_bytes(text)
    if machine is not None:
        zero_mm = _centred(path, _tools(path, text), measured_machine(folder, machine))
        return _write_program(folder, path, zero_mm, "")
    (folder / "machine.toml").write_text(straight_machine(TRAVEL_MM) + (ERRORS if errors else ""))
    at = np.arange(-TRAVEL_MM, TRAVEL_MM + 1.0, 25.0)
    for index, name in enumerate(("EYX", "EXY", "EZX", "EBX")):
        value = 4.0 * np.sin(at / (90.0 + 20.0 * index) + index) + 2.0 * np.sin(at / 31.0)
        rows = "".join(f"{a:g},{v:.4f},{v:.4f}\n" for a, v in zip(at, value, strict=True))
        (folder / f"{name}.csv").write_text("position_mm,forward,backward\n" + rows)
    return _write_program(folder, path, OFFSET_MM, effects)


def _write_program(folder, path, zero_mm, effects):
    text = path.read_bytes()
    tools = _tools(path, text)
    blocks = "".join(
        f'[tools.{n}]\nshape = "flat"\ndiameter_mm = {d!r}\nlength_mm = {z!r}\n'
        for n, z, d in tools
    )
    offsets = "".join(f'"{name}" = {list(zero_mm)}\n' for name in _OFFSETS)
    (folder / "job.toml").write_text(
        f'schema = 1\nmachine = "machine.toml"\nprogram = "{path.name}"\nworkpiece_zero = "G54"\n'
        f"[work_offsets_mm]\n{offsets}{blocks}{effects}"
    )
    return tools, zero_mm


_OFFSETS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")


@dataclass
class Outcome:
    """What became of one program.

    Attributes
    ----------
    found : Compensation or None
    blocks : int
        Blocks of the program, written out, that move the axes.
    refusal : str or None
        vmach's words where it refuses.
    linuxcnc : str or None
        LinuxCNC's words where it refuses the output.
    path : Comparison or None
        LinuxCNC's path of the output beside the intended one.
    wrong : list of str
        Moves that differ in more than rounding.
    """

    found: object = None
    blocks: int = 0
    refusal: str | None = None
    linuxcnc: str | None = None
    path: Comparison | None = None
    wrong: list[str] = field(default_factory=list)


@contextmanager
def _kept():
    """What is rounded at the end: the target before, the plan after, and what was written."""
    kept = {}
    round_program = module.round_program

    def keep(iteration, found, resolution_mm, view):
        targets, own_write = {}, iteration.write

        def write(target, resolution_mm):
            written = own_write(target, resolution_mm)
            targets[id(written)] = written, target
            return written

        iteration.write = write
        rounded = round_program(iteration, found, resolution_mm, view)
        kept.update(
            rewriter=iteration.rewriter,
            plan=rounded.run.plan,
            target=_wanted_at(found.plan, found.target, rounded.run.plan),
            chosen_mm=targets[id(rounded.written)][1].ends_mm,
            resolution_mm=resolution_mm,
            written=rounded.written,
        )
        return rounded

    with mock.patch.object(module, "round_program", keep):
        yield kept


def _wanted_at(plan, target, rounded_plan):
    """The target before rounding where the ends of the rounded plan are."""
    ends = target.ends_mm.copy()
    for k, (old, new) in enumerate(zip(plan.pieces, rounded_plan.pieces, strict=True)):
        if new.end != old.end:  # an inserted one, which went along its move
            places = [old.start, old.end, plan.pieces[k + 1].end]
            before = target.ends_mm[k - 1] if k else np.zeros(3)
            around = np.array([before, target.ends_mm[k], target.ends_mm[k + 1]])
            ends[k] = [np.interp(new.end, places, column) for column in around.T]
    return Target(plan.pieces, ends, target.middles_mm)


def compensated(folder, **options):
    """Compensate the job of a folder; returns the result and what was handed to the text."""
    job = read_job(Path(folder))
    effects = read_effects(job.effects, file=job.path, job=job)
    with _kept() as kept:
        found = compensate(job, effects, limit_mm=2.0, **options)
    return found, kept


def judged(folder, path, *, machine=None, **options):
    """Compensate a program and compare LinuxCNC's path of the text with the intended one."""
    try:
        tools, zero_mm = write_job(folder, path, machine=machine)
        found, kept = compensated(folder, **options)
    except ValueError as error:
        return Outcome(refusal=str(error))
    outcome = Outcome(found=found, blocks=len(kept["rewriter"].modes) if kept else 0)
    control = {"tools": tools, "work_offsets_mm": {name: zero_mm for name in _OFFSETS}}
    before, after = judge(path.read_bytes(), **control), judge(found.text, **control)
    outcome.linuxcnc = after.refusal
    if before.refusal:
        outcome.wrong.append(f"original refused: {before.refusal}")
    elif not outcome.linuxcnc and kept:
        # with another zero, axes without a word yet stand elsewhere in LinuxCNC
        intended = intended_pieces(kept, numbers_only=_SHIFTS.search(path.read_bytes()) is not None)
        outcome.path = compared(before, after, intended)
        outcome.wrong += outcome.path.wrong
    return outcome
