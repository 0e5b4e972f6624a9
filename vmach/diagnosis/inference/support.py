"""What speaks for an effect beside everything else, and whether it is there.

The readings may be clearly more probable with an effect of the catalogue, and it may yet be an
imitation of a cause that the catalogue does not hold. Two numbers tell: how its size compares with
what nothing explains, and how much better a form over states does in its place.

Source: logistic regression of how often effects were true on these two numbers; made by
`tests/benchmarks/calibrate_verdicts.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from vmach.diagnosis.inference.remains import remains_um, sizes_um, usual_u_um
from vmach.diagnosis.inference.rules import (
    CLEARLY,
    OFFSET,
    WEIGHT_OF_FORM,
    WEIGHT_OF_SIZE,
    WORTH_A_FORM,
)
from vmach.diagnosis.inference.weighing import Explanation, Weighing

__all__ = ["Support", "supports_of"]

#: share of an effect below which what remains beside it does not matter
_LEAST = 0.05


@dataclass(frozen=True)
class Support:
    """What speaks for one effect.

    Attributes
    ----------
    odds : float
        Log odds for it, given everything else.
    size_um : float
        Root mean square of what it does to the readings.
    rest_um : float
        What remains unexplained, beyond what would not be looked into.
    against_form : float
        Log evidence for it against the best form in its place, where that is negative.
    prior : float
        Log odds beforehand that the machine has it, where they are more than even.
    """

    odds: float
    size_um: float
    rest_um: float
    against_form: float = 0.0
    prior: float = 0.0

    @property
    def relative_size(self) -> float:
        """Logarithm of its variance in that of what remains, up to 400 times as much."""
        size = max(self.size_um, 1e-9)
        return 2.0 * float(np.log(size / np.hypot(self.rest_um, _LEAST * size)))

    @property
    def probability(self) -> float:
        """That it is no imitation of something else."""
        score = OFFSET + WEIGHT_OF_SIZE * self.relative_size + WEIGHT_OF_FORM * self.against_form
        return float(expit(score + self.prior))

    @property
    def is_shown(self) -> bool:
        """Whether readings clearly speak for it, and it is probably no imitation."""
        return self.odds >= CLEARLY and self.probability >= 0.5

    @property
    def order(self) -> tuple[bool, float]:
        """Smaller the less it is to be believed; first what a rival beside it makes needless."""
        return self.odds >= CLEARLY, self.probability * float(expit(self.odds))

    def after(self, before: Support) -> Support:
        """The same as it was judged beside others, which are gone: what they did is no rest."""
        return replace(
            self, odds=min(self.odds, before.odds), rest_um=min(self.rest_um, before.rest_um)
        )

    def beside(self, form: float) -> Support:
        """The same where a form in its place leaves it this log evidence."""
        return replace(self, against_form=min(form, 0.0))


def supports_of(weighing: Weighing, found: Explanation) -> Sequence[Support]:
    """What speaks for each effect of an explanation."""
    fewer = [weighing.without(found, [k]) for k in range(len(found.terms))]
    u_um = usual_u_um(weighing)
    beyond = max(remains_um(weighing, found) ** 2 - (WORTH_A_FORM * u_um) ** 2, 0.0)
    rest = float(np.sqrt(beyond))
    sizes = sizes_um(weighing, found)
    priors = [max(weighing.prior_of(t.effect, t.target), 0.0) for t in found.terms]
    return [
        Support(found.score - e.score, s, rest, prior=p)
        for e, s, p in zip(fewer, sizes, priors, strict=True)
    ]
