"""Search for the set of effects that explains the measurements.

Candidates are weighed by their evidence on what the effects before them left, absorbed, and
refitted together. Several sets are followed side by side, so that a pair of effects that mask
each other is found even where neither leads alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.diagnosis.explanation import Explanation, may_beat, simplest_of_the_best
from vmach.diagnosis.gates.impossible_sizes import has_impossible_sizes
from vmach.diagnosis.weighing import Weighing
from vmach.effects import Effect
from vmach.fit.candidates import gather_candidates
from vmach.fit.survey import Survey

__all__ = ["Search", "prepare_search"]

#: sets followed side by side, and candidates tried on a set of so many effects
_BEAM, _TRIED = 3, (5, 4, 2)
_MOST_EFFECTS = 3
#: times that an effect of the set found may be exchanged for another
_EXCHANGES = 2
#: share of the best candidate's evidence that makes another worth following
_WORTH_TRYING = 0.25
#: an effect whose law leaves no more open than this share ends the search when it explains all
_STIFF = 0.05


@threadpool_limits.wrap(limits=1, user_api="blas")
def prepare_search(survey: Survey, effects: Iterable[Effect] | None = None) -> Search:
    """The search over a survey; `effects` are its candidates, the catalogue where left out."""
    candidates, excluded = gather_candidates(survey, effects)
    return Search(survey, candidates, excluded=excluded)


class Search(Weighing):
    """The search over one survey's candidates."""

    def run(self) -> Explanation:
        """The best set of effects, every one of them above the threshold given the others."""
        beam, finished = [self.nothing], []
        seen = [self.nothing]
        for _ in range(_MOST_EFFECTS):
            grown = self._grown(beam)
            seen += grown
            finished += [e for e in (*beam, *grown) if self._is_finished(e)]
            beam = [e for e in grown if not self._is_finished(e) and may_beat(e, finished)]
            beam = sorted(beam, key=lambda e: -e.score - self.further(e))[:_BEAM]
            if not beam:
                break
        return self._without_needless(self._exchanged(self._simplest(finished or seen)))

    def _is_finished(self, explanation: Explanation) -> bool:
        """Whether no other candidate is above the threshold on what an explanation leaves."""
        return self.further(explanation) == 0.0

    def _grown(self, beam: Sequence[Explanation]) -> list[Explanation]:
        """Sets of one effect more; of those that several ways lead to, the better fitted one."""
        best: dict[frozenset[str], Explanation] = {}
        for explanation in beam:
            has = explanation.labels
            for child in self._children(explanation, tried=_TRIED[len(has)], but=has):
                known = best.get(child.labels)
                if known is None or child.score > known.score:
                    best[child.labels] = child
        return list(best.values())

    def _children(
        self, explanation: Explanation, *, tried: int, but: frozenset[str]
    ) -> Iterator[Explanation]:
        """The explanation with each of the leading candidates `but` some, until one explains all.

        An effect whose law leaves much open ends nothing: it may only imitate stiffer ones.
        """
        gains = self.gains(explanation)
        least = max(self.threshold, _WORTH_TRYING * max(gains))
        leading = [k for k in np.argsort(gains)[::-1][:tried] if gains[k] > least]
        for k in leading:
            if self.candidates[k].label in but:
                continue
            child = self.extend(explanation, k)
            if child.fit is not None and has_impossible_sizes(child.fit):
                continue
            yield child
            if not _is_loose(self.candidates[k].effect) and self._is_finished(child):
                return

    def _simplest(self, explanations: Sequence[Explanation]) -> Explanation:
        return simplest_of_the_best(explanations, self.missing_tables)

    def _exchanged(self, explanation: Explanation) -> Explanation:
        """With single effects replaced, as long as others do better beside those that stay."""
        for _ in range(_EXCHANGES if len(explanation.terms) > 1 else 0):
            seen = [explanation]
            for k in range(len(explanation.terms)):
                others = self.without(explanation, [k])
                seen += self._children(others, tried=_TRIED[-1], but=explanation.labels)
            best = self._simplest([e for e in seen if self._is_finished(e)] or seen)
            if best is explanation:
                break
            explanation = best
        return explanation

    def _without_needless(self, explanation: Explanation) -> Explanation:
        """Drop effects, the weakest first, that the others make needless."""
        while explanation.terms:
            gains = [self.gain_of(explanation, k) for k in range(len(explanation.terms))]
            weakest = int(np.argmin(gains))
            if gains[weakest] > self.threshold:
                break
            terms = [t for k, t in enumerate(explanation.terms) if k != weakest]
            explanation = self.explain(terms)
        return explanation


def _is_loose(effect: Effect) -> bool:
    """Whether an effect's law leaves so much open that it may imitate others."""
    return effect.is_flexible or effect.is_slow or effect.slack_share > _STIFF
