"""Figures of a compensation, for the terminal, for scripts and for the report."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vmach.base.note import note_records
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.compensation.aim.part_aim import PartAim
from vmach.compensation.aim.surface import SurfaceCheck
from vmach.compensation.compensate import Compensation
from vmach.compensation.safety import lines_text

__all__ = ["as_json", "as_text", "remarks", "rows"]

_CENTRED = "places made by one move that would need different shifts"
_STAYS = "machine coordinates or reference point"


def as_json(found: Compensation, surface: SurfaceCheck | None) -> dict[str, Any]:
    """All figures as plain numbers and strings; docs/how-to/compensate.md describes the keys."""
    figures: dict[str, Any] = {}
    residuals = {"before": found.before, "before_rounding": found.unrounded, "after": found.after}
    for name, residual in residuals.items():
        figures[f"{name}_largest_um"] = um_from_mm(residual.largest_mm)
        figures[f"{name}_mean_um"] = um_from_mm(residual.mean_mm)
    worst = int(found.after.distance_mm.argmax()) if len(found.after.distance_mm) else None
    return figures | {
        "worst_line_after": None if worst is None else int(found.after.line[worst]),
        "surface": None if surface is None else _surface(surface),
        "aimed_at": None if found.part_aim is None else _aimed_at(found.part_aim),
        "largest_correction_um": um_from_mm(found.largest_correction_mm),
        "growth": found.growth,
        "steps": found.steps,
        "arcs": found.arcs,
        "arcs_kept": found.arcs_kept,
        "expanded_lines": {str(line): why for line, why in sorted(found.expanded_lines.items())},
        "left_lines": list(found.left_lines),
        "swallowed_words": found.swallowed,
        "uncorrected_lines": {
            str(line): {"um": um_from_mm(size), "why": why}
            for line, (size, why) in sorted(found.uncorrected.items())
        },
        "uncorrected": _uncorrected(found, surface),
        "notes": [str(note) for note in found.notes],
        "note_records": note_records(found.notes),
    }


def _surface(surface: SurfaceCheck) -> dict[str, Any]:
    figures: dict[str, Any] = {"points": len(surface.row), "of": surface.surface.source}
    for name, error in {"before": surface.before_mm, "after": surface.after_mm}.items():
        size = um_from_mm(np.abs(error))
        figures |= {f"{name}_largest_um": float(size.max()), f"{name}_mean_um": surface.mean(size)}
    ratio, u_um = surface.ratio, um_from_mm(surface.u_mm)
    return figures | {
        "after_rms_um": float(um_from_mm(np.sqrt(surface.mean(surface.after_mm**2)))),
        "u_largest_um": float(u_um.max()),
        "u_mean_um": surface.mean(u_um),
        "u_rms_um": float(np.sqrt(surface.mean(u_um**2))),
        "expected_rms_um": um_from_mm(surface.expected_rms_mm),
        "mean_before_over_after": ratio if np.isfinite(ratio) else None,
        "points_lost": surface.lost,
    }


def _aimed_at(aim: PartAim) -> dict[str, Any]:
    """The points that the program was aimed at, before rounding."""
    figures: dict[str, Any] = {"points": len(aim.part.row)}
    for name, deviation in {"tool": aim.tool, "part": aim.part}.items():
        figures[f"{name}_largest_um"] = um_from_mm(deviation.largest_mm)
        figures[f"{name}_mean_um"] = um_from_mm(deviation.mean_mm)
    return figures | {
        "largest_shift_um": um_from_mm(aim.largest_shift_mm),
        "rounds": aim.rounds,
    }


def _uncorrected(found: Compensation, surface: SurfaceCheck | None) -> list[dict[str, Any]]:
    """What a path cannot correct, with its size."""
    named: list[dict[str, Any]] = []
    if found.tilt_rad:
        tilt: dict[str, Any] = {"what": "tilt of the tool", "urad": urad_from_rad(found.tilt_rad)}
        if surface is not None and found.part_aim is None:
            tilt["surface_um"] = float(um_from_mm(np.abs(surface.tilt_mm).max()))
        named.append(tilt)
    if found.part_aim is not None:
        named.append({"what": _CENTRED, "surface_um": um_from_mm(found.part_aim.part.largest_mm)})
        return named
    for label, share in ({} if surface is None else surface.at_edge_mm).items():
        named.append({"what": f"{label} (acts at the cutting edge)",
                      "surface_um": float(um_from_mm(np.abs(share).max()))})  # fmt: skip
    return named


def rows(found: Compensation, surface: SurfaceCheck | None) -> dict[str, str]:
    """Names and values of the figures, in order."""
    figures = as_json(found, surface)
    table = {
        f"tool, {name.replace('_', ' ')}": _largest_and_mean(figures, name)
        for name in ("before", "before_rounding", "after")
    }
    if surface is not None:
        on_part = figures["surface"]
        table |= {
            f"part, {name} (in the model)": _largest_and_mean(on_part, name)
            for name in ("before", "after")
        }
        table["part, tables and effects"] = (
            f"standard uncertainty largest {on_part['u_largest_um']:.3f} um, "
            f"mean {on_part['u_mean_um']:.3f} um"
        )
        table["part, after, to be expected"] = (
            f"RMS {on_part['expected_rms_um']:.3f} um: {on_part['after_rms_um']:.3f} um in the "
            f"model, {on_part['u_rms_um']:.3f} um by tables and effects"
        )
        table["part, points"] = f"{on_part['points']} of {on_part['of']}"
        if surface.lost:
            table["part, points cut no longer"] = str(surface.lost)
        if on_part["mean_before_over_after"]:
            table["part, mean error"] = f"{on_part['mean_before_over_after']:.1f} times smaller"
    if found.part_aim is not None:
        aimed = figures["aimed_at"]
        table |= {
            f"aimed at, {aim} in place": _largest_and_mean(aimed, aim) for aim in ("tool", "part")
        }
        table["aimed at, points"] = str(aimed["points"])
        table["largest shift of the path"] = f"{aimed['largest_shift_um']:.2f} um"
    return table | {
        "largest correction": f"{figures['largest_correction_um']:.2f} um",
        "blocks": f"{found.growth:.2f} times as many; {found.steps} for jumps of the error",
        "arcs": f"{found.arcs_kept} of {found.arcs} stay arcs",
        "words below the resolution": str(found.swallowed),
    }


def as_text(found: Compensation, surface: SurfaceCheck | None) -> Iterator[str]:
    """Lines for people."""
    for name, value in rows(found, surface).items():
        yield f"{name:28} {value}"
    yield from remarks(found, surface)


def remarks(found: Compensation, surface: SurfaceCheck | None) -> Iterator[str]:
    """What was written out, what stays and why, one sentence each."""
    yield from (f"note: {note}" for note in found.notes)
    for reason in sorted(set(found.expanded_lines.values())):
        lines = [line for line, why in found.expanded_lines.items() if why == reason]
        yield f"written out ({reason}): lines {lines_text(lines)}"
    if found.left_lines:
        yield f"left as they are ({_STAYS}): lines {lines_text(found.left_lines)}"
    for reason in sorted({why for _, why in found.uncorrected.values()}):
        sizes = {line: size for line, (size, why) in found.uncorrected.items() if why == reason}
        yield (
            f"not corrected, up to {um_from_mm(max(sizes.values())):.2f} um ({reason}): "
            f"lines {lines_text(sizes)}"
        )
    for named in _uncorrected(found, surface):
        size = [f"{named['urad']:.1f} urad"] if "urad" in named else []
        size += [f"{named['surface_um']:.2f} um on the part"] if "surface_um" in named else []
        yield f"not corrected: {named['what']}, up to {', '.join(size)}"
    if found.part_aim is None and surface is not None and surface.at_edge_mm:
        yield "--aim part answers what acts at the cutting edge, as far as a shift of the path can"


def _largest_and_mean(figures: dict[str, Any], name: str) -> str:
    largest, mean = figures[f"{name}_largest_um"], figures[f"{name}_mean_um"]
    return f"largest {largest:.3f} um, mean {mean:.3f} um"
