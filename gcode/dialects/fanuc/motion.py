"""Motion of a Fanuc program in programmed coordinates: polar, transformed, with corners."""

from __future__ import annotations

import math

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.corners import HeldPiece
from gcode.dialects.fanuc.transform import Transform
from gcode.errors import ProgramError
from gcode.motion.interpolation import traverse
from gcode.state.codes import CODES
from gcode.state.controller import PLANE_AXES, Controller
from gcode.state.record import Call

__all__ = ["ProgrammedMotion"]


class ProgrammedMotion:
    """Where the program stands, and moves from there.

    Parameters
    ----------
    controller : Controller
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.transform = Transform()
        self.polar: list[float] | None = None  #: its centre X Y Z
        self.corner: HeldPiece | None = None
        self._behind: list[str] = []  #: what comes after the piece that waits
        self._known: list[float] | None = None  #: while it differs from the control's position

    def execute(self, text: str) -> None:
        """Hand a block of RS274/NGC to the interpreter."""
        raise NotImplementedError

    def keep(self, why: str) -> None:
        """The line that is obeyed cannot be written anew."""
        raise NotImplementedError

    @property
    def is_plain(self) -> bool:
        """Whether nothing is in force that moves places or holds moves back."""
        return (self.corner is None and self.polar is None and self._known is None
                and self.transform.is_identity)  # fmt: skip

    def here(self) -> list[float]:
        """Programmed position X Y Z before transformations, program units."""
        if self.corner is not None:
            return list(self.corner.end)
        return self._programmed() if self._known is None else list(self._known)

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

    @property
    def axial(self) -> int:
        """Index of the axis square to the plane."""
        return PLANE_AXES[self.controller.plane][2]

    def interpolate(self, block: MacroBlock, code: float | None) -> bool:
        """G0 to G3, transformed where a transformation is on."""
        axes = bool(block.words.keys() & set("xyzabcijkr"))
        if code is None and not axes:
            if block.g or block.words:
                self.finish_corner()
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
        self.keep("rotation, scaling, mirror image or G16")
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
            behind, self._behind = self._behind, []
            for text in behind:
                self.execute(text)
        if block.corner is None:
            piece.go(piece.end)
        else:
            self.corner, self.controller.motion = piece, motion
        return True

    def in_order(self, text: str) -> None:
        """Hand over a block without motion, behind the piece that waits for its corner."""
        if self.corner is None:
            self.execute(text)
        else:
            self._behind.append(text)

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
            if axis != self.axial:
                position[axis] = goal[axis]
        traverse(c, position, Call.TRAVERSE)
        self._known = None if self.transform.is_identity else list(end)

    def stand_at(self, point: list[float]) -> None:
        """The programmed position after a hole."""
        self._known = None if self.transform.is_identity else point
