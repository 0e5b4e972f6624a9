"""Which motion a block makes, and whether its words may stand there, in compiled code."""

from __future__ import annotations

from gcode.fast.code_table import GROUPS
from gcode.fast.compiled import njit_part
from gcode.fast.line_words import bit

__all__ = ["CANCEL", "COUNTER", "are_signs_right", "letters_of", "motion_of"]

_MOTION = GROUPS.index("motion")
_F, _H, _L, _S, _T = (ord(letter) - ord("a") for letter in "fhlst")
_AXES, _IJK = bit("xyzabc"), bit("ijk")
#: codes times ten
CANCEL, _CLOCKWISE, COUNTER = 800, 20, 30


@njit_part
def motion_of(w, s):  # pragma: no cover - compiled
    """Motion of a block, ten times its number; -1 for none, -2 where it is refused."""
    motion, axes = w.group[_MOTION], w.seen & _AXES
    if motion >= 0:
        if motion == CANCEL:
            return -2 if axes else motion
        return motion if axes or motion <= COUNTER else -2
    if axes:
        return s.motion if s.motion >= 0 and s.motion != CANCEL else -2
    return s.motion if s.motion in (_CLOCKWISE, COUNTER) and w.seen & _IJK else -1


@njit_part
def letters_of(codes, motion):  # pragma: no cover - compiled
    """Letters that a motion takes."""
    return codes.letters[0, motion] if motion >= 0 else 0


@njit_part
def are_signs_right(w):  # pragma: no cover - compiled
    """Whether no word is negative that may not be."""
    for letter in (_F, _S, _T, _H, _L):
        if w.seen & (1 << letter) and w.value[letter] < 0.0:
            return False
    return True
