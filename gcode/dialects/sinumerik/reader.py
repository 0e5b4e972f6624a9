"""SINUMERIK, block by block: words of motion, and who obeys them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from gcode.dialects.sinumerik.block_words import ADDRESSES, BlockWords, Words, split_arguments
from gcode.dialects.sinumerik.builders_words import unknown_words
from gcode.dialects.sinumerik.codes import STOPS
from gcode.dialects.sinumerik.corners import SinumerikCorners
from gcode.dialects.sinumerik.cycles.calls import CycleCalls
from gcode.dialects.sinumerik.flow import Flow
from gcode.dialects.sinumerik.frames import ProgrammableFrame
from gcode.dialects.sinumerik.motion import SinumerikMotion
from gcode.dialects.sinumerik.poles import Poles
from gcode.dialects.sinumerik.soft_approach import SoftApproach
from gcode.dialects.sinumerik.statements import ARC_WORD, NO_MOTION_WORDS, Statements
from gcode.dialects.sinumerik.subprograms import Subprograms
from gcode.dialects.sinumerik.tool_words import ToolWords
from gcode.dialects.sinumerik.units import Units
from gcode.dialects.sinumerik.values.system_variables import system_variable
from gcode.dialects.sinumerik.values.variables import Variables
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number, xy_words
from gcode.state.controller import PLANE_AXES, XY, XZ, YZ, Controller
from gcode.text.source import Source

__all__ = ["SinumerikReader"]

_HEAD = re.compile(
    r"(?:/\s*(\d?)\s*)?(?:[N:](\d+)\s*)?(?:/\s*(\d?)\s*)?(?:([A-Z_]\w+):(?!=)\s*)?", re.IGNORECASE
)
_COMMENT = re.compile(r"(\"[^\"]*\")|;.*")  #: no comment within a string
_NAMED_TOOL = re.compile(r"\bT\s*=\s*\"([^\"]*)\"", re.IGNORECASE)
_FIRST_SPINDLE = re.compile(r"\b([SM])1\s*=", re.IGNORECASE)  #: S1=1000 M1=3
_KEY_WORD = re.compile(r"\w+")
#: letters with numbers and nothing else, which most lines of most programs are; G25 and G26 take
#: other words, and L calls a subprogram
_LETTERS = re.compile(r"(?:(?!G2[56](?!\d))[A-KM-Z]\s*[-+]?(?:\d+\.?\d*|\.\d+)\s*)+", re.IGNORECASE)
_MACHINE_AXIS = re.compile(r"\b([XYZ])1\s*=", re.IGNORECASE)  #: G74 X1=0
_TILTED = re.compile(r"CYCLE800\s*\((.*)\)", re.IGNORECASE)
_APART = frozenset((4.0, 9.0, 74.0, 75.0, 331.0, 332.0))  #: codes that take over their block
_NO_FRAMES = (("G", 53.0), ("G", 153.0))
_SUPPRESSED = re.compile(r"\bSUPA\b", re.IGNORECASE)  #: every frame, for one block


#: plane -> letters of a cycle's blocks, which are written for G17, in that plane
_TURNED = {XY: {}, XZ: str.maketrans("xyzijk", "zxykij"), YZ: str.maketrans("xyzijk", "yzxjki")}


@lru_cache(maxsize=4096)
def _split_head(line: str) -> tuple[re.Match, str]:
    text = _COMMENT.sub(lambda found: found[1] or "", line).strip()
    head = _HEAD.match(text)
    return head, text[head.end() :].strip()


@lru_cache(maxsize=4096)
def _bound(content: str) -> str:
    """Whether a block begins a program, PROC, or ends it, RET."""
    upper = content.upper()
    if upper.startswith(("%", "PROC ")):
        return "PROC"
    return "RET" if upper.split("(")[0].strip() == "RET" else ""


@lru_cache(maxsize=4096)
def _without_notes(content: str) -> tuple[str, tuple[str, ...]]:
    """Words of motion of a block, and the words that move nothing."""
    noted: list[str] = []

    def note(found: re.Match) -> str:
        noted.append((found[1] or found[2] or found[3]).upper())
        return ""

    left = _SUPPRESSED.sub("G53", NO_MOTION_WORDS.sub(note, content)).strip()
    return _FIRST_SPINDLE.sub(r"\1=", left), tuple(noted)


@lru_cache(maxsize=4096)
def _arc_and_words(content: str) -> tuple[str | None, str]:
    """CIP or CT, and the other words."""
    arc = ARC_WORD.search(content)
    words = ARC_WORD.sub("", _MACHINE_AXIS.sub(r"\1=", content))
    return None if arc is None else arc[1].upper(), words


class SinumerikReader(Translated):
    """Runs a Sinumerik program; every block becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.cycle_plane = XY  #: of the cycle that runs
        self.variables = Variables(
            system=lambda name, index: system_variable(self, name, index),
            given=options.control.variables,
            unknown=lambda name: unknown_words(self, variable=name),
            note=controller.note,
        )
        self.subprograms = Subprograms(self)
        self.flow, self.frame = Flow(self), ProgrammableFrame(self)
        self.words, self.tools = BlockWords(self), ToolWords(self)
        self.motion, self.corners = SinumerikMotion(self), SinumerikCorners(self)
        self.poles, self.approach = Poles(self), SoftApproach(self)
        self.cycles, self.units = CycleCalls(self), Units(self)
        self.statements = Statements(self)
        controller.start_up, controller.round_corners_from = "A", 0.0
        super().execute("g21g90g17g40")

    def use_fast_lane(self, source: Source) -> None:
        """Give stretches of lines to compiled code."""
        from gcode.dialects.sinumerik.lane import SinumerikLane  # loads the compiler

        self.lane = SinumerikLane(self, source.data, source.line_starts)

    def apart(self, controller: Controller) -> SinumerikReader:
        """The same program and variables for another controller."""
        inner = SinumerikReader(controller, list(self.lines), self.options)
        inner.variables, inner.budget = self.variables, self.budget
        inner.subprograms.routine = self.subprograms.routine
        inner.stop = self.subprograms.routine.stop
        return inner

    # blocks

    def content(self, index: int) -> tuple[re.Match, str]:
        """Head and body of a line without comment."""
        return _split_head(self.lines[index])

    @staticmethod
    def label_of(line: str) -> str | None:
        """Label at the head of a line, None where there is none."""
        return _split_head(line)[0][4]

    def obey(self, text: str) -> None:
        """Obey one line."""
        head, content = self.content(self.next - 1)
        if "/" in head.group() and self.options.skips(int(head[1] or head[3] or 1)):
            return
        if not content:
            return
        bound = _bound(content)
        if bound == "PROC":
            self.says_flow()
            return
        if bound == "RET":
            self.corners.finish()
            self.says_flow()
            self.ended = not self.subprograms.returned()
            return
        try:
            self._obey(content)
        except ProgramError as error:
            if self.subprograms.file is not None:
                error.located(file=self.subprograms.file, line=self.next)
            raise

    def _obey(self, content: str) -> None:
        if _LETTERS.fullmatch(content):
            self._motion(None, content)
            return
        if self.flow.obey(content):
            self.controller.use(_KEY_WORD.match(content)[0].upper())
            return
        rest = self.statements.obey(content)
        if rest:
            self._block(rest)

    def _block(self, content: str) -> None:
        tilted = _TILTED.search(content) if "(" in content else None
        if tilted and any(self.arguments(re.sub(r"\"[^\"]*\"", "", tilted[1]))[4:13]):
            raise ProgramError("CYCLE800 tilts or shifts the plane", accepted="CYCLE800()")
        content, noted = _without_notes(content)
        for word in noted:
            self._note(word)
        if '"' in content:
            content = _NAMED_TOOL.sub(lambda m: f"T{self.controller.tool_named(m[1])}", content)
        self._motion(*_arc_and_words(content))

    def _motion(self, kind: str | None, content: str) -> None:
        """Words of motion, and CIP or CT among them."""
        words = self.words.read(content)
        self._use(words, kind)
        if kind is None and not any(letter in "XYZABCUVW" for letter, _ in words):
            # frames are suppressed for the move of this block alone, and it has none
            words = [word for word in words if word not in _NO_FRAMES]
        self._obey_words(words, kind)

    def _obey_words(self, words: Words, arc: str | None) -> None:
        g_codes = [value for letter, value in words if letter == "G"]
        if not _APART.isdisjoint(g_codes):
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
        self.poles.obey(words, g_codes, is_special=arc is not None)
        self.motion.opening_angle(words, g_codes)
        if self.approach.obey(words, g_codes):
            return
        if self.corners.hold(words, g_codes, is_special=arc is not None):
            return
        self.tools.side(words, g_codes)
        moved = any(letter in "XYZ" for letter, _ in words)
        if arc is not None:
            self.motion.special_arc(arc, words)
        else:
            self.execute(self.words.text(words))
        if self.cycles.modal is not None and moved and not self.subprograms.is_in_modal_call():
            self.cycles.do_modal()
        stop = [v for letter, v in words if letter == "M" and v in STOPS]
        if 17.0 in stop and self.subprograms.returned():
            if {letter for letter, _ in words} <= {"M", "N"}:
                self.says_flow()
            return
        if stop:
            self.execute("m30" if stop[0] in (2, 17, 30) else f"m{stop[0]:.0f}")

    def _stop_exactly(self, words: Words, arc: str | None) -> None:
        """G9: an exact stop at the end of one block."""
        before = self.controller.path_control
        self.execute("g61.1")
        self._obey_words(words, arc)
        self.execute(before.lower())

    def says_flow(self) -> None:
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

    def _note(self, word: str) -> None:
        if word in ("NORM", "KONT"):
            self.tools.approach(word)
        else:
            self.controller.note(word, "screen, or following of the path")

    # for those who obey a block

    def unknown(self, *, call: str = "", m_code: int | None = None) -> ProgramError:
        """What the machine's builder made and the job does not say, all together."""
        return unknown_words(self, call=call, m_code=m_code)

    def only_in_xy(self, what: str) -> None:
        """Refuse what is worked out in the plane XY alone."""
        if self.controller.plane != 1:
            raise ProgramError(f"{what} in G18 or G19 is not read", accepted="G17")

    @contextmanager
    def plane_of_cycles(self) -> Iterator[None]:
        """Within it X Y Z are the axes of the plane and the one across, whichever they are."""
        before, self.cycle_plane = self.cycle_plane, self.controller.plane
        try:
            yield
        finally:
            self.cycle_plane = before

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
        if self.approach.waiting is not None:
            here[:3] = self.approach.waiting.end
        elif waiting is not None:
            here[:3] = *waiting.piece.end, waiting.end_level
        if self.cycle_plane != XY:
            here[:3] = [here[axis] for axis in PLANE_AXES[self.cycle_plane]]
        return here

    def execute(self, *blocks: str) -> None:
        """Hand blocks of RS274/NGC to the interpreter, in the lengths of the frame."""
        turned = _TURNED[self.cycle_plane]
        super().execute(
            *(self.units.converted(self.frame.scaled(block.translate(turned))) for block in blocks)
        )

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
        self.absolutely(f"{motion}{xy_words(x, y)}z{number(z)}")

    # subprograms

    def leave(self) -> bool:
        """End of a subprogram or of a part that is repeated."""
        self.corners.finish()
        return self.subprograms.leave()

    def source_line(self, index: int) -> int:
        """Line of the program; what a file beside it does is done by the line that calls it."""
        return self.subprograms.source_line or index + 1
