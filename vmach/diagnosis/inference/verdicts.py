"""A verdict for each effect, and what remains beside them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.moves import search, search_beyond
from vmach.diagnosis.inference.noise import noise_after, noise_before
from vmach.diagnosis.inference.remains import is_structure, remains_um
from vmach.diagnosis.inference.support import Support, supports_of
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.forms import Forms
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.fit.terms import Term

__all__ = ["Inference", "Reason", "Weak", "infer", "supports_before_verdict"]

#: times that the noise of single readings is estimated anew
_PASSES = 2


class Reason(StrEnum):
    """Why an effect that the search took is not shown."""

    DOUBTFUL = "evidence and size do not make it certain"
    REPLACED = "a form over states explains the readings as well"
    IMPOSSIBLE = "would need a size that nature does not have"


@dataclass(frozen=True)
class Weak:
    """An effect that the readings speak for, though not clearly.

    Attributes
    ----------
    term : Term
    support : Support
    why : Reason
    """

    term: Term
    support: Support
    why: Reason


@dataclass(frozen=True)
class Inference:
    """What was found.

    Attributes
    ----------
    weighing : Weighing
        With the noise that the readings show.
    explanation : Explanation
        By the effects that are shown.
    supports : tuple of Support
        What speaks for each.
    weak : tuple of Weak
    remains_um : float
        Root mean square of what neither effects nor noise explain.
    is_structure : bool
        Whether that is more than the uncertainty of one reading.
    proposals : tuple of Proposal
        Forms for what remains, the most probable first.
    """

    weighing: Weighing
    explanation: Explanation
    supports: tuple[Support, ...]
    weak: tuple[Weak, ...]
    remains_um: float
    is_structure: bool
    proposals: tuple[Proposal, ...] = ()


def infer(weighing: Weighing) -> Inference:
    """Search, noise of single readings and effects in turn, and weigh what was found.

    Forms over states compete: with what remains, and for the place of every effect. Effects that
    are not shown and forms count as what remains.
    """
    weighing, found = _searched(weighing)
    forms = Forms(weighing, found)
    everything = forms.grown(found)
    judged, supports, weak = _judged(forms, everything)
    shown = [term for term in judged.terms if term.label in supports]
    alone = weighing.explain(shown, found.posterior.sizes, refine=False)
    remains = remains_um(weighing, alone, noise=everything.posterior.sizes.factor)
    structure = is_structure(weighing, remains)
    return Inference(
        weighing,
        alone,
        tuple(supports[term.label] for term in shown),
        weak,
        remains,
        structure,
        proposals=forms.proposals(alone, judged) if structure else (),
    )


def supports_before_verdict(
    weighing: Weighing,
) -> tuple[Weighing, Explanation, dict[str, Support]]:
    """What speaks for every effect that a search takes, for a calibration to look at."""
    weighing, found = _searched(weighing)
    forms = Forms(weighing, found)
    grown = forms.grown(found)
    supports = _beside_rivals(forms, grown, _beside_others(forms, grown))[0]
    return weighing, found, supports


def _searched(weighing: Weighing) -> tuple[Weighing, Explanation]:
    """The most probable set of effects, and the weighing with the noise that it leaves."""
    weighing = weighing.with_noise(noise_before(weighing))
    found = search(weighing)
    for _ in range(_PASSES):
        noise = noise_after(weighing, found)
        if noise is None:
            break
        weighing = weighing.with_noise(noise)
        found = search(weighing, weighing.explain(found.terms, found.posterior.sizes))
    return weighing, search_beyond(weighing, found)


def _judged(
    forms: Forms, found: Explanation
) -> tuple[Explanation, dict[str, Support], tuple[Weak, ...]]:
    """An explanation without effects that are not shown, what speaks for the others, and those.

    The least probable goes first. The others stay judged as beside it: their smallest odds count,
    and the smallest rest.
    """
    supports: dict[str, Support] = {}
    weak: list[Weak] = []
    while True:
        here = _beside_others(forms, found)
        supports = {n: s.after(supports.get(n, s)) for n, s in here.items()}
        doubted = _doubted(forms.weighing, found, supports)
        if doubted is None:
            supports, doubted = _beside_rivals(forms, found, supports)
        if doubted is None:
            return found, supports, tuple(weak)
        weak.append(doubted[0])
        found = doubted[1]


def _beside_others(forms: Forms, found: Explanation) -> dict[str, Support]:
    """What speaks for each effect, by its label, everything else given."""
    both = zip(found.terms, supports_of(forms.weighing, found), strict=True)
    return {term.label: support for term, support in both if term.label not in forms.labels}


def _doubted(
    weighing: Weighing, found: Explanation, supports: dict[str, Support]
) -> tuple[Weak, Explanation] | None:
    """The effect that is least to be believed, and the explanation without it."""
    fit = weighing.careful(found)
    wrong = [k for k in impossible_terms(fit) if found.terms[k].label in supports] if fit else []
    for ks, why in ((_unsure(found, supports), Reason.DOUBTFUL), (wrong, Reason.IMPOSSIBLE)):
        if ks:
            k = min(ks, key=lambda k: supports[found.terms[k].label].order)
            term = found.terms[k]
            return Weak(term, supports[term.label], why), weighing.without(found, [k])
    return None


def _beside_rivals(
    forms: Forms, found: Explanation, supports: dict[str, Support]
) -> tuple[dict[str, Support], tuple[Weak, Explanation] | None]:
    """What speaks for each effect against forms in its place; the one that gives way to them."""
    asked = [k for k, term in enumerate(found.terms) if term.label in supports]
    instead = {k: forms.in_place_of(found, k) for k in asked}
    supports = {
        found.terms[k].label: supports[found.terms[k].label].beside(found.score - e.score)
        for k, e in instead.items()
    }
    unsure = _unsure(found, supports)
    if not unsure:
        return supports, None
    k = min(unsure, key=lambda k: supports[found.terms[k].label].order)
    term = found.terms[k]
    return supports, (Weak(term, supports[term.label], Reason.REPLACED), instead[k])


def _unsure(found: Explanation, supports: dict[str, Support]) -> list[int]:
    """Numbers of the effects that are not shown."""
    return [
        k
        for k, term in enumerate(found.terms)
        if term.label in supports and not supports[term.label].is_shown
    ]
