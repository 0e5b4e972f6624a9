"""One measurement of the machine or of a part: rows of deviations, and what they depend on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.toolpath import PathStates

__all__ = ["Measurement", "apart_from_neighbours", "group_offsets"]


@dataclass(frozen=True)
class Measurement:
    """P readings of one instrument, in mm.

    Attributes
    ----------
    kind : str
        "part", "ballbar", "laser", "drift" or "tip".
    name : str
        For people: the file's name.
    id : (P,) str
        Of each reading, as in the file.
    states : PathStates
        What the machine did at each reading; with normals where a surface was measured.
    sensing : (P, 3) float64
        Unit vector along which a displacement of the tool shows.
    measured_mm, predicted_mm : (P,) float64
        The reading and what the model says.
    u_mm : (P,) float64
        Standard uncertainty of a reading.
    group : (P,) str
        Readings that belong together: the feature, the run, the direction.
    nuisance : (P, K) float64
        Columns of what the instrument leaves free: alignment, zero, radius ...
    notes : tuple of str
        What the reader noticed and survived.
    """

    kind: str
    name: str
    id: np.ndarray
    states: PathStates
    sensing: np.ndarray
    measured_mm: np.ndarray
    predicted_mm: np.ndarray
    u_mm: np.ndarray
    group: np.ndarray
    nuisance: np.ndarray
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        count = len(self.measured_mm)
        for name in ("sensing", "measured_mm", "predicted_mm", "u_mm", "nuisance"):
            value = getattr(self, name)
            if len(value) != count or not np.isfinite(value).all():
                raise ValueError(f"Measurement.{name} has to hold {count} finite rows")

    def __len__(self) -> int:
        return len(self.measured_mm)

    @property
    def on_part(self) -> bool:
        """Whether a machined surface was measured."""
        return self.states.normal is not None

    def sensed(self, moved_mm: np.ndarray) -> np.ndarray:
        """What displacements of the tool (P, 3, K) do to the readings, (P, K)."""
        return np.einsum("pi,pik->pk", self.sensing, moved_mm)

    @cached_property
    def degrees(self) -> int:
        """Readings beyond the number of what is free."""
        return len(self) - int(np.linalg.matrix_rank(self.nuisance))

    def variation_mm(self, value_mm: np.ndarray) -> float:
        """Root mean square of values at the readings, (P,), what is free taken off."""
        free = np.linalg.lstsq(self.nuisance, value_mm, rcond=None)[0]
        squares = np.sum((value_mm - self.nuisance @ free) ** 2)
        return float(np.sqrt(squares / max(self.degrees, 1)))

    def noted(self, *notes: str) -> Measurement:
        """The measurement with further notes."""
        return replace(self, notes=(*self.notes, *notes))

    def keep(self, rows: np.ndarray, note: str) -> Measurement:
        """The measurement with some of its rows (bool or index), and a note why."""
        states = self.states
        normal = None if states.normal is None else states.normal[rows]
        kept = PathStates(
            moves=states.moves,
            tool_lengths_mm=states.tool_lengths_mm,
            move=states.move[rows],
            parameter=states.parameter[rows],
            contact_mm=states.contact_mm[rows],
            normal=normal,
        )
        arrays = ("id", "sensing", "measured_mm", "predicted_mm", "u_mm", "group", "nuisance")
        cut = {name: getattr(self, name)[rows] for name in arrays}
        return replace(self, states=kept, notes=(*self.notes, note), **cut)


def group_offsets(label: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """One column of ones and zeros for every distinct label, (P, K), and the labels."""
    names, number = np.unique(label, return_inverse=True)
    return np.eye(len(names))[number], tuple(str(name) for name in names)


#: neighbours on each side that a reading is compared with, and the fewest of one group
_NEIGHBOURS = 3
_FEWEST = 8


def apart_from_neighbours(value: np.ndarray, group: np.ndarray) -> np.ndarray:
    """How far each value lies from the median of its neighbours on the side that is nearer.

    Parameters
    ----------
    value : (P,) float64
    group : (P,) str
        Neighbours are those next to each other within a group.

    Returns
    -------
    (P,) float64
        Zero in groups of fewer than eight.
    """
    apart = np.zeros(len(value))
    for name in np.unique(group):
        rows = np.flatnonzero(group == name)
        if len(rows) >= _FEWEST:
            before = _from_those_before(value[rows])
            after = _from_those_before(value[rows][::-1])[::-1]
            apart[rows] = np.minimum(before, after)
    return apart


def _from_those_before(value: np.ndarray) -> np.ndarray:
    """Distance of each value from the median of the few before it; infinite for the first two."""
    apart = np.full(len(value), np.inf)
    for k in range(2, len(value)):
        apart[k] = abs(value[k] - np.median(value[max(k - _NEIGHBOURS, 0) : k]))
    return apart
