"""Words of G2 and G3: which may stand together, and the centre that they give.

Source: T. Kramer, F. Proctor and E. Messina, The NIST RS274NGC Interpreter - Version 3, NISTIR
6556 (2000); LinuxCNC, G-Codes.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry import arcs
from gcode.motion.feed import check_feed
from gcode.state.block_values import Values
from gcode.state.codes import AXES
from gcode.state.controller import PLANE_AXES, XY, Controller

__all__ = ["arc_centre", "check_arc_words"]


def arc_offsets(controller: Controller, words: dict[str, float]) -> tuple[float, float]:
    """I J K of the plane as (first, second); missing ones are zero unless G90.1 is on."""
    first, second, axial = PLANE_AXES[controller.plane]
    letters = "ijk"
    if letters[axial] in words:
        raise ProgramError(
            f"{letters[axial].upper()} word in an arc of plane {'XYZ'[first]}{'XYZ'[second]}",
            accepted=f"{letters[first].upper()} {letters[second].upper()}",
        )
    for index in (first, second):
        if letters[index] not in words and controller.arc_absolute:
            raise ProgramError(f"{letters[index].upper()} word missing in arc with absolute centre")
    return words.get(letters[first], 0.0), words.get(letters[second], 0.0)


def check_arc_words(controller: Controller, block: Values) -> None:
    """Raise ProgramError where the words of an arc contradict each other."""
    words = block.words
    has_ijk = any(letter in words for letter in "ijk")
    if controller.straight_only:
        raise ProgramError(
            "the move after the end of cutter compensation must be straight",
            hint="insert G0 or G1 before the arc",
        )
    if "r" not in words and not has_ijk:
        raise ProgramError("arc without R, I, J or K")
    if "r" in words and has_ijk:
        raise ProgramError("arc with R and with I, J or K", accepted="one of the two")
    check_feed(controller, block, "arc")
    if has_ijk:
        arc_offsets(controller, words)
        return
    first, second, _ = PLANE_AXES[controller.plane]
    polar = controller.plane == XY and ("@" in words or "^" in words)
    if AXES[first] not in words and AXES[second] not in words and not polar:
        raise ProgramError(f"arc with R without {AXES[first].upper()} and {AXES[second].upper()}")


def arc_centre(
    controller: Controller, block: Values, start: arcs.Point, end: arcs.Point
) -> tuple[arcs.Point, int]:
    """Centre in the plane's coordinates, and turns (negative clockwise)."""
    words = block.words
    clockwise = block.motion == "G2"
    turns = math.floor(words.get("p", 1.0) + 0.5)
    if "r" in words:
        centre = arcs.centre_from_radius(start, end, words["r"], clockwise=clockwise,
                                         unit_mm=controller.unit_mm)  # fmt: skip
    else:
        centre = arcs.centre_from_offsets(
            start, end, arc_offsets(controller, words), absolute=controller.arc_absolute,
            tolerance=controller.tolerance, unit_mm=controller.unit_mm,
        )  # fmt: skip
    return centre, -turns if clockwise else turns
