"""Klartext, line by line: motion, labels, Q parameters and drilling cycles."""

from __future__ import annotations

import re

from gcode.dialects.heidenhain.approach import approach, depart
from gcode.dialects.heidenhain.block_text import bare, joined_blocks, key_word
from gcode.dialects.heidenhain.cycles.calls import CycleCalls
from gcode.dialects.heidenhain.flow import KlartextFlow, measuring_cycle
from gcode.dialects.heidenhain.frames import KlartextFrames
from gcode.dialects.heidenhain.m_functions import only_m, without_words_of_m
from gcode.dialects.heidenhain.motion import KlartextMotion
from gcode.dialects.heidenhain.motion_words import motion_words
from gcode.dialects.heidenhain.parameters import QParameters
from gcode.dialects.heidenhain.plane import is_flat_plane
from gcode.dialects.heidenhain.tool_call import call_tool, tool_data, tool_of_spindle
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["KlartextReader"]

_OUTPUTS = (15, 16, 38)  #: FN that print or send
_FEED = re.compile(r"f([-+]?[\d.]+)")


class KlartextReader(Translated):
    """Runs Klartext; every line becomes blocks of RS274/NGC."""

    ending = ".h"  #: of files with programs

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        controller.start_up, controller.round_corners_from = "A", 0.0
        self.parameters = QParameters()
        self.parameters.remember(options.control.variables)
        self.called_at: int | None = None  #: line of the main program that calls this one
        self.depth = 0
        self.stopped = False  #: M2 or M30, which end the calling programs too
        self.cycles = CycleCalls(self)
        self.frames = KlartextFrames(self)
        self.motion = KlartextMotion(self)
        self.flow = KlartextFlow(self)
        self.contents = joined_blocks(lines)
        computed = self.parameters.computed
        computed["108"] = lambda: tool_of_spindle(self).offset_diameter_mm / 2.0
        computed["114"] = lambda: tool_of_spindle(self).offset_length_mm
        computed["109"] = lambda: 2.0
        self.parameters.tool_data = lambda asked: tool_data(self, asked)

    def use_fast_lane(self, source: Source) -> None:
        """Give stretches of lines to compiled code."""
        from gcode.dialects.heidenhain.lane import KlartextLane  # loads the compiler

        self.lane = KlartextLane(self, source.data, source.line_starts)

    def content(self, index: int) -> str:
        """A line without number, comment and structure, in upper case."""
        text = self.contents.get(index)
        if text is None:
            text = self.contents[index] = bare(self.lines[index])
        return text

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = self.content(self.next - 1)
        if content.startswith("/"):
            if self.options.skips(1):
                self._skip_parameters()
                return
            content = content[1:].strip()
        if not content or content.startswith(("*", "~")):
            return
        head, corners = re.match(r"[A-Z]+|", content)[0], self.motion.corners
        self.controller.use(key_word(content))
        if head in ("L", "C", "CR", "CT", "LP", "CP"):
            self.motion.move(head, content[len(head) :])
            return
        for start, action in (
            ("BEGIN PGM", self._begin), ("END PGM", self._end),
            ("BLK FORM", lambda _: self.noted("BLK FORM", "blank for the control's graphics")),
            ("TOOL CALL", lambda text: call_tool(self, text)), ("TOOL DEF", lambda _: self.noted(
                "TOOL DEF", "tool preselection; its dimensions are those of the job")),
            ("CYCL DEF", self.cycles.define), ("CYCL CALL", self.cycles.call),
            ("PATTERN DEF", self.cycles.define_pattern),
            ("APPR", lambda text: approach(self, text)), ("DEP", lambda text: depart(self, text)),
            ("CALL PGM", self.flow.call_program),
            ("CALL SELECTED PGM", self.flow.call_program), ("CALL LBL", self.flow.call_label),
            ("LBL", self.flow.label), ("CC", self.motion.define_pole),
            ("FN", self._function), ("RND", corners.define), ("CHF", corners.define),
            ("PLANE", self._plane), ("FUNCTION", self._control_function),
            ("TRANS", self.frames.transform), ("SEL PGM", self.flow.select_program),
            ("TCH PROBE", self._measure), ("STOP", lambda _: self.execute("m0")),
            ("M", lambda text: only_m(self, text)),
        ):  # fmt: skip
            if content.startswith(start):
                action(content)
                return
        if not self.parameters.assign(content):
            raise ProgramError(
                f"Klartext word '{head or content}' is not read",
                accepted="L C CR CT CC LP CP RND CHF LBL CALL LBL TOOL CALL FN Q CYCL DEF STOP M",
                hint="post the program with plain lines and arcs",
            )

    def _skip_parameters(self) -> None:
        """Leave out the further lines of a block that is skipped."""
        while self.next < self.stop and self.lines[self.next - 1].rstrip().endswith("~"):
            self.next += 1

    def noted(self, word: str, meaning: str) -> None:
        """Note a word that moves nothing here."""
        self.controller.note(word, meaning)

    def _begin(self, content: str) -> None:
        self.execute("g20" if content.endswith("INCH") else "g21", "g17g90g40g80")

    def _end(self, _: str) -> None:
        if self.called_at is None:
            self.execute("m30")
        self.ended = True

    def source_line(self, index: int) -> int:
        """Line of the program; what a called program does is done by the line that calls it."""
        return self.own_line(index) if self.called_at is None else self.called_at

    def own_line(self, index: int) -> int:
        """1-based line of the file that is read."""
        return index + 1

    def apart(self, controller: Controller) -> KlartextReader:
        """The same lines for another controller."""
        return KlartextReader(controller, list(self.lines), self.options)

    def _measure(self, content: str) -> None:
        name = measuring_cycle(content)
        if name is None or not self.options.control.ignores(name):
            raise self.flow.unknown_calls(name or content)
        self.noted(name, "left out by ignore_calls; the zero is that of the job")

    def _plane(self, content: str) -> None:
        is_flat = is_flat_plane(content, self.parameters.number)
        if not is_flat and not content.startswith("PLANE RESET"):
            raise ProgramError(f"'{content}' tilts the plane", accepted="PLANE RESET")
        self.parameters.values |= dict.fromkeys(("120", "121", "122"), 0.0)  # angles of A B C
        self.noted("PLANE RESET", "no tilted plane")

    def _control_function(self, content: str) -> None:
        if re.search(r"TCPM|TURN|PARAX|FACING", content) and "RESET" not in content:
            raise ProgramError(f"'{content}' is not read", accepted="milling with three axes")
        self.noted("FUNCTION", "mode of the control")

    def execute(self, *blocks: str) -> None:
        """Hand blocks of RS274/NGC to the interpreter; F of an inch program counts 0.1 inch/min."""
        if self.controller.unit_mm != 1.0:
            blocks = tuple(
                _FEED.sub(lambda m: f"f{number(float(m[1]) / 10.0)}", text) for text in blocks
            )
        super().execute(*blocks)

    # words and places

    def words(self, content: str) -> tuple[dict[str, float | str | None], list[int]]:
        """Words of a motion line in the control's lengths, and its M codes."""
        content = without_words_of_m(self, self.motion.plunging(content))
        words, codes = motion_words(content, self.parameters.number)
        scaling = self.frames.scaling
        if not scaling.is_identity and not {91, 92} & set(codes):
            self.keep("scaling")
            words = scaling.applied(words)
        return words, codes

    def here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        return self.motion.here()

    # Q parameters

    def _function(self, content: str) -> None:
        match = re.match(r"FN\s*(\d+)\s*:?\s*(.*)", content)
        if match is None:
            raise ProgramError(f"cannot read '{content}'", accepted="FN 0: Q1 = +5")
        if int(match[1]) == 14:
            raise ProgramError(f"the program stops itself: {content}")
        if int(match[1]) in _OUTPUTS:
            self.noted(f"FN {match[1]}", "text for a file, a screen or a printer")
            return
        label = self.parameters.function(int(match[1]), match[2].strip())
        if label is not None:
            self.next = self.flow.find(label) + 1
