"""Candidate scores: how every effect does on its own, for people to look at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.base.units import um_from_mm
from vmach.diagnosis.inference.weighing import Weighing
from vmach.effects import label_of

__all__ = ["CandidateScore", "candidate_scores"]


@dataclass(frozen=True)
class CandidateScore:
    """How a single effect does on its own.

    Attributes
    ----------
    effect, target : str
    score : float
        Log evidence on what the model misses, prior odds included.
    rms_after_um : float
        Root mean square that the effect leaves of it.
    status : str
        "tested", or why it could not be, as people read it.
    is_tested : bool
    why_not : str
        Why it could not be tested; empty where it was.
    """

    effect: str
    target: str
    score: float
    rms_after_um: float
    status: str
    is_tested: bool = True
    why_not: str = ""

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect, self.target)


def candidate_scores(weighing: Weighing, before_um: float) -> tuple[CandidateScore, ...]:
    """Scores of all candidates, the best first, then those that the survey cannot show.

    Parameters
    ----------
    weighing : Weighing
    before_um : float
        Root mean square without any effect, which the latter leave.
    """
    survey, gains = weighing.survey, weighing.gains(weighing.alone)
    explained = [weighing.alone_mm(k) for k in range(len(weighing.candidates))]
    after = survey.residual_mm[:, None] - np.column_stack(explained)
    after = um_from_mm(np.sqrt(np.mean((after - survey.aligned(after)) ** 2, axis=0)))
    tested = [
        CandidateScore(
            c.effect.name, c.target, round(float(gain), 2), round(float(rms), 3), "tested"
        )
        for c, gain, rms in zip(weighing.candidates, gains, after, strict=True)
    ]
    untested = [
        CandidateScore(e.name, target, 0.0, round(before_um, 3), f"not testable: {why}", False, why)
        for e, target, why in weighing.excluded
    ]
    return (*sorted(tested, key=lambda s: -s.score), *untested)
