"""The figures of volumetric accuracy, as plain numbers for JSON and for print.

Source: Huddersfield paper, sections 4.1 and 4.2; ISO 230-6 for the diagonals.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.note import note_records
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.machine import Machine, Variant
from vmach.machine.double_counting import double_counting
from vmach.plausibility import machine_notes
from vmach.volumetric.comparison import Comparison, compare_variants
from vmach.volumetric.diagonals import Diagonal, diagonals
from vmach.volumetric.field import ErrorField, Volume
from vmach.volumetric.grouping import group_vectors
from vmach.volumetric.profile import ProfileErrors
from vmach.volumetric.volumetric import VolumetricAccuracy, assess, contributions_between

__all__ = ["accuracy_figures", "arms_compared", "profile_figures"]

#: angular tolerances that the Huddersfield paper tabulates
_GROUPING_TOLERANCES = (0.05, 0.1, 0.2)
_GROUPING_POINTS = 30_000  #: more take minutes, for figures that only stand beside


def accuracy_figures(
    machine: Machine, field: ErrorField, comparison: Comparison | None,
    tool_mm: np.ndarray, *, model: Variant,
) -> dict[str, Any]:  # fmt: skip
    """All figures, as they stand in ``accuracy.json``.

    Parameters
    ----------
    machine : Machine
    field : ErrorField
        Its errors with the arms of `model`.
    comparison : Comparison or None
        Both forms of the arms; None where they cannot be compared.
    tool_mm : (3,) float64
        From the spindle nose to the tip.
    model : Variant
    """
    result = assess(field)
    found = diagonals(machine, field.volume, tool_mm, model)
    notes = machine_notes(machine)
    return {
        "machine": machine.name,
        "chain": str(machine.chain),
        "model": str(model),
        "tool_length_mm": -float(tool_mm[2]),
        "volume": _volume_dict(field.volume),
        "volumetric": _volumetric_dict(result),
        "contributions_percent": _shares(machine, result, tool_mm, model),
        "grouping": _grouping(field),
        "diagonals": [_diagonal_dict(one) for one in found],
        "variants": _variants_dict(comparison),
        "double_counting": _double_counting(machine),
        "findings": [note.labelled for note in notes],
        "finding_records": note_records(notes),
    }


def arms_compared(
    machine: Machine, tool_mm: np.ndarray, fields: dict[Variant, ErrorField]
) -> Comparison | None:
    """Both forms of the arms with a tool (3,) mm, where every measuring point is known."""
    try:
        machine.measuring_points_mm()
    except InputError:
        return None
    volume = next(iter(fields.values())).volume
    return compare_variants(machine, volume, tool_mm, known=fields)


def _um(value_mm: float | np.ndarray) -> Any:
    """Micrometres with three decimals, as plain numbers or lists."""
    return np.round(um_from_mm(np.asarray(value_mm, dtype=float)), 3).tolist()


def _volume_dict(volume: Volume) -> dict[str, Any]:
    return {
        "low_mm": np.asarray(volume.low_mm).tolist(),
        "high_mm": np.asarray(volume.high_mm).tolist(),
        "grid": list(volume.counts),
    }


def _volumetric_dict(result: VolumetricAccuracy) -> dict[str, Any]:
    return {
        "largest_difference_um": _um(result.largest_difference_mm),
        "between": [
            {"nose_mm": np.round(nose, 3).tolist(), "error_um": _um(error)}
            for nose, error in zip(result.worst_nose_mm, result.worst_error_mm, strict=True)
        ],
        "pairs": result.pairs,
        "points": result.points,
        "largest_error_um": _um(result.largest_mm),
        "mean_error_um": _um(result.mean_mm),
        "rms_error_um": _um(result.rms_mm),
        "p95_error_um": _um(result.p95_mm),
        "range_xyz_um": _um(result.range_mm),
    }


def _shares(
    machine: Machine, result: VolumetricAccuracy, tool_mm: np.ndarray, model: Variant
) -> dict[str, float]:
    shares = contributions_between(machine, result.worst_nose_mm, tool_mm, model)
    return {one.name: round(100.0 * one.share, 2) for one in shares}


def _grouping(field: ErrorField) -> list[dict[str, Any]]:
    if len(field.error_mm) > _GROUPING_POINTS:
        return []
    rows = []
    for tolerance in _GROUPING_TOLERANCES:
        found = group_vectors(field.error_mm, tolerance)
        rows.append({
            "angular_tolerance": tolerance, "records": len(found.kept),
            "comparisons": found.comparisons,
            "largest_difference_um": _um(found.largest_difference),
        })  # fmt: skip
    return rows


def _diagonal_dict(diagonal: Diagonal) -> dict[str, Any]:
    figures = diagonal.result
    return {
        "diagonal": diagonal.name,
        "kind": "body" if len(diagonal.name) > 5 else "face",
        "length_mm": round(float(figures.runs.position_mm[-1]), 3),
        "E_um": _um(figures.E), "M_um": _um(figures.M), "B_um": _um(figures.B),
    }  # fmt: skip


def _variants_dict(comparison: Comparison | None) -> dict[str, Any] | None:
    if comparison is None:
        return None
    return {
        "mean_htm_um": _um(comparison.mean_htm_mm),
        "mean_abbe_um": _um(comparison.mean_abbe_mm),
        "abbe_smaller_percent": round(comparison.smaller_percent, 2),
        "in_words": comparison.in_words,
        "note": "depends on where the reflectors stood: a figure of this machine and set-up",
    }


def _double_counting(machine: Machine) -> list[dict[str, Any]]:
    return [
        {
            "component": one.component, "reading_um": _um(one.reading_mm),
            "angular_share_um": _um(one.share_mm), "correlation": round(one.correlation, 3),
        }
        for one in double_counting(machine)
    ]  # fmt: skip


def profile_figures(path: Path, moved: ProfileErrors) -> dict[str, Any]:
    """Figures of the errors along the profile in the file `path`."""
    length = np.linalg.norm(moved.error_mm, axis=1)
    return {
        "file": str(path),
        "points": len(length),
        "length_mm": round(float(moved.distance_mm[-1]), 3),
        "largest_error_um": _um(length.max()),
        "range_xyz_um": _um([np.ptp(column) for column in moved.error_mm.T]),
        "largest_difference_um": _um(moved.largest_difference_mm),
    }
