"""Which words and codes may stand together in one block."""

from __future__ import annotations

from gcode.errors import ProgramError
from gcode.state.block_values import Values
from gcode.state.codes import AXES, CYCLES, code_name
from gcode.state.controller import XY, Controller

__all__ = ["check_block", "choose_motion"]

_COVETS_AXES = frozenset((100, 280, 300, 520, 920))
_MOVES_WITHOUT_AXES = frozenset((0, 10, 20, 30, 52))
_ARCS = frozenset((20, 30))


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
    if covets and nonmodal in (520, 920) and not axes and motion in (None, 800):
        raise ProgramError(f"{code_name(nonmodal)} without axis words")
    if covets and nonmodal == 920 and polar:
        raise ProgramError("polar coordinates with G92", accepted="polar words with motion")
    if motion is not None:
        if motion == 800:
            if (polar or axes) and not covets:
                raise ProgramError("axis words with G80", hint="G80 cancels motion; add G0 or G1")
        elif covets:
            raise ProgramError(
                f"{code_name(nonmodal)} and {code_name(motion)} both use axis words",
                hint="put them into two blocks",
            )
        elif not axes and not polar and motion not in _MOVES_WITHOUT_AXES:
            raise ProgramError(f"axis words missing with {code_name(motion)}")
        block.motion = motion
    elif not covets and (axes or polar):
        _carry_over(controller, block)
    elif not covets and controller.motion in _ARCS and {"i", "j", "k"} & words.keys():
        block.motion = controller.motion


def _carry_over(controller: Controller, block: Values) -> None:
    offset = block.g.get("tool_length")
    if offset == 431:
        return
    if controller.motion in (None, 800) and offset != 432:
        raise ProgramError("axis words without a motion code", accepted="G0 G1 G2 G3 ...")
    if controller.motion not in (None, 800):
        block.motion = controller.motion


def _is_used(block: Values, letter: str) -> bool:
    """Tell whether a code in the block wants the word."""
    g, m, motion = block.g, block.m, block.motion
    nonmodal = g.get("nonmodal")
    compensation = g.get("compensation")
    io = m.get("io")
    if letter == "d":
        return compensation in (410, 420, 411, 421) or motion in (730, 830) or (
            g.get("spindle_mode") == 960)
    if letter == "$":
        return True
    if letter == "e":
        return motion in (760, 330, 331) or io in (66, 67, 68)
    if letter == "h":
        return g.get("tool_length") in (430, 432) or motion == 760
    if letter in "ij":
        wanted = (20, 30, 50, 51, 760, 870, 331) if letter == "i" else (20, 30, 50, 51, 760, 870)
        return motion in wanted or nonmodal == 100
    if letter == "k":
        return motion in (20, 30, 330, 331, 760, 870)
    if letter == "l":
        return (motion in CYCLES and motion != 740) or motion in (760, 52) or nonmodal == 100 or (
            compensation in (410, 420, 411, 421) or io == 66)
    if letter == "p":
        return (
            nonmodal in (100, 40) or g.get("control") == 640 or io in (62, 63, 64, 65, 66)
            or motion in (760, 820, 860, 880, 890, 50, 52, 20, 30, 740, 840)
            or m.get("override") in (50, 51, 52, 53) or m.get("spindle") == 19
        )  # fmt: skip
    if letter == "q":
        return (
            motion in (830, 730, 50, 760) or io in (66, 67, 68) or nonmodal == 100
            or m.get("tool_change") == 61 or g.get("control") == 640 or m.get("spindle") == 19
        )  # fmt: skip
    return (  # r
        motion in (20, 30, 760) or motion in CYCLES or compensation in (411, 421)
        or nonmodal == 100 or m.get("spindle") == 19
    )  # fmt: skip


def check_block(controller: Controller, block: Values) -> None:
    """Raise ProgramError for words without a code that uses them, and the other way round."""
    words, motion = block.words, block.motion
    if motion in CYCLES:
        for letter in "abc":
            if letter in words:
                raise ProgramError(f"{letter.upper()} word in a canned cycle")
    for letter in words.keys() & set("dehijklpqr$"):
        if not _is_used(block, letter):
            raise ProgramError(
                f"{letter.upper()} word without a code that uses it",
                hint=f"remove {letter.upper()}{words[letter]:g} or add the code",
            )
    turns = words.get("p", 1.0)
    if motion in _ARCS and (abs(turns - round(turns)) > 0.001 or turns < 0.5):
        raise ProgramError(f"P word {turns:g} of an arc", accepted="whole turns, P1 ...")
    _check_complete(controller, block)


def _check_complete(controller: Controller, block: Values) -> None:
    words, motion, nonmodal = block.words, block.motion, block.g.get("nonmodal")
    if nonmodal == 40:
        if "p" not in words:
            raise ProgramError("G4 without P word", accepted="P with seconds: G4 P1.5")
        if block.g.get("motion") in _ARCS:
            raise ProgramError("G4 with an arc; both use P")
        if words["p"] < 0.0:
            raise ProgramError(f"negative dwell P{words['p']:g}", accepted="seconds")
    if nonmodal == 53 and motion not in (None, 52):
        raise ProgramError("G5.3 with another motion", accepted="G5.3 alone")
    if nonmodal == 530 and motion not in (0, 10):
        raise ProgramError("G53 without G0 or G1")
    if nonmodal == 530 and block.g.get("distance", 900 if controller.absolute else 910) == 910:
        raise ProgramError("G53 in incremental mode", hint="use G90")
    if block.g.get("spindle_mode") == 960 and "s" not in words:
        raise ProgramError("G96 without S word")
    if motion in (330, 331):
        if "k" not in words:
            raise ProgramError(f"{code_name(motion)} without K word")
        if "f" in words:
            raise ProgramError(f"F word with {code_name(motion)}")
    if motion == 760 and not {"p", "i", "j", "k"} <= words.keys():
        raise ProgramError("G76 needs P, I, J and K words")
