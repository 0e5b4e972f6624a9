"""Circles in the planes ZX and YZ: CC with Z, and C or CP about it.

Source: HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Circular path C around circle
center CC" and "Polar coordinates": angles count from +Z in ZX and from +Y in YZ, DR+ turns from the
first axis to the second.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.motion import KlartextMotion
    from gcode.dialects.heidenhain.motion_words import Words

__all__ = ["XY", "axes_of_pole", "side_arc"]

XY = (0, 1)
_PLANES = {frozenset("ZX"): (2, 0), frozenset("YZ"): (1, 2)}
_CODES = {(2, 0): "g18", (1, 2): "g19"}


def axes_of_pole(words: Words) -> tuple[int, int]:
    """First and second axis of the plane in which a block CC says a place."""
    named = frozenset(letter for letter in "XYZ" if {letter, "I" + letter} & words.keys())
    if "Z" not in named:
        return XY
    if named not in _PLANES:
        raise ProgramError(f"CC with {' '.join(sorted(named))}", accepted="CC X Y, CC Z X, CC Y Z")
    return _PLANES[named]


def side_arc(motion: KlartextMotion, words: Words, end: tuple[float, ...]) -> None:
    """Go along an arc about a centre in ZX or YZ.

    Raises
    ------
    ProgramError
        A corner or radius compensation belongs to it, which are those of XY alone.
    """
    reader, (first, second) = motion.reader, motion.pole_axes
    if reader.controller.side or motion.corners.is_next():
        raise ProgramError("radius compensation, RND or CHF with a circle in a plane of Z",
                           accepted="R0")  # fmt: skip
    motion.corners.go_towards(None)
    here = motion.here()
    third = 3 - first - second
    text = "".join(f"{'xyz'[k]}{number(end[k])}" for k in (first, second))
    if end[third] != here[third]:
        text += f"{'xyz'[third]}{number(end[third])}"
    for axis, place in zip((first, second), motion.pole, strict=True):
        text += f"{'ijk'[axis]}{number(place - here[axis])}"
    turns = math.ceil(abs(words.get("IPA", 0.0)) / 360.0 - 1e-9)
    text += f"p{turns}" if turns > 1 else ""
    code = "g3" if words["DR"] == "+" else "g2"
    reader.keep("a circle in a plane of Z")
    reader.execute(_CODES[motion.pole_axes], f"{code}{text}{motion.feed_word(False)}", "g17")
    motion.tangent = None
