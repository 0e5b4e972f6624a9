"""SINUMERIK, block by block: motion, frames by TRANS, variables, jumps and loops, cycles."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from gcode.dialects.sinumerik.codes import ACCEPTED_G, CODES, NO_MOTION, SAME, STOPS
from gcode.dialects.sinumerik.corners import CORNERS, WaitingLine
from gcode.dialects.sinumerik.cycles import CYCLES, PATTERNS, drill, pattern_points
from gcode.dialects.sinumerik.expressions import Variables
from gcode.dialects.sinumerik.flow import Flow
from gcode.dialects.sinumerik.frames import ProgrammableFrame
from gcode.dialects.sinumerik.milling import MILLING, mill
from gcode.dialects.sinumerik.subprograms import Subprograms
from gcode.dialects.sinumerik.system_variables import system_variable
from gcode.errors import ProgramError
from gcode.geometry.three_points import centre_of_three
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.motion import frames
from gcode.motion.tangent import tangent_centre
from gcode.state.controller import Controller
from gcode.text.lexer import read_block

__all__ = ["SinumerikReader"]

_NUMBER = re.compile(r"\s*([+-]?\s*(?:\d+\.?\d*|\.\d+))")
_WORD = re.compile(
    r"\s*(CR|TURN|AP|RPL|RP|RNDM?|CHF|CHR|FRCM?|ADIS|DISC|[IJK]1(?=\s*=)|[A-Z])\s*(=?)",
    re.IGNORECASE,
)
_OWN = re.compile(r"\s*(AC|IC)\s*\(", re.IGNORECASE)
_HEAD = re.compile(
    r"(?:/\s*(\d?)\s*)?(?:[N:](\d+)\s*)?(?:/\s*(\d?)\s*)?(?:([A-Z_]\w+):(?!=)\s*)?", re.IGNORECASE
)
_ASSIGNED = re.compile(
    r"(R\d+|R\[.*?\]|[A-Z_][A-Z_]\w*(?:\[[^\]]*\])?)\s*=(?!=)\s*(.*)", re.IGNORECASE
)
_ADDRESSES = ("CR", "TURN", "AP", "RP", "RND", "RNDM", "CHF", "CHR", "FRC", "FRCM", "RPL", "ADIS",
              "DISC", "I1", "J1", "K1")  # fmt: skip
_NAMED_TOOL = re.compile(r"\bT\s*=\s*\"([^\"]*)\"", re.IGNORECASE)
_ARC_WORD = re.compile(r"\b(CIP|CT)\b", re.IGNORECASE)
_UNIFR = re.compile(
    r"\$P_UIFR\[\s*(\d+)\s*(?:,\s*([XYZ])\s*,\s*TR\s*)?\]\s*=\s*(.*)", re.IGNORECASE
)
_WORDS_ALONE = re.compile(r"(?:[A-Z]\d+(?:\.\d*)?)+", re.IGNORECASE)  #: G0X0Y0
_SUBPROGRAM = re.compile(
    r"(?:(MCALL|CALL)\s+)?\"?([A-Z_]\w+)\"?\s*(\(.*\))?(?:(?:\s+|(?<=\)))P\s*=?\s*(\w+))?\s*",
    re.IGNORECASE,
)
_DEFINED = re.compile(r"DEF\s+(?:NCK\s+|CHAN\s+)?(REAL|INT|BOOL)\s+(.*)", re.IGNORECASE)
_CALLED = re.compile(
    r"(MCALL\s+)?(CYCLE\d+|HOLES[12]|POCKET[34]|SLOT1|LONGHOLE)\s*\((.*)\)", re.IGNORECASE
)
_FRAME = re.compile(r"(A?TRANS|A?ROT|A?SCALE|A?MIRROR)\b\s*(.*)", re.IGNORECASE)
#: for the screen, or how the control follows the path
_NO_MOTION = re.compile(
    r"\b(?:(WORKPIECE|MSG|CYCLE832|CYCLE800|GROUP_BEGIN|GROUP_END|SETMS|EXTCALL_END)\s*"
    r"\((?:\"[^\"]*\"|[^)\"])*\)"
    rf"|({'|'.join(NO_MOTION)})\b)",
    re.IGNORECASE,
)
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
        self.edge = 1  #: D: cutting edge, 0 takes the tool offset off
        self.variables = Variables(system=lambda name, index: system_variable(self, name, index))
        self.subprograms = Subprograms(self)
        self.flow = Flow(self)
        self.frame = ProgrammableFrame(self)
        self.waiting: WaitingLine | None = None  #: line whose corner is to be broken
        self.modal: tuple[str, list[float | None]] | None = None  #: MCALL
        self.pole = [0.0, 0.0]
        self.meets = False  #: G451
        self.rounding = 0.0  #: RNDM
        self.is_modal_corner = False
        controller.start_up, controller.round_corners = "A", True
        self.execute("g21g90g17g40")

    # blocks

    def content(self, index: int) -> tuple[re.Match, str]:
        """Head and body of a line without comment."""
        return _split_head(self.lines[index])

    def obey(self, text: str) -> None:
        """Obey one line."""
        head, content = self.content(self.next - 1)
        if "/" in head.group() and self.options.skips(int(head[1] or head[3] or 1)):
            return
        if not content or content.startswith("%") or content.upper().startswith("PROC "):
            return
        if content.upper().split("(")[0].strip() == "RET":
            self._finish_line()
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
        declared, frame = _DEFINED.fullmatch(content), _FRAME.fullmatch(content)
        called, settable = _CALLED.fullmatch(content), _UNIFR.fullmatch(content)
        if declared is not None:
            self._declare(declared[2])
        elif frame is not None:
            self._finish_line()
            self.controller.use(frame[1].upper())
            self.frame.obey(frame[1].upper(), dict(self._words(frame[2])) if frame[2] else {})
        elif called is not None and called[2].upper() not in ("CYCLE832", "CYCLE800"):
            self._finish_line()
            self._cycle(called[2].upper(), self._arguments(called[3]), modal=bool(called[1]))
        elif settable is not None:
            self._settable_frame(settable)
        elif content.upper() == "MCALL":
            self.modal = None
        elif re.match(r"(?:EXTERN|DEF|ENDLABEL)\b", content, re.IGNORECASE):
            self.controller.note(content.split()[0].upper(), "declaration")
        elif not self._subprogram(content) and not self._assignments(content):
            self._block(content)

    def _subprogram(self, content: str) -> bool:
        """Go to a subprogram that stands alone in its block; tells whether one does."""
        match = _SUBPROGRAM.fullmatch(content)
        is_word = match is None or _NO_MOTION.fullmatch(content) or _ARC_WORD.fullmatch(content)
        if is_word or (_WORDS_ALONE.fullmatch(content) and not re.fullmatch(r"[Ll]\d+", content)):
            return False
        if match[2].upper() in ("RET", "M17"):
            return False
        arguments = self._arguments(match[3][1:-1]) if match[3] and match[3] != "()" else []
        self._finish_line()
        if (match[1] or "").upper() == "MCALL":
            self.modal = (match[2], arguments)
        else:
            rounds = int(self.variables.value(match[4])) if match[4] else 1
            self.subprograms.call(match[2], arguments, rounds)
        return True

    def _settable_frame(self, match: re.Match) -> None:
        """``$P_UIFR[1,X,TR]=10`` and ``$P_UIFR[1]=CTRANS(X,10,Y,5)``."""
        number_, axis, value = int(match[1]), match[2], match[3].strip()
        code = 10 if number_ < 1 else number_
        if axis is not None:
            self.execute(f"g10l2p{code}{axis.lower()}{number(self.variables.value(value))}")
            return
        chained = re.fullmatch(r"CTRANS\s*\((.*)\)", value, re.IGNORECASE)
        if chained is None or not 1 <= number_ <= 4:
            raise ProgramError(
                f"cannot read '$P_UIFR[{number_}]={value}'",
                accepted="$P_UIFR[1]=CTRANS(X,10,Y,5,Z,0), 1 to 4 for G54 to G57",
            )
        pieces = [piece.strip() for piece in self._split(chained[1])]
        said = dict(zip(pieces[::2], pieces[1::2], strict=False))
        words = "".join(
            f"{a}{number(self.variables.value(said.get(a, said.get(a.lower(), '0'))))}"
            for a in "XYZ"
        )
        self.execute(f"g10l2p{number_}{words.lower()}")

    def _declare(self, text: str) -> None:
        for piece in self._split(text):
            name, _, value = piece.partition("=")
            self.variables.declare(name.strip().upper(), value.strip())

    def _assignments(self, content: str) -> bool:
        """Obey ``R1=5 R2=R1*2``; tells whether the block holds nothing else."""
        found = _ASSIGNED.match(content)
        if found is None or found[1].upper() in _ADDRESSES:
            return False
        while found is not None and found[1].upper() not in _ADDRESSES:
            value, stop = self.variables.read(content, found.start(2))
            self.variables.assign(found[1].upper(), value)
            content = content[stop:].strip()
            found = _ASSIGNED.match(content)
        if content:
            self._block(content)
        return True

    def _block(self, content: str) -> None:
        tilted = _TILTED.search(content)
        if tilted and any(self._arguments(re.sub(r"\"[^\"]*\"", "", tilted[1]))[4:13]):
            raise ProgramError("CYCLE800 tilts the plane", accepted="CYCLE800()")
        content = _SUPPRESSED.sub("G53", _NO_MOTION.sub(self._noted, content)).strip()
        content = _NAMED_TOOL.sub(lambda m: f"T{self.controller.tool_named(m[1])}", content)
        arc = _ARC_WORD.search(content)
        words = self._words(_ARC_WORD.sub("", _MACHINE_AXIS.sub(r"\1=", content)))
        g_codes = [value for letter, value in words if letter == "G"]
        self._use(words, None if arc is None else arc[1].upper())
        if 4.0 in g_codes:
            self._dwell(words)
            return
        if {74.0, 75.0} & set(g_codes):
            self._fixed_point(words)
            return
        if {331.0, 332.0} & set(g_codes):
            words, g_codes = self._rigid_tap(words)
        self._tool(words)
        self._polar(words, g_codes)
        if self._break_corner(words, g_codes, is_arc=arc is not None):
            return
        self._side(words, g_codes)
        moved = any(letter in "XYZ" for letter, _ in words)
        if arc is not None:
            self._special_arc(arc[1].upper(), words)
        else:
            self.execute(self._text(words, g_codes))
        if self.modal is not None and moved:
            self._do_modal()
        stop = [v for letter, v in words if letter == "M" and v in STOPS]
        if 17.0 in stop and self.subprograms.returned():
            return
        if stop:
            self.execute("m30" if stop[0] in (2, 17, 30) else f"m{stop[0]:.0f}")

    def _use(self, words: list[tuple[str, float]], arc: str | None) -> None:
        for letter, value in words:
            if letter in "GM":
                self.controller.use(f"{letter}{value:g}")
            elif letter in _ADDRESSES:
                self.controller.use(letter)
        if arc is not None:
            self.controller.use(arc)

    def _fixed_point(self, words: list[tuple[str, float]]) -> None:
        """G74, G75: rapid to the reference or fixed point of the named axes."""
        self._finish_line()
        axes = "".join(f"{letter.lower()}0" for letter, _ in words if letter in "XYZ")
        self.controller.note("G74, G75", "fixed point of the machine: machine zero is taken")
        modal = self.controller.motion
        if axes:
            self.keep("a fixed point of the machine")
            self.execute(f"g53g0{axes}")
        self.controller.motion = modal

    def _rigid_tap(
        self, words: list[tuple[str, float]]
    ) -> tuple[list[tuple[str, float]], list[float]]:
        """G331 into the thread and G332 out of it: pitch I, J or K times the speed is the feed."""
        pitch = next((abs(v) for letter, v in words if letter in ("I", "J", "K")), 0.0)
        values = dict(words)
        if "S" in values:
            self.execute(f"s{number(values['S'])}")
        feed = pitch * self.controller.speed
        if not feed > 0.0:
            raise ProgramError("G331 and G332 need a pitch I, J or K, and S")
        self.keep("tapping by G331 and G332")
        left = [w for w in words if w[0] not in ("I", "J", "K", "S") and w[0] != "G"]
        codes = [1.0 if v in (331.0, 332.0) else v for letter, v in words if letter == "G"]
        return [*(("G", v) for v in codes), *left, ("F", feed)], codes

    def only_in_xy(self, what: str) -> None:
        """Refuse what is worked out in the plane XY alone."""
        if self.controller.plane != 1:
            raise ProgramError(f"{what} in G18 or G19 is not read", accepted="G17")

    # corners

    def _break_corner(
        self, words: list[tuple[str, float]], g_codes: list[float], *, is_arc: bool
    ) -> bool:
        """RND, CHF, CHR and RNDM: hold a line back; tells whether this block waits."""
        values = dict(words)
        if "RNDM" in values:
            self.rounding = values["RNDM"]
        size = [(k, values[k]) for k in CORNERS if k in values]
        words[:] = [
            w for w in words if w[0] not in (*CORNERS, "RNDM", "FRC", "FRCM", "ADIS", "DISC")
        ]
        motion = next((v for v in g_codes if v in (0.0, 1.0, 2.0, 3.0)), None)
        modal = "G1" if self.waiting is not None else self.controller.motion
        code = modal if motion is None else f"G{motion:g}"
        moves = any(letter in "XYZ" for letter, _ in words)
        is_line = code == "G1" and moves and not is_arc and "CR" not in values
        if not moves:
            return False
        if size or self.rounding:
            self.only_in_xy(size[0][0] if size else "RNDM")
        if self.waiting is None and not (is_line and (size or self.rounding)):
            if size:
                raise ProgramError(
                    f"{size[0][0]} beside anything but a line G1 is not read", accepted="two lines"
                )
            return False
        end, start = self._end(words, g_codes), tuple(self.here()[:3])
        if self.waiting is not None:
            self._finish_line(end if is_line else None)
        words[:] = [w for w in words if w[0] not in ("X", "Y", "Z")]
        if is_line and (size or self.rounding):
            kind, length = size[0] if size else ("RND", self.rounding)
            self._side(words, g_codes)
            self.execute("".join(f"g{v:.0f}" for v in g_codes if v in (90.0, 91.0)))
            head = self._text([w for w in words if w[0] != "G"], [])
            self.waiting = WaitingLine(start, end, kind, length, head)
            self.is_modal_corner = not size
            return True
        absolute = self.controller.absolute if not {90.0, 91.0} & set(g_codes) else 90.0 in g_codes
        words += [
            (axis, e if absolute else e - h)
            for axis, e, h in zip("XYZ", end, self.here(), strict=False)
        ]
        return False

    def _end(
        self, words: list[tuple[str, float]], g_codes: list[float]
    ) -> tuple[float, float, float]:
        """Programmed end X Y Z of a block."""
        here, values = self.here(), dict(words)
        absolute = self.controller.absolute if not {90.0, 91.0} & set(g_codes) else 90.0 in g_codes
        return tuple(
            values.get(a, h if absolute else 0.0) + (0.0 if absolute else h)
            for a, h in zip("XYZ", here, strict=False)
        )

    def _finish_line(self, following: tuple[float, float, float] | None = None) -> None:
        """Go along the line that waits, with its corner where a line follows."""
        held, self.waiting = self.waiting, None
        if held is None:
            return
        if following is None:
            if not self.is_modal_corner:
                raise ProgramError(f"{held.kind} without a line G1 behind it", accepted="two lines")
            x, y, z = held.end
            blocks = [f"{held.head}g90g1x{number(x)}y{number(y)}z{number(z)}"]
        else:
            blocks = held.blocks(following)
        absolute = self.controller.absolute
        self.execute(*blocks)
        self.controller.absolute, self.controller.motion = absolute, "G1"

    def _special_arc(self, kind: str, words: list[tuple[str, float]]) -> None:
        """CIP over a point I1 J1, CT as a continuation."""
        g_codes = [v for letter, v in words if letter == "G"]
        start, end = self.here(), self._end(words, g_codes)
        others = [w for w in words if w[0] not in ("X", "Y", "Z", "I1", "J1", "K1")]
        self.only_in_xy(kind)
        if kind == "CT":
            if self.controller.side:
                raise ProgramError("CT with cutter compensation is not read", accepted="G40")
            centre = tangent_centre(self.controller.record, start, end, self.controller.unit_mm)
        else:
            values = dict(words)
            absolute = self.controller.absolute
            via = [
                values.get(k, 0.0 if not absolute else h) + (0.0 if absolute else h)
                for k, h in zip(("I1", "J1"), start, strict=False)
            ]
            centre = centre_of_three(start[:2], via, end[:2])
            cross = (via[0] - start[0]) * (end[1] - start[1]) - (via[1] - start[1]) * (
                end[0] - start[0]
            )
            centre = (*centre, cross)
        x, y, sense = centre
        text = self._text(others, [])
        was = self.controller.absolute
        self.execute(
            text,
            f"g90g{3 if sense > 0 else 2}x{number(end[0])}y{number(end[1])}"
            f"z{number(end[2])}i{number(x - start[0])}j{number(y - start[1])}",
        )
        self.controller.absolute = was

    def _noted(self, found: re.Match) -> str:
        self.controller.note((found[1] or found[2]).upper(), "screen, or following of the path")
        return ""

    def _words(self, content: str) -> list[tuple[str, float]]:
        """Words with their values; those of AC and IC as the mode of the block has them."""
        words, position = [], 0
        while content[position:].strip():
            match = _WORD.match(content, position)
            letter = match[1].upper() if match else ""
            if match is None or (letter in _ADDRESSES and not match[2]):
                raise self._unknown(content[position:].strip())
            value, position = self._value(content, match, letter, words)
            words.append((letter, value))
        return words

    def _unknown(self, rest: str) -> ProgramError:
        word = re.match(r"\w+|.", rest)[0]
        return ProgramError(
            f"Sinumerik word '{word}' is not read",
            accepted="G M T D F S X Y Z A B C I J K CR= TURN= AP= RP= with numbers or expressions",
            hint="post the program without subprograms and frames that turn",
        )

    def _value(
        self, content: str, match: re.Match, letter: str, words: list[tuple[str, float]]
    ) -> tuple[float, int]:
        if not match[2]:
            found = _NUMBER.match(content, match.end())
            if found is None:
                raise self._unknown(content[match.start() :].strip())
            return float(re.sub(r"\s", "", found[1])), found.end()
        own = _OWN.match(content, match.end())
        if own is None:
            return self.variables.read(content, match.end())
        value, stop = self.variables.read(content, own.end())
        closing = re.compile(r"\s*\)").match(content, stop)
        if closing is None:
            raise ProgramError(f"'{own[1].upper()}(' is not closed")
        return self._as_mode(letter, value, own[1].upper(), words), closing.end()

    def _as_mode(
        self, letter: str, value: float, kind: str, words: list[tuple[str, float]]
    ) -> float:
        """AC and IC: the number that says the same in the mode of the block."""
        here = self.here()
        if letter in "IJK":
            return value - here["IJK".index(letter)] if kind == "AC" else value
        if letter not in "XYZABC":
            raise ProgramError(f"{kind} with {letter}", accepted="X Y Z A B C I J K")
        codes = [v for name, v in words if name == "G"]
        absolute = self.controller.absolute if not {90.0, 91.0} & set(codes) else 90.0 in codes
        place = here["XYZABC".index(letter)]
        if absolute:
            return value if kind == "AC" else value + place
        return value - place if kind == "AC" else value

    def here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        c = self.controller
        here = list(c.position)
        if c.side and not c.entering:
            here[:3] = c.programmed
        if self.waiting is not None:
            here[:3] = self.waiting.end
        return here

    def go(self, motion: str, *, z: float, feed: float | None = None) -> None:
        """Move along the tool axis to an absolute level."""
        c = self.controller
        before, c.absolute = c.absolute, True
        self.execute(f"{motion}z{number(z)}" + (f"f{number(feed)}" if feed else ""))
        c.absolute = before

    def place(self, motion: str, x: float, y: float, z: float) -> None:
        """Move to an absolute place."""
        c = self.controller
        before, c.absolute = c.absolute, True
        self.execute(f"{motion}x{number(x)}y{number(y)}z{number(z)}")
        c.absolute = before

    def _dwell(self, words: list[tuple[str, float]]) -> None:
        """G4 F is a time in seconds, G4 S a number of revolutions."""
        values = {k: v for k, v in words if k != "N"}
        if set(values) == {"G", "F"}:
            self.execute(f"g4p{number(values['F'])}")
        elif set(values) == {"G", "S"} and self.controller.speed > 0.0:
            self.execute(f"g4p{number(values['S'] * 60.0 / self.controller.speed)}")
        else:
            raise ProgramError("G4 takes F (seconds) or S (revolutions) alone in its block")

    def _tool(self, words: list[tuple[str, float]]) -> None:
        values = dict(words)
        if "T" in values:
            self.execute(f"t{values['T']:.0f}")
        edge = self.edge
        if "D" in values:
            if values["D"] not in (0.0, 1.0):
                raise ProgramError(f"cutting edge D{values['D']:g}", accepted="D0 D1")
            edge = int(values["D"])
        changed = any(letter == "M" and value == 6 for letter, value in words)
        if changed:
            self.execute("m6")
        if changed or edge != self.edge:
            self.edge = edge
            tool = self.controller.tool
            self.execute(f"g43h{tool}" if edge and tool else "g49")

    def _side(self, words: list[tuple[str, float]], g_codes: list[float]) -> None:
        """G40, G41, G42 with the radius of the tool in the spindle."""
        if {450.0, 451.0} & set(g_codes):
            self.meets = 451.0 in g_codes
        for code in (40.0, 41.0, 42.0):
            if code not in g_codes:
                continue
            words.remove(("G", code))
            c = self.controller
            side = {40.0: 0, 41.0: 1, 42.0: -1}[code]
            if side == c.side:
                continue
            if side and self.meets:
                raise ProgramError(
                    "G451 (outer corners at the intersection) with G41 or G42", accepted="G450"
                )
            if side and c.side:
                self.execute("g40")
            self.execute(f"g{code:.0f}d{c.tool}" if side else "g40")

    def _polar(self, words: list[tuple[str, float]], g_codes: list[float]) -> None:
        """G110 to G112 set the pole; AP and RP say a place about it."""
        values = dict(words)
        pole = next((code for code in (110.0, 111.0, 112.0) if code in g_codes), None)
        if pole is not None:
            base = {110.0: self.here()[:2], 111.0: [0.0, 0.0], 112.0: self.pole}[pole]
            self.pole = [base[0] + values.get("X", 0.0), base[1] + values.get("Y", 0.0)]
            words[:] = [w for w in words if w not in (("G", pole),) and w[0] not in "XY"]
            return
        if not {"AP", "RP"} & values.keys():
            return
        self.only_in_xy("AP and RP")
        here = self.here()
        out = here[0] - self.pole[0], here[1] - self.pole[1]
        radius, angle = values.get("RP", math.hypot(*out)), values.get("AP")
        angle = math.radians(angle) if angle is not None else math.atan2(out[1], out[0])
        if not self.controller.absolute and 90.0 not in g_codes:
            raise ProgramError("AP and RP in G91 are not read", accepted="G90")
        words[:] = [w for w in words if w[0] not in ("AP", "RP")]
        words += [
            ("X", self.pole[0] + radius * math.cos(angle)),
            ("Y", self.pole[1] + radius * math.sin(angle)),
        ]

    def _text(self, words: list[tuple[str, float]], g_codes: list[float]) -> str:
        text = []
        for letter, value in words:
            if letter == "G":
                text.append(self._code(value))
            elif letter == "M":
                if value not in STOPS and value != 6:
                    text.append(self._m_code(value))
            elif letter == "CR":
                text.append(f"r{number(value)}")
            elif letter == "TURN":
                text.append(f"p{value + 1:.0f}")
            elif letter in ("T", "D", "N"):
                continue
            elif letter in "XYZABCIJKFS":
                text.append(f"{letter.lower()}{number(value)}")
            elif letter == "H":
                self.controller.note(f"H{value:g}", "auxiliary function")
            else:
                raise self._unknown(f"{letter}{value:g}")
        block = "".join(text)
        if block and not read_block(block).g_codes and self.controller.motion in (None, "G80"):
            block = "g1" + block if any(w[0] in "XYZABC" for w in words) else block
        return block

    def _m_code(self, value: float) -> str:
        if value in self.options.control.ignore_m:
            self.controller.note(f"M{value:g}", "machine builder's code, ignored by ignore_m")
            return ""
        return f"m{value:g}"

    def _code(self, value: float) -> str:
        if 505.0 <= value <= 599.0:
            frames.select_system(self.controller, f"G54.1 P{value - 500.0:.0f}")
            return ""
        if value == 500.0 and not any(self.controller.origin):
            return ""
        if value in CODES and value != 500.0:
            return CODES[value]
        if value not in SAME:
            raise ProgramError(f"Sinumerik G{value:g} is not read", accepted=ACCEPTED_G)
        return f"g{value:.0f}"

    # frames and cycles

    @staticmethod
    def _split(text: str) -> list[str]:
        """Arguments between commas that stand in no bracket."""
        pieces, depth = [""], 0
        for letter in text:
            depth += (letter in "([") - (letter in ")]")
            if letter == "," and depth == 0:
                pieces.append("")
            else:
                pieces[-1] += letter
        return pieces

    def _arguments(self, text: str) -> list[float | None]:
        return [
            self.variables.value(piece) if piece.strip() else None for piece in self._split(text)
        ]

    def _cycle(self, name: str, arguments: list[float | None], *, modal: bool) -> None:
        self.controller.use(name)
        self.only_in_xy(name)
        if name in PATTERNS:
            if self.modal is None:
                raise ProgramError(
                    f"{name} without a cycle", accepted="MCALL CYCLE81(...) before it"
                )
            for x, y in pattern_points(name, arguments):
                self.execute(f"g90g0x{number(x)}y{number(y)}")
                self._do_modal()
        elif name in MILLING:
            mill(self, name, arguments)
        elif name not in CYCLES:
            known = (*sorted(CYCLES), *sorted(MILLING))
            raise ProgramError(f"{name} is not read", accepted=", ".join(known))
        elif modal:
            self.modal = (name, arguments)
        else:
            drill(self, name, arguments)

    def _do_modal(self) -> None:
        """The cycle or subprogram of MCALL at the present place."""
        name, arguments = self.modal
        if name in CYCLES:
            drill(self, name, arguments)
        else:
            self.subprograms.call(name, arguments)

    # subprograms

    def leave(self) -> bool:
        """End of a subprogram or of a part that is repeated."""
        self._finish_line()
        return self.subprograms.leave()

    def source_line(self, index: int) -> int:
        """Line of the program; what a file beside it does is done by the line that calls it."""
        return self.subprograms.source_line or index + 1
