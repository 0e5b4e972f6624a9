"""The figures of compensation tables, as plain numbers for JSON and for print."""

from __future__ import annotations

from typing import Any

from vmach.base.note import Kind, Note, note_records
from vmach.base.units import um_from_mm
from vmach.controller_tables.make_tables import MadeTables, Residual
from vmach.controller_tables.table_task import TableTask
from vmach.machine import Machine

__all__ = ["tables_figures"]

#: components that keep less than this share of all that is left are not listed
_LISTED_SHARE = 0.02


def tables_figures(task: TableTask, made: list[MadeTables]) -> dict[str, Any]:
    """All figures, as they stand in ``tables.json``."""
    low, high = task.volume.low_mm, task.volume.high_mm
    notes = _notes(task)
    return {
        "schema": 1,
        "machine": task.machine.name,
        "model": str(task.variant),
        "judged": "volume" if task.program is None else "program",
        "tool_length_mm": task.tool_length_mm,
        "volume_mm": {axis: [low[k], high[k]] for k, axis in enumerate("XYZ")},
        "notes": [str(note) for note in notes],
        "note_records": note_records(notes),
        "formats": {one.name: _format_figures(one) for one in made},
    }


def _notes(task: TableTask) -> list[Note]:
    machine = task.machine
    said = "the tilt of the tool stays: three axes cannot correct it"
    notes = [Note.plain(Kind.TILT, said)]
    travel = machine.travel_mm
    if (travel[0] < task.volume.low_mm).any() or (travel[1] > task.volume.high_mm).any():
        said = (
            "tables end where the measured errors end; the travel goes on, and there the controls "
            "hold the last entry"
        )
        notes.append(Note.plain(Kind.TRAVEL, said))
    reversal = _reversal_um(machine)
    if reversal and not machine.separate_directions:
        said = (
            f"forward and backward tables differ by up to {reversal:.2f} um; the entries hold "
            'their mean. [tables] directions = "separate" in the machine file keeps both'
        )
        notes.append(Note.plain(Kind.DIRECTION, said, reversal, "um"))
    return [*notes, *task.notes]


def _reversal_um(machine: Machine) -> float:
    linear = [one for one in machine.components.values() if not one.is_angle]
    return um_from_mm(max((float(abs(c.forward - c.backward).max()) for c in linear), default=0.0))


def _format_figures(made: MadeTables) -> dict[str, Any]:
    longer = made.with_longer_tool
    return {
        "title": made.format.title,
        "holds": made.format.holds,
        "does_not_hold": made.format.lacks,
        "files": [str(path) for path in made.files],
        "entries_xyz": list(made.entries),
        "before_um": _residual_um(made.before),
        "after_um": _residual_um(made.after),
        "share_left_percent": 100.0 * made.after.rms_mm / max(made.before.rms_mm, 1e-12),
        "tool_100_mm_longer_um": longer
        and {"before": _residual_um(longer[0]), "after": _residual_um(longer[1])},
        "left_by_component_um": _left_um(made),
    }


def _residual_um(residual: Residual) -> dict[str, Any]:
    return {
        "mean": um_from_mm(residual.mean_mm),
        "rms": um_from_mm(residual.rms_mm),
        "largest": um_from_mm(residual.largest_mm),
        "largest_abs_xyz": um_from_mm(residual.largest_xyz_mm).tolist(),
    }


def _left_um(made: MadeTables) -> dict[str, dict[str, float]] | None:
    """Components that keep a share worth naming, largest first."""
    if made.left is None:
        return None
    whole = sum(after**2 for _, after in made.left.values()) ** 0.5
    rows = sorted(made.left.items(), key=lambda item: -item[1][1])
    return {
        name: {"before_rms": um_from_mm(before), "after_rms": um_from_mm(after)}
        for name, (before, after) in rows
        if after > _LISTED_SHARE * whole and um_from_mm(after) > 1e-3
    }
