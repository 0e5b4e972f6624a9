"""Which words and codes may stand together in one block."""

from __future__ import annotations

from gcode.errors import ProgramError
from gcode.state.block_values import Values
from gcode.state.codes import ARCS, AXES, CODES, CYCLES
from gcode.state.controller import XY, Controller

__all__ = ["check_block", "choose_motion"]

_COVETS_AXES = frozenset(("G10", "G28", "G30", "G52", "G92"))
_MOVES_WITHOUT_AXES = frozenset(("G0", "G1", "G2", "G3", "G5.2"))
#: Letters that stand only beside a code that takes them.
_OPTIONAL = frozenset("dehijklpqr")


def choose_motion(controller: Controller, block: Values) -> None:
    """Set `block.motion`: the block's own motion code, or the one still in force.

    Raises
    ------
    ProgramError
        Axis words that no code wants, or that two codes want.
    """
    words = block.words
    polar = "@" in words or "^" in words
    axes = any(axis in words for axis in AXES)
    if polar and (controller.plane != XY or "x" in words or "y" in words):
        raise ProgramError("polar coordinates @ ^ with X, Y or outside G17")
    nonmodal, motion = block.g.get("nonmodal"), block.g.get("motion")
    covets = nonmodal in _COVETS_AXES
    if covets and nonmodal in ("G52", "G92") and not axes and motion in (None, "G80"):
        raise ProgramError(f"{nonmodal} without axis words")
    if covets and nonmodal == "G92" and polar:
        raise ProgramError("polar coordinates with G92", accepted="polar words with motion")
    if motion is not None:
        if motion == "G80":
            if (polar or axes) and not covets:
                raise ProgramError("axis words with G80", hint="G80 cancels motion; add G0 or G1")
        elif covets:
            raise ProgramError(
                f"{nonmodal} and {motion} both use axis words",
                hint="put them into two blocks",
            )
        elif not axes and not polar and motion not in _MOVES_WITHOUT_AXES:
            raise ProgramError(f"axis words missing with {motion}")
        block.motion = motion
    elif not covets and (axes or polar):
        _carry_over(controller, block)
    elif not covets and controller.motion in ARCS and {"i", "j", "k"} & words.keys():
        block.motion = controller.motion


def _carry_over(controller: Controller, block: Values) -> None:
    offset = block.g.get("tool_length")
    if offset == "G43.1":
        return
    if controller.motion in (None, "G80") and offset != "G43.2":
        raise ProgramError("axis words without a motion code", accepted="G0 G1 G2 G3 ...")
    if controller.motion not in (None, "G80"):
        block.motion = controller.motion


def check_block(controller: Controller, block: Values) -> None:
    """Raise ProgramError for words without a code that uses them, and the other way round."""
    words, motion = block.words, block.motion
    codes = [CODES[name] for name in {*block.g.values(), *block.m.values(), motion} - {None}]
    if motion in CYCLES:
        for letter in "abc":
            if letter in words:
                raise ProgramError(f"{letter.upper()} word in a canned cycle")
    taken = {letter for code in codes for letter in code.words}
    for letter in sorted(words.keys() & _OPTIONAL - taken):
        raise ProgramError(
            f"{letter.upper()} word without a code that uses it",
            hint=f"remove {letter.upper()}{words[letter]:g} or add the code",
        )
    for code in codes:
        for letter in code.needs:
            if letter not in words:
                raise ProgramError(f"{code.name} without {letter.upper()} word",
                                   accepted=f"{code.name} ({code.text}) with "
                                   f"{' '.join(code.needs).upper()}")  # fmt: skip
    turns = words.get("p", 1.0)
    if motion in ARCS and (abs(turns - round(turns)) > 0.001 or turns < 0.5):
        raise ProgramError(f"P word {turns:g} of an arc", accepted="whole turns, P1 ...")
    _check_together(controller, block)


def _check_together(controller: Controller, block: Values) -> None:
    """What depends on two codes, on a mode or on a value."""
    words, motion, nonmodal = block.words, block.motion, block.g.get("nonmodal")
    if nonmodal == "G4":
        if block.g.get("motion") in ARCS:
            raise ProgramError("G4 with an arc; both use P")
        if words["p"] < 0.0:
            raise ProgramError(f"negative dwell P{words['p']:g}", accepted="seconds")
    if nonmodal == "G5.3" and motion not in (None, "G5.2"):
        raise ProgramError("G5.3 with another motion", accepted="G5.3 alone")
    if nonmodal == "G53" and motion not in ("G0", "G1"):
        raise ProgramError("G53 without G0 or G1")
    distance = block.g.get("distance", "G90" if controller.absolute else "G91")
    if nonmodal == "G53" and distance == "G91":
        raise ProgramError("G53 in incremental mode", hint="use G90")
    if motion in ("G33", "G33.1") and "f" in words:
        raise ProgramError(f"F word with {motion}")
