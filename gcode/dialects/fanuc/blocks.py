"""A block of a Fanuc program, obeyed: frames, offsets, transformations and motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import INCREMENTS, MacroBlock
from gcode.dialects.fanuc.codes import NOTED, REFUSED
from gcode.dialects.fanuc.corners import HeldPiece
from gcode.dialects.fanuc.cycles import CYCLES, DrillingCycle
from gcode.dialects.fanuc.haas_cycles import HAAS_CYCLES, haas_cycle
from gcode.dialects.fanuc.machine_moves import (
    dwell,
    machine_position,
    reference,
    skip,
    to_reference,
)
from gcode.dialects.fanuc.modal_variables import modal_variables
from gcode.dialects.fanuc.offset_words import OffsetWords
from gcode.dialects.fanuc.settings import FanucSettings
from gcode.dialects.fanuc.transform import Transform
from gcode.dialects.fanuc.turning import check_milling
from gcode.errors import ProgramError
from gcode.motion import frames
from gcode.motion.interpolation import traverse
from gcode.state.block_values import whole
from gcode.state.codes import CODES
from gcode.state.controller import PLANE_AXES
from gcode.state.record import Call

if TYPE_CHECKING:
    from gcode.dialects.fanuc.reader import FanucReader

__all__ = ["BlockRunner", "FanucSettings"]

#: G code -> the one that does the same here; 84.2 and 84.3 are those of the Series 15 format
_SAME = ((61.0, 61.1), (62.0, 64.0), (63.0, 64.0), (84.2, 84.0), (84.3, 74.0))
_END_OF_BLOCK_M = (0, 1, 2, 5, 9, 30, 60)
_ENDS = (2, 30)
_SENSES = {13: 3, 14: 4}


class BlockRunner:
    """Obeys blocks without flow.

    Parameters
    ----------
    reader : FanucReader
    settings : FanucSettings
    """

    def __init__(self, reader: FanucReader, settings: FanucSettings) -> None:
        self.reader, self.settings, self.controller = reader, settings, reader.controller
        control = reader.options.control
        self.increments = INCREMENTS[control.increment or "calculator"]
        self.is_told = control.increment is not None or settings.only_calculator
        self.ended = False
        self.transform = Transform()
        self.polar: list[float] | None = None  #: its centre X Y Z
        self.offsets = OffsetWords(self)
        self.cycle: DrillingCycle | None = None
        self.corner: HeldPiece | None = None
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

    @property
    def is_plain(self) -> bool:
        """Whether nothing is in force that moves places or holds moves back."""
        return (self.corner is None and self.polar is None and self._known is None
                and self.transform.is_identity)  # fmt: skip

    def memory(self) -> tuple:
        """What tells one round of a loop from another."""
        return (self.transform, self.polar, self.offsets.memory(), repr(self.cycle),
                repr(self.corner))  # fmt: skip

    # blocks

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
        self._count_increments(block)
        self._refuse(block)
        self._note(block)
        after = self._m_codes(block)
        self._frames(block)
        moved = self._motion(block)
        for code in after:
            self.finish_corner()
            self.execute(f"m{30 if code in _ENDS else code}")
        return moved

    def _count_increments(self, block: MacroBlock) -> None:
        lengths = set("xyzijkrqabc") - (set("ijk") if block.has(51) else set())
        letters = sorted(block.pointless & lengths & block.words.keys())
        if not self.is_told and any(block.words[letter] for letter in letters):
            word = next(letter for letter in letters if block.words[letter])
            self._note_increments(f"{word.upper()}{block.words[word]:g}")
        for letter in letters:
            block.words[letter] *= self.increments.of(letter, unit_mm=self.controller.unit_mm)
        if block.corner is not None and "," in block.pointless:
            kind, size = block.corner
            block.corner = (kind, size * self.increments.of("r", unit_mm=self.controller.unit_mm))

    def _note_increments(self, word: str) -> None:
        notes = self.controller.notes
        if not any(name == "increment" for _, name in notes):
            self.controller.note(
                "increment", f"{word} has no decimal point and is read as it stands (calculator "
                "type); where the control counts 0.001 mm, say increment = \"IS-B\"")  # fmt: skip

    def _refuse(self, block: MacroBlock) -> None:
        for code in block.g:
            if code in REFUSED and not (code in HAAS_CYCLES and self.settings.haas_cycles):
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
            text, letters = NOTED[code]
            self.controller.note(f"G{code:g}", text)
            if code not in (64.0,):
                block.g.remove(code)
                block.pop(letters)
        for code, rs274 in _SAME:
            if code in block.g:
                block.g[block.g.index(code)] = rs274
        if block.take(60) is not None:
            self.controller.note("G60", "single direction: only the end of the rapid is taken")
            block.g += [] if block.has(0) else [0.0]

    def _m_codes(self, block: MacroBlock) -> list[int]:
        """Obey the M codes that act before the motion; gives those that act after it."""
        after = [code for code in block.m if code in _END_OF_BLOCK_M]
        before = [code for code in block.m if code not in after]
        block.m = []
        tool = block.pop("t")
        if tool:
            self.execute(f"t{whole(tool['t'], 'T word')}")
        if "s" in block.words:
            self.execute(f"s{block.words.pop('s'):g}")
        for code in before:
            if code in (3, 4, 6, 7, 8, 19):
                self.finish_corner()
                if code == 19:
                    block.pop("pr")
                self.execute(f"m{code}")
            elif code in _SENSES:
                self.execute(f"m{_SENSES[code]}m8")
            elif code in self.settings.z_home_m:
                self.finish_corner()
                to_reference(self, {"z": self.here()[2]}, 28.0)
            elif code in self.settings.builder_m:
                block.pop("p" if code not in (29,) else "")
                self.controller.note(f"M{code}", self.settings.builder_m[code])
            elif code in self.reader.options.control.ignore_m:
                self.controller.note(f"M{code}", "machine builder's code, ignored by ignore_m")
            else:
                raise self._unknown_m()
        return after

    def _unknown_m(self) -> ProgramError:
        """One error for all M codes of the program that nobody knows."""
        known = {*self.settings.builder_m, *self.settings.z_home_m, *_SENSES, *_END_OF_BLOCK_M,
                 *self.reader.options.control.ignore_m, 3, 4, 6, 7, 8, 19, 97, 98, 99}  # fmt: skip
        found = self.reader.m_codes() - known
        listed = ", ".join(str(code) for code in sorted(found))
        names = " ".join(f"M{code}" for code in sorted(found))
        return ProgramError(
            f"M codes of the machine's builder: {names}",
            accepted=f"ignore_m = [{listed}] in [control], if they move nothing",
        )

    # frames and offsets

    def _frames(self, block: MacroBlock) -> None:
        """Everything before the motion; takes its words out of the block."""
        self._extended_system(block)
        for codes in ((20, 21), (17, 18, 19), (90, 91), (93, 94, 95), (61.1, 64),
                      (98, 99), (54, 55, 56, 57, 58, 59)):  # fmt: skip
            code = block.take(*codes)
            if code is not None:
                self.finish_corner()
                self.execute(f"g{code:g}")
        if "f" in block.words and not block.has(93) and self.controller.feed_mode != "inverse":
            self.execute(f"f{block.words.pop('f')!r}")
        self._polar(block)
        self._transformations(block)
        self.offsets.obey(block)
        if block.has(52, 92):
            self.finish_corner()
            self.execute(MacroBlock(block.pop("xyzabc"), g=[block.take(52, 92)]).text())
        if block.has(92.1):
            block.take(92.1)
            self.execute("g92.1")

    def _extended_system(self, block: MacroBlock) -> None:
        """G54.1 P5, G154 P5: further work offsets; G110 to G129 of Haas are the first of them."""
        if self.settings.haas_cycles:
            for code in [code for code in block.g if code in range(110, 130)]:
                block.g.remove(code)
                frames.select_system(self.controller, f"G54.1 P{code - 109:.0f}")
        code = block.take(54.1, 154)
        if code is None and block.has(54) and "p" in block.words:
            code = block.take(54)
        if code is None:
            return
        if "p" not in block.words:
            raise ProgramError(f"G{code:g} without P word", accepted="P1 to P99")
        frames.select_system(self.controller, f"G54.1 P{whole(block.words.pop('p'), 'P word')}")

    def _polar(self, block: MacroBlock) -> None:
        if block.take(15) is not None:
            self.polar = None
        if block.take(16) is not None:
            absolute = self.controller.absolute
            self.polar = [0.0] * 3 if absolute else list(self.here())
        # with G16 the first axis of the plane is a radius, the second an angle

    def _transformations(self, block: MacroBlock) -> None:
        controller = self.controller
        codes = [code for code in (50.1, 51.1, 50.0, 51.0, 68.0, 69.0) if code in block.g]
        if not codes:
            return
        self.finish_corner()
        controller.require_no_compensation("change scaling, rotation or mirror image")
        for code in codes:
            block.g.remove(code)
            if code in (50.1, 51.1):
                self.transform = self.transform.mirrored(block.pop("xyz"), on=code == 51.1)
            elif code == 50.0:
                self.transform = self.transform.unscaled()
            elif code == 51.0:
                self.transform = self._scaling(block)
            elif code == 69.0:
                self.transform = self.transform.unrotated()
            else:
                self.transform = self._rotation(block)

    def _scaling(self, block: MacroBlock) -> Transform:
        words = block.pop("xyzijkp")
        if not words.keys() & set("ijkp"):
            raise ProgramError("G51 without scale factor", accepted="P, or I J K")
        if not self.settings.pointless_factor and block.pointless & words.keys() & set("ijkp"):
            raise ProgramError(
                "G51 with a scale factor without a decimal point",
                accepted="P1.5; its unit is parameter 5400#7 of the control",
            )
        return self.transform.scaled(words, self.here())

    def _rotation(self, block: MacroBlock) -> Transform:
        if "r" not in block.words:
            raise ProgramError("G68 without R word", accepted="R with the angle in degrees")
        first, second, _ = PLANE_AXES[self.controller.plane]
        words, here = block.pop("xyzr"), self.here()
        pivot = (words.get("xyz"[first], here[first]), words.get("xyz"[second], here[second]))
        angle = words["r"]
        if not self.controller.absolute and self.transform.angle_deg:
            angle += self.transform.angle_deg
        return self.transform.rotated(pivot, angle, self.controller.plane)

    # positions

    def here(self) -> list[float]:
        """Programmed position X Y Z before transformations, program units."""
        if self.corner is not None:
            return list(self.corner.end)
        return self._programmed() if self._known is None else list(self._known)

    _known: list[float] | None = None  #: while transformations make it differ from the control's

    def _programmed(self) -> list[float]:
        c = self.controller
        return list(c.programmed if c.side and not c.entering else c.position[:3])

    def target(self, block: MacroBlock) -> list[float]:
        """Programmed end X Y Z of a block."""
        here, words = self.here(), block.words
        if self.polar is not None:
            return self._polar_target(here, words)
        if self.controller.absolute:
            return [words.get(a, h) for a, h in zip("xyz", here, strict=True)]
        return [h + words.get(a, 0.0) for a, h in zip("xyz", here, strict=True)]

    def _polar_target(self, here: list[float], words: dict[str, float]) -> list[float]:
        first, second, axial = PLANE_AXES[self.controller.plane]
        names = "xyz"
        end, absolute, centre = list(here), self.controller.absolute, self.polar
        step = words.get(names[axial], 0.0 if not absolute else here[axial])
        end[axial] = step if absolute else here[axial] + step
        if names[first] in words or names[second] in words:
            out = here[first] - centre[first], here[second] - centre[second]
            radius = words.get(names[first], math.hypot(*out))
            before = math.degrees(math.atan2(out[1], out[0]))
            angle = words.get(names[second], before if absolute else 0.0)
            angle = math.radians(angle if absolute else before + angle)
            end[first] = centre[first] + radius * math.cos(angle)
            end[second] = centre[second] + radius * math.sin(angle)
        return end

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
            previous = self.cycle
            level = previous.initial if previous else self.here()[self._axial]
            self.cycle = DrillingCycle(code, level, previous)
        return self.cycle.obey(self, block)

    @property
    def _axial(self) -> int:
        return PLANE_AXES[self.controller.plane][2]

    def interpolate(self, block: MacroBlock, code: float | None) -> bool:
        """G0 to G3, transformed where a transformation is on."""
        axes = bool(block.words.keys() & set("xyzabcijkr"))
        if code is None and not axes:
            if block.g or block.words:
                self.execute(block.text())
            return False
        if code is None and self.controller.motion in (None, "G80"):
            self.controller.motion = "G0"
        if block.corner is not None or self.corner is not None:
            return self._with_corner(block, code)
        if self.transform.is_identity and self.polar is None:
            self.forget()
            self._arc_without_end(block, code)
            self.execute(block.text())
            return bool(block.words.keys() & set("xyzabcijk"))
        return self._transformed(block, code)

    def _arc_without_end(self, block: MacroBlock, code: float | None) -> None:
        """A block that says an arc's motion and feed alone moves nothing."""
        if code in (2.0, 3.0) and not block.words.keys() & set("xyzijkr"):
            block.g.remove(code)
            self.controller.motion = f"G{code:g}"

    def _with_corner(self, block: MacroBlock, code: float | None) -> bool:
        motion = f"G{code:g}" if code is not None else self.controller.motion
        piece = HeldPiece(self, self.here(), self.target(block), motion, block)
        held, self.corner = self.corner, None
        if held is not None:
            held.round_towards(piece)
        if block.corner is None:
            piece.go(piece.end)
        else:
            self.corner, self.controller.motion = piece, motion
        return True

    def finish_corner(self) -> None:
        """Obey a line that waits for the one behind it."""
        held, self.corner = self.corner, None
        if held is not None:
            raise ProgramError(",R or ,C without a line or arc behind it")

    def straight_to(self, end: list[float], motion: str, block: MacroBlock | None = None) -> None:
        """Go to a programmed point; other words of the block with it."""
        words = dict(block.words) if block else {}
        words |= dict(zip("xyz", end, strict=True))
        self._transformed(MacroBlock(words, g=[float(motion[1:])]), float(motion[1:]),
                          absolute=True)  # fmt: skip

    def _transformed(
        self, block: MacroBlock, code: float | None, *, absolute: bool = False
    ) -> bool:
        """A block whose end is said in absolute numbers of the control's own system."""
        c, words = self.controller, block.words
        modal = f"G{code:g}" if code is not None else c.motion
        if absolute:
            end = [words.get(a, h) for a, h in zip("xyz", self.here(), strict=True)]
        else:
            end = self.target(block)
        motion, named = modal, words.keys() & set("xyz")
        goal = self.transform.point(end)
        now = self._programmed()
        said = {a: g for a, g, n in zip("xyz", goal, now, strict=True)
                if a in words or abs(g - n) > 0.0}  # fmt: skip
        said |= {k: v for k, v in words.items() if k not in "xyzijkr"}
        if motion in ("G2", "G3"):
            motion = self._arc_words(words, said, motion)
        others = [g for g in block.g if getattr(CODES.get(f"G{g:g}"), "group", "") != "motion"]
        was_absolute, c.absolute = c.absolute, True
        try:
            self.execute(MacroBlock(said, g=[*others, float(motion[1:])]).text())
        finally:
            c.absolute = was_absolute
        c.motion = modal
        self._known = None if self.transform.is_identity else end
        return bool(named)

    def _arc_words(self, words: dict[str, float], said: dict[str, float], motion: str) -> str:
        """I J K or R after the transformation; gives the arc's sense."""
        plane = self.controller.plane
        first, second, _ = PLANE_AXES[plane]
        if "r" in words:
            said["r"] = words["r"] * self.transform.arc_factor(plane)
            for axis in (first, second):
                said.setdefault("xyz"[axis], self.transform.point(self.here())[axis])
        else:
            self.transform.arc_factor(plane)
            out = self.transform.vector([words.get(k, 0.0) for k in "ijk"])
            said |= {"ijk"[axis]: out[axis] for axis in (first, second)}
        return {"G2": "G3", "G3": "G2"}[motion] if self.transform.flips(plane) else motion

    def forget(self) -> None:
        """The control's own position is the programmed one again."""
        self._known = None

    def arc_to(self, block: MacroBlock, code: float) -> None:
        """An arc to a programmed point, whatever the modes are."""
        self._transformed(block, code, absolute=True)

    def place_for_hole(self, end: list[float]) -> None:
        """Rapid in the plane to a programmed point; the axis of the plane stays."""
        goal, c = self.transform.point(end), self.controller
        position = list(c.position)
        for axis in range(3):
            if axis != self._axial:
                position[axis] = goal[axis]
        traverse(c, position, Call.TRAVERSE)
        self._known = None if self.transform.is_identity else list(end)

    def stand_at(self, point: list[float]) -> None:
        """The programmed position after a hole."""
        self._known = None if self.transform.is_identity else point
