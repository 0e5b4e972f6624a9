"""A dialect: how the programs of one control are recognised, read and written."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import MappingProxyType

from gcode.errors import ProgramError
from gcode.geometry.arc_tolerance import ArcTolerance
from gcode.language.options import RunOptions
from gcode.language.translate import Translated
from gcode.state.controller import Controller
from gcode.text.source import Source
from gcode.writing.block_text import BlockText
from gcode.writing.line_edit import LineEdit

__all__ = ["Dialect"]

#: so much of a mark is shown
_SHOWN = 30


class Dialect:
    """Base of all dialects; a subclass in a file of `gcode.dialects` is all that a new one takes.

    Every attribute below may be given by the subclass, no other without a leading underscore.

    Attributes
    ----------
    name : str
        In jobs, on the command line and in messages.
    title : str
        Maker and models.
    source : str
        The maker's manuals that it follows, with pages.
    synonyms : tuple of str
        Other names that are accepted.
    marks : re.Pattern or None
        Found in the text of a program by which it is recognised; None for a dialect that has
        to be named.
    file_endings : tuple of str
        Of files by which it is recognised where no marks are found, in lower case, with the dot.
    rank : int
        Where the marks of two are found, the lower one has the program.
    reader : type
        Obeys the lines, see `gcode.language.translate.Translated`. A dialect that does not read
        line by line replaces `run`.
    is_rs274 : bool
        Its blocks are read as RS274/NGC: letters with numbers and expressions.
    arcs : ArcTolerance
        The control's check of an arc's radii at start and end.
    reads : tuple of str
        Dialects beside its own whose programs may be written for it.
    own_words : re.Pattern or None
        Words that no other control reads which shares its letters and numbers.
    unlike : re.Pattern or None
        Words that controls which share its letters read, but otherwise.
    flow_lines : re.Pattern or None
        Lines that are left out where loops and subprograms are written out.
    unwritable : re.Pattern or None
        In a line that moves: words whose ends cannot be written anew.
    inch_decimals : int
        Decimals of an inch beyond those of a mm: 1 gives 0.0001 inch beside 0.001 mm.
    ending : frozenset of int
        M codes that act when the block's motion has ended.
    floating_tap : bool
        G84 is a feed move with the spindle reversed, so that it can be written out.
    pointed_pause : bool
        P of a pause counts seconds with a decimal point, and milliseconds without.
    options : mapping of str to tuple of str
        Parameter of the control that a job may set -> what it accepts, its default first.
    comment : tuple of str
        What begins and what ends a comment behind the words of a block.
    is_written : bool
        Its programs can be written back with other ends; False where they are read only.
    confirmed : mapping of str to str
        A truth of `gcode.language.confirmation.TRUTHS` -> words whose reading it confirms, with
        semicolons between them. A program that uses others gets a note; none where it is empty.
    text : type
        Syntax of its blocks, see `gcode.writing.block_text.BlockText`.
    edit : type
        Edits of one line, see `gcode.writing.line_edit.LineEdit`.
    """

    name: str = ""
    title: str = ""
    source: str = ""
    synonyms: tuple[str, ...] = ()
    marks: re.Pattern[str] | None = None
    file_endings: tuple[str, ...] = ()
    rank: int = 50
    reader: type[Translated] = Translated
    is_rs274: bool = False
    #: Fanuc parameter 3410 and the like are set between 0.005 and 0.02 mm; the smaller is kept
    arcs: ArcTolerance = ArcTolerance(0.005, 0.005, 0.0, 1.0)
    reads: tuple[str, ...] = ()
    own_words: re.Pattern[str] | None = None
    unlike: re.Pattern[str] | None = None
    flow_lines: re.Pattern[str] | None = None
    unwritable: re.Pattern[str] | None = None
    inch_decimals: int = 1
    ending: frozenset[int] = frozenset((0, 1, 2, 5, 9, 30, 60))
    floating_tap: bool = False
    pointed_pause: bool = False
    options: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    comment: tuple[str, str] = ("(", ")")
    is_written: bool = True
    confirmed: Mapping[str, str] = MappingProxyType({})
    text: type[BlockText] = BlockText
    edit: type[LineEdit] = LineEdit

    @classmethod
    def check_options(cls, said: Mapping[str, str]) -> None:
        """Refuse options that the control does not have; raises ProgramError."""
        for name, value in said.items():
            if name not in cls.options:
                known = ", ".join(cls.options) or f"none for {cls.name}"
                raise ProgramError(f"[control] options: {name}", accepted=known)
            if value not in cls.options[name]:
                raise ProgramError(f"[control] options: {name} = '{value}'",
                                   accepted=", ".join(cls.options[name]))  # fmt: skip

    @classmethod
    def detect(cls, text: str) -> str | None:
        """Why a program is recognised as one of this dialect; None where it is not."""
        found = None if cls.marks is None else cls.marks.search(text)
        if found is None:
            return None
        words = " ".join(found.group().split())[:_SHOWN]
        return f"'{words}' in line {text.count(chr(10), 0, found.end()) + 1}"

    @classmethod
    def run(cls, controller: Controller, source: Source, options: RunOptions) -> None:
        """Obey a program; raises ProgramError where it cannot go on."""
        reader = cls.reader(controller, source.lines, options)
        if options.fast:
            reader.use_fast_lane(source)
        reader.run()

    @classmethod
    def pause(cls, seconds: float) -> str:
        """Block of a dwell, where a cycle is written out as plain blocks of RS274/NGC."""
        return "G4 P" + f"{seconds:.6f}".rstrip("0").rstrip(".")

    @classmethod
    def decimals(cls, resolution_mm: float, unit_mm: float) -> int:
        """Decimals of a length in program units."""
        decimals = math.ceil(-math.log10(resolution_mm) - 1e-9)
        return max(decimals, 1) + (cls.inch_decimals if unit_mm != 1.0 else 0)
