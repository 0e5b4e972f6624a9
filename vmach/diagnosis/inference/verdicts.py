"""A verdict for each effect, and what remains beside them."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.moves import search
from vmach.diagnosis.inference.noise import noise_after, noise_before
from vmach.diagnosis.inference.remains import (
    is_structure,
    odds_of,
    remains_um,
    sizes_um,
    usual_u_um,
)
from vmach.diagnosis.inference.rules import DOMINATES, SHOWN, WORTH_A_FORM
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.forms import Forms
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.fit.terms import Term

__all__ = ["Inference", "Weak", "infer"]

IMPOSSIBLE = "would need a size that nature does not have"
#: times that the noise of single readings is estimated anew
_PASSES = 2


@dataclass(frozen=True)
class Weak:
    """An effect that the readings speak for, though not clearly.

    Attributes
    ----------
    term : Term
    odds : float
        Log odds for it, given everything else, divided by the dispersion.
    why : str
        Why it is not shown.
    """

    term: Term
    odds: float
    why: str


@dataclass(frozen=True)
class Inference:
    """What was found.

    Attributes
    ----------
    weighing : Weighing
        With the noise that the readings show.
    explanation : Explanation
        By the effects that are shown.
    odds : tuple of float
        Log odds of each, given everything else, divided by the dispersion.
    weak : tuple of Weak
    remains_um : float
        Root mean square of what neither effects nor noise explain.
    is_structure : bool
        Whether that is more than the uncertainty of one reading.
    proposals : tuple of Proposal
        Forms for what remains, the most probable first.
    imitated_um : float
        What effects of sizes that nature does not have would explain.
    """

    weighing: Weighing
    explanation: Explanation
    odds: tuple[float, ...]
    weak: tuple[Weak, ...]
    remains_um: float
    is_structure: bool
    proposals: tuple[Proposal, ...] = ()
    imitated_um: float = 0.0


def infer(weighing: Weighing) -> Inference:
    """Search, noise of single readings and effects in turn, and weigh what was found.

    Where structure remains, forms over states are tried beside the effects: what is shown has to
    be so beside the best of them too.
    """
    weighing = weighing.with_noise(noise_before(weighing))
    found = search(weighing)
    for _ in range(_PASSES):
        noise = noise_after(weighing, found)
        if noise is None:
            break
        weighing = weighing.with_noise(noise)
        found = search(weighing, weighing.explain(found.terms, found.posterior.sizes))
    plain = _weighed(weighing, found)
    if plain.remains_um < WORTH_A_FORM * usual_u_um(weighing):
        return plain
    forms = Forms(weighing, found)
    beside, grown = forms.grown(found)
    judged = _weighed(beside, grown, but=forms.labels)
    shown = [t for t in judged.explanation.terms if t.label not in forms.labels]
    odds = dict(zip((t.label for t in judged.explanation.terms), judged.odds, strict=True))
    alone = weighing.explain(shown, plain.explanation.posterior.sizes, refine=False)
    remains = float(np.hypot(remains_um(weighing, alone), judged.imitated_um))
    structure = is_structure(weighing, remains)
    return Inference(
        weighing,
        alone,
        tuple(odds[t.label] for t in shown),
        judged.weak,
        remains,
        structure,
        proposals=forms.proposals(alone, judged.explanation) if structure else (),
    )


def _weighed(weighing: Weighing, found: Explanation, *, but: Collection[str] = ()) -> Inference:
    """Effects that are shown and those that are not, none of `but` asked about."""
    weak: list[Weak] = []
    imitated = 0.0
    while True:
        odds = odds_of(weighing, found)
        remains = float(np.hypot(remains_um(weighing, found), imitated))
        sizes = sizes_um(weighing, found)
        least = DOMINATES * remains if is_structure(weighing, remains) else 0.0
        asked = [k for k, t in enumerate(found.terms) if t.label not in but and odds[k] >= SHOWN]
        k, why = _least(weighing, found, {k: (odds[k], sizes[k]) for k in asked}, least)
        if k is None:
            break
        weak.append(Weak(found.terms[k], odds[k], why))
        if why == IMPOSSIBLE:
            # it imitates something that is there
            imitated = float(np.hypot(imitated, sizes[k]))
        found = weighing.without(found, [k])
    # beside each other: one that is not shown still explains what others need not
    kept = [k for k, t in enumerate(found.terms) if t.label in but or odds[k] >= SHOWN]
    fewer = [k for k in range(len(found.terms)) if k not in kept]
    why = f"log odds below {SHOWN:g}"
    weak += [Weak(found.terms[k], odds[k], why) for k in fewer]
    if fewer:
        found = weighing.without(found, fewer)
        remains = float(np.hypot(remains_um(weighing, found), imitated))
    return Inference(
        weighing,
        found,
        tuple(odds[k] for k in kept),
        tuple(weak),
        remains,
        is_structure(weighing, remains),
        imitated_um=imitated,
    )


def _least(
    weighing: Weighing,
    found: Explanation,
    asked: Mapping[int, tuple[float, float]],
    least_um: float,
) -> tuple[int | None, str]:
    """Which effect of clear evidence is no finding all the same, and why; None where all are.

    Parameters
    ----------
    weighing : Weighing
    found : Explanation
    asked : mapping of int to (odds, size)
        Of each term that is asked about.
    least_um : float
        Size that an effect has to have.
    """
    if not asked:
        return None, ""
    smallest = min(asked, key=lambda k: asked[k][1])
    if asked[smallest][1] < least_um:
        return smallest, "smaller than what remains unexplained"
    fit = weighing.careful(found)
    wrong = [k for k in impossible_terms(fit) if k in asked] if fit else []
    return min(wrong, key=lambda k: asked[k][0], default=None), IMPOSSIBLE
