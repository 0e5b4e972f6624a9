"""M functions of HEIDENHAIN controls: what they do, and which are refused."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["BEFORE_MOTION", "m_code", "only_m", "without_words_of_m"]

_PLAIN = {3: "m3", 4: "m4", 5: "m5", 7: "m7", 8: "m8", 9: "m9", 0: "m0", 1: "m1", 6: ""}
_READ = frozenset((*_PLAIN, 2, 13, 14, 30, 89, 91, 92, 99, 103, 140))
_WORD = re.compile(r"(?<![A-Z0-9])M\s*(\d+)")
#: act when the block begins; all others when it ends
BEFORE_MOTION = frozenset((3, 4, 7, 8, 13, 14))
#: move nothing here: feeds at corners, look-ahead, rotary axes that stand still
_NOTED = {90: "corners", 94: "rotary display", 107: "oversize", 108: "",
          109: "feed at the edge", 110: "feed at inner arcs", 111: "feed of the centre",
          112: "corners", 113: "corners", 117: "", 118: "handwheel", 120: "look-ahead",
          124: "points left out", 126: "short way of rotary axes", 127: "", 129: "TCPM off",
          134: "", 135: "", 137: "", 138: "", 141: "", 142: "", 143: "", 145: "", 148: "",
          149: "", 150: "", 197: ""}  # fmt: skip
#: change the path or its feed
_REFUSED = {97: "small steps of a contour", 98: "open corners", 116: "feed of rotary axes",
            128: "tool centre point", 136: "feed per revolution", 144: "tilted head"}  # fmt: skip


#: M functions with words of their own, which are no places: how far the handwheel may go beside the
#: path (iTNC 530, User's Manual, section 11.5), blocks looked at ahead, tolerances, rotary axes
_WITH_WORDS = re.compile(
    rf"(M\s*118)(?:\s*[XYZABC]\s*{NUMBER})+|(M\s*120)\s*LA\s*{NUMBER}"
    rf"|(M\s*1(?:12|24))(?:\s*[TA]\s*{NUMBER})+|(M\s*138)(?:\s+[ABC](?![\w+-]))+"
)


def without_words_of_m(reader: KlartextReader, content: str) -> str:
    """A block without the words that belong to M112, M118, M120, M124 and M138."""
    if "M1" not in content:
        return content
    left = _WITH_WORDS.sub(lambda found: f"{next(filter(None, found.groups()))} ", content)
    if left != content and "118" in content:
        reader.keep("M118, whose words look like places")
    return left


def only_m(reader: KlartextReader, content: str) -> None:
    """A block of M functions alone."""
    content = without_words_of_m(reader, reader.motion.plunging(content)).strip()
    if not content:
        return
    if re.search(r"M\s*140\b", content):
        reader.motion.move("L", content)
        return
    if not re.fullmatch(r"(?:M\s*\d+\s*)+", content):
        raise ProgramError(f"cannot read '{content}'", accepted="M with a number")
    for code in map(int, re.findall(r"M\s*(\d+)", content)):
        if code == 99:
            reader.cycles.do()
        else:
            reader.execute(m_code(reader, code))


def m_code(reader: KlartextReader, code: int) -> str:
    """Block of an M function; nothing for one that moves nothing here.

    Raises
    ------
    ProgramError
        It changes the path in a way that is not read, or nobody knows it.
    """
    reader.controller.use(f"M{code}")
    if code in _REFUSED:
        raise ProgramError(f"M{code} ({_REFUSED[code]}) is not read",
                           accepted="milling with three axes")  # fmt: skip
    if code in (13, 14):
        return f"m{code - 10}m8"
    if code in (2, 30):
        reader.stopped = True
        return "m30"
    if code in _NOTED or code in reader.options.control.ignore_m:
        if reader.controller.used[f"M{code}"] == reader.controller.line:  # the first of many
            reader.noted(f"M{code}", _NOTED.get(code) or "moves nothing here")
        return ""
    if code == 89:
        reader.cycles.modal = True
        return ""
    if code not in _PLAIN:
        raise _unknown_m(reader, code)
    return _PLAIN[code]


def _unknown_m(reader: KlartextReader, code: int) -> ProgramError:
    """One error for all M functions of the program that nobody knows."""
    texts = (re.sub(r"\"[^\"]*\"", "", reader.content(k)) for k in range(len(reader.lines)))
    found = {code} | {int(m) for text in texts for m in _WORD.findall(text)}
    found -= {*_READ, *_NOTED, *_REFUSED, *reader.options.control.ignore_m}
    listed = ", ".join(map(str, sorted(found)))
    return ProgramError(
        f"M functions of the machine's builder: {' '.join(f'M{m}' for m in sorted(found))}",
        accepted="M0 M1 M2 M3-M6 M7-M9 M13 M14 M30 M89 M91 M99; others "
        f"that move nothing by ignore_m = [{listed}] in [control]",
    )
