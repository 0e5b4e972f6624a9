"""Blind spots: which effects these measurements could not see, and from what size on they would."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.diagnosis.words import with_unit
from vmach.effects import Effect, label_of

__all__ = ["BlindSpot", "blind_spots"]


@dataclass(frozen=True)
class BlindSpot:
    """An effect that could be there unseen.

    Attributes
    ----------
    effect, target : str
    parameter : str
        Its first amplitude.
    from_size : float or None
        Smallest amplitude that would be found, in the parameter's unit; None where no size would.
    text : str
    """

    effect: str
    target: str
    parameter: str
    from_size: float | None
    text: str

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect, self.target)


def blind_spots(search: Search, explanation: Explanation) -> tuple[BlindSpot, ...]:
    """Effects whose usual size would stay below the threshold, given what was found."""
    found = [
        BlindSpot(effect.name, target, _first(effect), None, reason)
        for effect, target, reason in search.excluded
    ]
    needed = 2.0 * (search.threshold + 2.0)
    for candidate, evidence in zip(search.candidates, explanation.evidence, strict=True):
        if candidate.label in explanation.labels or not candidate.effect.amplitudes:
            continue
        usual = candidate.effect.amplitudes[0].usual
        seen = evidence.information
        size = usual * np.sqrt(needed) / seen if seen > 1e-3 else np.inf
        if size <= usual:
            continue
        name = _first(candidate.effect)
        from_size = float(f"{size:.2g}") if size < 1000 * usual else None
        text = (
            f"would be seen from {with_unit(name, from_size)} on; "
            f"usual are {with_unit(name, usual)}"
            if from_size
            else "these measurements do not show it at any size"
        )
        found.append(BlindSpot(candidate.effect.name, candidate.target, name, from_size, text))
    return tuple(found)


def _first(effect: Effect) -> str:
    return effect.amplitudes[0].name if effect.amplitudes else effect.parameters[-1].name
