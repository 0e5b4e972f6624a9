"""Dimensions that no tool has: given in another unit than mm."""

from __future__ import annotations

from collections.abc import Iterator

from vmach.job import Job

__all__ = ["doubtful_length", "lengths_meant_mm", "tool_notes"]

#: a holder alone is longer, and no machine of this kind carries a longer one
_LEAST_LENGTH_MM, _MOST_LENGTH_MM = 10.0, 1000.0
#: hardly a cutter is thinner
_LEAST_DIAMETER_MM = 0.05
#: what a length may have been given in, and how many millimetres that is
_UNITS = {"metres": 1e3, "inches": 25.4}


def lengths_meant_mm(length_mm: float) -> Iterator[float]:
    """Lengths from spindle nose to tip that may have been meant by a number, mm."""
    for unit in _UNITS.values():
        if _LEAST_LENGTH_MM <= unit * length_mm <= _MOST_LENGTH_MM:
            yield unit * length_mm


def doubtful_length(key: str, length_mm: float) -> str | None:
    """A question where a length from spindle nose to tip is none of a tool in its holder."""
    if _LEAST_LENGTH_MM <= length_mm <= _MOST_LENGTH_MM:
        return None
    units = [
        unit
        for unit, mm in _UNITS.items()
        if 3.0 * _LEAST_LENGTH_MM <= mm * length_mm <= _MOST_LENGTH_MM
    ]
    unit = f"in {' or '.join(units)}" if units else "right"
    return f"{key} = {length_mm:g}, from spindle nose to tip: is it {unit}? It has to be in mm"


def tool_notes(job: Job) -> tuple[str, ...]:
    """A note for every tool of a job that no machine has in its spindle."""
    notes = []
    for number, tool in job.tools.items():
        doubt = doubtful_length("length_mm", tool.length_mm)
        if doubt is None and tool.diameter_mm < _LEAST_DIAMETER_MM:
            doubt = f"diameter_mm = {tool.diameter_mm:g}: is it in metres? It has to be in mm"
        if doubt is not None:
            notes.append(f"{job.path.name}: tool {number}: {doubt}")
    return tuple(notes)
