"""RND, RNDM, CHF and CHR: a line or arc waits for the next one, and their corner is broken.

Source: SINUMERIK 840D sl/828D, Programming Manual Fundamentals, "Chamfer, rounding (CHF, CHR, RND,
RNDM)": RND a radius, CHR a length along each line, CHF the length of the chamfer itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.block_words import Words
from gcode.dialects.sinumerik.codes import STOPS
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point, centre_from_offsets, centre_from_radius
from gcode.geometry.corners import Piece, broken_corner
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["SinumerikCorners", "WaitingPiece"]

_CORNERS = ("RND", "CHF", "CHR")
_OF_CORNERS = (*_CORNERS, "RNDM", "FRC", "FRCM", "ADIS", "DISC")
_SENSE = {"G1": 0, "G2": -1, "G3": 1}


@dataclass(frozen=True)
class WaitingPiece:
    """A line or arc at feed and what is to become of its end.

    Attributes
    ----------
    piece : Piece
        In the plane.
    start_level, end_level : float
        Z.
    kind : str
        ``RND``, ``CHF`` or ``CHR``.
    size : float
    head : str
        The other words of its block, as RS274/NGC.
    line : int
    """

    piece: Piece
    start_level: float
    end_level: float
    kind: str
    size: float
    head: str
    line: int

    def going_to(self, end: Point) -> str:
        """Its block, to a place before its end."""
        piece, code = self.piece, {0: 1, 1: 3, -1: 2}[self.piece.sense]
        text = f"{self.head}g90g{code}{xy_words(end[0], end[1])}"
        if self.end_level != self.start_level:
            text += f"z{number(self.end_level)}"
        if piece.centre is not None:
            x, y = piece.centre
            text += f"i{number(x - piece.start[0])}j{number(y - piece.start[1])}"
        return text

    def blocks(self, following: Piece) -> list[str]:
        """The piece and its corner towards the next one.

        Raises
        ------
        ProgramError
            The corner does not fit.
        """
        size = self._along_lines(following)
        broken = broken_corner(self.piece, following, size, chamfer=self.kind != "RND")
        if broken is None:
            return [self.going_to(self.piece.end)]
        x, y = broken.end
        behind = xy_words(x, y)
        if self.kind == "RND":
            behind = f"g{3 if broken.sense > 0 else 2}{behind}r{number(self.size)}"
        else:
            behind = f"g1{behind}"
        return [self.going_to(broken.begin), behind]

    def _along_lines(self, following: Piece) -> float:
        if self.kind != "CHF":
            return self.size
        back, ahead = self.piece.heading(self.piece.end), following.heading(following.start)
        half = math.acos(max(-1.0, min(1.0, -back[0] * ahead[0] - back[1] * ahead[1]))) / 2.0
        return self.size / (2.0 * math.sin(half)) if half > 0.0 else self.size


class SinumerikCorners:
    """What waits for a corner, and RNDM.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.waiting: WaitingPiece | None = None
        self.rounding = 0.0  #: RNDM
        self.behind: list[str] = []  #: blocks without motion behind the piece that waits
        self._is_modal = False

    def hold(self, words: Words, g_codes: list[float], *, is_special: bool) -> bool:
        """Obey RND, CHF, CHR and RNDM; tells whether this block waits for the next.

        Parameters
        ----------
        words : list of (str, float)
            Of the block; those of corners are taken out, and ends become those that are left.
        g_codes : list of float
        is_special : bool
            An arc CIP or CT.
        """
        values, reader = dict(words), self.reader
        self.rounding = values.get("RNDM", self.rounding)
        size = [(k, values[k]) for k in _CORNERS if k in values]
        words[:] = [w for w in words if w[0] not in _OF_CORNERS]
        if not any(letter in "XYZ" for letter, _ in words):
            return self._put_off(words)
        corner = size[0] if size else ("RND", self.rounding) if self.rounding else None
        if corner is not None:
            reader.only_in_xy(corner[0] if size else "RNDM")
        code = self._motion(g_codes)
        is_piece = code in _SENSE and not is_special and "TURN" not in values
        if self.waiting is None and not (is_piece and corner):
            if size:
                raise ProgramError(
                    f"{size[0][0]} beside anything but G1, G2 and G3 is not read",
                    accepted="lines and arcs",
                )
            return False
        end, start = reader.motion.end(words, g_codes), tuple(reader.here()[:3])
        piece = self._piece(values, start, end, code) if is_piece else None
        self.finish(piece)
        words[:] = [w for w in words if w[0] not in ("X", "Y", "Z")]
        if piece is not None and corner:
            piece = replace(piece, start=tuple(reader.here()[:2]))  # behind the corner before it
            self._wait(words, g_codes, piece, (start[2], end[2]), corner)
            self._is_modal = not size
            return True
        self._go_on(words, g_codes, end, piece)
        return False

    def _put_off(self, words: Words) -> bool:
        """M, S and F of a block without motion wait until the corner before it is done."""
        others = [w for w in words if w[0] != "N"]
        if self.waiting is None or not others or not all(
            letter in "SFH" or (letter == "M" and value not in STOPS) for letter, value in others
        ):  # fmt: skip
            return False
        self.behind.append(self.reader.words.text(others))
        return True

    def _motion(self, g_codes: list[float]) -> str:
        motion = next((v for v in g_codes if v in (0.0, 1.0, 2.0, 3.0)), None)
        return self.reader.controller.motion if motion is None else f"G{motion:g}"

    def piece(
        self, words: Words, g_codes: list[float], start: tuple = (), end: tuple = ()
    ) -> Piece | None:
        """The line or arc at feed that a block asks for, from here on unless a start is said."""
        code, reader = self._motion(g_codes), self.reader
        start = start or tuple(reader.here()[:3])
        end = end or reader.motion.end(words, g_codes)
        if code not in _SENSE or (start[:2] == end[:2] and code == "G1"):
            return None
        return self._piece(dict(words), start, end, code)

    def _piece(self, values: dict[str, float], start: tuple, end: tuple, code: str) -> Piece:
        if code == "G1":
            return Piece(start[:2], end[:2])
        c = self.reader.controller
        if "CR" in values:
            centre = centre_from_radius(start[:2], end[:2], values["CR"], clockwise=code == "G2",
                                        unit_mm=c.unit_mm)  # fmt: skip
        else:
            offsets = (values.get("I", 0.0), values.get("J", 0.0))
            centre = centre_from_offsets(start[:2], end[:2], offsets, absolute=False,
                                         unit_mm=c.unit_mm, tolerance=c.tolerance)  # fmt: skip
        return Piece(start[:2], end[:2], centre, _SENSE[code])

    def _wait(
        self, words: Words, g_codes: list[float], piece: Piece, levels: tuple[float, float],
        corner: tuple[str, float],
    ) -> None:  # fmt: skip
        reader = self.reader
        reader.tools.side(words, g_codes)
        reader.execute("".join(f"g{v:.0f}" for v in g_codes if v in (90.0, 91.0)))
        others = [w for w in words if w[0] not in ("G", "CR", "I", "J")]
        self.waiting = WaitingPiece(
            piece, *levels, *corner, reader.words.text(others), reader.controller.line
        )
        reader.controller.motion = {0: "G1", 1: "G3", -1: "G2"}[piece.sense]

    def _go_on(self, words: Words, g_codes: list[float], end: tuple, piece: Piece | None) -> None:
        """Words of the block behind a corner, from where the corner ends."""
        here = self.reader.here()
        absolute = self.reader.is_absolute(g_codes)
        words += [
            (axis, e if absolute else e - h) for axis, e, h in zip("XYZ", end, here, strict=False)
        ]
        if piece is not None and piece.centre is not None:
            words[:] = [w for w in words if w[0] not in ("CR", "I", "J")]
            words += [(k, c - h) for k, c, h in zip("IJ", piece.centre, here, strict=False)]

    def finish(self, following: Piece | None = None) -> None:
        """Go along the piece that waits, with its corner where another follows."""
        self.reader.approach.finish()
        held, self.waiting = self.waiting, None
        if held is None:
            return
        if following is None:
            if not self._is_modal:
                raise ProgramError(
                    f"{held.kind} without a line or arc at feed behind it", accepted="G1, G2, G3"
                )
            blocks = [held.going_to(held.piece.end)]
        else:
            blocks = held.blocks(following)
        controller = self.reader.controller
        absolute, motion = controller.absolute, controller.motion
        behind, self.behind = self.behind, []
        with controller.told_as(held.line):
            self.reader.execute(*blocks)
        self.reader.execute(*behind)
        controller.absolute, controller.motion = absolute, motion
