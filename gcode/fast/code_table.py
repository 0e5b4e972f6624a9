"""G and M codes that compiled code obeys, as arrays made of the interpreter's own table."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from gcode.state.codes import CODES

__all__ = ["GROUPS", "CodeTable", "code_table", "sinumerik_codes"]

#: modal groups, by their numbers in compiled code
GROUPS = ("nonmodal", "motion", "plane", "distance", "arc_distance", "feed_mode", "units",
          "compensation", "tool_length", "retract", "system", "control", "tool_change", "spindle",
          "coolant", "stop")  # fmt: skip

_MODES = ("G17 G18 G19", "G20 G21", "G40", "G43 G49", "G90 G91", "G94", "G98 G99")
_MOTION = ("G0 G1 G2 G3", "G73", "G80 G81 G82 G83 G84 G85", "G89", "G54 G55 G56 G57 G58 G59")
_M_CODES = ("M0 M1", "M3 M4 M5", "M6", "M7 M8 M9")
#: obeyed in blocks of Fanuc's language, which come to the interpreter word by word
_FANUC = (*_MODES, *_MOTION, *_M_CODES)
#: obeyed in blocks of RS274/NGC; every other code is left to the interpreter
_RS274 = (*_FANUC, "G4", "G74", "G90.1 G91.1", "G59.1 G59.2 G59.3", "G61 G61.1 G64")
#: obeyed in lines of SINUMERIK
_SINUMERIK = ("G0 G1 G2 G3", "M3 M4 M5", "M7 M8 M9", "G90 G91")
_TENTHS = 1000  #: codes times ten are below


class CodeTable(NamedTuple):
    """What compiled code knows of the codes, by G (0) or M (1) and by number times ten.

    Attributes
    ----------
    group : (2, 1000) int64
        Index into `GROUPS`; -1 for a code that is not obeyed here.
    letters : (2, 1000) int64
        Bits of the letters that the code takes.
    is_sequential : int
        1 where every word is obeyed for itself, as Fanuc's are.
    """

    group: np.ndarray
    letters: np.ndarray
    is_sequential: int


@cache
def code_table(*, is_sequential: bool) -> CodeTable:
    """The codes of RS274/NGC, or those that stand in Fanuc's blocks."""
    return _table(_FANUC if is_sequential else _RS274, is_sequential=is_sequential)


@cache
def sinumerik_codes(*, with_modes: bool) -> CodeTable:
    """The codes that stand in lines of SINUMERIK, with G90 and G91 or without."""
    return _table(_SINUMERIK[: None if with_modes else -1], is_sequential=False)


def _table(names: tuple[str, ...], *, is_sequential: bool) -> CodeTable:
    group = np.full((2, _TENTHS), -1, np.int64)
    letters = np.zeros((2, _TENTHS), np.int64)
    for name in " ".join(names).split():
        place = int(name[0] == "M"), round(10 * float(name[1:]))
        code = CODES[name]
        group[place] = GROUPS.index(code.group)
        letters[place] = sum(1 << (ord(letter) - ord("a")) for letter in code.words)
    return CodeTable(group, letters, int(is_sequential))
