"""CYCL DEF and CYCL CALL: which cycle is defined, and where it is done.

Source: HEIDENHAIN TNC 640, User's Manual Cycle Programming: Z of CYCL CALL POS shifts the cycle
beside its Q203, and Z of PATTERN DEF counts on top of it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles import face
from gcode.dialects.heidenhain.cycles.contour_cycles import CONTOUR_CYCLES, ContourCycles
from gcode.dialects.heidenhain.cycles.drilling import DRILLING, drill
from gcode.dialects.heidenhain.cycles.first_controls import OLD_CYCLES, old_data, renewed
from gcode.dialects.heidenhain.cycles.milling import MILLING, mill
from gcode.dialects.heidenhain.cycles.patterns import (
    PATTERNS,
    Pattern,
    pattern_definition,
    pattern_places,
)
from gcode.dialects.heidenhain.cycles.thread_milling import THREADS, mill_thread
from gcode.dialects.heidenhain.m_functions import m_code
from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["CycleCalls"]

#: cycles that change nothing of the path
_NOTED = {
    32: "tolerance of the control's path",
    13: "orientation of the spindle",
    392: "adaption of the control to the load",
    332: "tolerance of the control's path",
}
_FRAMES = frozenset((7, 8, 10, 11, 26))
#: cycles that a call runs
_CALLED = frozenset((*DRILLING, *MILLING, *THREADS, *CONTOUR_CYCLES, *face.FACES))


class CycleCalls:
    """Cycles of a program.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.cycle: tuple[int, dict[str, float]] | None = None
        self.modal = False  #: M89
        self.old: tuple[int, dict[int, dict[str, float]]] | None = None  #: an old cycle's lines
        self.pattern: list[Pattern] = []
        self.contour = ContourCycles()

    # definitions

    def define(self, content: str) -> None:
        """CYCL DEF, with the lines of parameters behind it."""
        text = content.removeprefix("CYCL DEF").strip()
        text = re.sub(r"^(\d+)\s+\.(\d)", r"\1.\2", text)
        code = re.match(r"(\d+)(?:\.(\d+))?", text)
        if code is None:
            raise ProgramError(f"cannot read '{content}'", accepted="CYCL DEF with a number")
        cycle = int(code[1])
        data = self._data(text)
        if cycle in _CALLED:
            self.cycle, self.old = (cycle, data), None
        elif cycle == 14:
            self.contour.name_labels(text)
        elif cycle == 20:
            self.contour.data = data
        elif cycle == 270:
            self.contour.train = data
            self.reader.controller.note("CYCL DEF 270", "the way to the contour is the control's")
        elif cycle in OLD_CYCLES and code[2] is not None:
            self._old_line(text)
        elif cycle in PATTERNS:
            self._pattern(cycle, data)
        elif cycle == 247:
            self.reader.frames.presets.activate(data.get("339"))
        elif cycle in _NOTED:
            self.reader.controller.note(f"CYCL DEF {cycle}", _NOTED[cycle])
        elif cycle == 9:
            self._dwell(text)
        elif cycle in _FRAMES:
            self.reader.frames.define(cycle, text)
        elif cycle == 19 and _changes_nothing(text):
            self.reader.controller.note(f"CYCL DEF {cycle}", "changes nothing")
        else:
            known = sorted(
                {*_CALLED, *PATTERNS, *OLD_CYCLES, *_FRAMES, *_NOTED, 9, 14, 20, 247, 270}
            )
            raise ProgramError(
                f"Klartext cycle '{content}' is not read",
                accepted="CYCL DEF " + ", ".join(map(str, known)),
                hint=_why_refused(cycle) + "post the program without this cycle",
            )

    def _data(self, text: str) -> dict[str, float]:
        """Q parameters of a cycle, on its line and on those that follow."""
        reader, pieces = self.reader, [text]
        while reader.next < len(reader.lines):
            content = reader.content(reader.next)
            if not re.match(r"Q\d+\s*=", content):
                break
            if re.match(r"\s*\d+\s+", reader.lines[reader.next]):  # a block of its own
                break
            pieces.append(content)
            reader.next += 1
        data = {}
        for name, value in re.findall(
            rf"Q(\d+)\s*=\s*({NUMBER}|F?\s*MAX|F?\s*AUTO)", " ".join(pieces)
        ):
            if value.endswith("AUTO") and reader.motion.tool_feed is not None:
                data[name] = reader.motion.tool_feed
            elif not value.endswith(("MAX", "AUTO")):
                data[name] = reader.parameters.number(value)
        reader.parameters.values |= data
        return data

    def _old_line(self, text: str) -> None:
        found = old_data(text, self.reader.parameters.number)
        if found is None:
            self.old, self.cycle = (int(re.match(r"\d+", text)[0]), {}), None
        elif self.old is None or self.old[0] != found[0]:
            raise ProgramError(f"CYCL DEF {text} without CYCL DEF {found[0]}.0")
        else:
            self.old[1][found[1]] = found[2]

    def _dwell(self, text: str) -> None:
        found = re.search(rf"9\.1\D*?({NUMBER})\s*$", text)
        if found:
            self.reader.execute(f"g4p{number(self.reader.parameters.number(found[1]))}")

    # calls

    def call(self, content: str) -> None:
        """CYCL CALL, CYCL CALL POS and CYCL CALL PAT."""
        reader = self.reader
        if content.startswith("CYCL CALL POS"):
            words, _ = reader.words(content.removeprefix("CYCL CALL POS"))
            self._call_position(words, reader.motion.target(words))
        elif content.startswith("CYCL CALL PAT"):
            self._call_pattern()
        else:
            codes = re.findall(r"M\s*(\d+)", content)
            reader.execute(*(m_code(reader, int(code)) for code in codes))
            self.do()

    def _call_position(self, words: Mapping, end: Sequence[float]) -> None:
        """At a place; its Z is an additional datum shift of the cycle."""
        shift = float(words.get("Z", 0.0))
        if shift and (self.cycle is None or "203" not in self.cycle[1]):
            raise ProgramError(f"CYCL CALL POS with Z{shift:+g} beside a cycle without Q203",
                               accepted="Z+0, or CYCL DEF 7 with the shift")  # fmt: skip
        self.reader.execute(f"g0{xy_words(end[0], end[1])}")
        if shift:
            number_, data = self.cycle
            self._run(number_, _raised(data, shift))
        else:
            self.do()

    def do(self) -> None:
        """Do the cycle in force at the present place."""
        if self.old is not None:
            self._run(*renewed(*self.old, self.reader.here()[2]))
        elif self.cycle is None:
            raise ProgramError("no cycle to call", accepted="CYCL DEF 200 ... before it")
        else:
            self._run(*self.cycle)

    def _run(self, cycle: int, data: dict[str, float]) -> None:
        if not self.reader.frames.scaling.is_identity:
            raise ProgramError(f"cycle {cycle} with scaling (CYCL DEF 11 or 26) is not read",
                               hint="cancel the scaling first")  # fmt: skip
        if cycle in CONTOUR_CYCLES:
            self.contour.run(self.reader, cycle, data)
            return
        how = mill if cycle in MILLING else mill_thread if cycle in THREADS else drill
        how = face.mill if cycle in face.FACES else how
        how(self.reader, cycle, data)

    def define_pattern(self, content: str) -> None:
        """PATTERN DEF, with its further lines."""
        reader, pieces = self.reader, [content.removeprefix("PATTERN DEF")]
        while reader.next < len(reader.lines) and re.match(
            r"(?:POS|ROW|PAT|FRAME|CIRC|PITCHCIRC)\s*\d+\s*\(", reader.content(reader.next)
        ):
            pieces.append(reader.content(reader.next))
            reader.next += 1
        self.pattern = pattern_definition(" ".join(pieces), reader.parameters.number)

    def _call_pattern(self) -> None:
        if not self.pattern:
            raise ProgramError("CYCL CALL PAT without places", accepted="PATTERN DEF before it")
        if self.cycle is None:
            raise ProgramError("no cycle to call", accepted="CYCL DEF 200 ... before it")
        number_, data = self.cycle
        for x, y, level in self.pattern:
            self._at(x, y, number_, _raised(data, level))

    def _pattern(self, cycle: int, data: dict[str, float]) -> None:
        """Cycles 220 and 221 call the cycle before them, with their own levels."""
        if self.cycle is None:
            raise ProgramError(
                f"CYCL DEF {cycle} without a cycle before it", accepted="CYCL DEF 200 ... before it"
            )
        number_, own = self.cycle
        levels = {name: data[name] for name in ("200", "203", "204") if name in data}
        for x, y in pattern_places(cycle, data):
            self._at(x, y, number_, own | levels)

    def _at(self, x: float, y: float, cycle: int, data: dict[str, float]) -> None:
        reader = self.reader
        out = data.get("203", 0.0) + max(data.get("200", 0.0), data.get("204", 0.0))
        if reader.here()[2] < out:
            reader.execute(f"g0z{number(out)}")
        reader.execute(f"g0{xy_words(x, y)}")
        self._run(cycle, data)


def _raised(data: dict[str, float], by: float) -> dict[str, float]:
    """Data of a cycle whose surface lies higher."""
    return data | {"203": data.get("203", 0.0) + by} if by else data


def _why_refused(cycle: int) -> str:
    if cycle == 19:
        return "it tilts the plane, which a three-axis machine cannot; "
    if 800 <= cycle < 900:
        return "it is a cycle of turning programs; "
    return ""


def _changes_nothing(text: str) -> bool:
    body = re.sub(r"^\d+\.\d+\s*", "", text)
    return not re.search(r"\d", body) or bool(
        re.fullmatch(r"(?:(?:[ABC]|MB\s*MAX)\s*[+-]?0*\.?0*\s*|SCL\s*1(?:\.0*)?)+", body)
    )
