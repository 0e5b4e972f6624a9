"""Diagnosis: what the model lacks, named, or a class, or something unknown, or nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.diagnosis.absorbing import absorbing, slack_of
from vmach.diagnosis.blind_spots import blind_spots
from vmach.diagnosis.contrived import is_contrived
from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.findings import CandidateScore, Diagnosis, Finding
from vmach.diagnosis.held_out import holds_out
from vmach.diagnosis.impossible_sizes import impossible_sizes
from vmach.diagnosis.next_measurement import next_measurement
from vmach.diagnosis.outliers import (
    MOST_OUTLIERS,
    outlier_note,
    outliers,
    reading_names,
    worst_of,
)
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.rivals import Rivals, rivals_of
from vmach.diagnosis.search import Search
from vmach.diagnosis.shown_laws import laws_not_shown
from vmach.diagnosis.where_it_fails import Failure, where_it_fails
from vmach.diagnosis.words import component_parameters, where_component
from vmach.effects import Effect
from vmach.effects.component import Component
from vmach.fit.candidates import gather_candidates
from vmach.fit.joint_fit import fit_terms
from vmach.fit.survey import Survey
from vmach.fit.terms import Term
from vmach.fit.uncertainty import parameter_uncertainty
from vmach.fit.whitening import Whitening
from vmach.units import um_from_mm

__all__ = ["BEND_SHARE", "diagnose", "explanation_with_slack", "prepare_search"]

#: share of the error between two table points that is carried as uncertainty
BEND_SHARE = 1.0
#: times that the slack is set by the fit before, so that it is a share of what is there at last
_PASSES = 3
#: times that readings are left out; all but the last time the worst ones alone
_OUTLIER_PASSES = 4
#: share of the stated scatter below which what is left makes u_um doubtful
_TOO_QUIET = 1.0 / 3.0

Progress = Callable[[str], None]


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
    search, explanation, left_out = _without_outliers(search)
    survey = search.survey
    explanation = _settled(search, explanation)
    tell("is what is left noise?")
    findings = _findings(search, explanation)
    left, not_shown = search.left_in(explanation), []
    if not left:
        left, not_shown = impossible_sizes(findings)
    if not left:
        left, not_shown = laws_not_shown(search, explanation)
    residuals = Residuals(
        survey, search.whiten, survey.factors(bend_share=BEND_SHARE), explanation.fit
    )
    failures = where_it_fails(survey, search.whiten, survey.residual_mm)
    verdict = _verdict(findings, left)
    if verdict == "unknown":
        remaining = ()
        if not not_shown:
            remaining = where_it_fails(survey, search.whiten, residuals.left_mm)
        findings = (_something(remaining or failures),)
    tell("what to measure next")
    return Diagnosis(
        verdict=verdict,
        findings=findings,
        rms_um=residuals.rms_um,
        candidates=_scores(search, residuals.rms_um["before"]),
        failures=failures,
        blind_spots=blind_spots(search, explanation),
        next_measurement=next_measurement(search, explanation, findings),
        left=left,
        notes=(
            *(note for m in survey.measurements for note in m.notes if note),
            *left_out,
            *not_shown,
            *_wide_uncertainty(explanation),
        ),
        residuals=residuals,
    )


@threadpool_limits.wrap(limits=1, user_api="blas")
def prepare_search(survey: Survey, effects: Sequence[Effect] | None = None) -> Search:
    """The search over a survey; `effects` are its candidates, the catalogue where left out."""
    candidates, excluded = gather_candidates(survey, effects)
    return Search(survey, candidates, _whitening(survey), excluded=excluded)


def _without_outliers(search: Search) -> tuple[Search, Explanation, tuple[str, ...]]:
    """The search without readings that no cause explains, what it finds, and a note on them.

    Where they would be many, none is left out: something is behind them.
    """
    whole, found = search.survey, search.run()
    terms = found.fit.terms if found.fit else ()
    survey, whiten, residual = whole, search.whiten, found.residual
    names: list[str] = []
    kept = np.ones(len(whole), dtype=bool)
    for left in reversed(range(_OUTLIER_PASSES)):
        astray = outliers(survey, residual)
        if len(names) + astray.sum() > MOST_OUTLIERS * len(whole):
            return search, found, ()
        if not astray.any():
            break
        rows = worst_of(astray, residual) if left else astray
        names += reading_names(survey, rows)
        kept[np.flatnonzero(kept)[rows]] = False
        survey = whole.part_of(kept)
        whiten = _whitening(survey)
        residual = _left_by(terms, survey, whiten)
    if not names:
        return search, found, ()
    candidates = [replace(c, signatures_mm=c.signatures_mm[kept]) for c in search.candidates]
    search = Search(survey, candidates, whiten, excluded=search.excluded)
    return search, search.run(), (outlier_note(names, len(whole)),)


def _left_by(terms: Sequence[Term], survey: Survey, whiten: Whitening) -> np.ndarray:
    """What fitted terms leave of whitened readings, (n,)."""
    reading = whiten(survey.residual_mm)
    if not terms:
        return reading
    return absorbing(survey, whiten, fit_terms(survey, terms, whiten))(reading)


def _whitening(survey: Survey) -> Whitening:
    return Whitening(survey.u_mm, survey.factors(bend_share=BEND_SHARE), survey.nuisance)


def _settled(search: Search, explanation: Explanation) -> Explanation:
    """Without effects that do not help to predict held-out readings, and refitted carefully."""
    while explanation.fit is not None:
        useful = holds_out(search.survey, explanation.fit)
        if all(useful):
            break
        terms = [t for t, good in zip(explanation.fit.terms, useful, strict=True) if good]
        explanation = search.explain(terms)
    return explanation_with_slack(search, explanation)


def explanation_with_slack(search: Search, explanation: Explanation) -> Explanation:
    """Refitted with what the effects' laws leave open counted as uncertainty."""
    if explanation.fit is None:
        return explanation
    survey, fit = search.survey, explanation.fit
    factors = survey.factors(bend_share=BEND_SHARE)
    for _ in range(_PASSES):
        slack = slack_of(survey, replace(fit, slack_mm=None))
        if slack.shape[1] == 0:
            return explanation
        careful = Whitening(survey.u_mm, np.hstack([factors, slack]), survey.nuisance)
        fit = replace(fit_terms(survey, fit.terms, careful), slack_mm=slack)
    return search.explanation_of(fit)


def _findings(search: Search, explanation: Explanation) -> tuple[Finding, ...]:
    if explanation.fit is None:
        return ()
    findings = []
    for k, term in enumerate(explanation.fit.terms):
        where, intervals, hardly = None, {}, ()
        if isinstance(term.effect, Component):
            part = search.survey.paths[0]
            parameters, u = component_parameters(explanation.fit, k, part)
            where = where_component(parameters, u, term.target)
        else:
            parameters = explanation.fit.parameters(k)
            spreads = parameter_uncertainty(search.survey, explanation.fit, k)
            u = {name: spread.u for name, spread in spreads.items()}
            intervals = {name: (spread.low, spread.high) for name, spread in spreads.items()}
            hardly = tuple(name for name, spread in spreads.items() if not spread.is_shown)
        rivals = rivals_of(search, explanation, k)
        findings.append(
            Finding(term.effect, term.target, parameters, u, rivals, where, intervals, hardly)
        )
    return tuple(findings)


def _verdict(findings: tuple[Finding, ...], left: dict[str, float]) -> str:
    if left or is_contrived(findings):
        return "unknown"
    if not findings:
        return "nothing"
    return "class" if any(len(f.rivals.names) > 1 for f in findings) else "named"


def _wide_uncertainty(explanation: Explanation) -> tuple[str, ...]:
    """A note where the rest scatters far less than the readings' uncertainty says."""
    share = float(np.sqrt(np.sum(explanation.residual**2) / max(explanation.degrees, 1)))
    if share > _TOO_QUIET:
        return ()
    return (
        f"what is left scatters {1.0 / max(share, 1e-9):.3g} times less than u_um says: is u_um "
        "too large? Effects go unseen by it, and intervals are too wide",
    )


def _something(failures: tuple[Failure, ...]) -> Finding:
    where = "; ".join(f.text for f in failures[:3]) or None
    return Finding(None, "", {}, {}, Rivals((), ()), where, {})


def _scores(search: Search, before_um: float) -> tuple[CandidateScore, ...]:
    survey, nothing = search.survey, search.nothing
    explained = [search.alone_mm(k) for k in range(len(search.candidates))]
    after = survey.residual_mm[:, None] - np.column_stack(explained)
    after = um_from_mm(np.sqrt(np.mean((after - survey.aligned(after)) ** 2, axis=0)))
    scores = [
        CandidateScore(c.effect.name, c.target, round(gain, 2), round(float(rms), 3), "tested")
        for c, gain, rms in zip(search.candidates, search.gains(nothing), after, strict=True)
    ]
    scores.sort(key=lambda s: -s.score)
    scores += [
        CandidateScore(e.name, target, 0.0, round(before_um, 3), f"not testable: {why}")
        for e, target, why in search.excluded
    ]
    return tuple(scores)
