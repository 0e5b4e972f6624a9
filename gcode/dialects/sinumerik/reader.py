"""SINUMERIK, block by block: motion, frames by TRANS, variables, jumps and loops, cycles."""

from __future__ import annotations

import math
import re

from gcode.control.loop_guard import LoopGuard
from gcode.dialects.sinumerik.cycles import CYCLES, PATTERNS, drill, pattern_points
from gcode.dialects.sinumerik.expressions import Variables
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.state.controller import Controller
from gcode.text.lexer import read_block

__all__ = ["SinumerikReader"]

_NUMBER = re.compile(r"\s*([+-]?\s*(?:\d+\.?\d*|\.\d+))")
_WORD = re.compile(r"\s*(CR|TURN|AP|RP|[A-Z])\s*(=?)", re.IGNORECASE)
_OWN = re.compile(r"\s*(AC|IC)\s*\(", re.IGNORECASE)
_HEAD = re.compile(r"(?:/\s*(\d?)\s*)?(?:[N:](\d+)\s*)?(?:/\s*(\d?)\s*)?(?:([A-Z_]\w+):(?!=)\s*)?",
                   re.IGNORECASE)  # fmt: skip
_KEYWORD = re.compile(
    r"(IF|ELSE|ENDIF|WHILE|ENDWHILE|FOR|ENDFOR|LOOP|ENDLOOP|REPEAT|UNTIL|GOTO[FBC]?)\b\s*(.*)",
    re.IGNORECASE,
)
_ASSIGNED = re.compile(r"(R\d+|R\[.*?\]|[A-Z_][A-Z_]\w*)\s*=(?!=)\s*(.*)", re.IGNORECASE)
_ADDRESSES = ("CR", "TURN", "AP", "RP")
_DEFINED = re.compile(r"DEF\s+(REAL|INT|BOOL)\s+(.*)", re.IGNORECASE)
_CALLED = re.compile(r"(MCALL\s+)?(CYCLE\d+|HOLES[12])\s*\((.*)\)", re.IGNORECASE)
_FRAME = re.compile(r"(A?TRANS|A?ROT|A?SCALE|A?MIRROR)\b\s*(.*)", re.IGNORECASE)
#: codes of this control -> RS274/NGC; absent ones keep their meaning
_CODES = {70: "g20", 700: "g20", 71: "g21", 710: "g21", 60: "g61.1", 601: "", 602: "", 603: "",
          451: "", 64: "g64", 641: "g64", 642: "g64", 643: "g64", 644: "g64", 645: "g64", 450: "",
          97: "", 153: "g53", 460: "", 461: "", 462: "", 290: "", 500: ""}  # fmt: skip
_SAME = frozenset((0, 1, 2, 3, 17, 18, 19, 53, 54, 55, 56, 57, 90, 91, 94, 95))
_STOPS = frozenset((0, 1, 2, 30, 17))
_ACCEPTED_G = "G0-G4 G17-G19 G40-G42 G53-G57 G60 G64 G70 G71 G90 G91 G94 G95 G110-G112"
#: for the screen, or how the control follows the path
_NO_MOTION = re.compile(
    r"\b(?:(WORKPIECE|MSG|CYCLE832|CYCLE800|GROUP_BEGIN|GROUP_END|SETMS|EXTCALL_END)\s*"
    r"\((?:\"[^\"]*\"|[^)\"])*\)"
    r"|(STOPRE|FFWON|FFWOF|SOFT|BRISK|DRIVE|COMPOF|COMPON|COMPCURV|COMPCAD|CFTCP|CFC|CFIN|NORM"
    r"|CUT2D|CUT2DF|TRAFOOF|DIAMOF|CDOF|CDON|ORIWKS|ORIMKS|FIFOCTRL|STARTFIFO|STOPFIFO|SPOS)\b)",
    re.IGNORECASE,
)
_TILTED = re.compile(r"CYCLE800\s*\((.*)\)", re.IGNORECASE)
_SUPPRESSED = re.compile(r"\bSUPA\b", re.IGNORECASE)  #: every frame, for one block
_PAIRS = {"IF": "ENDIF", "WHILE": "ENDWHILE", "FOR": "ENDFOR", "LOOP": "ENDLOOP",
          "REPEAT": "UNTIL"}  # fmt: skip


class SinumerikReader(Translated):
    """Runs a Sinumerik program; every block becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.edge = 1  #: D: cutting edge, 0 takes the tool offset off
        self.variables = Variables()
        self.guard = LoopGuard(controller)
        self.modal: tuple[int, list[float | None]] | None = None  #: MCALL
        self.pole = [0.0, 0.0]
        self.meets = False  #: G451
        self.counters: dict[int, float] = {}  #: line of a FOR that runs -> its end
        controller.start_up, controller.round_corners = "A", True
        self.execute("g21g90g17g40")

    # blocks

    def _content(self, index: int) -> tuple[re.Match, str]:
        """Head and body of a line without comment."""
        text = re.sub(r";.*", "", self.lines[index]).strip()
        head = _HEAD.match(text)
        return head, text[head.end() :].strip()

    def obey(self, text: str) -> None:
        """Obey one line."""
        head, content = self._content(self.next - 1)
        if "/" in head.group() and self.options.skips(int(head[1] or head[3] or 1)):
            return
        if not content or content.startswith("%") or content.upper().startswith(("PROC ", "RET")):
            return
        self._obey(content)

    def _obey(self, content: str) -> None:
        flow = _KEYWORD.fullmatch(content)
        if flow is not None:
            self._flow(flow[1].upper(), flow[2].strip())
            return
        declared, frame = _DEFINED.fullmatch(content), _FRAME.fullmatch(content)
        called = _CALLED.fullmatch(content)
        if declared is not None:
            self._declare(declared[2])
        elif frame is not None:
            self._frame(frame[1].upper(), frame[2])
        elif called is not None and called[2].upper() not in ("CYCLE832", "CYCLE800"):
            self._cycle(called[2].upper(), self._arguments(called[3]), modal=bool(called[1]))
        elif content.upper() == "MCALL":
            self.modal = None
        elif not self._assignments(content):
            self._block(content)

    def _declare(self, text: str) -> None:
        for piece in self._split(text):
            name, _, value = piece.partition("=")
            first = self.variables.value(value) if value else 0.0
            self.variables.named[name.strip().upper()] = first

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
        words = self._words(content)
        g_codes = [value for letter, value in words if letter == "G"]
        if 4.0 in g_codes:
            self._dwell(words)
            return
        self._tool(words)
        self._polar(words, g_codes)
        self._side(words, g_codes)
        moved = any(letter in "XYZ" for letter, _ in words)
        self.execute(self._text(words, g_codes))
        if self.modal is not None and moved:
            drill(self, *self.modal)
        stop = [v for letter, v in words if letter == "M" and v in _STOPS]
        if stop:
            self.execute("m30" if stop[0] in (2, 17, 30) else f"m{stop[0]:.0f}")

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
        here = self._here()
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

    def _here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        c = self.controller
        here = list(c.position)
        if c.side and not c.entering:
            here[:3] = c.programmed
        return here

    def go(self, motion: str, *, z: float, feed: float | None = None) -> None:
        """Move along the tool axis to an absolute level."""
        c = self.controller
        before, c.absolute = c.absolute, True
        self.execute(f"{motion}z{number(z)}" + (f"f{number(feed)}" if feed else ""))
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
            base = {110.0: self._here()[:2], 111.0: [0.0, 0.0], 112.0: self.pole}[pole]
            self.pole = [base[0] + values.get("X", 0.0), base[1] + values.get("Y", 0.0)]
            words[:] = [w for w in words if w not in (("G", pole),) and w[0] not in "XY"]
            return
        if not {"AP", "RP"} & values.keys():
            return
        here = self._here()
        out = here[0] - self.pole[0], here[1] - self.pole[1]
        radius, angle = values.get("RP", math.hypot(*out)), values.get("AP")
        angle = math.radians(angle) if angle is not None else math.atan2(out[1], out[0])
        if not self.controller.absolute and 90.0 not in g_codes:
            raise ProgramError("AP and RP in G91 are not read", accepted="G90")
        words[:] = [w for w in words if w[0] not in ("AP", "RP")]
        words += [("X", self.pole[0] + radius * math.cos(angle)),
                  ("Y", self.pole[1] + radius * math.sin(angle))]  # fmt: skip

    def _text(self, words: list[tuple[str, float]], g_codes: list[float]) -> str:
        text = []
        for letter, value in words:
            if letter == "G":
                text.append(self._code(value))
            elif letter == "M":
                if value not in _STOPS and value != 6:
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
        if value == 500.0 and not any(self.controller.origin):
            return ""
        if value in _CODES and value != 500.0:
            return _CODES[value]
        if value not in _SAME:
            raise ProgramError(f"Sinumerik G{value:g} is not read", accepted=_ACCEPTED_G)
        return f"g{value:.0f}"

    # frames and cycles

    def _frame(self, name: str, text: str) -> None:
        """TRANS sets the zero, ATRANS moves it on; others alone take all frames away."""
        words = dict(self._words(text)) if text else {}
        if words and name not in ("TRANS", "ATRANS"):
            raise ProgramError(f"{name} with axes is not read", accepted="TRANS, ATRANS")
        c = self.controller
        base = list(c.g92[:3]) if name == "ATRANS" and words else [0.0] * 3
        shift = [b + words.get(a, 0.0) for a, b in zip("XYZ", base, strict=True)]
        if shift != list(c.g92[:3]):
            said = zip("xyz", shift, strict=True)
            self.execute("g52" + "".join(f"{a}{number(v)}" for a, v in said))

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
        return [self.variables.value(piece) if piece.strip() else None
                for piece in self._split(text)]  # fmt: skip

    def _cycle(self, name: str, arguments: list[float | None], *, modal: bool) -> None:
        if name in PATTERNS:
            if self.modal is None:
                raise ProgramError(
                    f"{name} without a cycle", accepted="MCALL CYCLE81(...) before it"
                )
            for x, y in pattern_points(name, arguments):
                self.execute(f"g90g0x{number(x)}y{number(y)}")
                drill(self, *self.modal)
            return
        cycle = int(name.removeprefix("CYCLE"))
        if cycle not in CYCLES:
            raise ProgramError(
                f"{name} is not read", accepted=", ".join(f"CYCLE{k}" for k in sorted(CYCLES))
            )
        if modal:
            self.modal = (cycle, arguments)
        else:
            drill(self, cycle, arguments)

    # flow

    def _flow(self, keyword: str, rest: str) -> None:
        if keyword.startswith("GOTO"):
            self._goto(keyword, rest)
        elif keyword == "IF":
            self._if(rest)
        elif keyword == "ELSE":
            self.next = self._partner("IF", self.next) + 1
        elif keyword == "WHILE":
            if not self.variables.value(rest):
                self.next = self._partner("WHILE", self.next) + 1
        elif keyword == "FOR":
            self._for(rest)
        elif keyword == "UNTIL":
            if not self.variables.value(rest):
                self._back(self._opening(keyword))
        elif keyword in ("ENDWHILE", "ENDLOOP", "ENDFOR"):
            self._back(self._opening(keyword))
        elif keyword == "REPEAT" and rest:
            raise ProgramError("REPEAT with a label is not read", accepted="REPEAT ... UNTIL")

    def _if(self, rest: str) -> None:
        jump = re.fullmatch(r"(.*?)\s*\b(GOTO[FBC]?)\b\s*(.*)", rest, re.IGNORECASE)
        if jump is not None:
            if self.variables.value(jump[1]):
                self._goto(jump[2].upper(), jump[3])
        elif not self.variables.value(rest):
            self.next = self._partner("IF", self.next, stop_at_else=True) + 1

    def _for(self, rest: str) -> None:
        match = re.fullmatch(r"(\w+|R\[.*\])\s*=\s*(.*?)\s+TO\s+(.*)", rest, re.IGNORECASE)
        if match is None:
            raise ProgramError(f"cannot read FOR {rest}", accepted="FOR R1=1 TO 10")
        line, name = self.next - 1, match[1].upper()
        if line in self.counters:
            self.variables.assign(name, self.variables.value(name) + 1.0)
        else:
            self.variables.assign(name, self.variables.value(match[2]))
            self.counters[line] = self.variables.value(match[3])
        if self.variables.value(name) > self.counters[line]:
            del self.counters[line]
            self.next = self._partner("FOR", self.next) + 1

    def _keyword(self, index: int) -> tuple[str, str]:
        match = _KEYWORD.fullmatch(self._content(index)[1])
        return (match[1].upper(), match[2]) if match else ("", "")

    def _opens(self, index: int, opening: str) -> bool:
        keyword, rest = self._keyword(index)
        is_jump = keyword == "IF" and re.search(r"\bGOTO[FBC]?\b", rest, re.IGNORECASE)
        return keyword == opening and not is_jump

    def _partner(self, opening: str, start: int, *, stop_at_else: bool = False) -> int:
        """Line of the end of a structure that is open at `start`."""
        depth = 0
        for index in range(start, len(self.lines)):
            keyword, _ = self._keyword(index)
            if self._opens(index, opening):
                depth += 1
            elif keyword == _PAIRS[opening]:
                if depth == 0:
                    return index
                depth -= 1
            elif stop_at_else and keyword == "ELSE" and depth == 0:
                return index
        raise ProgramError(f"{opening} without {_PAIRS[opening]}")

    def _opening(self, closing: str) -> int:
        """Line of the head of the structure that ends here."""
        opening = next(k for k, v in _PAIRS.items() if v == closing)
        depth = 0
        for index in range(self.next - 2, -1, -1):
            if self._keyword(index)[0] == closing:
                depth += 1
            elif self._opens(index, opening):
                if depth == 0:
                    return index
                depth -= 1
        raise ProgramError(f"{closing} without {opening}")

    def _goto(self, keyword: str, target: str) -> None:
        wanted = target.strip().upper()
        ahead, behind = range(self.next, len(self.lines)), range(self.next - 1, -1, -1)
        where = {"GOTOF": ahead, "GOTOB": behind}.get(keyword, (*ahead, *behind))
        for index in where:
            head, _ = self._content(index)
            if wanted in ((head[4] or "").upper(), f"N{head[2]}"):
                self._back(index)
                return
        if keyword != "GOTOC":
            raise ProgramError(f"{keyword} {wanted}: there is no such label")

    def _back(self, index: int) -> None:
        """Go on at another line."""
        if index < self.next:
            self.guard.jumped_back(
                index + 1, level=0, executed=self.budget.executed,
                flow=(self.variables.r, self.variables.named, self.counters),
            )  # fmt: skip
        self.next = index
