"""Controls whose programs look like FANUC's and are not read: named rather than refused by a word.

Fadal's format 1: ``E1`` beside X or Y is a work offset, ``H7`` alone a length, ``L101`` a call.
Seen in janforys/cnc-programming and Unigraphics/NX.Postprocessor on GitHub.
"""

from __future__ import annotations

import re

from gcode.errors import ProgramError

__all__ = ["name_unread_control"]

_COMMENT = re.compile(r"\([^)\n]*\)?|;.*|^[ \t]*\*.*", re.MULTILINE)
_E_WORD = re.compile(r"E[ \t]*([-+\d.]+)", re.IGNORECASE)
#: E0 to E48 in a block with X or Y. With a point it is the feed of a printer's filament, beside G70
#: to G72, a word of LinuxCNC's lathe cycles
_FADAL = re.compile(
    r"^(?!.*G7[0-2](?!\d))(?=.*[XY][ \t]*[-+.\d])"
    r"(?:[^#\[\n]*?[ \t])?E[ \t]*0*(?:[0-3]?\d|4[0-8])(?![\d.])",
    re.IGNORECASE | re.MULTILINE,
)


def name_unread_control(text: str) -> None:
    """Raise ProgramError where every E word of a text is one of Fadal's work offsets."""
    bare = _COMMENT.sub("", text)
    found = list(_FADAL.finditer(bare))
    if not found or len(found) != len(_E_WORD.findall(bare)):
        return
    word = _E_WORD.search(found[0].group()).group()
    raise ProgramError(
        f"a program of Fadal's own format: {word} chooses a work offset",
        line=bare.count("\n", 0, found[0].start()) + 1,
        accepted="programs in the words of FANUC",
        hint="post it for FANUC: G54 to G59 in the place of E, G43 with H, M98 in the place of L",
    )
