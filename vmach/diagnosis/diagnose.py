"""Diagnosis: what the model lacks, named, or a class, or something unknown, or nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.diagnosis.candidate_scores import CandidateScore, candidate_scores
from vmach.diagnosis.examination import examine
from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.findings import Finding, something_unknown
from vmach.diagnosis.next_test.blind_spots import BlindSpot, blind_spots
from vmach.diagnosis.next_test.next_measurement import NextMeasurement, next_measurement
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.residuals.where_it_fails import Failure, where_it_fails
from vmach.diagnosis.search import Search, prepare_search
from vmach.fit.survey import Survey

__all__ = ["Diagnosis", "diagnose"]

#: share of the stated scatter below which what is left makes u_um doubtful
_TOO_QUIET = 1.0 / 3.0

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Diagnosis:
    """What the measurements say about the model.

    Attributes
    ----------
    verdict : str
        "named", "class", "unknown" or "nothing".
    findings : tuple of Finding
    rms_um : dict
        "before", "after", "expected_noise": over all readings, alignment taken off.
    candidates : tuple of CandidateScore
    failures : tuple of Failure
        Where the model fails, before anything is added.
    blind_spots : tuple of BlindSpot
    next_measurement : NextMeasurement or None
    left : dict
        What is left beyond noise by kind of pattern; empty where the rest is noise.
    notes : tuple of str
    residuals : Residuals
        Measured minus predicted, to be looked at.
    """

    verdict: str
    findings: tuple[Finding, ...]
    rms_um: dict[str, float]
    candidates: tuple[CandidateScore, ...]
    failures: tuple[Failure, ...]
    blind_spots: tuple[BlindSpot, ...]
    next_measurement: NextMeasurement | None
    left: dict[str, float]
    notes: tuple[str, ...]
    residuals: Residuals


@threadpool_limits.wrap(limits=1, user_api="blas")
def diagnose(
    survey: Survey, *, like: Search | None = None, progress: Progress | None = None
) -> Diagnosis:
    """Compare measurements with the model and say what is missing.

    Parameters
    ----------
    survey : Survey
    like : Search, optional
        Of other readings of the same design, whose signatures are used again; made by
        `prepare_search`.
    progress : callable, optional
        Told what is being done.
    """
    tell = progress or (lambda text: None)
    tell("signatures of all effects")
    search = like.on(survey) if like else prepare_search(survey)
    tell("search")
    found = examine(search)
    search, explanation, findings = found.search, found.explanation, found.findings
    survey = search.survey
    residuals = Residuals(survey, search.whiten, survey.factors, explanation.fit)
    failures = where_it_fails(survey, search.whiten, survey.residual_mm)
    if found.verdict == "unknown":
        left_mm = residuals.left_mm
        remaining = () if found.not_shown else where_it_fails(survey, search.whiten, left_mm)
        findings = (something_unknown(remaining or failures),)
    tell("what to measure next")
    return Diagnosis(
        verdict=found.verdict,
        findings=findings,
        rms_um=residuals.rms_um,
        candidates=candidate_scores(search, residuals.rms_um["before"]),
        failures=failures,
        blind_spots=blind_spots(search, explanation, is_named=found.verdict != "unknown"),
        next_measurement=next_measurement(search, explanation, findings),
        left=found.left,
        notes=(
            *map(str, survey.notes),
            *found.left_out,
            *found.not_shown,
            *_wide_uncertainty(explanation),
        ),
        residuals=residuals,
    )


def _wide_uncertainty(explanation: Explanation) -> tuple[str, ...]:
    """A note where the rest scatters far less than the readings' uncertainty says."""
    share = float(np.sqrt(np.sum(explanation.residual**2) / max(explanation.degrees, 1)))
    if share > _TOO_QUIET:
        return ()
    return (
        f"what is left scatters {1.0 / max(share, 1e-9):.3g} times less than u_um says: is u_um "
        "too large? Effects go unseen by it, and intervals are too wide",
    )
