"""Dimensions that no tool has: given in another unit than mm."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

import numpy as np

from vmach.base.note import Kind, Level, Note

__all__ = ["Dimensions", "cutting_notes", "doubtful_length", "lengths_meant_mm", "tool_notes"]

#: a holder alone is longer, and no machine of this kind carries a longer one
_LEAST_LENGTH_MM, _MOST_LENGTH_MM = 10.0, 1000.0
#: thinner cutters are rare, thicker ones do not pass a tool changer
_LEAST_DIAMETER_MM, _MOST_DIAMETER_MM = 1.0, 200.0
#: beyond this it is no tool
_IMPOSSIBLE_LENGTH_MM, _IMPOSSIBLE_DIAMETER_MM = 3000.0, 1000.0
#: what a length may have been given in, and how many millimetres that is
_UNITS = {"metres": 1e3, "inches": 25.4}
#: feed in a turn over the diameter: of roughing cutters up to 0.1, of high-feed cutters 0.16
_MOST_FEED_SHARE = 0.2
#: fastest cutting speed, of aluminium with polycrystalline diamond, m/min
_FASTEST_M_PER_MIN = 5000.0


class Dimensions(Protocol):
    """A tool as far as it is asked about here."""

    @property
    def diameter_mm(self) -> float:
        """Cutting diameter."""

    @property
    def length_mm(self) -> float:
        """From spindle nose to tip."""


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


def tool_notes(tools: Mapping[int, Dimensions]) -> tuple[Note, ...]:
    """A note for every tool, by its number, that no machine has in its spindle."""
    return tuple(
        note
        for number, tool in tools.items()
        for note in (_length_note(number, tool.length_mm), _diameter_note(number, tool.diameter_mm))
        if note is not None
    )


def cutting_notes(
    tools: Mapping[int, Dimensions],
    tool: np.ndarray,
    feed_mm_per_min: np.ndarray,
    spindle_rpm: np.ndarray,
) -> tuple[Note, ...]:
    """A note for every tool whose diameter does not go with how the program cuts.

    Parameters
    ----------
    tools : mapping of number to Dimensions
    tool : (M,) int64
        Of the moves at feed.
    feed_mm_per_min, spindle_rpm : (M,) float64
    """
    found = []
    for number, one in tools.items():
        mine = (tool == number) & (spindle_rpm > 0.0)
        if not mine.any() or _diameter_note(number, one.diameter_mm) is not None:
            continue
        share = float((feed_mm_per_min[mine] / spindle_rpm[mine]).max()) / one.diameter_mm
        speed = float(spindle_rpm[mine].max()) * np.pi * one.diameter_mm / 1e3
        if share > _MOST_FEED_SHARE:
            said = f"cuts with a feed of {share:.2g} diameters in a turn"
            found.append(_doubt(Kind.DIAMETER, number, said, one.diameter_mm))
        elif speed > _FASTEST_M_PER_MIN:
            said = f"cuts with {speed:.0f} m/min"
            found.append(_doubt(Kind.DIAMETER, number, said, one.diameter_mm))
    return tuple(found)


def _doubt(kind: Kind, number: int, said: str, size_mm: float) -> Note:
    sentence = f"{kind}_mm = {size_mm:g} {said}: is it in mm?"
    return Note(Level.DOUBT, kind, f"tool {number}", sentence, size_mm, "mm")


def _length_note(number: int, length_mm: float) -> Note | None:
    said = doubtful_length("length_mm", length_mm)
    if said is None:
        return None
    level = Level.REFUSED if length_mm > _IMPOSSIBLE_LENGTH_MM else Level.DOUBT
    most = _IMPOSSIBLE_LENGTH_MM if level is Level.REFUSED else _MOST_LENGTH_MM
    accepted = f"{_LEAST_LENGTH_MM:g} .. {most:g} mm"
    return Note(level, Kind.LENGTH, f"tool {number}", said, length_mm, "mm", accepted)


def _diameter_note(number: int, diameter_mm: float) -> Note | None:
    if _LEAST_DIAMETER_MM <= diameter_mm <= _MOST_DIAMETER_MM:
        return None
    level = Level.REFUSED if diameter_mm > _IMPOSSIBLE_DIAMETER_MM else Level.DOUBT
    most = _IMPOSSIBLE_DIAMETER_MM if level is Level.REFUSED else _MOST_DIAMETER_MM
    unit = "in metres or inches" if diameter_mm < _LEAST_DIAMETER_MM else "right"
    said = f"diameter_mm = {diameter_mm:g}: is it {unit}? It has to be in mm"
    accepted = f"{_LEAST_DIAMETER_MM:g} .. {most:g} mm"
    return Note(level, Kind.DIAMETER, f"tool {number}", said, diameter_mm, "mm", accepted)
