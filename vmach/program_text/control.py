"""Controls that a compensated program is written for: resolution, arcs, and what they read."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

from gcode import ARC_TOLERANCES, ArcTolerance, Program, ProgramError, dialect_name
from vmach.errors import InputError

__all__ = ["CONTROLS", "LETTER_DIALECTS", "TargetControl", "check_words", "target_control"]

#: Dialects whose blocks are letters with numbers and expressions.
LETTER_DIALECTS = ("linuxcnc", "fanuc", "haas")


@dataclass(frozen=True)
class TargetControl:
    """What differs from control to control in the text of a program.

    Attributes
    ----------
    name : str
    reads : tuple of str
        Dialects of `gcode` whose texts it reads.
    inch_decimals : int
        Decimals of an inch beyond those of a mm: 1 gives 0.0001 inch beside 0.001 mm.
    arcs : ArcTolerance
        Its check of an arc's radii at start and end.
    ending : frozenset of int
        M codes that act when the block's motion has ended.
    floating_tap : bool
        G84 is a feed move with the spindle reversed, so that it can be written out.
    """

    name: str
    reads: tuple[str, ...]
    inch_decimals: int
    arcs: ArcTolerance
    ending: frozenset[int]
    floating_tap: bool = False

    def decimals(self, resolution_mm: float, unit_mm: float) -> int:
        """Decimals of a length in program units."""
        decimals = math.ceil(-math.log10(resolution_mm) - 1e-9)
        return max(decimals, 1) + (self.inch_decimals if unit_mm != 1.0 else 0)

    def radii_agree(self, first: float, last: float, *, unit_mm: float) -> bool:
        """Whether an arc with these radii at start and end, program units, is accepted."""
        off, largest = abs(first - last), max(first, last)
        return off <= max(self.arcs.absolute(unit_mm), self.arcs.relative * largest)


_STOP = frozenset((0, 1, 2, 30, 60))
_STOP_AND_OFF = _STOP | {5, 9}
#: Fanuc parameter 3410 and the like are set between 0.005 and 0.02 mm; the smaller is kept
_CAUTIOUS = ArcTolerance(0.005, 0.005, 0.0, 1.0)

CONTROLS = {
    control.name: control
    for control in (
        TargetControl("linuxcnc", ("linuxcnc",), 2, ARC_TOLERANCES["linuxcnc"], _STOP, True),
        TargetControl("fanuc", LETTER_DIALECTS, 1, _CAUTIOUS, _STOP_AND_OFF),
        TargetControl("haas", LETTER_DIALECTS, 1, _CAUTIOUS, _STOP_AND_OFF),
        TargetControl("sinumerik", ("sinumerik",), 2, ARC_TOLERANCES["sinumerik"], _STOP_AND_OFF),
        TargetControl(
            "heidenhain", ("heidenhain",), 2, ARC_TOLERANCES["heidenhain"], _STOP_AND_OFF
        ),
    )
}

#: words of LinuxCNC that other controls with letters and numbers do not read, or read otherwise
_OWN_WORDS = re.compile(
    r"(?:^|[\s\d/])O\s*(?:<|\d+\s*(?:SUB|CALL|IF|ELSE|END|WHILE|DO|REPEAT|BREAK|CONTINUE|RETURN))"
    r"|[@^]|#\s*<|G\s*(?:43\.[12]|59\.[123]|6[14]\s*\.1|64\s*P|9[01]\.1|92\.[123]|38\.\d|33\.1"
    r"|4[12]\.1|7(?![\d.])|8(?![\d.])|10\s*L\s*(?:1|10|11|20)(?!\d))|M\s*(?:6[1-8]|7[0-3])(?!\d)",
    re.IGNORECASE,
)


def target_control(own: str, name: str | None, *, file: Path) -> TargetControl:
    """The control asked for, or the one whose dialect the program is written in.

    Parameters
    ----------
    own : str
        Dialect of the program.
    name : str or None
        The control asked for.
    file : Path
        The program, for messages.

    Raises
    ------
    InputError
        There is no such control, or it does not read the program's text.
    """
    try:
        found = dialect_name(name or "auto")
    except ProgramError:
        raise InputError(f"--dialect {name}", accepted=", ".join(CONTROLS)) from None
    control = CONTROLS[own if found == "auto" else found]
    if own not in control.reads:
        raise InputError(
            f"a {own} program cannot be written for {control.name}: "
            "words are corrected, not translated",
            file=file,
            accepted=f"--dialect {own}",
        )
    return control


def check_words(program: Program, control: TargetControl) -> None:
    """Refuse words that the control does not know.

    Raises
    ------
    InputError
        With the first such line.
    """
    if program.dialect != "linuxcnc" or control.name == "linuxcnc":
        return
    for line, text in enumerate(program.source.lines, 1):
        code = re.sub(r"\([^)]*\)|;.*", "", text)
        found = _OWN_WORDS.search(code)
        if found:
            raise InputError(
                f"'{found.group().strip()}' is LinuxCNC's own and no word of {control.name}",
                file=program.path,
                line=line,
                accepted="--dialect linuxcnc",
            )
