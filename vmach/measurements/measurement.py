"""One measurement of the machine or of a part: rows of deviations, and what they depend on.

Source: closed form derived here: what is left free is taken off by least squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from vmach.base.note import Note
from vmach.measurements.clock import AssumedClock
from vmach.measurements.instrument import Instrument
from vmach.path.toolpath import PathStates
from vmach.prediction import ActingEffect
from vmach.prediction.made_surface import MadeSurface

__all__ = ["Contacts", "Measurement"]

#: what has an entry for every reading, where it is there
_WITH_ROWS = (
    "id",
    "states",
    "sensing",
    "measured_mm",
    "predicted_mm",
    "u_mm",
    "group",
    "nuisance",
    "clamping",
    "measured_at",
    "scale_u_mm",
)
#: of what is chosen at random among readings
_SEED = 0


@dataclass(frozen=True)
class Contacts:
    """Places of the tool that P readings are taken over, where one reading has several.

    The position of a bore is a mean of displacements all round it.

    Attributes
    ----------
    states : PathStates
        The machine at each of S contacts.
    share : scipy.sparse array of shape (P, 3 S)
        What a displacement along X, Y, Z of each contact adds to each reading.
    """

    states: PathStates
    share: csr_array

    def sensed(self, moved_mm: np.ndarray) -> np.ndarray:
        """What displacements (S, 3, K) mm of the contacts do to the readings, (P, K)."""
        states, axes, columns = moved_mm.shape
        return self.share @ moved_mm.reshape(states * axes, columns)


@dataclass(frozen=True)
class Measurement:
    """P readings of one instrument, in mm.

    Attributes
    ----------
    instrument : subclass of Instrument
        What took the readings: what they mean, what is left free, how they are drawn.
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
    notes : tuple of Note
        What the reader noticed and survived.
    contacts : Contacts or None
        Where a reading is taken over several places; else at its state alone. `states` and
        `sensing` are then those that stand for it.
    surface : MadeSurface or None
        Of a machined surface: it tells which contacts make it while further effects act.
    clamping : (P,) str or None
        In which clamping on the measuring machine each reading was taken, where that is known.
    measured_at : (P,) float64 or None
        When it was taken, where that is known: the clock of the measuring machine in s, or the
        number in the order of measuring.
    scale_u_mm : (P,) float64 or None
        What one standard uncertainty of the instrument's own scale does to each reading, where it
        has one.
    scale_is_stated : bool
        Whether the job states it; else it is that of an ordinary instrument.
    assumed : AssumedClock or None
        Where the file states no times.
    """

    instrument: type[Instrument]
    name: str
    id: np.ndarray
    states: PathStates
    sensing: np.ndarray
    measured_mm: np.ndarray
    predicted_mm: np.ndarray
    u_mm: np.ndarray
    group: np.ndarray
    nuisance: np.ndarray
    notes: tuple[Note, ...] = ()
    contacts: Contacts | None = None
    surface: MadeSurface | None = None
    clamping: np.ndarray | None = None
    measured_at: np.ndarray | None = None
    scale_u_mm: np.ndarray | None = None
    scale_is_stated: bool = True
    assumed: AssumedClock | None = None

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

    @property
    def seen_states(self) -> PathStates:
        """The states at which a displacement of the tool is asked for, S of them."""
        return self.states if self.contacts is None else self.contacts.states

    def sensed(self, moved_mm: np.ndarray) -> np.ndarray:
        """What displacements of the tool at `seen_states` (S, 3, K) do to the readings, (P, K)."""
        if self.contacts is not None:
            return self.contacts.sensed(moved_mm)
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

    def made_beside(self, others: Sequence[ActingEffect]) -> Measurement:
        """The same where the surface is the one that is left while further effects act."""
        if self.surface is None:
            return self
        states, predicted = self.surface.beside(others, known=self.states)
        return replace(self, states=states, predicted_mm=predicted)

    def noted(self, *notes: Note) -> Measurement:
        """The measurement with further notes."""
        return replace(self, notes=(*self.notes, *notes))

    def keep(self, rows: np.ndarray, *notes: Note) -> Measurement:
        """The measurement with some of its rows, (P,) bool or (R,) index, and notes why."""
        whole = {name: getattr(self, name) for name in _WITH_ROWS}
        kept = {name: value[rows] for name, value in whole.items() if value is not None}
        if self.contacts is not None:
            chosen = np.arange(len(self))[rows]
            kept["contacts"] = replace(self.contacts, share=self.contacts.share[chosen])
        if self.surface is not None:
            kept["surface"] = self.surface[rows]
        return replace(self, notes=(*self.notes, *notes), **kept)

    def thinned(self, least: int) -> Measurement:
        """One reading of each stretch of a group, so many at least; as given where few are more.

        Stretches are as long as leaves less than twice as many. Of each one reading is taken at
        random, as readings along several axes may take turns.
        """
        many = len(self) // least
        if many < 2:
            return self
        start = np.arange(0, len(self), many)
        chosen = start + np.random.default_rng(_SEED).integers(many, size=len(start))
        order = np.argsort(self.group, kind="stable")
        return self.keep(np.sort(order[chosen[chosen < len(self)]]))
