"""What differs between the controls that read Fanuc's language."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gcode.dialects.fanuc.macro.variables import OffsetColumn, OffsetColumns

__all__ = ["FANUC_COLUMNS", "HAAS_COLUMNS", "HAAS_M", "FanucSettings"]

#: Memory C with 200 pairs: B-64484EN, system variables of tool compensation memory C
FANUC_COLUMNS: OffsetColumns = (
    OffsetColumn(2001, "length_wear_mm"),
    OffsetColumn(2201, "length_mm"),
    OffsetColumn(10001, "length_wear_mm", 999),
    OffsetColumn(11001, "length_mm", 999),
    OffsetColumn(12001, "diameter_wear_mm", 999),
    OffsetColumn(13001, "diameter_mm", 999),
)
#: Haas Mill Operator's Manual 96-8210, "System Variables"
HAAS_COLUMNS: OffsetColumns = (
    OffsetColumn(2001, "length_mm"),
    OffsetColumn(2201, "length_wear_mm"),
    OffsetColumn(2401, "diameter_mm"),
    OffsetColumn(2601, "diameter_wear_mm"),
)

#: M codes without effect on the path that most builders share
_COMMON_M = {10: "clamp 4th axis", 11: "release 4th axis", 12: "clamp 5th axis",
             13: "spindle clockwise and coolant", 14: "spindle counter-clockwise and coolant",
             29: "rigid tapping", 48: "overrides on", 49: "overrides off",
             50: "pallet or coolant", 51: "user function", 60: "pallet change"}  # fmt: skip
#: Haas Mill Operator's Manual 96-8210, "M-codes"
HAAS_M = _COMMON_M | {
    15: "release 5th axis", 16: "tool change",
    17: "release 4th axis", 18: "clamp 5th axis", 21: "user function", 22: "user function",
    23: "user function", 24: "user function", 25: "user function", 26: "user function",
    27: "user function", 28: "user function", 31: "chip conveyor forward",
    32: "chip conveyor reverse", 33: "chip conveyor stop", 34: "coolant spigot down",
    35: "coolant spigot up", 36: "pallet part ready", 39: "rotate tool turret",
    41: "low gear", 42: "high gear", 46: "pallet in place", 59: "output on", 68: "clamp",
    69: "release", 73: "tool air blast on", 74: "tool air blast off", 75: "reference point",
    76: "display off", 77: "display on", 78: "alarm if skip is met", 79: "alarm if skip is missed",
    80: "door open", 81: "door close", 82: "tool unclamp", 83: "air gun on", 84: "air gun off",
    86: "tool clamp", 88: "coolant through spindle on", 89: "coolant through spindle off",
    95: "sleep mode", 104: "probe arm out", 105: "probe arm in", 109: "user input",
}  # fmt: skip


@dataclass(frozen=True)
class FanucSettings:
    """One control of the family.

    Attributes
    ----------
    columns : tuple of OffsetColumn
        Variables of the offset memory.
    radius_in_d : bool
        D holds radii (Fanuc parameter 5004#2 ODI = 0, the default; Haas setting 40).
    pointed_p_is_seconds : bool
        G4 P5. is 5 s (Haas); otherwise a point is refused there.
    pointless_factor : bool
        G51 P2 is a factor of 2 (Haas); otherwise its unit is a parameter, and it is refused.
    dwell_p_s : float
        What P of G4 and of the drilling cycles counts where it has no point, s.
    only_calculator : bool
        A number without a point is read as it stands, whatever is set.
    haas_cycles : bool
        G12, G13, G70 and G71 are Haas's.
    reference_all_axes : bool
        G28 without axes moves all of them (Haas); otherwise it is refused.
    counters : range
        System variables that count times and tool life; they are taken as zero.
    common_again : range
        Further numbers of the common variables #0, #1 and so on.
    builder_m : mapping of int to str
        M codes that are known to move nothing.
    z_home_m : frozenset of int
        M codes that take Z to its reference point.
    peck_clearance_mm : float
        Above the last depth in G73 and G83 (Fanuc parameters 5114, 5115; Haas settings 22, 52).
    next_tool_in_block : bool
        Of two T words the first is for M6, the second chooses the next tool (Mazak).
    smooth_g61_1 : bool
        G61.1 is a shape correction without stops (Mazak).
    """

    columns: OffsetColumns = FANUC_COLUMNS
    radius_in_d: bool = True
    pointed_p_is_seconds: bool = False
    pointless_factor: bool = False
    dwell_p_s: float = 0.001
    only_calculator: bool = False
    haas_cycles: bool = False
    reference_all_axes: bool = False
    counters: range = range(0)
    common_again: range = range(0)
    builder_m: Mapping[int, str] = field(default_factory=lambda: dict(_COMMON_M))
    z_home_m: frozenset[int] = frozenset()
    peck_clearance_mm: float = 1.0
    next_tool_in_block: bool = False
    smooth_g61_1: bool = False
