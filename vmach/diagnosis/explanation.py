"""A set of effects that was fitted to the readings, and how two such sets compare."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.fit.evidence import Evidence
from vmach.fit.terms import JointFit, Term

__all__ = ["MARGIN", "Explanation", "may_beat", "simplest_of_the_best"]

#: explanations whose log evidence is this close cannot be told apart
MARGIN = 4.0
#: log evidence that an effect costs at least, whatever it explains
_PRICE = 3.0


@dataclass(frozen=True)
class Explanation:
    """A set of effects, fitted, and what the candidates say about the rest.

    Attributes
    ----------
    fit : JointFit or None
        None for the empty set.
    score : float
        Log evidence of the set against nothing, prior odds included.
    evidence : tuple of Evidence
        Of every candidate on what the set leaves.
    residual : (n,) float64
        Whitened, what the set leaves.
    degrees : int
        Its degrees of freedom.
    """

    fit: JointFit | None
    score: float
    evidence: tuple[Evidence, ...]
    residual: np.ndarray
    degrees: int

    @property
    def terms(self) -> tuple[Term, ...]:
        """The effects in the set, as fitted."""
        return self.fit.terms if self.fit else ()

    @property
    def labels(self) -> frozenset[str]:
        """Their names and targets."""
        return frozenset(term.label for term in self.terms)

    def numbers(self, expected: Collection[str] = ()) -> float:
        """How many numbers of the set the readings determine; expected effects count as one."""
        if self.fit is None:
            return 0.0
        return sum(
            1.0 if term.label in expected else self.fit.numbers(k)
            for k, term in enumerate(self.terms)
        )


def simplest_of_the_best(
    explanations: Sequence[Explanation], expected: Collection[str] = ()
) -> Explanation:
    """Of the sets that the readings cannot tell apart, that with the fewest numbers.

    The numbers of `expected` effects are no extravagance: a table that the machine lacks has as
    many as it takes.
    """
    best = max(e.score for e in explanations)
    near = [e for e in explanations if e.score > best - MARGIN]
    return min(near, key=lambda e: (round(e.numbers(expected)), len(e.labels), -e.score))


def may_beat(explanation: Explanation, finished: Sequence[Explanation]) -> bool:
    """Whether further effects could bring an explanation above the best that needs none.

    At most they win half of what its sum of squares has too much, less the price of one effect.
    """
    if not finished:
        return True
    best = max(finished, key=lambda e: e.score)
    excess = explanation.residual @ explanation.residual - best.residual @ best.residual
    return explanation.score + 0.5 * float(excess) - _PRICE > best.score
