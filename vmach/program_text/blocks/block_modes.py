"""What is modally in force in every block of a program in plain blocks."""

from __future__ import annotations

import numpy as np

from gcode import Modes, MoveKind, PlainLines, Program, Step
from vmach.errors import InputError
from vmach.program_text.blocks.line_modes import BlockModes, LineModes

__all__ = ["PLANE_AXES", "block_modes"]

#: number of the plane, as in `gcode.Modes` -> first and second axis in it, and the one across
PLANE_AXES = {1: (0, 1, 2), 2: (1, 2, 0), 3: (2, 0, 1)}


#: machine coordinates, reference points, and tapping that turns back by itself: they stay
_LEFT = {"G28", "G30", "G53", "G33.1"}
_RIGID_TAP = "G33.1"
#: part of a reason -> what to do about it; the first that fits
_HINTS = (
    ("tapping", "tap in a program of its own, which is not corrected"),
    ("boring", "bore with a stopped spindle in a program of its own, which is not corrected"),
    ("rotation", "post the program with the transformation worked out"),
    ("scaling", "post the program at the size of the part"),
    ("fixed point", "say the machine's place by G53 or SUPA, which stays as it is"),
    ("cutter compensation", "post the path of the tool's centre"),
    ("polar", "post X Y Z"),
)
_KLARTEXT_HELIX = (
    'post X Y Z; for a helix CP, options = { helix = "C" } in [control] where the control reads '
    "C with Z"
)


def block_modes(program: Program) -> LineModes:
    """Modes of every line that moves the axes.

    Parameters
    ----------
    program : Program
        In plain blocks (`vmach.program_text.expanding.expansion.expanded`).

    Raises
    ------
    InputError
        A line has more than one motion, or runs out of order.
    """
    moving = program.moves.line[program.moves.kind != MoveKind.DWELL].astype(np.int64)
    lines, rows = np.unique(moving, return_counts=True)
    several = set(lines[rows > 1].tolist())
    modes = LineModes(lines)
    refused: dict[int, str] = {}
    for step in program.outline:
        if isinstance(step, PlainLines):
            here = slice(*np.searchsorted(lines, [step.first, step.last + 1]))
            modes.put(here, _modes(step.modes, set()))
            if not program.language.is_rs274:
                refused |= _not_written(program, lines[here].tolist())
            continue
        line = step.line
        place = np.searchsorted(lines, line)
        if place == len(lines) or lines[place] != line:
            continue
        found = _modes(step.modes, step.g_names)
        if line in several and not found.left:
            refused.setdefault(line, "several motions of one block")
        if step.modes.motion == _RIGID_TAP and found.incremental:
            refused.setdefault(line, "tapping by G33.1 in G91")
        if not found.left:
            refused |= _not_writable(program, step)
        modes.put(place, found)
    for line in moving[1:][np.diff(moving) < 0].tolist():
        refused.setdefault(line, "motion out of the order of the lines")
    _refuse(program, refused)
    return modes


def _not_writable(program: Program, step: Step) -> dict[int, str]:
    """Why a line of a dialect that is not written out cannot get another end."""
    language = program.language
    if step.unwritable:
        return {step.line: step.unwritable}
    if language.is_rs274:
        return {}
    if step.modes.side or step.before.side:
        return {step.line: "cutter compensation"}
    return _not_written(program, [step.line])


def _not_written(program: Program, lines: list[int]) -> dict[int, str]:
    """Lines whose words a dialect that is not written out cannot write anew, and why."""
    pattern, text = program.language.unwritable, program.source.line
    if pattern is None:
        return {}
    found = [line for line in lines if pattern.search(text(line))]
    return dict.fromkeys(found, "a parameter, polar coordinates or a tangential arc")


def _modes(modes: Modes, codes: set[str]) -> BlockModes:
    return BlockModes(
        unit_mm=modes.unit_mm,
        incremental=not modes.absolute,
        absolute_centre=modes.arc_absolute,
        left=bool((codes | {modes.motion}) & _LEFT),
        inverse_time=modes.feed_mode == "inverse",
        plane=modes.plane,
    )


def _refuse(program: Program, refused: dict[int, str]) -> None:
    if not refused:
        return
    first = min(refused)
    lines = ", ".join(map(str, sorted(refused)[:10])) + (" ..." if len(refused) > 10 else "")
    raise InputError(
        f"{refused[first]} cannot be compensated (lines {lines})",
        file=program.path,
        line=first,
        accepted="G0, G1, G2, G3",
        hint=_hint(refused[first], program.dialect),
    )


def _hint(reason: str, dialect: str) -> str:
    """What may be done about a motion that cannot be compensated."""
    for word, hint in _HINTS:
        if word in reason:
            if dialect == "heidenhain" and word == "polar":
                return _KLARTEXT_HELIX
            return hint
    return "post the program with plain lines and arcs in X Y Z"
