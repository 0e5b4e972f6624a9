"""How far apart the two radii of an arc may be, control by control.

Source: LinuxCNC, G-Codes and its interpreter; Grbl 1.1, Settings; SINUMERIK machine data 21000
and 21010; HEIDENHAIN MP 7431.
"""

from __future__ import annotations

from dataclasses import dataclass

from gcode.errors import ProgramError

__all__ = ["ARC_TOLERANCES", "ZERO_RADIUS_MM", "ArcTolerance", "arc_tolerance"]

#: LinuxCNC: an arc of a smaller radius is none, and an end may be so far beyond the diameter
ZERO_RADIUS_MM = 0.00127


@dataclass(frozen=True)
class ArcTolerance:
    """Limits for the difference between start radius and end radius.

    An arc is refused where the difference exceeds `ceiling_mm`, or both `absolute_mm` and
    `relative` times the greater radius.

    Attributes
    ----------
    absolute_mm, absolute_inch_mm : float
        For programs in mm and in inches.
    relative : float
        Share of the greater radius.
    ceiling : float
        Times the absolute tolerance.
    """

    absolute_mm: float
    absolute_inch_mm: float
    relative: float
    ceiling: float

    def absolute(self, unit_mm: float) -> float:
        """Absolute tolerance in program units."""
        return (self.absolute_mm if unit_mm == 1.0 else self.absolute_inch_mm) / unit_mm

    def limits(self, unit_mm: float) -> tuple[float, float, float]:
        """Absolute and relative tolerance, and the least radius, lengths in program units."""
        return self.absolute(unit_mm), self.relative, ZERO_RADIUS_MM / unit_mm


_SQRT2 = 2.0**0.5

#: name of the control -> tolerance. LinuxCNC: 2 * 0.01 * sqrt(2) mm and 2 * 0.001 * sqrt(2) inch
#: with 0.1 %, never more than a hundred times that. grbl: 0.005 mm with 0.1 %, never more than
#: 0.5 mm. Sinumerik: machine data 21000 CIRCLE_ERROR_CONST 0.01 mm and 21010
#: CIRCLE_ERROR_FACTOR 0.1 %. Heidenhain: MP 7431 (circle tolerance), 0.016 mm at most.
ARC_TOLERANCES: dict[str, ArcTolerance] = {
    "linuxcnc": ArcTolerance(0.02 * _SQRT2, 0.002 * _SQRT2 * 25.4, 0.001, 100.0),
    "grbl": ArcTolerance(0.005, 0.005, 0.001, 100.0),
    "sinumerik": ArcTolerance(0.01, 0.01, 0.001, float("inf")),
    "heidenhain": ArcTolerance(0.016, 0.016, 0.0, 1.0),
}


def arc_tolerance(name: str | ArcTolerance) -> ArcTolerance:
    """Look up a control's tolerance by name; raises ProgramError for an unknown one."""
    if isinstance(name, ArcTolerance):
        return name
    if name not in ARC_TOLERANCES:
        raise ProgramError(f"unknown arc tolerance '{name}'", accepted=", ".join(ARC_TOLERANCES))
    return ARC_TOLERANCES[name]
