"""A weighing of candidates over the readings of a survey, and nothing known of its noise."""

from __future__ import annotations

from collections.abc import Iterable

from threadpoolctl import threadpool_limits

from vmach.diagnosis.inference.weighing import Weighing
from vmach.effects import Effect
from vmach.fit.candidates import gather_candidates
from vmach.fit.survey import Survey

__all__ = ["prepare_weighing"]


@threadpool_limits.wrap(limits=1, user_api="blas")
def prepare_weighing(survey: Survey, effects: Iterable[Effect] | None = None) -> Weighing:
    """Over a survey; `effects` are its candidates, the catalogue where left out."""
    candidates, excluded = gather_candidates(survey, effects)
    return Weighing(survey, candidates, excluded=excluded)
