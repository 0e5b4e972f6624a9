"""Blocks of a TNC program in DIN/ISO as blocks of Klartext.

Source: HEIDENHAIN TNC 426/430 User's Manual ISO Programming: G00 to G16 are the path functions of
Klartext, I and J its CC, R and H its PR and PA, D00 to D13 its FN 0 to FN 13, G98 L its LBL.
G26 and G27 are arcs between the contour's point and the start or end, tangent to the contour: TNC
320 (34055x-06), User's Manual for DIN/ISO Programming, 5/2013, page 172; read as APPR and DEP LCT.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from gcode.dialects.tnciso.iso_cycles import CYCLES, cycle_lines
from gcode.errors import ProgramError

__all__ = ["Translation", "klartext_of_iso"]

_VALUE = r"[+-]?\s*(?:\d+\.?\d*|\.\d+|Q\d+)"
_WORD = re.compile(rf"\s*([A-Z])\s*({_VALUE})")
#: M functions with words of their own, which are no places and no feeds of the block
_M_WITH_WORDS = re.compile(
    rf"M\s*(?:103\s*F\s*{_VALUE}|118(?:\s*[XYZABC]\s*{_VALUE})+|120\s*LA\s*{_VALUE}"
    rf"|1(?:12|24)(?:\s*[TA]\s*{_VALUE})+|138(?:\s+[ABC](?![\w+-]))+|140\s*MB\s*(?:MAX|{_VALUE}))"
)
_HEAD = re.compile(r"\s*(/?)\s*(?:N\s*\d+)?\s*(/?)\s*")
_FUNCTION = re.compile(rf"D\s*(\d+)\s*(?:(Q\d+)\s*)?((?:P0?\d\s*{_VALUE}\s*)+)$")
_LEADING = re.compile(r"((?:G\s*9[01]\s*)?)G\s*(\d+)")
_CALL = re.compile(r"L\s*(\d+)\s*[,.]\s*(\d+)$")
_PROGRAM = re.compile(r"%\s*:?\s*([\w\-.]+)\s*(G7[01])?")
#: line with RL or RR; what stands before its L or LP, and what behind
_COMPENSATED = re.compile(r"(/ )?L(P?)\b((?=.* R[LR]\b).*)")
#: D function -> Klartext, with its parameters P01 to P03
_FUNCTIONS = {
    0: "{q} = {0}", 1: "{q} = {0} + {1}", 2: "{q} = {0} - {1}", 3: "{q} = {0} * {1}",
    4: "{q} = {0} DIV {1}", 5: "{q} = SQRT {0}", 6: "{q} = SIN {0}", 7: "{q} = COS {0}",
    8: "{q} = {0} LEN {1}", 9: "IF {0} EQU {1} GOTO LBL {2}", 10: "IF {0} NE {1} GOTO LBL {2}",
    11: "IF {0} GT {1} GOTO LBL {2}", 12: "IF {0} LT {1} GOTO LBL {2}", 13: "{q} = {0} ANG {1}",
}  # fmt: skip
_SIDES = {40: "R0", 41: "RL", 42: "RR"}
_RAPID, _POLAR = {0, 10}, {10, 11, 12, 13, 15}
_SENSES = {2: "-", 3: "+", 12: "-", 13: "+"}
_PATHS = {0, 1, 2, 3, 5, 6, 7, 10, 11, 12, 13, 15}
_ARCS = {2, 3, 5}
_MODES = {17, 40, 41, 42, 90, 91}
_KNOWN = _MODES | _PATHS | {70, 71, 29, 79}
#: letters that stand beside every path function
_USUAL = frozenset("XYZABCIJFSM")
#: letter of DIN/ISO -> Klartext
_AXES, _POLAR_WORDS = {k: k for k in "XYZABC"}, {"R": "PR", "H": "PA"}


@dataclass
class Translation:
    """Klartext of a program.

    Attributes
    ----------
    lines : list of (str, int)
        Klartext, and the 0-based line that it stands for.
    errors : dict of int to ProgramError
        Index of a line of Klartext -> why what it stands for is not read.
    """

    lines: list[tuple[str, int]] = field(default_factory=list)
    errors: dict[int, ProgramError] = field(default_factory=dict)


def klartext_of_iso(lines: Sequence[str]) -> Translation:
    """Translate a program; errors are kept for when their lines run."""
    found, blocks = Translation(), _Blocks()
    for index, line in enumerate(lines):
        try:
            texts = blocks.translated(line)
        except ProgramError as error:
            found.errors[len(found.lines)] = error
            texts = ["*"]
        if blocks.approach is not None:
            _approach(found, blocks.approach)
            blocks.approach = None
        found.lines += [(text, index) for text in texts or ["*"]]
    return found


def _approach(found: Translation, radius: str) -> None:
    """Make an approach on an arc of the last block of motion, as G26 behind it says."""
    for k in range(len(found.lines) - 1, -1, -1):
        text, index = found.lines[k]
        first = _COMPENSATED.match(text)
        if first is not None:
            found.lines[k] = f"{first[1] or ''}APPR {first[2]}LCT{first[3]} R{radius}", index
            return
        if text != "*":
            break
    found.errors[len(found.lines)] = ProgramError(
        "G26 behind no block with G41 or G42", accepted="G26 behind the contour's first point"
    )


class _Blocks:
    """Modes of the program at a block."""

    def __init__(self) -> None:
        self.name: str | None = None
        self.absolute = True
        self.path = 1
        self.sense = "+"
        self.approach: str | None = None  #: radius of a G26
        self.departure: str | None = None  #: radius of a G27 whose G40 is still to come

    def translated(self, line: str) -> list[str]:
        """Blocks of Klartext for a line."""
        text = line.split(";")[0].upper()
        head = _HEAD.match(text)
        is_open = text.rstrip().endswith("~")
        body = text[head.end() :].replace("~", " ").strip().removesuffix("*").strip()
        if not body:
            return []
        skip = "/ " if head[1] or head[2] else ""
        found = [skip + block for block in self._block(body)]
        if is_open and found:
            found[-1] += " ~"
        return found

    def _block(self, body: str) -> list[str]:
        for match, action in (
            (_PROGRAM.match(body), self._program),
            (_CALL.match(body), lambda m: [_call(m[1], int(m[2]))]),
            (_FUNCTION.match(body), _function),
        ):
            if match:
                return action(match)
        if re.match(r"Q[LR]?\d+\s*=", body):
            return [body]
        leading = _LEADING.match(body)
        code = int(leading[2]) if leading else -1
        if code in CYCLES or code >= 200:
            if leading[1]:
                self.absolute = "91" not in leading[1]
            return cycle_lines(code, body[leading.end() :].strip(), absolute=self.absolute)
        return self._words(body)

    def _program(self, match: re.Match) -> list[str]:
        if self.name is None:
            self.name = match[1]
            return [f"BEGIN PGM {match[1]} {'INCH' if match[2] == 'G70' else 'MM'}"]
        return [f"END PGM {match[1]} MM" if match[2] else f"CALL PGM {match[1]}"]

    def _words(self, body: str) -> list[str]:
        codes, words, position = [], [], 0
        own = ""
        if "M" in body:
            own = "".join(f" {found}" for found in _M_WITH_WORDS.findall(body))
            body = _M_WITH_WORDS.sub(" ", body)
        for match in _WORD.finditer(body):
            if body[position : match.start()].strip():
                break
            position = match.end()
            value = "".join(match[2].split())
            if match[1] == "G":
                if not value.isdigit():
                    raise ProgramError(f"G{value} is no G code", accepted="G with a whole number")
                codes.append(int(value))
            else:
                words.append((match[1], value))
        if body[position:].strip():
            raise ProgramError(f"cannot read '{body[position:].strip()}'",
                               accepted="words of a letter and a number")  # fmt: skip
        return self._said(codes, words, own)

    def _said(self, codes: list[int], words: list[tuple[str, str]], own: str) -> list[str]:
        said = dict(words)
        special = self._special(codes, said)
        if special is not None:
            return special
        unknown = [c for c in codes if c not in _KNOWN]
        if unknown:
            raise ProgramError(
                f"G{unknown[0]:02d} of a TNC program in DIN/ISO is not read",
                accepted="G00-G07 G10-G15 G17 G24-G31 G38 G40-G42 G54 G70-G79 G83-G85 G90 G91 G98 "
                "G99 G120-G125 G200 and above",
            )
        for code in codes:
            self.absolute = {90: True, 91: False}.get(code, self.absolute)
            self.path = code if code in _PATHS else self.path
        found = ["CC IX+0 IY+0"] if 29 in codes else []
        if said.keys() & {"I", "J"}:
            found.append("CC" + self._places(said, {"I": "X", "J": "Y"}))
        codes_m = "".join(f" M{value}" for letter, value in words if letter == "M") + own
        if 79 in codes:
            return [*found, "CYCL CALL" + codes_m]
        self._refuse_foreign(said)
        return found + self._motion(codes, said, codes_m)

    def _refuse_foreign(self, said: dict[str, str]) -> None:
        """Refuse words that say nothing beside the path function."""
        of_path = "RH" if self.path in _POLAR else "R" if self.path in _ARCS else ""
        for letter in sorted(said.keys() - _USUAL.union(of_path)):
            raise ProgramError(
                f"word {letter} beside G{self.path:02d} is not read", hint="remove it"
            )

    def _special(self, codes: list[int], said: dict[str, str]) -> list[str] | None:
        """Blocks that are no motion."""
        if {30, 31} & set(codes):
            return ["BLK FORM 0.1"]
        if 98 in codes and "L" in said:
            return [f"LBL {said['L']}"]
        if {99, 51} & set(codes):
            return [f"TOOL DEF {said.get('T', '')}"]
        if 38 in codes:
            return ["STOP"]
        for code, word in ((24, "CHF"), (25, "RND R")):
            if code in codes and "R" in said:
                return [f"{word} {said['R']}"]
        if {26, 27} & set(codes) and "R" in said:
            if 26 in codes:
                self.approach = said["R"]
            else:
                self.departure = said["R"]
            return ["*"]
        if "T" in said and not set(codes) - {17, 18, 19, 40, 90, 91}:
            axis = {18: "Y", 19: "X"}.get(next((c for c in codes if c in (18, 19)), 17), "Z")
            more = "".join(f" {k}{said[k]}" for k in ("S", "F") if k in said)
            return [f"TOOL CALL {said['T']} {axis}{more}"]
        return None

    def _places(self, said: dict[str, str], names: dict[str, str]) -> str:
        prefix = "" if self.absolute else "I"
        return "".join(f" {prefix}{new}{said[old]}" for old, new in names.items() if old in said)

    def _motion(self, codes: list[int], said: dict[str, str], codes_m: str) -> list[str]:
        sides = "".join(f" {_SIDES[c]}" for c in codes if c in _SIDES)
        polar = self.path in _POLAR
        places = self._places(said, _AXES)
        if polar:
            places += self._places(said, _POLAR_WORDS)
        if not places and not (self.path in (2, 3, 12, 13) and set(codes) & _PATHS):
            rest = f" F{said['F']}" if "F" in said else ""
            more = [f"TOOL CALL S{said['S']}"] if "S" in said else []
            return more + ([f"L{sides}{rest}{codes_m}"] if sides or rest or codes_m else [])
        self.sense = _SENSES.get(self.path, self.sense)
        word, tail = {
            0: ("L", ""), 1: ("L", ""), 7: ("L", ""), 10: ("LP", ""), 11: ("LP", ""), 6: ("CT", ""),
        }.get(self.path, ("CP" if polar else "C", f" DR{self.sense}"))  # fmt: skip
        if word == "C" and "R" in said:
            word, tail = "CR", f" R{said['R']}{tail}"
        if self.departure is not None:
            if word not in ("L", "LP") or 40 not in codes:
                raise ProgramError("G27 without G40 behind it", accepted="G01 G40 X Y behind G27")
            radius, self.departure = self.departure, None
            word, tail, sides = f"DEP {word[1:]}LCT", f" R{radius}", ""
        feed = " FMAX" if self.path in _RAPID else f" F{said['F']}" if "F" in said else ""
        return [f"{word}{places}{tail}{sides}{feed}{codes_m}"]


def _call(label: str, repeats: int) -> str:
    return f"CALL LBL {label}" + (f" REP {repeats}" if repeats else "")


def _function(match: re.Match) -> list[str]:
    number, name = int(match[1]), match[2]
    values = dict(re.findall(rf"P0?(\d)\s*({_VALUE})", match[3]))
    given = [values[k] for k in sorted(values)]
    form = _FUNCTIONS.get(number)
    if form is None:
        raise ProgramError(f"D{number:02d} asks or tells the machine and is not read",
                           accepted="D00 to D13")  # fmt: skip
    fill: Callable[..., str] = form.format
    try:
        return [f"FN {number}: " + fill(*given, q=name)]
    except IndexError:
        raise ProgramError(f"D{number:02d} lacks a parameter P", accepted="P01, P02, P03") from None
