"""Statements of SINUMERIK beside motion: declarations, frames, cycles, calls, ``R1=5``."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.block_words import ADDRESSES, split_arguments
from gcode.dialects.sinumerik.codes import NO_MOTION, OWN_ASSIGNED, REFUSED
from gcode.dialects.sinumerik.frames import SETTABLE, settable_frame
from gcode.dialects.sinumerik.values.expressions import Worked, expression_at
from gcode.dialects.sinumerik.values.held_data import obey_held_data
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["ARC_WORD", "NO_MOTION_WORDS", "Statements", "subprogram_call"]

ARC_WORD = re.compile(r"\b(CIP|CT)\b", re.IGNORECASE)
#: for the screen, or how the control follows the path
NO_MOTION_WORDS = re.compile(
    r"\b(?:(WORKPIECE|MSG|WRITE|DELETE|CYCLE832|CYCLE800|GROUP_(?:BEGIN|ADDEND|END)|SETMS"
    r"|EXTCALL_END|BRISKA|SOFTA|DRIVEA|WAIT(?:MC?|S|P|E)|CLRINT|CANCEL|WRTPR)\s*"
    r"\((?:\"[^\"]*\"|[^)\"])*\)"
    r"|((?:SPOSA?|FGREF|LIMS|ACC|ACCLIMA|VELOLIMA?|JERKLIMA?|ADISPOS|[CAO]TOL|STOLF|ORIS)"
    r"\s*(?:\[\w+\])?\s*=\s*(?:(?:AC|IC|DC|ACP|ACN)\s*\([^)]*\)|[\w.+-]+)"
    # nothing is asked for: no offset, no carrier, the feed as it is
    r"|(?:DL|TCARR|CUTMOD|TOFF[LR]?|FXS)\s*(?:\[\w+\])?\s*=\s*0(?![\d.])"
    r"|OVRA?\s*(?:\[\w+\])?\s*=\s*100(?![\d.])"
    r"|G2[56](?:\s+(?:S\d*|[XYZ])\s*=?\s*[-+\w.]+)+|FGROUP\s*\([^)]*\))"
    rf"|({'|'.join(NO_MOTION)}|CYCLE8(?:00|32)(?!\s*\()|SETMS)\b)",
    re.IGNORECASE,
)
_WORDS_ALONE = re.compile(r"(?:[A-Z]\d+(?:\.\d*)?)+", re.IGNORECASE)  #: G0X0Y0
_ASSIGNED = re.compile(
    r"(R\d+|R\[.*?\]|\$?[A-Z_][A-Z_]\w*(?:\[(?:[^\[\]]|\[[^\[\]]*\])*\])?)\s*=(?!=)\s*(.*)",
    re.IGNORECASE,
)
#: letters that may be names of variables, on machines that have no such axis
_LETTER = re.compile(r"([ABCEOPQUVW])\s*=(?!=)\s*(.*)", re.IGNORECASE)
_PARAMETER = re.compile(r"\s*R(\d+)\s*=(?!=)", re.IGNORECASE)
_MODES_OF_CYCLES = ("CYCLE800", "CYCLE832")  #: no brackets: everything back
_SUBPROGRAM = re.compile(
    r"(?:(MCALL|CALL)\s+)?\"?([A-Z_]\w+)\"?\s*(\(.*\))?(?:(?:\s+|(?<=\)))P\s*=?\s*(\w+))?\s*",
    re.IGNORECASE,
)
_DEFINED = re.compile(r"DEF\s+(?:NCK\s+|CHAN\s+)?(REAL|INT|BOOL)\s+(.*)", re.IGNORECASE)
_CALLED = re.compile(
    r"(MCALL\s+)?(CYCLE\d+|HOLES[12]|POCKET[1-4]|SLOT[12]|LONGHOLE)\s*\((.*)\)", re.IGNORECASE
)
_STRING = re.compile(r"\"[^\"]*\"(?:\s*<<\s*(?:\"[^\"]*\"|[\w$]+))*")
_FRAME = re.compile(r"(A?TRANS|A?ROT|A?SCALE|A?MIRROR)\b\s*(.*)", re.IGNORECASE)
_ELSEWHERE = re.compile(
    r"(?:EXTCALL\s*\(\s*(\".*\")\s*\)|(?:PCALL\s+|EXTCALL\s*(?=\"))(\S+))", re.IGNORECASE
)
_REFUSED = re.compile(rf"\b({'|'.join(REFUSED)})\b", re.IGNORECASE)
_OWN_ASSIGNED = re.compile(
    rf"\b({'|'.join(OWN_ASSIGNED)})\s*(?:\[[^\]]*\]\s*)?=(?!=)", re.IGNORECASE
)


def subprogram_call(content: str) -> re.Match[str] | None:
    """Call of a subprogram that stands alone in its block: MCALL or CALL, name, arguments, P."""
    match = _SUBPROGRAM.fullmatch(content)
    is_word = match is None or NO_MOTION_WORDS.fullmatch(content) or ARC_WORD.fullmatch(content)
    if is_word or (_WORDS_ALONE.fullmatch(content) and not re.fullmatch(r"[Ll]\d+", content)):
        return None
    return None if match[2].upper() in _MODES_OF_CYCLES else match


@lru_cache(maxsize=4096)
def _parameters(content: str) -> tuple[tuple[int, Worked], ...]:
    """``R1=5 R2=R1*2``: R parameters and what they become; nothing where a block says more."""
    found: list[tuple[int, Worked]] = []
    position = 0
    while position < len(content):
        name = _PARAMETER.match(content, position)
        if name is None or "$" in content or _REFUSED.search(content):
            return ()
        try:
            worked, position = expression_at(content, name.end())
        except ProgramError:
            return ()
        found.append((int(name[1]), worked))
    return tuple(found)


class Statements:
    """Obeys what is no motion.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader

    def obey(self, content: str) -> str:
        """Obey a block; gives the words of motion that are left of it.

        Raises
        ------
        ProgramError
            It has a word that is refused, or raises an alarm.
        """
        parameters = _parameters(content)
        for number, worked in parameters:
            self.reader.variables.r[number] = self.reader.variables.worked_out(worked, content)
        if parameters:
            return ""
        self._refuse(content)
        kept = obey_held_data(content).strip()
        if self._left_out(content) or not kept:
            return ""
        content = kept
        declared, frame = _DEFINED.fullmatch(content), _FRAME.fullmatch(content)
        called, settable = _CALLED.fullmatch(content), SETTABLE.fullmatch(content)
        if declared is not None:
            self._declare(declared[2])
        elif frame is not None:
            self.reader.corners.finish()
            self.reader.controller.use(frame[1].upper())
            self.reader.frame.obey(
                frame[1].upper(), dict(self.reader.words.read(frame[2])) if frame[2] else {}
            )
        elif called is not None and called[2].upper() not in _MODES_OF_CYCLES:
            self.reader.corners.finish()
            self.reader.cycles.call(called[2].upper(), called[3], modal=bool(called[1]))
        elif settable is not None:
            settable_frame(self.reader, settable)
        elif content.upper() == "MCALL":
            self.reader.cycles.modal = None
        elif re.match(r"(?:EXTERN|DEF|ENDLABEL)\b", content, re.IGNORECASE):
            self.reader.controller.note(content.split()[0].upper(), "declaration")
        elif not self._subprogram(content):
            return self._assignments(content)
        return ""

    def _refuse(self, content: str) -> None:
        found = None if '"' in content else _REFUSED.search(content)
        if found is not None:
            raise ProgramError(f"{found[1].upper()} ({REFUSED[found[1].upper()]}) is not read",
                               accepted="milling with three axes")  # fmt: skip
        if _OWN_ASSIGNED.search(content):
            self._refuse_assigned(content)
        if content.upper().startswith("SETAL"):
            raise ProgramError(f"the program raises an alarm: {content}")

    def _refuse_assigned(self, content: str) -> None:
        """Refuse the control's words that stand with ``=`` and ask for anything."""
        own = _OWN_ASSIGNED.search(NO_MOTION_WORDS.sub("", content))
        if own is not None and own[1].upper() not in self.reader.variables.named:
            raise ProgramError(
                f"{own[1].upper()} ({OWN_ASSIGNED[own[1].upper()]}) is not read",
                accepted="milling with three axes and the offsets of the tool table",
            )

    def _left_out(self, content: str) -> bool:
        """Whether a block is nothing but a call that the job leaves out."""
        ignored = self.reader.options.control.ignore_calls
        match = subprogram_call(content) if ignored else None
        if match is None or not self.reader.options.control.ignores(match[2]):
            return False
        self.reader.controller.note(match[2].upper(), "call left out by ignore_calls")
        return True

    def _subprogram(self, content: str) -> bool:
        """Go to a subprogram that stands alone in its block; tells whether one does."""
        elsewhere = _ELSEWHERE.fullmatch(content)
        if elsewhere:  # only the name of a path counts: programs lie beside this one
            name = re.split(r"[\\/:]", (elsewhere[1] or elsewhere[2]).strip('" '))[-1]
            content = f'CALL "{re.sub(r"(?i)^_N_|[._][SM]PF$", "", name)}"'
        match = subprogram_call(content)
        if match is None or match[2].upper() in ("RET", "M17"):
            return False
        texts = split_arguments(match[3][1:-1]) if match[3] and match[3] != "()" else []
        self.reader.corners.finish()
        if (match[1] or "").upper() == "MCALL":
            given = self.reader.arguments(",".join(texts)) if texts else []
            self.reader.cycles.modal = (match[2], given)
        else:
            rounds = int(self.reader.variables.value(match[4])) if match[4] else 1
            self.reader.says_flow()
            self.reader.subprograms.call(match[2], texts, rounds)
        return True

    def _declare(self, text: str) -> None:
        for piece in split_arguments(text):
            name, _, value = piece.partition("=")
            self.reader.variables.declare(name.strip().upper(), value.strip())

    def _assignments(self, content: str) -> str:
        """Obey ``R1=5 R2=R1*2``; gives what else the block holds."""
        found = self._assigned(content)
        if found is None or found[1].upper() in ADDRESSES or NO_MOTION_WORDS.match(content):
            return content
        while found is not None and found[1].upper() not in ADDRESSES:
            text = _STRING.match(found[2])
            if text is not None:
                self.reader.controller.note(found[1].upper(), "text of the program")
                stop = found.start(2) + text.end()
            else:
                value, stop = self.reader.variables.read(content, found.start(2))
                self.reader.variables.assign(found[1].upper(), value)
            content = content[stop:].strip()
            found = self._assigned(content)
        return content

    def _assigned(self, content: str) -> re.Match[str] | None:
        """The assignment with which a text begins; one letter is a variable where DEF says so."""
        letter = _LETTER.match(content)
        if letter is not None and letter[1].upper() in self.reader.variables.named:
            return letter
        return _ASSIGNED.match(content)
