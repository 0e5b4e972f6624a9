"""What speaks for an effect beside everything else, and whether it is there.

The readings may be clearly more probable with an effect of the catalogue, and it may yet be an
imitation of a cause that the catalogue does not hold. An imitation follows its cause in part only:
what it leaves tells it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit, logsumexp

from vmach.diagnosis.inference.noise import score_with_tails
from vmach.diagnosis.inference.remains import (
    remains_um,
    sizes_um,
    usual_u_um,
    where_they_act_um,
)
from vmach.diagnosis.inference.rules import IMITATION, SHOWN, WORTH_A_FORM
from vmach.diagnosis.inference.weighing import Explanation, Weighing

__all__ = ["Support", "in_its_place", "supports_of"]

#: log odds beyond which it does not matter how many they are; chosen, far beyond `SHOWN`
_CERTAIN = 20.0
#: share of an effect below which what remains beside it does not matter: that of the smallest
#: effect beside the largest
_LEAST = 1e-4


@dataclass(frozen=True)
class Support:
    """What speaks for one effect.

    Attributes
    ----------
    odds : float
        Log odds that it, or another in its place, is there, given everything else.
    size_um : float
        Root mean square of what it does, each reading weighed by the square of that.
    rest_um : float
        What remains unexplained, weighed alike, beyond what would not be looked into.
    share : float
        Of the variance of what remains and what effects do, but for those that are shown: a cause
        falls into imitations.
    prior : float
        Log odds beforehand that the machine has it, or what is in its place, where they are more
        than even.
    """

    odds: float
    size_um: float
    rest_um: float
    share: float = 1.0
    prior: float = 0.0

    @property
    def probability(self) -> float:
        """That it is no imitation of something else."""
        own = max(self.size_um * self.share, 1e-9)
        rest = float(np.hypot(self.rest_um, _LEAST * own))
        return float(expit(2.0 * np.log(own / (IMITATION * rest)) + self.prior))

    @property
    def is_shown(self) -> bool:
        """Whether readings clearly speak for it, and it is probably no imitation."""
        return self.odds >= SHOWN and self.probability >= 0.5

    @property
    def order(self) -> tuple[bool, float]:
        """Smaller the less it is to be believed; first what a rival beside it makes needless."""
        return self.odds >= SHOWN, self.probability * float(expit(self.odds))

    def after(self, before: Support) -> Support:
        """The same as it was judged beside others, which are gone: what they did is no rest."""
        return replace(self, odds=min(self.odds, before.odds)).beside(before.rest_um)

    def beside(self, rest_um: float) -> Support:
        """The same where no more than that remains beside something else."""
        return replace(self, rest_um=min(self.rest_um, rest_um))


def supports_of(
    weighing: Weighing, found: Explanation, count: int | None = None
) -> Sequence[Support]:
    """What speaks for the first effects of an explanation, for each where no count is given."""
    count = len(found.terms) if count is None else count
    sizes, rests = where_they_act_um(weighing, found, count)
    ignored = WORTH_A_FORM * usual_u_um(weighing)
    rests = np.sqrt(np.maximum(np.square(rests) - ignored**2, 0.0)).tolist()
    # the noise may still be that of another explanation: each beside its own tails
    own = score_with_tails(weighing, found, -np.inf)
    supports = []
    for k, (size, rest) in enumerate(zip(sizes, rests, strict=True)):
        more, prior = in_its_place(weighing, found, k)
        # without it beside the noise that this leaves: odd readings call for no effect
        fewer = score_with_tails(weighing, weighing.without(found, [k]), own - _CERTAIN)
        supports.append(Support(own - fewer + more, size, rest, prior=max(prior, 0.0)))
    return _with_shares(weighing, found, supports)


def _with_shares(
    weighing: Weighing, found: Explanation, supports: Sequence[Support]
) -> Sequence[Support]:
    """What speaks for the first effects, with the share of each in what is not known to be there.

    What every machine has is no piece of another cause, nor is what is shown or a form that was
    found: none counts for the others. The most probable one is shown first.
    """
    count = len(supports)
    own = np.array(sizes_um(weighing, found)[:count]) ** 2
    rest = remains_um(weighing, found) ** 2
    usual = [weighing.prior_of(t.effect, t.target) > 0.0 for t in found.terms[:count]]
    supports, left = list(supports), [k for k in range(count) if not usual[k]]
    while left:
        whole = max(own[left].sum() + rest, 1e-300)
        for k in left:
            supports[k] = replace(supports[k], share=float(own[k] / whole))
        first = max(left, key=lambda k: (supports[k].is_shown, supports[k].probability))
        if not supports[first].is_shown:
            break
        left.remove(first)
    return supports


def in_its_place(weighing: Weighing, found: Explanation, k: int) -> tuple[float, float]:
    """What all effects that could stand in the place of term k add to its own.

    Returns
    -------
    float
        Log odds that they add to its own.
    float
        Log odds beforehand that the machine has the one that is there: a mean over all of them.
    """
    own, others = found.terms[k].label, weighing.without(found, [k], resize=False)
    beside = (gains := weighing.gains(others)) - gains[weighing.index_of(own)]
    # as it was fitted with the others, which may be elsewhere then
    for one, score in weighing.tried.items():
        if found.labels - one == {own} and len(new := one - found.labels) == 1:
            i = weighing.index_of(*new)
            beside[i] = max(beside[i], score - found.score)
    there = [i for i, c in enumerate(weighing.candidates) if c.label not in found.labels - {own}]
    total = float(logsumexp(beside[there]))
    prior = np.array([weighing.prior_of(c.effect, c.target) for c in weighing.candidates])
    return total, float(logsumexp((beside + prior)[there]) - total)
