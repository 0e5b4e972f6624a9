"""Blind spots: which effects these measurements could not see, and from what size on they would."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.inference.rules import SHOWN
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.words import with_unit
from vmach.effects import Effect, label_of
from vmach.fit.candidates import Candidate

__all__ = ["BlindSpot", "blind_spots"]

#: log evidence that an amplitude costs for being free, about
_FREEDOM = 2.0
#: so many usual sizes do not happen; chosen: half a millimetre of what is 5 um as a rule
_NEVER = 100
#: an effect that has to be this many times larger beside those found hides behind them
_HIDDEN = 2.0
#: effects found that are named one by one
_FEW = 3
_TINY = 1e-12


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
    from_size_alone : float or None
        The same if nothing else had been found.
    """

    effect: str
    target: str
    parameter: str
    from_size: float | None
    text: str
    from_size_alone: float | None = None

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect, self.target)


def blind_spots(
    weighing: Weighing, explanation: Explanation, *, is_named: bool = True, remains: bool = False
) -> tuple[BlindSpot, ...]:
    """Effects whose usual size would stay below the threshold, given what was found.

    Of what would be seen alone, but hides behind an explanation, both sizes are said.

    Parameters
    ----------
    weighing : Weighing
    explanation : Explanation
    is_named : bool
        Whether the effects of the explanation are named; else they only come nearest.
    remains : bool
        Whether something remains beside them.
    """
    labels = sorted(explanation.labels)
    beside = " and ".join(labels) if len(labels) <= _FEW else f"the {len(labels)} effects found"
    beside = " and ".join(filter(None, [beside, "what remains" if remains else ""]))
    beside = (beside or "what else may vary") if is_named else "what comes nearest"
    untestable = [
        BlindSpot(effect.name, target, _first(effect), None, reason)
        for effect, target, reason in weighing.excluded
    ]
    # one amplitude that is z standard uncertainties large has an evidence of about z^2 / 2
    needed_z = float(np.sqrt(2.0 * (SHOWN + np.log(len(weighing.candidates)) + _FREEDOM)))
    weighed = zip(
        weighing.candidates,
        weighing.evidence(explanation).information,
        weighing.evidence(weighing.alone).information,
        strict=True,
    )
    spots = [
        _blind_spot(
            candidate,
            needed_z / max(left, _TINY),
            alone=needed_z / max(all_of_it, _TINY),
            beside=beside,
        )
        for candidate, left, all_of_it in weighed
        if candidate.label not in explanation.labels and candidate.effect.amplitudes
    ]
    return (*untestable, *(spot for spot in spots if spot is not None))


def _blind_spot(
    candidate: Candidate, needed: float, *, alone: float, beside: str
) -> BlindSpot | None:
    """From which size on a candidate is seen, where its usual size is not enough.

    Sizes in multiples of the usual one: `needed` with what was found, `alone` without it;
    `beside` says what that is.
    """
    effect, usual = candidate.effect, candidate.effect.amplitudes[0].usual
    if needed <= 1.0:
        return None
    name = _first(effect)
    from_size = float(f"{needed * usual:.2g}") if needed < _NEVER else None
    from_size_alone = float(f"{alone * usual:.2g}") if alone < _NEVER else None
    said = f"below {with_unit(name, from_size)}" if from_size else "at any size"
    if from_size_alone and alone * _HIDDEN < needed:
        text = f"below {with_unit(name, from_size_alone)} alone, {said} beside {beside}"
    elif from_size:
        text = said
    else:
        text = "these measurements do not show it at any size"
        return BlindSpot(effect.name, candidate.target, name, None, text)
    text += f"; usual size {with_unit(name, usual)}"
    return BlindSpot(effect.name, candidate.target, name, from_size, text, from_size_alone)


def _first(effect: Effect) -> str:
    return effect.amplitudes[0].name if effect.amplitudes else effect.parameters[-1].name
