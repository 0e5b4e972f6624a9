"""The comparison of the virtual part with the nominal CAD, for the terminal and summary.json."""

from __future__ import annotations

import math

from vmach.base.units import um_from_mm
from vmach.report.result import RunRecord, SolidDifference

__all__ = ["differences_summary", "differences_text"]

#: places that the terminal lists
_MOST_LINES = 8


def differences_summary(run: RunRecord) -> dict | None:
    """The value of ``differences`` in summary.json; None where there is no nominal CAD."""
    comparison = run.comparison
    if comparison is None:
        return None
    return {
        "threshold_um": um_from_mm(comparison.threshold_mm),
        "count": comparison.count,
        "places": [
            {
                "kind": one.kind,
                "depth_um": um_from_mm(abs(one.depth_mm)),
                "point_mm": list(one.point_mm),
                "size_mm": list(one.size_mm),
                "area_mm2": one.area_mm2,
                "volume_mm3": one.volume_mm3 if math.isfinite(one.volume_mm3) else None,
                "feature": one.feature,
                "line": one.line,
                "nc": run.nc_text(one.line),
                "tool": one.tool,
            }
            for one in comparison.places
        ],
    }


def differences_text(run: RunRecord) -> list[str]:
    """Lines for the terminal: one a place, or one that says there is none."""
    comparison = run.comparison
    if comparison is None:
        return []
    head = f"virtual part against nominal CAD, beyond {comparison.threshold_mm:g} mm:"
    if not comparison.count:
        return [f"{head} no difference"]
    lines = [f"{head} {comparison.said}"]
    lines += [f"  {_line(one, run)}" for one in comparison.places[:_MOST_LINES]]
    if comparison.count > _MOST_LINES:
        lines.append(f"  ... {comparison.count - _MOST_LINES} more in summary.json")
    return lines


def _line(one: SolidDifference, run: RunRecord) -> str:
    x, y, z = one.point_mm
    a, b, c = one.size_mm
    maker = f"line {one.line}: {run.nc_text(one.line)}" if one.line else "surface of the stock"
    volume = f", {one.volume_mm3:.3g} mm3" if math.isfinite(one.volume_mm3) else ""
    return (
        f"{one.kind} {abs(one.depth_mm):.3f} mm at ({x:.3f}, {y:.3f}, {z:.3f}), "
        f"{a:.1f} x {b:.1f} x {c:.1f} mm, {one.area_mm2:.3g} mm2{volume}, {one.feature}; {maker}"
    )
