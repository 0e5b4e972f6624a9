"""Lines and arcs of Klartext: L, LP, C, CP, CR, CT, and the pole CC.

HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Programming contours".
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.corners import KlartextCorners, WaitingPiece
from gcode.dialects.heidenhain.m_functions import BEFORE_MOTION, m_code
from gcode.dialects.heidenhain.motion_words import refuse_foreign
from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.dialects.heidenhain.side_planes import XY, axes_of_pole, side_arc
from gcode.errors import ProgramError
from gcode.geometry.corners import Piece
from gcode.language.translate import number, xy_words
from gcode.motion.tangent import centre_behind, tangent_centre

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.motion_words import Words
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextMotion", "centre_of_radius"]

_PLUNGING = re.compile(rf"\bM\s*103\b\s*(?:F\s*({NUMBER}))?")
_MACHINE = frozenset((91, 92))
_ELSEWHERE = frozenset((91, 92, 99, 140))  #: M codes that say how the block moves


class KlartextMotion:
    """Motion of a program.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.pole: tuple[float, float] | None = None
        self.pole_axes = XY  #: of the plane of the pole: 0, 1, 2 for X, Y, Z
        self.feed: float | None = None
        self.tool_feed: float | None = None
        self.plunge_share: float | None = None  #: M103: of the feed, at most along -Z
        self.corners = KlartextCorners(reader)
        self.sides: list[int] | None = None  #: RL and RR of a contour that is only read
        #: end of the last programmed line or arc, and its direction there
        self.tangent: tuple[tuple[float, ...], float, float] | None = None

    def belong_to(self, reader: KlartextReader) -> None:
        """Go on for a program that is called, or for the one that called it."""
        self.reader = self.corners.reader = reader

    def plunging(self, content: str) -> str:
        """Take M103 and its factor out of a block."""
        found = _PLUNGING.search(content)
        if found is None:
            return content
        said = None if found[1] is None else self.reader.parameters.number(found[1])
        self.plunge_share = None if said is None else said / 100.0
        self.reader.controller.use("M103")
        return content[: found.start()] + " " + content[found.end() :]

    # places

    def here(self) -> list[float]:
        """Programmed position X Y Z A B C."""
        c = self.reader.controller
        if self.corners.waiting is not None:
            return list(self.corners.waiting.end)
        here = list(c.position)
        if c.side and not c.entering:
            here[:3] = c.programmed
        return here

    def target(self, words: Words) -> tuple[float, ...]:
        """X Y Z A B C where the line ends."""
        end = self.here()
        for axis, letter in enumerate("XYZABC"):
            if letter in words and "I" + letter in words:
                raise ProgramError(f"{letter} and I{letter} in one line")
            end[axis] = words.get(letter, end[axis] + words.get("I" + letter, 0.0))
        return tuple(end)

    def polar_target(self, words: Words, place: Sequence[float] | None = None) -> tuple[float, ...]:
        """PR, PA, IPR, IPA about the pole, and the tool axis; from a place, or where it stands."""
        if self.pole is None:
            raise ProgramError("polar coordinates without a pole", hint="give CC first")
        here = self.here() if place is None else place
        first, second = self.pole_axes
        out = here[first] - self.pole[0], here[second] - self.pole[1]
        radius = words.get("PR", math.hypot(*out) + words.get("IPR", 0.0))
        before = math.degrees(math.atan2(out[1], out[0]))
        angle = math.radians(words.get("PA", before + words.get("IPA", 0.0)))
        others = set("XYZABC") - {"XYZ"[first], "XYZ"[second]}
        end = list(self.target({k: v for k, v in words.items() if k[-1] in others}))
        end[first] = self.pole[0] + radius * math.cos(angle)
        end[second] = self.pole[1] + radius * math.sin(angle)
        return tuple(end)

    def define_pole(self, content: str) -> None:
        """CC: pole and centre of the arcs C."""
        words, _ = self.reader.words(content.removeprefix("CC"))
        polar = words.keys() & {"PR", "PA", "IPA"}
        if polar:
            place = self.polar_target(words)
        else:
            place, self.pole_axes = self.target(words), axes_of_pole(words)
        first, second = self.pole_axes
        self.pole = place[first], place[second]

    # blocks

    def move(self, head: str, content: str) -> None:
        """A block of motion with its M functions, and the cycle that it calls."""
        reader = self.reader
        words, codes = reader.words(content)
        refuse_foreign(head, words)
        before = [m_code(reader, c) for c in codes if c in BEFORE_MOTION]
        after = [m_code(reader, c) for c in codes if c not in BEFORE_MOTION | _ELSEWHERE]
        if "F" in words:
            self.feed = words["F"]
        if "FAUTO" in words:
            self.feed = self.tool_feed
        for code in _ELSEWHERE & set(codes):
            reader.controller.use(f"M{code}")
        if 140 in codes:
            self._retract(words)
        side = self._side(words)
        self._note_ends(side)
        reader.execute(side)
        blocks = self._line(head, words, codes) if head in ("L", "LP") else self._arc(head, words)
        reader.execute(*before, blocks)
        if blocks or self.corners.waiting is None:
            reader.execute(*after)
        else:  # its motion is still to come
            self.corners.waiting = replace(self.corners.waiting, after=tuple(after))
        cycles = reader.cycles
        if 99 in codes or (cycles.modal and {"X", "Y"} & words.keys()):
            cycles.modal = cycles.modal and 99 not in codes
            cycles.do()

    def _retract(self, words: dict[str, float | str | None]) -> None:
        """M140 MB: away from the part along the tool axis, MB MAX to the end of the travel."""
        height, feed = words.pop("MB", None), words.pop("F", None)
        c = self.reader.controller
        if height is None:
            top = c.machine_position()
            top[2] = max(top[2], 0.0)
            level = c.from_machine(top)[2]
            self.reader.noted("M140 MB MAX", "to the end of the travel: machine zero of Z is taken")
        else:
            level = self.here()[2] + height
        self.reader.execute(
            f"g0z{number(level)}" if feed is None else f"g1z{number(level)}f{number(feed)}"
        )

    def _side(self, words: Words) -> str:
        """G40, G41 or G42 where the line changes it."""
        side = next((k for k in ("R0", "RL", "RR") if k in words), None)
        c = self.reader.controller
        wanted = {"R0": 0, "RL": 1, "RR": -1, None: c.side}[side]
        c.use(side or "R0")
        if self.sides is not None:
            self.sides += [wanted] if wanted else []
            return ""
        if wanted == c.side:
            return ""
        if wanted and c.side:
            raise ProgramError("RL and RR without R0 between them")
        return f"g{41 if wanted > 0 else 42}d{c.tool}" if wanted else "g40"

    def _note_ends(self, side: str) -> None:
        """RND at the first or last point under compensation: an arc of approach on old controls.

        HEIDENHAIN TNC 406, TNC 416, User's Manual, page 91.
        """
        begins = side[:3] in ("g41", "g42") and self.corners.is_next("RND")
        if begins or (side == "g40" and self.corners.corner is not None):
            self.reader.noted(
                "RND",
                "the corner is rounded; TNC 406 and older approach or leave the contour on this "
                "arc, as APPR LCT and DEP LCT do",
            )

    def _line(self, head: str, words: Words, codes: list[int]) -> str:
        rapid = "FMAX" in words
        if _MACHINE & set(codes):
            return self._line_of_machine(words, codes, rapid=rapid)
        end = self.polar_target(words) if head == "LP" else self.target(words)
        named = {name[-1] for name in words if name.lstrip("I") in ("X", "Y", "Z", *"ABC")}
        named |= {"XYZ"[k] for k in self.pole_axes} if head == "LP" else set()
        start = tuple(self.here())
        piece = Piece(start[:2], end[:2])
        self.corners.go_towards(None if rapid else piece)
        self.tangent = end[:2], end[0] - start[0], end[1] - start[1]
        if not rapid and self.corners.is_next():
            self._wait(piece, end)
            return ""
        if not named:
            return ""
        places = "".join(f"{a}{number(end[k])}" for k, a in enumerate("XYZABC") if a in named)
        out = [e - s for s, e in zip(start[:3], end[:3], strict=True)]
        return ("g0" if rapid else "g1") + places + self.feed_word(rapid, out)

    def _line_of_machine(self, words: Words, codes: list[int], *, rapid: bool) -> str:
        """M91 and M92: places of the machine."""
        if 92 in codes:
            if not rapid:
                raise ProgramError("M92 at feed: its datum is a parameter of the machine",
                                   accepted="M91, or FMAX")  # fmt: skip
            self.reader.noted(
                "M92", "its datum is a parameter of the machine; that of M91 is taken"
            )
        if any("I" + letter in words for letter in "XYZABC"):
            raise ProgramError("incremental words with M91")
        places = "".join(f"{a}{number(words[a])}" for a in "XYZABC" if a in words)
        return f"g53g{0 if rapid else 1}{places}{self.feed_word(rapid)}" if places else ""

    def _wait(self, piece: Piece, end: Sequence[float]) -> None:
        start = tuple(self.here())  # behind the corner before it
        piece = replace(piece, start=start[:2])
        line = self.reader.controller.line
        self.corners.waiting = WaitingPiece(piece, start, tuple(end), self.feed_word(False), line)

    def last_direction(self, end: Sequence[float], asks: str) -> tuple[float, float]:
        """Unit direction of the contour at its last programmed point, which a word asks for.

        Raises
        ------
        ProgramError
            The last block was no line L, LP or arc C, CR, CT that ends there.
        """
        there, x, y = self.tangent or ((math.nan, math.nan), 0.0, 0.0)
        size = math.hypot(x, y)
        if math.dist(there, end) > 1e-9 or size == 0.0:
            raise ProgramError(f"{asks} needs a line L or an arc C, CR or CT before it")
        return x / size, y / size

    def feed_word(self, rapid: bool, out: Sequence[float] = ()) -> str:
        """F word of a move, less where it plunges under M103 along `out`; none of a rapid."""
        if rapid:
            return ""
        if self.feed is None:
            raise ProgramError("motion without feed", hint="give F or FMAX")
        feed = self.feed
        if self.plunge_share is not None and out and out[2] < 0.0:
            feed = min(feed, feed * self.plunge_share * math.hypot(*out) / -out[2])
        return f"f{number(feed)}"

    def _arc(self, head: str, words: Words) -> str:
        end = self.polar_target(words) if head == "CP" else self.target(words)
        start = self.here()
        if head == "CT":
            return self._tangent_arc(start, end)
        if words.get("DR") not in ("+", "-"):
            raise ProgramError(f"{head} without DR+ or DR-")
        if head in ("C", "CP") and self.pole_axes != XY:
            side_arc(self, words, end)
            return ""
        sense = 1 if words["DR"] == "+" else -1
        centre = self._centre(head, words, start, end, sense)
        piece = Piece(tuple(start[:2]), end[:2], centre, sense)
        is_cut = self.corners.go_towards(piece)
        self.tangent = end[:2], (centre[1] - end[1]) * sense, (end[0] - centre[0]) * sense
        turns = math.ceil(abs(words.get("IPA", 0.0)) / 360.0 - 1e-9)
        if self.corners.is_next():
            if turns > 1:
                raise ProgramError("RND behind an arc of several turns", accepted="one turn")
            self._wait(piece, end)
            return ""
        text = f"g{3 if sense > 0 else 2}{xy_words(end[0], end[1])}"
        if end[2] != start[2]:
            text += f"z{number(end[2])}"
        if head == "CR" and not is_cut:
            return text + f"r{number(words['R'])}" + self.feed_word(False)
        if turns > 1:
            text += f"p{turns}"
        start = self.here()
        offsets = (centre[0] - start[0], centre[1] - start[1])
        return text + f"i{number(offsets[0])}j{number(offsets[1])}" + self.feed_word(False)

    def _centre(
        self, head: str, words: Words, start: Sequence[float], end: Sequence[float], sense: int
    ) -> tuple[float, float]:
        if head == "CR":
            if "R" not in words:
                raise ProgramError("CR without R")
            return centre_of_radius(start, end, words["R"] * sense)
        if self.pole is None:
            raise ProgramError("C without a circle centre", hint="give CC first")
        return self.pole

    def _tangent_arc(self, start: list[float], end: tuple[float, ...]) -> str:
        """CT: the arc that goes on from the line or arc before it without a corner."""
        c = self.reader.controller
        if self.corners.waiting is not None or self.corners.is_next():
            raise ProgramError("RND or CHF beside CT is not read", accepted="L, C and CR")
        if c.side:  # the contour goes on, and not the path of the tool
            x, y, sense = centre_behind(self.last_direction(start[:2], "CT"), start, end)
        else:
            x, y, sense = tangent_centre(c.record, start, end, c.unit_mm)
        turn = math.copysign(1.0, sense)
        self.tangent = end[:2], (y - end[1]) * turn, (end[0] - x) * turn
        text = f"{'g3' if sense > 0.0 else 'g2'}{xy_words(end[0], end[1])}"
        if end[2] != start[2]:
            text += f"z{number(end[2])}"
        return text + f"i{number(x - start[0])}j{number(y - start[1])}" + self.feed_word(False)


def centre_of_radius(
    start: Sequence[float], end: Sequence[float], radius: float
) -> tuple[float, float]:
    """Centre of CR; the radius is positive where a short arc turns counter-clockwise."""
    x, y = end[0] - start[0], end[1] - start[1]
    chord = math.hypot(x, y)
    rise = math.sqrt(max(radius * radius - chord * chord / 4.0, 0.0))
    side = math.copysign(rise, radius) / chord if chord else 0.0
    return start[0] + x / 2.0 - y * side, start[1] + y / 2.0 + x * side
