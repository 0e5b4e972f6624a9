"""Klartext, line by line: motion, labels, Q parameters and drilling cycles."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace

from gcode.dialects.heidenhain.approach import approach, depart
from gcode.dialects.heidenhain.block_text import bare, joined_blocks, key_word
from gcode.dialects.heidenhain.cycle_calls import CycleCalls
from gcode.dialects.heidenhain.flow import KlartextFlow
from gcode.dialects.heidenhain.frames import KlartextFrames
from gcode.dialects.heidenhain.parameters import NUMBER, QParameters
from gcode.dialects.heidenhain.plane import is_flat_plane
from gcode.errors import ProgramError
from gcode.geometry.corners import broken_corner
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.motion.tangent import tangent_centre
from gcode.state.controller import Controller
from gcode.state.tools import ToolEntry

__all__ = ["KlartextReader"]

_WORD = re.compile(
    r"(I?[XYZABC]|I?P[RA]|DR|R[0LR](?![\d.])|LEN|MB|F\s*(?:MAX|AUTO)|F|S|M|R|[A-Z]+)\s*"
    rf"({NUMBER}|MAX)?\s*([+-])?(?=\s|$|[A-Z])"
)
_ACCEPTED = "X Y Z IX IY IZ PR PA IPA R DR RL RR R0 F FMAX M"
_TOOL = re.compile(r"TOOL CALL(?:\s+(\d+|Q\d+|\"[^\"]*\"))?(?:\s+([XYZ])(?!\w))?(.*)")
_TOOL_WORD = re.compile(rf"\s*(DL|DR2|DR|S|F)\s*({NUMBER})")
_PLAIN_M = {3: "m3", 4: "m4", 5: "m5", 7: "m7", 8: "m8", 9: "m9", 0: "m0", 1: "m1", 6: ""}
_FIRST_M = frozenset((3, 4, 7, 8, 13, 14))
#: M functions that move nothing here: feeds at corners, look-ahead, rotary axes that stand still
_NOTED_M = {90: "corners", 94: "rotary display", 103: "plunging feed", 107: "oversize", 108: "",
            109: "feed at the edge", 110: "feed at inner arcs", 111: "feed of the centre",
            112: "corners", 113: "corners", 117: "", 118: "handwheel", 120: "look-ahead",
            124: "points left out", 126: "short way of rotary axes", 127: "", 129: "TCPM off",
            134: "", 135: "", 137: "", 138: "", 141: "", 142: "", 143: "", 145: "", 148: "",
            149: "", 150: "", 197: ""}  # fmt: skip
#: M functions that change the path or its feed
_REFUSED_M = {97: "small steps of a contour", 98: "open corners", 116: "feed of rotary axes",
              128: "tool centre point", 136: "feed per revolution", 144: "tilted head"}  # fmt: skip


class KlartextReader(Translated):
    """Runs Klartext; every line becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        controller.start_up, controller.round_corners = "A", True
        self.pole: tuple[float, float] | None = None
        self.feed: float | None = None
        self.tool_feed: float | None = None
        self.parameters = QParameters()
        self.called_at: int | None = None  #: line of the main program that calls this one
        self.depth = 0
        self.stopped = False  #: M2 or M30, which end the calling programs too
        self.cycles = CycleCalls(self)
        self.frames = KlartextFrames(self)
        self.corner: tuple[str, float] | None = None  #: RND or CHF that waits
        #: start and end of the line before it
        self.held: tuple[list[float], tuple[float, ...]] | None = None
        #: end of the last programmed line or arc, and its direction there
        self.tangent: tuple[tuple[float, ...], float, float] | None = None
        self.flow = KlartextFlow(self)
        self.contents = joined_blocks(lines)
        computed = self.parameters.computed
        computed["108"] = lambda: self.tool_of_spindle().offset_diameter_mm / 2.0
        computed["114"] = lambda: self.tool_of_spindle().offset_length_mm
        computed["109"] = lambda: 2.0
        self.parameters.tool_data = self._tool_data

    def tool_of_spindle(self) -> ToolEntry:
        return self.controller.offsets.get(self.controller.tool, ToolEntry())

    def _tool_data(self, asked: str) -> float | None:
        """What FN 18 is told of the tools: ID20 NR1 number, ID50 NR1 length and NR2 radius."""
        match = re.match(rf"(?:SYSREAD\s+)?ID\s*(20|50)\s*NR\s*([12])\s*(?:IDX\s*({NUMBER}))?$",
                         asked.strip())  # fmt: skip
        if match is None or (match[1] == "20") != (match[3] is None) or match.group(1, 2) == (
            "20", "2"
        ):  # fmt: skip
            return None
        if match[1] == "20":
            return float(self.controller.tool)
        entry = self.controller.first_offsets.get(
            number_ := int(self.parameters.number(match[3])),
            self.controller.offsets.get(number_, ToolEntry()),
        )
        size = entry.length_mm if match[2] == "1" else entry.diameter_mm / 2.0
        return size / self.controller.unit_mm

    def content(self, index: int) -> str:
        """A line without number, comment and structure, in upper case."""
        text = self.contents.get(index)
        if text is None:
            text = self.contents[index] = bare(self.lines[index])
        return text

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = self.content(self.next - 1)
        if not content or content.startswith(("*", "~")):
            return
        if content.startswith("/"):
            if self.options.skips(1):
                return
            content = content[1:].strip()
        head = re.match(r"[A-Z]+|", content)[0]
        self.controller.use(key_word(content))
        if head in ("L", "C", "CR", "CT", "LP", "CP"):
            self._move(head, content[len(head) :])
            return
        for start, action in (
            ("BEGIN PGM", self._begin), ("END PGM", self._end),
            ("BLK FORM", lambda _: self._noted("BLK FORM", "blank for the control's graphics")),
            ("TOOL CALL", self._tool_call), ("TOOL DEF", lambda _: self._noted(
                "TOOL DEF", "tool preselection; its dimensions are those of the job")),
            ("CYCL DEF", self.cycles.define), ("CYCL CALL", self.cycles.call),
            ("PATTERN DEF", self.cycles.define_pattern),
            ("APPR", lambda text: approach(self, text)), ("DEP", lambda text: depart(self, text)),
            ("CALL PGM", self.flow.call_program), ("CALL LBL", self.flow.call_label),
            ("LBL", self.flow.label), ("CC", self._centre),
            ("FN", self._function), ("RND", self._corner), ("CHF", self._corner),
            ("PLANE", self._plane), ("FUNCTION", self._control_function),
            ("STOP", lambda _: self.execute("m0")), ("M", self._only_m),
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

    def _noted(self, word: str, meaning: str) -> None:
        self.controller.note(word, meaning)

    def _begin(self, content: str) -> None:
        self.execute("g20" if content.endswith("INCH") else "g21", "g17g90g40g80")

    def _end(self, _: str) -> None:
        if self.called_at is None:
            self.execute("m30")
        self.ended = True

    def source_line(self, index: int) -> int:
        """Line of the program; what a called program does is done by the line that calls it."""
        return index + 1 if self.called_at is None else self.called_at

    def _plane(self, content: str) -> None:
        is_flat = is_flat_plane(content, self.parameters.number)
        if not is_flat and not content.startswith("PLANE RESET"):
            raise ProgramError(f"'{content}' tilts the plane", accepted="PLANE RESET")
        self.parameters.values |= dict.fromkeys(("120", "121", "122"), 0.0)  # angles of A B C
        self._noted("PLANE RESET", "no tilted plane")

    def _control_function(self, content: str) -> None:
        if re.search(r"TCPM|TURN|PARAX|FACING", content) and "RESET" not in content:
            raise ProgramError(f"'{content}' is not read", accepted="milling with three axes")
        self._noted("FUNCTION", "mode of the control")

    # M functions

    def _only_m(self, content: str) -> None:
        if re.search(r"M\s*140\b", content):
            self._move("L", content)
            return
        if not re.fullmatch(r"(?:M\s*\d+\s*)+", content):
            raise ProgramError(f"cannot read '{content}'", accepted="M with a number")
        for code in map(int, re.findall(r"M\s*(\d+)", content)):
            if code == 99:
                self.cycles.do()
            else:
                self.execute(self.m_code(code))

    def m_code(self, code: int) -> str:
        """Block of an M function; nothing for one that moves nothing here."""
        self.controller.use(f"M{code}")
        if code in _REFUSED_M:
            raise ProgramError(f"M{code} ({_REFUSED_M[code]}) is not read",
                               accepted="milling with three axes")  # fmt: skip
        if code in (13, 14):
            return f"m{code - 10}m8"
        if code in (2, 30):
            self.stopped = True
            return "m30"
        if code in _NOTED_M or code in self.options.control.ignore_m:
            self._noted(f"M{code}", _NOTED_M.get(code) or "moves nothing here")
            return ""
        if code == 89:
            self.cycles.modal = True
            return ""
        if code not in _PLAIN_M:
            raise ProgramError(
                f"M{code} is not read",
                accepted="M0 M1 M2 M3-M6 M7-M9 M13 M14 M30 M89 M91 M99; others "
                f"that move nothing by ignore_m = [{code}] in [control]",
            )
        return _PLAIN_M[code]

    # words

    def words(self, content: str) -> tuple[dict[str, float | str | None], list[int]]:
        """Words of a motion line, and its M codes."""
        words: dict[str, float | str | None] = {}
        codes, position = [], 0
        for match in _WORD.finditer(content):
            if content[position : match.start()].strip():
                break
            position = match.end()
            letter, value, sign = re.sub(r"\s", "", match[1]), match[2], match[3]
            if letter == "M":  # early controls write an M without a number
                codes += [] if value is None else [int(self.parameters.number(value))]
            elif letter == "DR" and (sign or value is None):
                words["DR"] = sign
            elif letter == "MB":
                words["MB"] = None if value in (None, "MAX") else self.parameters.number(value)
            elif letter in ("R0", "RL", "RR", "FMAX", "FAUTO") and value is None:
                words[letter] = None
            elif letter in ("R", "F") and value is None:  # early controls: as before
                continue
            elif value in (None, "MAX") or letter not in _LETTERS:
                raise ProgramError(f"Klartext word '{letter}' is not read in a motion line",
                                   accepted=_ACCEPTED)  # fmt: skip
            elif letter in words:
                raise ProgramError(f"two {letter} words in one line")
            else:
                words[letter] = self.parameters.number(value)
        if content[position:].strip():
            raise ProgramError(f"cannot read '{content[position:].strip()}'", accepted=_ACCEPTED)
        scaling = self.frames.scaling
        if not scaling.is_identity and not {91, 92} & set(codes):
            self.keep("scaling")
            words = scaling.applied(words)
        return words, codes

    def here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        c = self.controller
        if self.held is not None:
            return list(self.held[1])
        here = list(c.position)
        if c.side and not c.entering:
            here[:3] = c.programmed
        return here

    def target(self, words: dict[str, float | str | None]) -> tuple[float, ...]:
        """X Y Z A B C where the line ends."""
        end = self.here()
        for axis, letter in enumerate("XYZABC"):
            if letter in words and "I" + letter in words:
                raise ProgramError(f"{letter} and I{letter} in one line")
            end[axis] = words.get(letter, end[axis] + words.get("I" + letter, 0.0))
        return tuple(end)

    def _polar_target(self, words: dict[str, float | str | None]) -> tuple[float, ...]:
        """PR, PA, IPR, IPA about the pole, and the tool axis."""
        if self.pole is None:
            raise ProgramError("polar coordinates without a pole", hint="give CC first")
        here = self.here()
        out = here[0] - self.pole[0], here[1] - self.pole[1]
        radius = words.get("PR", math.hypot(*out) + words.get("IPR", 0.0))
        before = math.degrees(math.atan2(out[1], out[0]))
        angle = math.radians(words.get("PA", before + words.get("IPA", 0.0)))
        end = list(self.target({k: v for k, v in words.items() if k[-1] in "ZABC"}))
        end[0] = self.pole[0] + radius * math.cos(angle)
        end[1] = self.pole[1] + radius * math.sin(angle)
        return tuple(end)

    def _centre(self, content: str) -> None:
        words, _ = self.words(content.removeprefix("CC"))
        if words.keys() & {"Z", "IZ"}:
            raise ProgramError("a circle centre with Z: circles in planes of Z are not read",
                               accepted="CC X Y")  # fmt: skip
        if "PR" in words or "PA" in words or "IPA" in words:
            self.pole = self._polar_target(words)[:2]
        else:
            self.pole = self.target(words)[:2]

    # motion

    def _move(self, head: str, content: str) -> None:
        words, codes = self.words(content)
        before = [self.m_code(c) for c in codes if c in _FIRST_M]
        after = [self.m_code(c) for c in codes if c not in _FIRST_M and c not in (91, 92, 99, 140)]
        if "F" in words:
            self.feed = words["F"]
        if "FAUTO" in words:
            self.feed = self.tool_feed
        for code in {91, 92, 99, 140} & set(codes):
            self.controller.use(f"M{code}")
        if 140 in codes:
            self._retract(words)
        self.execute(*before, self._side(words))
        blocks = self._line(head, words, codes) if head in ("L", "LP") else self._arc(head, words)
        self.execute(blocks, *after)
        if 99 in codes or (self.cycles.modal and {"X", "Y"} & words.keys()):
            self.cycles.modal = self.cycles.modal and 99 not in codes
            self.cycles.do()

    def _retract(self, words: dict[str, float | str | None]) -> None:
        """M140 MB: away from the part along the tool axis, MB MAX to the end of the travel."""
        height = words.pop("MB", None)
        feed = words.pop("F", None)
        c = self.controller
        if height is None:
            top = c.machine_position()
            top[2] = max(top[2], 0.0)
            level = c.from_machine(top)[2]
            self._noted("M140 MB MAX", "to the end of the travel: machine zero of Z is taken")
        else:
            level = self.here()[2] + height
        self.execute(
            f"g0z{number(level)}" if feed is None else f"g1z{number(level)}f{number(feed)}"
        )

    def _side(self, words: dict[str, float | str | None]) -> str:
        """G40, G41 or G42 where the line changes it."""
        side = next((k for k in ("R0", "RL", "RR") if k in words), None)
        c = self.controller
        wanted = {"R0": 0, "RL": 1, "RR": -1, None: c.side}[side]
        c.use(side or "R0")
        if wanted == c.side:
            return ""
        if wanted and c.side:
            raise ProgramError("RL and RR without R0 between them")
        return f"g{41 if wanted > 0 else 42}d{c.tool}" if wanted else "g40"

    def _line(self, head: str, words: dict[str, float | str | None], codes: list[int]) -> str:
        rapid = "FMAX" in words
        if 92 in codes:
            if not rapid:
                raise ProgramError("M92 at feed: its datum is a parameter of the machine",
                                   accepted="M91, or FMAX")  # fmt: skip
            self._noted("M92", "its datum is a parameter of the machine; that of M91 is taken")
        if 91 in codes or 92 in codes:
            if any("I" + letter in words for letter in "XYZABC"):
                raise ProgramError("incremental words with M91")
            axes = [(letter, words[letter]) for letter in "XYZABC" if letter in words]
            motion = "g53g0" if rapid else "g53g1"
        else:
            end = self._polar_target(words) if head == "LP" else self.target(words)
            named = {name[-1] for name in words if name.lstrip("I") in ("X", "Y", "Z", *"ABC")}
            named |= {"X", "Y"} if head == "LP" else set()
            motion = "g0" if rapid else "g1"
            axes = [(a, end[k]) for k, a in enumerate("XYZABC") if a in named]
            self._round_towards(end, rapid=rapid)
            self.tangent = end[:2], end[0] - self.here()[0], end[1] - self.here()[1]
            if self._waits() and not rapid:
                self.held = (self.here(), end)
                return ""
        if not axes:
            return ""
        return motion + "".join(f"{a}{number(v)}" for a, v in axes) + self.feed_word(rapid)

    def last_direction(self, end: Sequence[float]) -> tuple[float, float]:
        """Unit direction of the contour at its last programmed point.

        Raises
        ------
        ProgramError
            The last block was no line L, LP or arc C, CR that ends there.
        """
        there, x, y = self.tangent or ((math.nan, math.nan), 0.0, 0.0)
        size = math.hypot(x, y)
        if math.dist(there, end) > 1e-9 or size == 0.0:
            raise ProgramError("DEP needs a line L or an arc C or CR before it")
        return x / size, y / size

    def feed_word(self, rapid: bool) -> str:
        """F word of a move; none of a rapid."""
        if rapid:
            return ""
        if self.feed is None:
            raise ProgramError("motion without feed", hint="give F or FMAX")
        return f"f{number(self.feed)}"

    def _arc(self, head: str, words: dict[str, float | str | None]) -> str:
        if self.corner is not None or self.held is not None:
            raise ProgramError(
                "RND or CHF between a line and an arc is not read", accepted="two lines"
            )
        end = self._polar_target(words) if head == "CP" else self.target(words)
        start = self.here()
        if head == "CT":
            return self._tangent_arc(start, end)
        if words.get("DR") not in ("+", "-"):
            raise ProgramError(f"{head} without DR+ or DR-")
        code = "g3" if words["DR"] == "+" else "g2"
        text = f"{code}x{number(end[0])}y{number(end[1])}"
        if end[2] != start[2]:
            text += f"z{number(end[2])}"
        sense = 1.0 if words["DR"] == "+" else -1.0
        if head == "CR":
            if "R" not in words:
                raise ProgramError("CR without R")
            centre = _centre_of_radius(start, end, words["R"] * sense)
            self.tangent = end[:2], (centre[1] - end[1]) * sense, (end[0] - centre[0]) * sense
            return text + f"r{number(words['R'])}" + self.feed_word(False)
        if self.pole is None:
            raise ProgramError("C without a circle centre", hint="give CC first")
        self.tangent = (end[:2], (self.pole[1] - end[1]) * sense, (end[0] - self.pole[0]) * sense)
        turns = abs(words.get("IPA", 0.0)) / 360.0
        if turns > 1.0 + 1e-9:
            text += f"p{math.ceil(turns - 1e-9)}"
        offsets = (self.pole[0] - start[0], self.pole[1] - start[1])
        return text + f"i{number(offsets[0])}j{number(offsets[1])}" + self.feed_word(False)

    def _tangent_arc(self, start: list[float], end: tuple[float, ...]) -> str:
        """CT: the arc that goes on from the line or arc before it without a corner."""
        c = self.controller
        if c.side:
            raise ProgramError("CT with radius compensation is not read", accepted="R0")
        x, y, sense = tangent_centre(c.record, start, end, c.unit_mm)
        text = f"{'g3' if sense > 0.0 else 'g2'}x{number(end[0])}y{number(end[1])}"
        if end[2] != start[2]:
            text += f"z{number(end[2])}"
        return text + f"i{number(x - start[0])}j{number(y - start[1])}" + self.feed_word(False)

    # RND and CHF

    def _corner(self, content: str) -> None:
        """RND R5, CHF 5: the line before has waited for it."""
        found = re.fullmatch(rf"(RND|CHF)\s*R?\s*({NUMBER})(?:\s*F\s*{NUMBER})?", content)
        if found is None:
            raise ProgramError(f"cannot read '{content}'", accepted="RND R5 or CHF 5")
        if self.held is None:
            raise ProgramError(
                f"{found[1]} behind anything but a line L is not read", accepted="two lines"
            )
        scale = self.frames.scaling.of_radii
        self.corner = (found[1], self.parameters.number(found[2]) * scale)

    def _waits(self) -> bool:
        """Whether RND or CHF stands in the next line."""
        return self.next < len(self.lines) and bool(
            re.match(r"(?:RND|CHF)\b", self.content(self.next))
        )

    def _round_towards(self, end: tuple[float, ...], *, rapid: bool) -> None:
        """Go along the line that waits, and round its corner."""
        held, corner = self.held, self.corner
        self.held = self.corner = None
        if held is None:
            return
        if corner is None or rapid:
            raise ProgramError("a line with RND or CHF needs a line at feed behind it")
        start, middle = held
        broken = broken_corner(start[:2], middle[:2], end[:2], corner[1],
                               chamfer=corner[0] == "CHF")  # fmt: skip
        first, second, sense = broken or (middle[:2], middle[:2], 0)
        level = "" if middle[2] == start[2] else f"z{number(middle[2])}"
        self.execute(f"g1x{number(first[0])}y{number(first[1])}{level}" + self.feed_word(False))
        if sense and corner[0] == "RND":
            self.execute(f"g{3 if sense > 0 else 2}x{number(second[0])}y{number(second[1])}"
                         f"r{number(corner[1])}")  # fmt: skip
        elif sense:
            self.execute(f"g1x{number(second[0])}y{number(second[1])}")

    # tools

    def _tool_call(self, content: str) -> None:
        match = _TOOL.fullmatch(content)
        said = match[1]
        rest = match[3]
        if match[2] not in (None, "Z") or _TOOL_WORD.sub("", rest).strip():
            raise ProgramError(
                f"cannot read '{content}'", accepted="TOOL CALL 1 Z S3500 F500 DL+0.1 DR-0.05"
            )
        words = {k: self.parameters.number(v) for k, v in _TOOL_WORD.findall(rest)}
        if "S" in words:
            self.execute(f"s{number(words['S'])}")
        if "F" in words:
            self.feed = self.tool_feed = words["F"]
        if said is None:
            if words.keys() & {"DL", "DR"}:
                self._apply_oversize(self.controller.tool, words)
                self.execute(f"g43h{self.controller.tool}")
            return
        named = said.startswith('"')
        tool = (
            self.controller.tool_named(said[1:-1]) if named else int(self.parameters.number(said))
        )
        self.execute("g40", f"t{tool}m6")
        if tool:
            self._apply_oversize(tool, words)
            self.execute(f"g43h{tool}")
        else:
            self.execute("g49")

    def _apply_oversize(self, tool: int, words: dict[str, float]) -> None:
        """DL and DR of the call, for as long as the tool is in the spindle."""
        c = self.controller
        c.check_tool(tool, word="TOOL CALL ")
        unit = c.unit_mm
        entry = c.first_offsets[tool] if tool in c.first_offsets else c.find_offset(tool, word="H")
        c.offsets[tool] = replace(
            entry,
            length_wear_mm=entry.length_wear_mm + words.get("DL", 0.0) * unit,
            diameter_wear_mm=entry.diameter_wear_mm + 2.0 * words.get("DR", 0.0) * unit,
        )

    # Q parameters

    def _function(self, content: str) -> None:
        match = re.match(r"FN\s*(\d+)\s*:?\s*(.*)", content)
        if match is None:
            raise ProgramError(f"cannot read '{content}'", accepted="FN 0: Q1 = +5")
        if int(match[1]) == 14:
            raise ProgramError(f"the program stops itself: {content}")
        label = self.parameters.function(int(match[1]), match[2].strip())
        if label is not None:
            self.next = self.flow.find(label) + 1


def _centre_of_radius(
    start: Sequence[float], end: Sequence[float], radius: float
) -> tuple[float, float]:
    """Centre of CR; the radius is positive where a short arc turns counter-clockwise."""
    x, y = end[0] - start[0], end[1] - start[1]
    chord = math.hypot(x, y)
    rise = math.sqrt(max(radius * radius - chord * chord / 4.0, 0.0))
    side = math.copysign(rise, radius) / chord if chord else 0.0
    return start[0] + x / 2.0 - y * side, start[1] + y / 2.0 + x * side


_LETTERS = frozenset(("X", "Y", "Z", "A", "B", "C", "IX", "IY", "IZ", "IA", "IB", "IC", "F", "R",
                      "S", "PR", "PA", "IPR", "IPA"))  # fmt: skip
