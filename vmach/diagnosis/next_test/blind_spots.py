"""Blind spots: which effects these measurements could not see, and from what size on they would."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.diagnosis.words import with_unit
from vmach.effects import Effect, label_of
from vmach.fit.candidates import Candidate

__all__ = ["BlindSpot", "blind_spots"]

#: log evidence that an amplitude costs for being free, about
_FREEDOM = 2.0
#: a usual size of fewer standard uncertainties shows nothing at all
_NONE = 1e-3
#: so many usual sizes do not happen
_NEVER = 1000


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
    untestable = [
        BlindSpot(effect.name, target, _first(effect), None, reason)
        for effect, target, reason in search.excluded
    ]
    # one amplitude that is z standard uncertainties large has an evidence of about z^2 / 2
    needed_z = np.sqrt(2.0 * (search.threshold + _FREEDOM))
    spots = [
        _blind_spot(candidate, needed_z, evidence.information)
        for candidate, evidence in zip(search.candidates, explanation.evidence, strict=True)
        if candidate.label not in explanation.labels and candidate.effect.amplitudes
    ]
    return (*untestable, *(spot for spot in spots if spot is not None))


def _blind_spot(candidate: Candidate, needed_z: float, usual_z: float) -> BlindSpot | None:
    """From which size on a candidate is seen, where its usual size is not enough.

    Sizes in standard uncertainties: the one that is needed, and the usual one.
    """
    effect, usual = candidate.effect, candidate.effect.amplitudes[0].usual
    size = usual * needed_z / usual_z if usual_z > _NONE else np.inf
    if size <= usual:
        return None
    name = _first(effect)
    from_size = float(f"{size:.2g}") if size < _NEVER * usual else None
    text = (
        f"would be seen from {with_unit(name, from_size)} on; usual are {with_unit(name, usual)}"
        if from_size
        else "these measurements do not show it at any size"
    )
    return BlindSpot(effect.name, candidate.target, name, from_size, text)


def _first(effect: Effect) -> str:
    return effect.amplitudes[0].name if effect.amplitudes else effect.parameters[-1].name
