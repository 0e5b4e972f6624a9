"""CYCLE90 of SINUMERIK: a thread by a mill on a helix.

Source: SINUMERIK 840D/810D Programming Guide Cycles, "Thread milling - CYCLE90": RTP, RFP, SDIS,
DP, DPR, DIATH, KDIAM, PIT, FFR, CDIR, TYPTH, CPA, CPO; d-creations/ncplot7py on GitHub has the same
order (siemens_mill_cnc/cycles_handler.py). The helix goes down by PIT a turn, CDIR 2 or
3 is its G code, TYPTH 1 an external thread. How the tool comes to the wall is the control's own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.modes import check_milling_modes
from gcode.errors import ProgramError
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["mill_thread"]

_MOST_TURNS = 10_000


def mill_thread(reader: SinumerikReader, arguments: list[float | None]) -> None:
    """Do the cycle; the tool ends at RTP above the middle of the thread, or beside it."""
    check_milling_modes("CYCLE90", arguments[13:], reader.cycle_plane)
    out, surface, distance, depth, relative, outer, _, pitch, feed, sense, kind, x, y = (
        *arguments, *([None] * 13)
    )[:13]  # fmt: skip
    if out is None or not outer or not pitch or not feed or sense not in (2.0, 3.0):
        raise ProgramError("CYCLE90 without RTP, DIATH, PIT, FFR or CDIR", accepted="CDIR 2 or 3")
    surface, x, y = surface or 0.0, x or 0.0, y or 0.0
    bottom = surface - abs(relative) if relative else depth
    if bottom is None or not bottom < surface:
        raise ProgramError("CYCLE90 without a depth below the surface", accepted="DP or DPR")
    c = reader.controller
    mill = reader.tools.entry.offset_diameter_mm / 2.0 / c.unit_mm
    radius = outer / 2.0 + (mill if kind else -mill)
    turns = math.ceil((surface - bottom) / abs(pitch) - 1e-9)
    if radius <= 0.0 or turns > _MOST_TURNS:
        raise ProgramError(f"CYCLE90: a tool of radius {mill:g}, a thread of {outer:g} and {turns} "
                           "turns")  # fmt: skip
    top, code, modal = bottom + turns * abs(pitch), f"g{sense:.0f}", c.motion
    wall, middle = xy_words(x + radius, y), xy_words(x, y)
    aside = xy_words(x + radius + 2.0 * mill, y) if kind else middle
    c.note("CYCLE90", "the way to the wall is the control's own; the helix is that of the cycle")
    reader.go("g0", z=max(out, reader.here()[2]))
    reader.absolutely(f"g0{aside}")
    reader.go("g0", z=surface + abs(distance or 0.0))
    reader.go("g1", z=top, feed=feed)
    half = f"r{number(radius / 2.0)}"
    reader.absolutely(f"g1{wall}" if kind else f"{code}{wall}{half}")
    reader.absolutely(f"{code}{wall}z{number(bottom)}i{number(-radius)}j0p{turns}")
    reader.absolutely(f"g1{aside}" if kind else f"{code}{middle}{half}")
    reader.go("g0", z=out)
    c.motion = modal
