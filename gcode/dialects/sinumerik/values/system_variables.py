"""System variables of SINUMERIK that follow from the program and the job.

SINUMERIK 840D sl/828D, List Manual System Variables.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.frames import work_system
from gcode.text.parameters import system_base

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["system_variable"]

_AXES = "XYZABC"
#: the program runs from its start on a machine: no search, test, simulation or dry run
_ORDINARY_RUN = dict.fromkeys(("$P_SEARCH", "$P_ISTEST", "$P_SIM", "$P_DRYRUN"), 0.0)
_SHIFT = re.compile(r"(.*?)\s*,\s*([XYZABC])\s*,\s*TR\s*")  #: [1,X,TR] of a settable frame


def system_variable(reader: SinumerikReader, name: str, index: str) -> float | None:
    """Value of a system variable in the units of F; None for one that only the machine knows."""
    c = reader.controller
    tool = reader.tools.entry
    plain = {"$P_TOOLNO": float(c.tool), "$P_TOOL": float(reader.tools.edge),
             "$P_TOOLR": tool.offset_diameter_mm / 2.0 / reader.units.feed_mm,
             "$P_F": reader.units.said(c.feed), "$P_S": c.speed,
             "$MN_SCALING_SYSTEM_IS_METRIC": float(c.machine_unit_mm == 1.0),
             **_ORDINARY_RUN}  # fmt: skip
    if not index:
        return plain.get(name)
    shift = _SHIFT.fullmatch(index)
    if name == "$P_UIFR" and shift is not None:
        system = work_system(int(reader.variables.value(shift[1])))
        offset = c.to_program(c.parameters.vector(system_base(system)))
        place = _AXES.index(shift[2])
        return reader.units.said(offset[place]) if place < 3 else offset[place]
    axis = _AXES.find(index.strip())
    places = {"$P_EP": reader.here, "$AA_IW": reader.here, "$AA_IM": c.machine_position}
    if axis < 0 or name not in places:
        return None
    value = places[name]()[axis]
    return reader.units.said(value) if axis < 3 else value
