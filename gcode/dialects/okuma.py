"""Okuma OSP: Fanuc's letters with work offsets G15 H, tool lengths G56 H, return levels and CALL.

Only what public sources say alike is read: the posts for OSP-E100M and OSP-P300 that Autodesk and
HSMWorks published (``okuma.cps``), and the list of G codes of OSP. VC, IF, GOTO, CALL and RTS are
read as in MachinistFTW/OkumaMacros on GitHub (OPULL.SSB, OROTA.SSB, SET-MASTER-Z.MIN).
nc-macro-lab.na.coocan.jp/osp2.html says the same. Every other word is refused.
"""

from __future__ import annotations

import re
from types import MappingProxyType

from gcode.dialects.fanuc import Fanuc
from gcode.dialects.fanuc.confirmed import CONFIRMED
from gcode.dialects.fanuc.macro.line_text import BLANKS, HEAD
from gcode.dialects.fanuc.reader import FanucReader
from gcode.dialects.fanuc.settings import FanucSettings
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["Okuma"]

_COMMENT = re.compile(r"\([^)]*\)?")
_FILE = re.compile(r"\s*\$.*|\s*%\s*")
_NUMBERED = re.compile(r"\s*(/?\d?)\s*(?:N(\d+)\b)?\s*", re.IGNORECASE)
_VARIABLE = re.compile(r"\bVC\[?(\d+)\]?", re.IGNORECASE)
_EQUALS = re.compile(r"\b([XYZIJKRFSQPDH])\s*=\s*([^\s]+)", re.IGNORECASE)
_CODE = re.compile(r"(?<![A-Z])G\s*0*(\d+(?:\.\d+)?)", re.IGNORECASE)
_NAMED = re.compile(r"(?<![A-Z])N[A-Z]\w*", re.IGNORECASE)
_STATEMENTS = (
    (re.compile(r"CALL\s+O(\d+)(?:\s+Q(\d+))?", re.IGNORECASE), r"M98 P\1 L\2"),
    (re.compile(r"RTS", re.IGNORECASE), "M99"),
    (re.compile(r"GOTO\s+N(\d+)", re.IGNORECASE), r"GOTO \1"),
    (re.compile(r"IF\s*(\[.*\])\s*(?:GOTO\s*)?N(\d+)", re.IGNORECASE), r"IF \1 GOTO \2"),
)
#: common variable VC1 is #501 inside
_FIRST_COMMON = 500
_CYCLES = frozenset((73, 74, 81, 82, 83, 84, 85, 86, 89))
_READ = _CYCLES | {0, 1, 2, 3, 4, 9, 10, 15, 17, 18, 19, 20, 21, 30, 40, 41, 42, 53, 56, 61, 64, 71,
                   80, 90, 91, 94, 95}  # fmt: skip
_OWN = frozenset((4, 10, 15, 30, 53, 56, 71))  #: read otherwise than Fanuc's
_LETTERS = "GMNOTHDFSPQRXYZIJK"
_RETURNS = {53: "G98", 54: "G99"}


class OkumaReader(FanucReader):
    """Runs an OSP program, each block translated to Fanuc's."""

    settings = FanucSettings(dwell_p_s=1.0, builder_m=MappingProxyType({}))

    _says_return = False  #: M53 or M54 has stood somewhere

    def content(self, index: int) -> str:
        """Text of the block that runs in Fanuc's words; of one that is looked at, as it stands."""
        if index != self.next - 1:
            return super().content(index)
        text = self._translated(self.lines[index]).translate(BLANKS).lower()
        return text[HEAD.match(text).end() :]

    def _translated(self, line: str) -> str:
        bare = _COMMENT.sub(" ", line)
        if _FILE.fullmatch(bare):
            return ""
        head = _NUMBERED.match(bare)
        text = bare[head.end() :].strip()
        if _NAMED.search(text):
            raise ProgramError(f"block name '{_NAMED.search(text)[0]}'", accepted="N and a number")
        text = _VARIABLE.sub(lambda m: f"#{_FIRST_COMMON + self._common(m)}", text)
        for pattern, fanuc in _STATEMENTS:
            found = pattern.fullmatch(text)
            if found is not None:
                self._use_own(text.split()[0])
                text = found.expand(fanuc).removesuffix("L")
                break
        else:
            if not text.startswith("#"):
                text = self._block(_EQUALS.sub(r"\1[\2]", text))
        return f"{head[1]}{'N' + head[2] if head[2] else ''} {text}"

    def _use_own(self, word: str) -> None:
        """Count a word that is not Fanuc's."""
        self.controller.use(f"OSP {word.upper()}")

    def _common(self, found: re.Match[str]) -> int:
        number = int(found[1])
        if not 1 <= number <= 200:
            raise ProgramError(f"variable {found[0]}", accepted="VC1 to VC200")
        self._use_own("VC")
        return number

    def _block(self, text: str) -> str:
        """Words of a block: G codes by the list above, other addresses as far as they are read."""
        codes = [float(code) for code in _CODE.findall(text)]
        unknown = [code for code in codes if code not in _READ]
        strange = re.search(rf"[A-Z]{{2,}}|(?![{_LETTERS}])[A-Z]", re.sub(r"\[.*?\]", "", text),
                            re.IGNORECASE)  # fmt: skip
        strange = strange or re.search(r"M\s*0*9[789](?!\d)", text, re.IGNORECASE)
        if unknown or strange or "=" in text:
            word = f"G{unknown[0]:g}" if unknown else strange[0] if strange else text
            raise ProgramError(f"Okuma word '{word}' is not read", accepted=self._accepted(),
                               hint="post the program for Fanuc")  # fmt: skip
        for code in sorted(set(codes) & _OWN):
            self._use_own(f"G{code:g}")
        return self._renamed(text, codes)

    @staticmethod
    def _accepted() -> str:
        return " ".join(f"G{code}" for code in sorted(_READ)) + " CALL O RTS GOTO N IF VC"

    def _renamed(self, text: str, codes: list[float]) -> str:
        offset = re.search(r"H\s*(\d+)", text, re.IGNORECASE)
        if 15 in codes:
            if offset is None or not 1 <= int(offset[1]) <= 48:
                raise ProgramError("G15 without H", accepted="G15 H1 to G15 H48")
            number = int(offset[1])
            name = f"G{53 + number}" if number <= 6 else f"G54.1 P{number - 6}"
            text = re.sub(r"(?i)G\s*0*15(?!\d)", name, text.replace(offset[0], "", 1))
            self.controller.note(f"G15 H{number}", f"work coordinate system {name} of the job")
        for code, fanuc in ((53, "G49"), (56, "G43"), (10, "")):
            if code in codes:
                text = re.sub(rf"(?i)G\s*0*{code}(?![\d.])", fanuc, text)
        if 10 in codes:
            self.controller.note("G10", "end of a shift or turn of the coordinates")
        if 56 in codes and offset is None:
            raise ProgramError("G56 without H", accepted="G56 H1")
        return self._levels(text, codes)

    def _levels(self, text: str, codes: list[float]) -> str:
        """G71, M52 to M54: to where the cycles return; G30: the home position; G4 F."""
        if 71 in codes:
            level = re.fullmatch(r"(?i)\s*G\s*71\s*Z\s*([-+]?(?:\d+\.?\d*|\.\d+))\s*", text)
            if level is None:
                raise ProgramError(f"cannot read '{text}'", accepted="G71 Z and a level")
            self.blocks.return_level = float(level[1])
            return ""
        if 30 in codes:
            self.controller.note("G30", "home position of the machine: machine zero is taken")
            return "G90 G53 X0. Y0. Z0."
        if 4 in codes:
            self.controller.note("G4", "its unit is a parameter of the control; seconds are taken")
            text = re.sub(r"(?i)F(?=\s*[\d.])", "P", text)
        returns = re.search(r"(?i)M\s*(5[234])(?!\d)", text)
        if returns is not None:
            if returns[1] == "52" or (returns[1] == "53" and self.blocks.return_level is None):
                raise ProgramError(f"M{returns[1]}: its level is the machine's",
                                   accepted="G71 Z with M53, or M54")  # fmt: skip
            self._use_own(f"M{returns[1]}")
            text = text.replace(returns[0], _RETURNS[int(returns[1])])
            self._says_return = True
        if _CYCLES & set(codes):
            self._check_cycle(codes)
        return text

    def _check_cycle(self, codes: list[float]) -> None:
        if not self._says_return:
            raise ProgramError("a cycle without M53 or M54 returns to the machine's level",
                               accepted="G71 Z with M53, or M54")  # fmt: skip
        if 91 in codes or not self.controller.absolute:
            raise ProgramError("a cycle in G91 is not read", accepted="G90")


class Okuma(Fanuc):
    """Programs of Okuma's OSP controls for milling."""

    name = "okuma"
    title = "Okuma OSP"
    source = "Autodesk and HSMWorks posts for Okuma OSP-E100M and OSP-P300 (okuma.cps)"
    file_endings = (".min",)
    rank = 5
    marks = re.compile(
        r"^[ \t]*\$\S+\.(?:MIN|SUB)\b"
        r"|^[ \t]*(?:N\w+[ \t]+)?(?:CALL[ \t]+O\w|G15[ \t]*H\d|VC\d+[ \t]*=)",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = OkumaReader
    reads = ()
    is_written = False
    options = MappingProxyType({})
    confirmed = {
        "public posts": "OSP G4; OSP G15; OSP G56; OSP G71; OSP M53",
        "public programs": "OSP VC; OSP IF; OSP GOTO; OSP CALL; OSP RTS",
        "fanuc": CONFIRMED["manual"],
        "no motion": CONFIRMED["no motion"],
    }

    @classmethod
    def detect(cls, text: str) -> str | None:
        """By its own words alone."""
        return super(Fanuc, cls).detect(text)

    @classmethod
    def run(cls, controller: Controller, source: Source, options: RunOptions) -> None:
        """Obey a program line by line."""
        cls.reader(controller, list(source.lines), options).run()
