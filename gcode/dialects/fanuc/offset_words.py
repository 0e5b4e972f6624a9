"""H, D and G10: length and cutter offsets, work offsets (B-64484EN, -2)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.motion import frames
from gcode.state.block_values import whole
from gcode.state.controller import WORK_OFFSETS
from gcode.state.tools import ToolEntry
from gcode.text.parameters import system_base

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["OffsetWords"]

#: L of G10 -> column of the offset memory
_COLUMNS = {1: "length_wear_mm", 10: "length_mm", 11: "length_wear_mm", 12: "diameter_mm",
            13: "diameter_wear_mm"}  # fmt: skip
_SYSTEMS = 6


class OffsetWords:
    """What H and D say, and the forms of G10."""

    def __init__(self, runner: BlockRunner) -> None:
        self.runner, self.controller = runner, runner.controller
        self.h: float | None = None
        self.d: float | None = None
        self._applied: dict[str, float] = {}  #: external offset in the stored work offsets, mm
        self.length_sign = 0  #: of G43 and G44 while one is on

    def memory(self) -> tuple:
        """What tells one round of a loop from another."""
        return self.h, self.d, self.length_sign, tuple(self.runner.reader.variables.external_mm)

    def obey(self, block: MacroBlock) -> None:
        """G43, G44, G49 with H; G40, G41, G42 with D."""
        if block.has(10, 11):
            return
        self._length(block)
        self._radius(block)

    def _length(self, block: MacroBlock) -> None:
        code, said = block.take(43, 44, 49), "h" in block.words
        if said:
            self.h = block.words.pop("h")
        if code == 49.0:
            self.length_sign = 0
        elif code is not None:
            self.length_sign = 1 if code == 43.0 else -1
        if code is None and not (said and self.length_sign):
            return
        self.runner.finish_corner()
        number = 0 if self.h is None else whole(self.h, "H word")
        controller, before = self.controller, list(self.controller.position)
        if self.length_sign == 0 or number == 0:
            self.runner.execute("g49")  # H0 holds zero
        else:
            controller.find_offset(number, word="H")
            if self.length_sign > 0:
                self.runner.execute(f"g43h{number}")
            else:
                self._negative(number)
        if not controller.absolute:  # in G91 the axes move by the change of the offset as well
            for axis, letter in enumerate("xyz"):
                if letter in block.words:
                    block.words[letter] += before[axis] - controller.position[axis]

    def _negative(self, tool: int) -> None:
        """G44: the offset with its sign changed."""
        offset = [-v for v in self.controller.tool_offset_of(tool, word="H")]
        self.runner.execute("g43.1" + "".join(
            f"{a}{number(v)}" for a, v in zip("xyz", offset[:3], strict=True)))  # fmt: skip

    def _radius(self, block: MacroBlock) -> None:
        if "d" in block.words:
            self.d = block.words.pop("d")
        code = block.take(40, 41, 42)
        if code is None:
            return
        self.runner.finish_corner()
        if code == 40.0:
            self.runner.execute("g40")
            return
        if self.runner.transform.flips(self.controller.plane):
            code = 83.0 - code
        side = 1 if code == 41.0 else -1
        if self.controller.side == side:
            return
        number = 0 if self.d is None else whole(self.d, "D word")
        if number == 0:
            raise ProgramError(
                f"G{code:g} without D word, or with D0",
                accepted="D with a number of the offset memory",
            )
        self.runner.execute(f"g{code:g}d{number}")

    # G10

    def write(self, block: MacroBlock) -> bool:
        """G10 in its forms; G11 ends a list of parameters."""
        if block.take(11) is not None:
            return False
        block.take(10)
        words = block.pop("lprxyzabcijk")
        form = whole(words.get("l", 1.0), "L word of G10")
        if form in _COLUMNS:
            self._write_tool(words, form)
        elif form == 2:
            self._write_system(words)
        elif form == 20:
            number = self._number(words, form, 1, len(WORK_OFFSETS) - 9)
            self._set_system(WORK_OFFSETS.index(f"G54.1 P{number}") + 1, words)
        else:
            raise ProgramError(
                f"G10 L{form} is not read",
                accepted="L1 L2 L10 L11 L12 L13 L20",
                hint="L50, L52 write parameters of the control",
            )
        return False

    @staticmethod
    def _number(words: dict[str, float], form: int, low: int, high: int) -> int:
        number = whole(words.get("p", -1.0), "P word of G10")
        if not low <= number <= high:
            raise ProgramError(f"P{number} with G10 L{form}", accepted=f"P{low} to P{high}")
        return number

    def _write_tool(self, words: dict[str, float], form: int) -> None:
        number = self._number(words, form, 1, 999)
        if "r" not in words:
            raise ProgramError(f"G10 L{form} without R word", accepted="R with the offset")
        c, name = self.controller, _COLUMNS[form]
        size = words["r"] * c.unit_mm
        if name.startswith("diameter") and self.runner.settings.radius_in_d:
            size *= 2.0
            c.note(f"G10 L{form}", "D holds radii (parameter 5004#2 ODI = 0)")
        entry = c.offsets.get(number, ToolEntry())
        if not c.absolute:
            size += getattr(entry, name)
        c.offsets[number] = replace(entry, **{name: size})
        c.set_tool_parameters()

    def write_axis(self, system: int, letter: str, value: float) -> None:
        """A variable of a work offset; 0 is the external one."""
        c = self.controller
        was, c.absolute = c.absolute, True
        self._write_system({"p": float(system), letter: value})
        c.absolute = was

    def _write_system(self, words: dict[str, float]) -> None:
        number = self._number(words, 2, 0, _SYSTEMS)
        if number:
            self._set_system(number, words)
            return
        c, external = self.controller, self.runner.reader.variables.external_mm
        for axis, letter in enumerate("xyzabc"):
            if letter in words:
                scale = c.unit_mm if axis < 3 else 1.0
                external[axis] = words[letter] * scale + (0.0 if c.absolute else external[axis])
        changed = {a: external[k] for k, a in enumerate("xyzabc") if a in words}
        self._shift_all(changed)

    def _shift_all(self, external_mm: dict[str, float]) -> None:
        """The external offset is part of every work offset."""
        c, before = self.controller, dict(self._applied)
        self._applied |= external_mm
        for system in range(1, len(WORK_OFFSETS) + 1):
            stored = c.to_program(c.parameters.vector(system_base(system)))
            for axis, letter in enumerate("xyzabc"):
                unit = c.unit_mm if axis < 3 else 1.0
                moved = self._applied.get(letter, 0.0) - before.get(letter, 0.0)
                stored[axis] += moved / unit
            self._store(system, stored)

    def _set_system(self, system: int, words: dict[str, float]) -> None:
        c = self.controller
        stored = c.to_program(c.parameters.vector(system_base(system)))
        external = c.to_program(self.runner.reader.variables.external_mm)
        for axis, letter in enumerate("xyzabc"):
            if letter in words:
                own = 0.0 if c.absolute else stored[axis] - external[axis]
                stored[axis] = own + words[letter] + external[axis]
        self._store(system, stored)

    def _store(self, system: int, offset: list[float]) -> None:
        c = self.controller
        c.parameters.set_vector(system_base(system), c.to_machine_units(offset))
        if system == c.system:
            c.require_no_compensation("change the active work system")
            frames.apply_system(c, offset, c.rotation_deg)
