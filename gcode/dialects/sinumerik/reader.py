"""SINUMERIK, block by block: which statement a block is, and who obeys it."""

from __future__ import annotations

import re
from functools import lru_cache

from gcode.dialects.sinumerik.block_words import (
    ADDRESSES,
    BlockWords,
    Words,
    split_arguments,
)
from gcode.dialects.sinumerik.codes import NO_MOTION, REFUSED, STOPS
from gcode.dialects.sinumerik.corners import SinumerikCorners
from gcode.dialects.sinumerik.cycle_calls import CycleCalls
from gcode.dialects.sinumerik.expressions import Variables
from gcode.dialects.sinumerik.flow import Flow
from gcode.dialects.sinumerik.frames import SETTABLE, ProgrammableFrame, settable_frame
from gcode.dialects.sinumerik.motion import SinumerikMotion
from gcode.dialects.sinumerik.subprograms import Subprograms
from gcode.dialects.sinumerik.system_variables import system_variable
from gcode.dialects.sinumerik.tool_words import ToolWords
from gcode.dialects.sinumerik.units import Units
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.state.controller import Controller

__all__ = ["SinumerikReader"]

_HEAD = re.compile(
    r"(?:/\s*(\d?)\s*)?(?:[N:](\d+)\s*)?(?:/\s*(\d?)\s*)?(?:([A-Z_]\w+):(?!=)\s*)?", re.IGNORECASE
)
_ASSIGNED = re.compile(
    r"(R\d+|R\[.*?\]|[A-Z_][A-Z_]\w*(?:\[[^\]]*\])?)\s*=(?!=)\s*(.*)", re.IGNORECASE
)
_NAMED_TOOL = re.compile(r"\bT\s*=\s*\"([^\"]*)\"", re.IGNORECASE)
_ARC_WORD = re.compile(r"\b(CIP|CT)\b", re.IGNORECASE)
_WORDS_ALONE = re.compile(r"(?:[A-Z]\d+(?:\.\d*)?)+", re.IGNORECASE)  #: G0X0Y0
_SUBPROGRAM = re.compile(
    r"(?:(MCALL|CALL)\s+)?\"?([A-Z_]\w+)\"?\s*(\(.*\))?(?:(?:\s+|(?<=\)))P\s*=?\s*(\w+))?\s*",
    re.IGNORECASE,
)
_DEFINED = re.compile(r"DEF\s+(?:NCK\s+|CHAN\s+)?(REAL|INT|BOOL)\s+(.*)", re.IGNORECASE)
_CALLED = re.compile(
    r"(MCALL\s+)?(CYCLE\d+|HOLES[12]|POCKET[1-4]|SLOT[12]|LONGHOLE)\s*\((.*)\)", re.IGNORECASE
)
_FRAME = re.compile(r"(A?TRANS|A?ROT|A?SCALE|A?MIRROR)\b\s*(.*)", re.IGNORECASE)
#: for the screen, or how the control follows the path
_NO_MOTION = re.compile(
    r"\b(?:(WORKPIECE|MSG|CYCLE832|CYCLE800|GROUP_BEGIN|GROUP_END|SETMS|EXTCALL_END)\s*"
    r"\((?:\"[^\"]*\"|[^)\"])*\)"
    r"|((?:SPOSA?|FGREF\s*\[\w+\]|LIMS)\s*=\s*[\w.+-]+|FGROUP\s*\([^)]*\))"
    rf"|({'|'.join(NO_MOTION)})\b)",
    re.IGNORECASE,
)
_REFUSED = re.compile(rf"\b({'|'.join(REFUSED)})\b", re.IGNORECASE)
_FIRST_SPINDLE = re.compile(r"\b([SM])1\s*=", re.IGNORECASE)  #: S1=1000 M1=3
_ELSEWHERE = re.compile(r"(?:EXTCALL\s*\(\s*(\".*\")\s*\)|PCALL\s+(\S+))", re.IGNORECASE)
_KEY_WORD = re.compile(r"\w+")
_MACHINE_AXIS = re.compile(r"\b([XYZ])1\s*=", re.IGNORECASE)  #: G74 X1=0
_TILTED = re.compile(r"CYCLE800\s*\((.*)\)", re.IGNORECASE)
_SUPPRESSED = re.compile(r"\bSUPA\b", re.IGNORECASE)  #: every frame, for one block


@lru_cache(maxsize=4096)
def _split_head(line: str) -> tuple[re.Match, str]:
    text = re.sub(r";.*", "", line).strip()
    head = _HEAD.match(text)
    return head, text[head.end() :].strip()


class SinumerikReader(Translated):
    """Runs a Sinumerik program; every block becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.variables = Variables(system=lambda name, index: system_variable(self, name, index))
        self.subprograms = Subprograms(self)
        self.flow, self.frame = Flow(self), ProgrammableFrame(self)
        self.words, self.tools = BlockWords(self), ToolWords(self)
        self.motion, self.corners = SinumerikMotion(self), SinumerikCorners(self)
        self.cycles, self.units = CycleCalls(self), Units(self)
        controller.start_up, controller.round_corners_from = "A", 0.0
        super().execute("g21g90g17g40")

    # blocks

    def content(self, index: int) -> tuple[re.Match, str]:
        """Head and body of a line without comment."""
        return _split_head(self.lines[index])

    def obey(self, text: str) -> None:
        """Obey one line."""
        head, content = self.content(self.next - 1)
        if "/" in head.group() and self.options.skips(int(head[1] or head[3] or 1)):
            return
        if not content:
            return
        if content.startswith("%") or content.upper().startswith("PROC "):
            self._says_flow()
            return
        if content.upper().split("(")[0].strip() == "RET":
            self.corners.finish()
            self._says_flow()
            self.ended = not self.subprograms.returned()
            return
        try:
            self._obey(content)
        except ProgramError as error:
            if self.subprograms.routine.file is not None:
                error.located(file=self.subprograms.routine.file, line=self.next)
            raise

    def _obey(self, content: str) -> None:
        if self.flow.obey(content):
            self.controller.use(_KEY_WORD.match(content)[0].upper())
            return
        self._refuse(content)
        declared, frame = _DEFINED.fullmatch(content), _FRAME.fullmatch(content)
        called, settable = _CALLED.fullmatch(content), SETTABLE.fullmatch(content)
        if declared is not None:
            self._declare(declared[2])
        elif frame is not None:
            self.corners.finish()
            self.controller.use(frame[1].upper())
            self.frame.obey(frame[1].upper(), dict(self.words.read(frame[2])) if frame[2] else {})
        elif called is not None and called[2].upper() not in ("CYCLE832", "CYCLE800"):
            self.corners.finish()
            self.cycles.call(called[2].upper(), called[3], modal=bool(called[1]))
        elif settable is not None:
            settable_frame(self, settable)
        elif content.upper() == "MCALL":
            self.cycles.modal = None
        elif re.match(r"(?:EXTERN|DEF|ENDLABEL)\b", content, re.IGNORECASE):
            self.controller.note(content.split()[0].upper(), "declaration")
        elif not self._subprogram(content) and not self._assignments(content):
            self._block(content)

    def _refuse(self, content: str) -> None:
        found = None if '"' in content else _REFUSED.search(content)
        if found is not None:
            raise ProgramError(f"{found[1].upper()} ({REFUSED[found[1].upper()]}) is not read",
                               accepted="milling with three axes")  # fmt: skip
        if content.upper().startswith("SETAL"):
            raise ProgramError(f"the program raises an alarm: {content}")

    def _subprogram(self, content: str) -> bool:
        """Go to a subprogram that stands alone in its block; tells whether one does."""
        elsewhere = _ELSEWHERE.fullmatch(content)
        if elsewhere:  # only the name of a path counts: programs lie beside this one
            name = re.split(r"[\\/:]", (elsewhere[1] or elsewhere[2]).strip('" '))[-1]
            content = f'CALL "{re.sub(r"(?i)^_N_|[._][SM]PF$", "", name)}"'
        match = _SUBPROGRAM.fullmatch(content)
        is_word = match is None or _NO_MOTION.fullmatch(content) or _ARC_WORD.fullmatch(content)
        if is_word or (_WORDS_ALONE.fullmatch(content) and not re.fullmatch(r"[Ll]\d+", content)):
            return False
        if match[2].upper() in ("RET", "M17"):
            return False
        arguments = self.arguments(match[3][1:-1]) if match[3] and match[3] != "()" else []
        self.corners.finish()
        if (match[1] or "").upper() == "MCALL":
            self.cycles.modal = (match[2], arguments)
        else:
            rounds = int(self.variables.value(match[4])) if match[4] else 1
            self._says_flow()
            self.subprograms.call(match[2], arguments, rounds)
        return True

    def _declare(self, text: str) -> None:
        for piece in split_arguments(text):
            name, _, value = piece.partition("=")
            self.variables.declare(name.strip().upper(), value.strip())

    def _assignments(self, content: str) -> bool:
        """Obey ``R1=5 R2=R1*2``; tells whether the block holds nothing else."""
        found = _ASSIGNED.match(content)
        if found is None or found[1].upper() in ADDRESSES or _NO_MOTION.match(content):
            return False
        while found is not None and found[1].upper() not in ADDRESSES:
            value, stop = self.variables.read(content, found.start(2))
            self.variables.assign(found[1].upper(), value)
            content = content[stop:].strip()
            found = _ASSIGNED.match(content)
        if content:
            self._block(content)
        return True

    def _block(self, content: str) -> None:
        tilted = _TILTED.search(content)
        if tilted and any(self.arguments(re.sub(r"\"[^\"]*\"", "", tilted[1]))[4:13]):
            raise ProgramError("CYCLE800 tilts the plane", accepted="CYCLE800()")
        content = _SUPPRESSED.sub("G53", _NO_MOTION.sub(self._noted, content)).strip()
        content = _FIRST_SPINDLE.sub(r"\1=", content)
        content = _NAMED_TOOL.sub(lambda m: f"T{self.controller.tool_named(m[1])}", content)
        arc = _ARC_WORD.search(content)
        kind = None if arc is None else arc[1].upper()
        words = self.words.read(_ARC_WORD.sub("", _MACHINE_AXIS.sub(r"\1=", content)))
        self._use(words, kind)
        self._obey_words(words, kind)

    def _obey_words(self, words: Words, arc: str | None) -> None:
        g_codes = [value for letter, value in words if letter == "G"]
        if 4.0 in g_codes:
            self.motion.dwell(words)
            return
        if {74.0, 75.0} & set(g_codes):
            self.motion.fixed_point(words)
            return
        if {331.0, 332.0} & set(g_codes):
            words, g_codes = self.motion.rigid_tap(words)
        if 9.0 in g_codes:
            words = [w for w in words if w != ("G", 9.0)]
            self._stop_exactly(words, arc)
            return
        self.units.select(words)
        self.tools.change(words)
        self.motion.polar(words, g_codes)
        self.motion.opening_angle(words, g_codes)
        if self.corners.hold(words, g_codes, is_special=arc is not None):
            return
        self.tools.side(words, g_codes)
        moved = any(letter in "XYZ" for letter, _ in words)
        if arc is not None:
            self.motion.special_arc(arc, words)
        else:
            self.execute(self.words.text(words))
        if self.cycles.modal is not None and moved:
            self.cycles.do_modal()
        stop = [v for letter, v in words if letter == "M" and v in STOPS]
        if 17.0 in stop and self.subprograms.returned():
            if {letter for letter, _ in words} <= {"M", "N"}:
                self._says_flow()
            return
        if stop:
            self.execute("m30" if stop[0] in (2, 17, 30) else f"m{stop[0]:.0f}")

    def _stop_exactly(self, words: Words, arc: str | None) -> None:
        """G9: an exact stop at the end of one block."""
        before = self.controller.path_control
        self.execute("g61.1")
        self._obey_words(words, arc)
        self.execute(before.lower())

    def _says_flow(self) -> None:
        """The line that runs says nothing but what comes next."""
        if self.controller.trace is not None:
            self.controller.trace.flow()

    def _use(self, words: Words, arc: str | None) -> None:
        for letter, value in words:
            if letter in "GM":
                self.controller.use(f"{letter}{value:g}")
            elif letter in ADDRESSES:
                self.controller.use(letter)
        if arc is not None:
            self.controller.use(arc)

    def _noted(self, found: re.Match) -> str:
        self.controller.note(
            (found[1] or found[2] or found[3]).upper(), "screen, or following of the path"
        )
        return ""

    # for those who obey a block

    def only_in_xy(self, what: str) -> None:
        """Refuse what is worked out in the plane XY alone."""
        if self.controller.plane != 1:
            raise ProgramError(f"{what} in G18 or G19 is not read", accepted="G17")

    def is_absolute(self, g_codes: list[float]) -> bool:
        """Whether a block with these codes counts from the zero (G90)."""
        return 90.0 in g_codes if {90.0, 91.0} & set(g_codes) else self.controller.absolute

    def arguments(self, text: str) -> list[float | None]:
        """Values of the arguments of a cycle or subprogram."""
        pieces = split_arguments(text)
        return [self.variables.value(piece) if piece.strip() else None for piece in pieces]

    def here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        c = self.controller
        here = list(c.position)
        if c.side and not c.entering:
            here[:3] = c.programmed
        here = self.frame.unscaled(here)
        waiting = self.corners.waiting
        if waiting is not None:
            here[:3] = *waiting.piece.end, waiting.end_level
        return here

    def execute(self, *blocks: str) -> None:
        """Hand blocks of RS274/NGC to the interpreter, in the lengths of the frame."""
        super().execute(*(self.units.converted(self.frame.scaled(block)) for block in blocks))

    def absolutely(self, block: str) -> None:
        """Obey a block in G90, whatever the mode is."""
        before, self.controller.absolute = self.controller.absolute, True
        self.execute(block)
        self.controller.absolute = before

    def go(self, motion: str, *, z: float, feed: float | None = None) -> None:
        """Move along the tool axis to an absolute level."""
        self.absolutely(f"{motion}z{number(z)}" + (f"f{number(feed)}" if feed else ""))

    def place(self, motion: str, x: float, y: float, z: float) -> None:
        """Move to an absolute place."""
        self.absolutely(f"{motion}x{number(x)}y{number(y)}z{number(z)}")

    # subprograms

    def leave(self) -> bool:
        """End of a subprogram or of a part that is repeated."""
        self.corners.finish()
        return self.subprograms.leave()

    def source_line(self, index: int) -> int:
        """Line of the program; what a file beside it does is done by the line that calls it."""
        return self.subprograms.source_line or index + 1
