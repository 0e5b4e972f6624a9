"""Heidenhain Klartext: straight lines and arcs; cycles, Q parameters and RL/RR are refused."""

from __future__ import annotations

import re

from gcode.errors import ProgramError
from gcode.geometry.arc_tolerance import ARC_TOLERANCES
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.language.translate import Translated, number
from gcode.state.controller import Controller
from gcode.writing.klartext import KlartextEdit, KlartextText

__all__ = ["Heidenhain"]

_WORD = re.compile(r"(I?[XYZABC]|FMAX|F|S|M|DR|R[0LR](?![\d.])|R|LEN|PR|PA|[A-Z]+)\s*"
                   r"([+-]?\s*(?:\d+\.?\d*|\.\d+))?\s*([+-])?(?=\s|$|[A-Z])")  # fmt: skip
_NO_SHIFT = re.compile(
    r"CYCL DEF\s+7\.\d+(?:\s+DATUM SHIFT|(?:\s+I?[XYZABC]\s*[+-]?0*\.?0*(?=\s|$))+)"
)
_IGNORED = re.compile(r"BLK FORM|STOP$|\*|CC$")
_PLAIN_M = {3: "m3", 4: "m4", 5: "m5", 7: "m7", 8: "m8", 9: "m9", 0: "m0", 1: "m1"}


class KlartextReader(Translated):
    """Runs Klartext; every line becomes blocks of RS274/NGC."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.pole: tuple[float, float] | None = None
        self.feed: float | None = None
        self.labels: dict[int, int] = {}
        self.begun: dict[int, int] = {}  #: blocks obeyed when what stands below a label began
        #: label line, return line, repeats left, what `begun` was before the repeats
        self.calls: list[tuple[int, int, int, int]] = []

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = re.sub(r";.*", "", text).strip().upper()
        content = re.sub(r"^\d+(?:\s+|$)", "", content)
        head = content.split(" ")[0] if content else ""
        if not content or content.startswith("*"):
            return
        if content.startswith("BEGIN PGM"):
            self.execute("g20" if content.endswith("INCH") else "g21", "g17g90g40g80")
        elif content.startswith("END PGM"):
            self.execute("m30")
        elif content.startswith("BLK FORM"):
            self.controller.note("BLK FORM", "blank for the control's graphics")
        elif content.startswith("TOOL CALL"):
            self._tool_call(content)
        elif content.startswith("TOOL DEF"):
            self.controller.note("TOOL DEF", "tool preselection")
        elif content.startswith("CYCL DEF"):
            self._cycle(content)
        elif head == "LBL":
            self._label(content)
        elif content.startswith("CALL LBL"):
            self._call_label(content)
        elif content == "STOP" or re.fullmatch(r"(?:M\d+\s*)+", content):
            self.execute(*(["m0"] if content == "STOP" else self._m_codes(content)))
        elif head == "CC":
            words, _ = self._words(content[2:])
            self.pole = self._target(words)[:2]
        elif head in ("L", "C", "CR"):
            self._move(head, content[len(head) :])
        else:
            raise ProgramError(
                f"Klartext word '{head}' is not read",
                accepted="L C CR CC LBL CALL LBL TOOL CALL STOP M BLK FORM",
                hint="post the program with plain lines and arcs",
            )

    def _cycle(self, content: str) -> None:
        """CYCL DEF 32 is the control's own tolerance; a datum shift by nothing shifts nothing."""
        if re.match(r"CYCL DEF\s+32\.", content):
            self.controller.note("CYCL DEF 32", "tolerance of the control's path")
        elif not _NO_SHIFT.fullmatch(content):
            raise ProgramError(
                f"Klartext cycle '{content}' is not read",
                accepted="CYCL DEF 32, CYCL DEF 7 with zeros",
                hint="post the program without cycles and datum shifts",
            )

    def _m_codes(self, content: str) -> list[str]:
        return [self._m_code(int(code)) for code in re.findall(r"M(\d+)", content)]

    def _m_code(self, code: int) -> str:
        if code in (13, 14):
            return f"m{code - 10}m8"
        if code in (2, 30):
            return "m30"
        if code not in _PLAIN_M:
            raise ProgramError(f"M{code} is not read", accepted="M0 M1 M2 M3-M5 M7-M9 M13 M14 M30")
        return _PLAIN_M[code]

    def _words(self, content: str) -> tuple[dict[str, float | str | None], list[int]]:
        """Words of a motion line, and its M codes."""
        words: dict[str, float | str | None] = {}
        codes, position = [], 0
        for match in _WORD.finditer(content):
            if content[position : match.start()].strip():
                break
            position = match.end()
            letter, value, sign = match.groups()
            if letter == "M" and value is not None:
                codes.append(int(float(value)))
            elif letter == "DR" and (sign or value is None):
                words["DR"] = sign
            elif letter in ("R0", "RL", "RR", "FMAX") and value is None:
                words[letter] = None
            elif value is None or letter not in ("X", "Y", "Z", "A", "B", "C", "IX", "IY", "IZ",
                                                 "IA", "IB", "IC", "F", "R", "S"):  # fmt: skip
                raise ProgramError(
                    f"Klartext word '{letter}' is not read in a motion line",
                    accepted="X Y Z IX IY IZ R DR R0 F FMAX M",
                )
            elif letter in words:
                raise ProgramError(f"two {letter} words in one line")
            else:
                words[letter] = float(re.sub(r"\s", "", value))
        if content[position:].strip():
            raise ProgramError(
                f"cannot read '{content[position:].strip()}'",
                accepted="X Y Z IX IY IZ R DR R0 F FMAX M",
            )
        return words, codes

    def _target(self, words: dict[str, float | str | None]) -> tuple[float, ...]:
        """X Y Z A B C where the line ends."""
        end = list(self.controller.position)
        for axis, letter in enumerate("XYZABC"):
            if letter in words and "I" + letter in words:
                raise ProgramError(f"{letter} and I{letter} in one line")
            end[axis] = words.get(letter, end[axis] + words.get("I" + letter, 0.0))
        return tuple(end)

    def _move(self, head: str, content: str) -> None:
        words, codes = self._words(content)
        for side in ("RL", "RR"):
            if side in words:
                raise ProgramError(f"radius compensation {side} is not read", accepted="R0")
        before = [self._m_code(c) for c in codes if c in (3, 4, 7, 8, 13, 14)]
        after = [self._m_code(c) for c in codes if c not in (3, 4, 7, 8, 13, 14, 91)]
        if "F" in words:
            self.feed = words["F"]
        self.execute(*before)
        block = self._arc(head, words) if head != "L" else self._line(words, codes)
        self.execute(block, *after)

    def _line(self, words: dict[str, float | str | None], codes: list[int]) -> str:
        rapid = "FMAX" in words
        axes = [(letter, words[letter]) for letter in "XYZABC" if letter in words]
        if 91 in codes:
            if any("I" + letter in words for letter in "XYZABC"):
                raise ProgramError("incremental words with M91")
            motion = "g53g0" if rapid else "g53g1"
        else:
            end, motion = self._target(words), "g0" if rapid else "g1"
            axes = [(letter, end[axis]) for axis, letter in enumerate("XYZABC")
                    if letter in words or "I" + letter in words]  # fmt: skip
        if not axes:
            return ""
        return motion + "".join(f"{a}{number(v)}" for a, v in axes) + self._feed(rapid)

    def _feed(self, rapid: bool) -> str:
        if rapid:
            return ""
        if self.feed is None:
            raise ProgramError("motion without feed", hint="give F or FMAX")
        return f"f{number(self.feed)}"

    def _arc(self, head: str, words: dict[str, float | str | None]) -> str:
        if words.get("DR") not in ("+", "-"):
            raise ProgramError(f"{head} without DR+ or DR-")
        end = self._target(words)
        start = self.controller.position
        text = ("g3" if words["DR"] == "+" else "g2") + f"x{number(end[0])}y{number(end[1])}"
        if end[2] != start[2]:
            text += f"z{number(end[2])}"
        if head == "CR":
            if "R" not in words:
                raise ProgramError("CR without R")
            return text + f"r{number(words['R'])}" + self._feed(False)
        if self.pole is None:
            raise ProgramError("C without a circle centre", hint="give CC first")
        offsets = (self.pole[0] - start[0], self.pole[1] - start[1])
        return text + f"i{number(offsets[0])}j{number(offsets[1])}" + self._feed(False)

    def _tool_call(self, content: str) -> None:
        bare = re.sub(r"\s+D[LR]2?\s*[+-]?0*\.?0*(?=\s|$)", "", content)  # no wear
        match = re.fullmatch(r"TOOL CALL\s+(\d+)(?:\s+([XYZ]))?((?:\s+[SF]\s*[\d.]+)*)", bare)
        if match is None or match[2] not in (None, "Z"):
            raise ProgramError(f"cannot read '{content}'", accepted="TOOL CALL 1 Z S3500 F500")
        for letter, value in re.findall(r"([SF])\s*([\d.]+)", match[3]):
            if letter == "S":
                self.execute(f"s{value}")
            else:
                self.feed = float(value)
        self.execute(f"t{match[1]}m6", f"g43h{match[1]}" if int(match[1]) else "g49")

    def _label(self, content: str) -> None:
        label = int(self._integer(content, r"LBL\s+(\d+)"))
        if label:
            self.labels[label], self.begun[label] = self.next - 1, self.budget.executed
        elif self.calls and self.calls[-1][2] < 0:
            self.next = self.calls.pop()[1]

    def _integer(self, content: str, pattern: str) -> str:
        match = re.match(pattern, content)
        if match is None:
            raise ProgramError(f"cannot read '{content}'", accepted="a label with a number")
        return match[1]

    def _call_label(self, content: str) -> None:
        """CALL LBL n jumps to a subprogram that LBL 0 ends; with REP it repeats what is above."""
        label = int(self._integer(content, r"CALL LBL\s+(\d+)"))
        repeats = re.search(r"REP\s*(\d+)", content)
        if repeats:
            self._repeat(label, int(repeats[1]))
            return
        wanted = re.compile(rf"\s*(?:\d+\s+)?LBL\s+{label}\s*(?:;.*)?", re.IGNORECASE)
        target = next((i for i, line in enumerate(self.lines) if wanted.fullmatch(line)), None)
        if target is None:
            raise ProgramError(f"LBL {label} does not exist")
        if len(self.calls) >= 19:
            raise ProgramError("subprograms nested deeper than 19")
        self.calls.append((target, self.next, -1, 0))
        self.next = target + 1

    def _repeat(self, label: int, repeats: int) -> None:
        here = self.next
        if label not in self.labels:
            raise ProgramError(f"LBL {label} is not above this block")
        if self.calls and self.calls[-1][:2] == (self.labels[label], here):
            *_, left, begun = self.calls.pop()
        else:
            left, begun = repeats, self.begun[label]
            self.budget.check_rounds(repeats, self.budget.executed - begun)
        if left > 0:
            self.calls.append((self.labels[label], here, left - 1, begun))
            self.next, self.begun[label] = self.labels[label] + 1, self.budget.executed
        else:
            self.begun[label] = begun


class Heidenhain(Dialect):
    """Heidenhain Klartext."""

    name = "heidenhain"
    title = "HEIDENHAIN TNC 620, TNC 640"
    source = "HEIDENHAIN TNC 640 User's Manual for Klartext Programming 892903"
    synonyms = ("klartext",)
    rank = 10
    marks = re.compile(
        r"^[ \t]*(?:N?\d+[ \t]+)?(?:BEGIN PGM|BLK FORM|TOOL CALL|CYCL DEF)\b",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = KlartextReader
    arcs = ARC_TOLERANCES["heidenhain"]
    flow_lines = re.compile(r"\s*(?:\d+\s+)?(?:LBL|CALL\s+LBL)\b", re.IGNORECASE)
    inch_decimals = 2
    text = KlartextText
    edit = KlartextEdit
