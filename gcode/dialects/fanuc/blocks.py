"""A block of a Fanuc program, obeyed: frames, offsets, transformations and motion."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.codes import NOTED, REFUSED
from gcode.dialects.fanuc.cycles import CYCLES, DrillingCycle
from gcode.dialects.fanuc.frame_words import HAAS_MIRROR, obey_frames
from gcode.dialects.fanuc.haas_cycles import HAAS_CYCLES, haas_cycle
from gcode.dialects.fanuc.increments import INCREMENTS, count_increments
from gcode.dialects.fanuc.m_codes import obey_m_codes
from gcode.dialects.fanuc.machine_moves import (
    dwell,
    machine_position,
    reference,
    skip,
)
from gcode.dialects.fanuc.macro.modal_variables import modal_variables
from gcode.dialects.fanuc.motion import ProgrammedMotion
from gcode.dialects.fanuc.offset_words import OffsetWords
from gcode.dialects.fanuc.settings import FanucSettings
from gcode.dialects.fanuc.turning import check_milling
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.fanuc.reader import FanucReader

__all__ = ["BlockRunner", "FanucSettings"]

#: G code -> the one that does the same here; 84.2 and 84.3 are those of the Series 15 format
_SAME = ((61.0, 61.1), (62.0, 64.0), (63.0, 64.0), (84.2, 84.0), (84.3, 74.0))
_OF_HAAS = frozenset((*HAAS_CYCLES, *HAAS_MIRROR))  #: refused of Fanuc alone
_ENDS = (2, 30)
_NO_STOPS = (5, 9)  #: of the M codes at the end of a block


def _without_named_axes(block: MacroBlock) -> None:
    """Take out X0 Y0 Z0 of G5.1 Q2, which name the axes to be smoothed and are no places.

    FANUC, Series 15i/150i-MA, Operator's Manual (Programming), section 4.16.
    """
    named = {letter: block.words[letter] for letter in "xyzabc" if letter in block.words}
    if named and (block.words.get("q") != 2 or any(named.values())):
        raise ProgramError(
            f"G5.1 with {' '.join(named).upper()} is not read",
            accepted="G5.1 Q2 X0 Y0 Z0, which names axes",
            hint="give G5.1 a block of its own",
        )
    block.pop("xyzabc")


class BlockRunner(ProgrammedMotion):
    """Obeys blocks without flow.

    Parameters
    ----------
    reader : FanucReader
    settings : FanucSettings
    """

    def __init__(self, reader: FanucReader, settings: FanucSettings) -> None:
        super().__init__(reader.controller)
        self.reader, self.settings = reader, settings
        control = reader.options.control
        self.increments = INCREMENTS[control.increment or "calculator"]
        self.is_told = control.increment is not None or settings.only_calculator
        self.ended = False
        self.offsets = OffsetWords(self)
        self.cycle: DrillingCycle | None = None
        self.return_level: float | None = None  #: of G98, where the program says it (Okuma)
        controller = self.controller
        controller.retract_to_initial = True  # G98 after power-on
        controller.start_up = control.options.get("start_up", "A")
        if control.options.get("outer_corners") == "arcs":
            controller.round_corners_from = 0.0
        reader.variables.modal |= modal_variables(self)
        reader.variables.write_offset = self.offsets.write_axis

    # whole program

    def check_whole_program(self, lines: list[str]) -> None:
        """Refuse turning programs, which look like milling ones."""
        check_milling(lines)

    def finish(self) -> None:
        """At the end of the text."""
        self.finish_corner()
        if not self.reader.says_unit():
            said = "neither G20 nor G21: the program is read in mm"
            self.controller.notes[(1, "units")] = said

    @property
    def takes_pointless(self) -> bool:
        """Whether numbers without a point need no further note."""
        notes = self.controller.notes
        return self.is_told or any(name == "increment" for _, name in notes)

    def memory(self) -> tuple:
        """What tells one round of a loop from another."""
        return (self.transform, self.polar, self.offsets.memory(), repr(self.cycle),
                repr(self.corner))  # fmt: skip

    # blocks

    def keep(self, why: str) -> None:
        """The line that is obeyed cannot be written anew."""
        self.reader.keep(why)

    def execute(self, text: str) -> None:
        """Hand a block of RS274/NGC to the interpreter; the trace has the words as written."""
        trace, self.controller.trace = self.controller.trace, None
        try:
            self.reader.execute(text)
        finally:
            self.controller.trace = trace
        self.ended = self.ended or self.reader.ended

    def obey(self, block: MacroBlock) -> bool:
        """Obey a block; tells whether it moved the axes."""
        count_increments(self, block)
        self._refuse(block)
        self._note(block)
        after = obey_m_codes(self, block)
        obey_frames(self, block)
        moved = self._motion(block)
        for code in after:
            if code not in _NO_STOPS:
                self.finish_corner()
            self.in_order(f"m{30 if code in _ENDS else code}")
        return moved

    def _refuse(self, block: MacroBlock) -> None:
        for code in block.g:
            if code in REFUSED and not (code in _OF_HAAS and self.settings.haas_cycles):
                raise ProgramError(
                    f"G{code:g} ({REFUSED[code]}) is not read", hint="post the program without it"
                )
        for letter in "uvw":
            if letter in block.words and not (letter == "u" and block.has(4)):
                raise ProgramError(
                    f"{letter.upper()} word: incremental words of a lathe, or an "
                    "axis that does not exist here",
                    accepted="X Y Z A B C",
                )

    def _note(self, block: MacroBlock) -> None:
        for code in [code for code in block.g if code in NOTED]:
            if code == 5.1:
                _without_named_axes(block)
            text, letters = NOTED[code]
            self.controller.note(f"G{code:g}", text)
            if code not in (64.0,):
                block.g.remove(code)
                block.pop(letters)
        for code, rs274 in _SAME:
            if code in block.g:
                block.g[block.g.index(code)] = rs274
        if self.settings.smooth_g61_1 and block.has(61.1):
            block.g[block.g.index(61.1)] = 64.0
        if block.take(60) is not None:
            self.controller.note("G60", "single direction: only the end of the rapid is taken")
            block.g += [] if block.has(0) else [0.0]

        # with G16 the first axis of the plane is a radius, the second an angle

    # motion

    def _motion(self, block: MacroBlock) -> bool:
        handler = self._own_motion(block)
        if handler is not None:
            self.finish_corner()
            return handler(block)
        exact = block.take(9) is not None
        code = next((c for c in (*CYCLES, 80.0, 0.0, 1.0, 2.0, 3.0) if c in block.g), None)
        if code in CYCLES or (self.cycle is not None and code is None):
            self.finish_corner()
            return self._drill(block, code)
        if code is not None:
            self.cycle = None
            if code == 80.0:
                block.g.remove(80.0)
                self.controller.motion = "G80"
                code = next((c for c in (0.0, 1.0, 2.0, 3.0) if c in block.g), None)
                if code is None and block.words.keys() & set("xyz"):
                    block.g.append(0.0)
                    code = 0.0
        if not (block.words or block.g):
            return False
        return self._exactly(exact, lambda: self.interpolate(block, code))

    def is_drilling(self, block: MacroBlock) -> bool:
        """Whether a block has a cycle's words: of one that it says, or of the one in force."""
        if self._own_motion(block) is not None:
            return False
        said = block.has(80.0, 0.0, 1.0, 2.0, 3.0)
        return block.has(*CYCLES) or (self.cycle is not None and not said)

    def _exactly(self, exact: bool, move: Callable[[], bool]) -> bool:
        """Move with an exact stop where G9 asks for one."""
        before = self.controller.path_control
        if not exact or before == "G61.1":
            return move()
        self.execute("g61.1")
        moved = move()
        self.execute(before.lower())
        return moved

    def _own_motion(self, block: MacroBlock) -> Callable[[MacroBlock], bool] | None:
        for codes, action in (((4,), dwell), ((28, 30), reference), ((53,), machine_position),
                              ((31,), skip)):  # fmt: skip
            if block.has(*codes):
                return partial(action, self)
        if block.has(10, 11):
            return self.offsets.write
        if self.settings.haas_cycles and block.has(*HAAS_CYCLES):
            return partial(haas_cycle, self)
        return None

    def _drill(self, block: MacroBlock, code: float | None) -> bool:
        if code is not None:
            block.g.remove(code)
            self._note_moves_beside(block, code)
            previous = self.cycle
            level = previous.initial if previous else self.here()[self.axial]
            level = level if self.return_level is None else self.return_level
            self.cycle = DrillingCycle(code, level, previous)
        return self.cycle.obey(self, block)

    def _note_moves_beside(self, block: MacroBlock, code: float) -> None:
        """Two codes of one group in a block: most programs mean the cycle, some controls do not."""
        for other in (0.0, 1.0, 2.0, 3.0):
            if block.has(other):
                self.controller.note(
                    "two motions",
                    f"G{other:g} beside G{code:g} is read as the cycle; some controls cancel the "
                    "cycle there, and move to X, Y and Z",
                )
