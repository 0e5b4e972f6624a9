"""CYCLE71: a face in lines.

Source: SINUMERIK 808D, Programming and Operating Manual (Milling) 07/2018, 6FC5398-4DP10-0BA7,
page 189: the order of the arguments, and that VARI says roughing or finishing, and whether lines
lie along the first or the second axis, in one sense or both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.modes import check_milling_modes
from gcode.errors import ProgramError
from gcode.language.face_milling import Face, layers, mill_face
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["mill_face_cycle"]

_NAMES = [
    "RTP",
    "RFP",
    "SDIS",
    "DP",
    "PA",
    "PO",
    "LENG",
    "WID",
    "STA",
    "MID",
    "MIDA",
    "FDP",
    "FALD",
    "FFP1",
    "VARI",
    "FDP1",
]


def mill_face_cycle(reader: SinumerikReader, arguments: list[float | None]) -> None:
    """Do the cycle; the tool ends on the retraction plane."""
    said = {k: v for k, v in zip(_NAMES, arguments, strict=False) if v is not None}
    check_milling_modes("CYCLE71", arguments[len(_NAMES) :], reader.cycle_plane)
    missing = [name for name in ("RTP", "DP", "LENG", "WID", "MIDA") if name not in said]
    if missing:
        raise ProgramError(f"CYCLE71 without {missing[0]}")
    kind, way = int(said.get("VARI", 31.0)) % 10, int(said.get("VARI", 31.0)) // 10 % 10
    if kind not in (1, 2) or way not in (1, 2, 3, 4):
        raise ProgramError(f"CYCLE71 with VARI {said['VARI']:g}", accepted="11 to 42")
    c, clear = reader.controller, said.get("RFP", 0.0) + abs(said.get("SDIS", 0.0))
    feed = said.get("FFP1", reader.units.said(c.feed))
    floor, left = said["DP"], abs(said.get("FALD", 0.0))
    depths = [floor] if kind == 2 else layers(said.get("RFP", 0.0), floor + left,
                                              abs(said.get("MID", 0.0)))  # fmt: skip
    length, width, angle = said["LENG"], said["WID"], said.get("STA", 0.0)
    if way in (2, 4):  # along the second axis: the same, a quarter further
        length, width, angle = width, -length, angle + 90.0
    beyond = abs(said.get("FDP", 0.0))
    face = Face(
        corner=(said.get("PA", 0.0), said.get("PO", 0.0)), length=length, width=width,
        angle_deg=angle, step_over=abs(said["MIDA"]), start=beyond, before=beyond, behind=beyond,
        one_way=way in (1, 2), levels=tuple((depth, feed) for depth in depths), clear=clear,
        lift=clear - said.get("RFP", 0.0), plunge_feed=feed, link_feed=feed,
    )  # fmt: skip
    c.note("CYCLE71", "where its lines lie is the control's own; they are spaced evenly here")
    modal, absolute, c.absolute = c.motion, c.absolute, True
    reader.execute(f"g0z{number(said['RTP'])}", *mill_face(face), f"g0z{number(said['RTP'])}")
    c.motion, c.absolute = modal, absolute
