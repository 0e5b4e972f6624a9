"""Jumps, loops and branches of SINUMERIK.

Source: SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Flexible NC programming".
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from gcode.control.loop_guard import LoopGuard
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["Flow"]

_KEYWORD = re.compile(
    r"(IF|ELSE|ENDIF|WHILE|ENDWHILE|FOR|ENDFOR|LOOP|ENDLOOP|REPEATB?|UNTIL|GOTO[FBCS]?|CASE)\b\s*(.*)",
    re.IGNORECASE,
)
_PAIRS = {
    "IF": "ENDIF",
    "WHILE": "ENDWHILE",
    "FOR": "ENDFOR",
    "LOOP": "ENDLOOP",
    "REPEAT": "UNTIL",
}
_JUMP = re.compile(r"(.*?)\s*\b(GOTO[FBC]?)\b\s*(.*)", re.IGNORECASE)
_REPEATED = re.compile(r"([A-Z_]\w+)(?:\s+([A-Z_]\w+))?(?:\s*P\s*=?\s*(.+))?", re.IGNORECASE)
_BRANCH = re.compile(r"\s*(?:(DEFAULT)|([^\s]+))\s+(GOTO[FBC]?)\s+(\w+)", re.IGNORECASE)


@lru_cache(maxsize=4096)
def _said(content: str) -> tuple[str, str] | None:
    """Word of the flow and what follows it; None for any other block."""
    match = _KEYWORD.fullmatch(content)
    return None if match is None else (match[1].upper(), match[2].strip())


@lru_cache(maxsize=4096)
def _jump(rest: str) -> tuple[str, str, str] | None:
    """Condition, GOTO and target of an IF that jumps."""
    match = _JUMP.fullmatch(rest)
    return None if match is None else (match[1], match[2].upper(), match[3].strip().upper())


class Flow:
    """Where a program goes on.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.guard = LoopGuard(reader.controller)
        #: jump, by where it stands -> the lines of its program, and the line that it goes to
        self.targets: dict[tuple[int, str, str], tuple[list[str], int]] = {}
        self.counters: dict[tuple[int, int], float] = {}  #: FOR that runs -> its end

    @staticmethod
    def is_flow(content: str) -> bool:
        """Whether a block says where the program goes on."""
        return _said(content) is not None

    def obey(self, content: str) -> bool:
        """Obey a block of the flow; tells whether it is one."""
        said = _said(content)
        if said is None:
            return False
        (keyword, rest), reader = said, self.reader
        value = reader.variables.value
        if keyword.startswith("GOTO"):
            self._goto(keyword, rest)
        elif keyword == "IF":
            self._if(rest)
        elif keyword == "ELSE":
            reader.next = self._partner("IF", reader.next) + 1
        elif keyword == "WHILE":
            if not value(rest):
                reader.next = self._partner("WHILE", reader.next) + 1
        elif keyword == "FOR":
            self._for(rest)
        elif keyword == "CASE":
            self._case(rest)
        elif keyword == "UNTIL":
            if not value(rest):
                self._back(self._opening(keyword))
        elif keyword in ("ENDWHILE", "ENDLOOP", "ENDFOR"):
            self._back(self._opening(keyword))
        elif keyword in ("REPEAT", "REPEATB") and rest:
            self._repeat(keyword, rest)
        return True

    def _if(self, rest: str) -> None:
        reader = self.reader
        jump = _jump(rest)
        if jump is not None:
            if reader.variables.value(jump[0]):
                self._goto(jump[1], jump[2])
        elif not reader.variables.value(rest):
            reader.next = self._partner("IF", reader.next, stop_at_else=True) + 1

    def _for(self, rest: str) -> None:
        match = re.fullmatch(r"(\w+|R\[.*\])\s*=\s*(.*?)\s+TO\s+(.*)", rest, re.IGNORECASE)
        if match is None:
            raise ProgramError(f"cannot read FOR {rest}", accepted="FOR R1=1 TO 10")
        reader = self.reader
        here, name, variables = reader.next - 1, match[1].upper(), reader.variables
        line = (id(reader.lines), here)
        if line in self.counters:
            variables.assign(name, variables.value(name) + 1.0)
        else:
            variables.assign(name, variables.value(match[2]))
            self.counters[line] = variables.value(match[3])
        if reader.controller.trace is not None:
            reader.controller.trace.assign(f"{name}={variables.value(name):.17g}")
        if variables.value(name) > self.counters[line]:
            del self.counters[line]
            reader.next = self._partner("FOR", reader.next) + 1

    def _case(self, rest: str) -> None:
        """``CASE(R1) OF 8 GOTOF A 6 GOTOF B DEFAULT GOTOF C``."""
        parts = re.fullmatch(r"(.*?)\s*\bOF\b\s*(.*)", rest, re.IGNORECASE)
        branches = list(_BRANCH.finditer(parts[2])) if parts else []
        if not branches or _BRANCH.sub("", parts[2]).strip():
            raise ProgramError(f"cannot read CASE {rest}", accepted="CASE(R1) OF 8 GOTOF A")
        value = self.reader.variables.value(parts[1])
        for branch in branches:
            if branch[1] or self.reader.variables.value(branch[2]) == value:
                self._goto(branch[3].upper(), branch[4])
                return

    def _repeat(self, keyword: str, rest: str) -> None:
        """REPEAT from a label to ENDLABEL or here, or between two labels; REPEATB one block."""
        match = _REPEATED.fullmatch(rest)
        if match is None:
            raise ProgramError(f"cannot read {keyword} {rest}", accepted="REPEAT LABEL P=3")
        reader = self.reader
        rounds = int(reader.variables.value(match[3])) if match[3] else 1
        start = self.line_of(match[1])
        if keyword == "REPEATB":
            stop = start + 1
        elif match[2]:
            stop = self.line_of(match[2]) + 1
        else:
            stop = reader.next - 1
            for index in range(start + 1, stop):
                head, content = reader.content(index)
                if "ENDLABEL" in ((head[4] or "").upper(), content.upper()):
                    stop = index + 1
                    break
        reader.subprograms.repeat(start, stop, rounds)

    # places

    def _keyword(self, index: int) -> tuple[str, str]:
        return _said(self.reader.content(index)[1]) or ("", "")

    def _opens(self, index: int, opening: str) -> bool:
        keyword, rest = self._keyword(index)
        is_jump = keyword == "IF" and re.search(r"\bGOTO[FBC]?\b", rest, re.IGNORECASE)
        return keyword == opening and not is_jump and not (keyword == "REPEAT" and rest)

    def _partner(self, opening: str, start: int, *, stop_at_else: bool = False) -> int:
        """Line of the end of a structure that is open at `start`."""
        depth = 0
        for index in range(start, self.reader.subprograms.routine.stop):
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
        for index in range(self.reader.next - 2, self.reader.subprograms.routine.start - 1, -1):
            if self._keyword(index)[0] == closing:
                depth += 1
            elif self._opens(index, opening):
                if depth == 0:
                    return index
                depth -= 1
        raise ProgramError(f"{closing} without {opening}")

    def line_of(self, name: str) -> int:
        """Line of a label: above this block, or below it."""
        reader, routine = self.reader, self.reader.subprograms.routine
        behind, ahead = range(routine.start, reader.next - 1), range(reader.next, routine.stop)
        found = reader.subprograms.places_of(reader.lines, routine.file).label(name, behind, ahead)
        if found is None:
            raise ProgramError(f"there is no label {name}")
        return found

    def _goto(self, keyword: str, target: str) -> None:
        reader, routine = self.reader, self.reader.subprograms.routine
        if keyword == "GOTOS":
            raise ProgramError("GOTOS repeats the program for ever", hint="use M30")
        wanted = target.strip().upper()
        jump = reader.next, keyword, wanted
        lines, index = self.targets.get(jump, (None, 0))
        if lines is reader.lines and routine.start <= index < routine.stop:
            self._back(index)
            return
        ahead = range(reader.next, routine.stop)
        behind = range(reader.next - 1, routine.start - 1, -1)
        where = {"GOTOF": ahead, "GOTOB": behind}.get(keyword, (*ahead, *behind))
        for index in where:
            head, _ = reader.content(index)
            if wanted in ((head[4] or "").upper(), f"N{head[2]}"):
                self.targets[jump] = reader.lines, index
                self._back(index)
                return
        if keyword != "GOTOC":
            raise ProgramError(f"{keyword} {wanted}: there is no such label")

    def _back(self, index: int) -> None:
        """Go on at another line."""
        reader = self.reader
        if index < reader.next:
            self.guard.jumped_back(
                index + 1,
                level=len(reader.subprograms.levels),
                executed=reader.budget.executed,
                flow=(
                    reader.variables.r,
                    reader.variables.named,
                    reader.variables.shared,
                    self.counters,
                    reader.subprograms.memory(),
                ),
            )
        reader.next = index
