"""The next measurement: the test that tells best apart what is still open, as an NC program.

Every runnable test is simulated on the machine. Of two rivals, one is fitted to what the other
would show there; what it cannot imitate, in units of the instrument's uncertainty, is the test's
power to separate them (a T-optimal design chosen among tests that exist).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.findings import Finding
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.next_test.planned_program import U_MM, write_program
from vmach.diagnosis.proposals.form import FormEffect
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.proposals.states import CUT
from vmach.effects import Circumstances
from vmach.fit.terms import Term
from vmach.fit.whitening import orthonormal
from vmach.instruments import PlannedTest, planned_tests
from vmach.job import Job

__all__ = ["NextMeasurement", "next_measurement"]

#: a test that separates by less than this, in standard uncertainties, is not worth its time
_USEFUL = 3.0
#: candidates that a test for something unknown is to tell apart
_LEADING = 3
#: places of a rival that are tried
_MOST_PLACES = 40


@dataclass(frozen=True)
class NextMeasurement:
    """The test to run next.

    Attributes
    ----------
    separates : tuple of str
        The effect found and the rivals that the test tells it from; of something unknown the
        candidates that came nearest.
    text : str
        What to do, in words.
    program : str or None
        The test as an NC program; None where none without cutting would tell.
    power : float
        By how many standard uncertainties they differ in it, at least.
    """

    separates: tuple[str, ...]
    text: str
    program: str | None
    power: float


def next_measurement(
    weighing: Weighing,
    explanation: Explanation,
    findings: Sequence[Finding],
    proposals: Sequence[Proposal] = (),
) -> NextMeasurement | None:
    """The most powerful test for the first finding that has rivals; None where none helps.

    Where forms are proposed for what else remains it is one that would refute the first. For
    something unknown without a form it is the test that tells the candidates apart that came
    nearest to an explanation, whichever of them is true.
    """
    tests: Sequence[_Test] = ()
    for k, finding in enumerate(findings):
        if finding.effect is None:
            break
        assert explanation.fit is not None
        rivals = _labels(weighing, finding)
        if not rivals:
            continue
        tests = tests or _tests(weighing.survey.job)
        one = _Shown(explanation.fit.terms[k], explanation.fit.coefficients[k])
        # as if the effect found were true; where no test shows it, as if the rival were
        for is_true in (True, False):
            best = _best_test(weighing, tests, one, rivals, is_true=is_true)
            if best is not None:
                return best
    if proposals:
        return _for_form(weighing.survey.job, proposals[0])
    is_unknown = any(finding.effect is None for finding in findings)
    return _for_unknown(weighing) if is_unknown else None


def _for_form(job: Job, proposal: Proposal) -> NextMeasurement:
    """The test without cutting in which a form shows most; where it shows in none, one by hand."""
    powers = [(_power_of_form(*test, proposal), test[0]) for test in _tests(job)]
    power, test = max(powers, key=lambda both: both[0])
    separates = (f"form 1: {proposal.form.formula}",)
    if power <= _USEFUL:
        text = (
            "no test without cutting would show what form 1 says of this machine. "
            f"To refute it, {proposal.form.refute}"
        )
        return NextMeasurement(separates, text, None, power)
    text = (
        f"{test.text}: if form 1 is true, it shows there by {power:.0f} standard uncertainties; "
        "where it does not, form 1 is refuted"
    )
    return NextMeasurement(separates, text, write_program(test, job), power)


def _power_of_form(test: PlannedTest, path: Circumstances, proposal: Proposal) -> float:
    """What the test would show of a form, in standard uncertainties.

    Those of its amounts count with the test's: an amount that may as well be zero shows nothing.
    With columns A of the test in its own u, amounts a and their variances D its square is
    aᵀ Aᵀ (1 + A D Aᵀ)⁻¹ A a.
    """
    if proposal.form.needs_surface or proposal.form.kinds & CUT:
        return 0.0
    effect = FormEffect(proposal.form, len(proposal.amounts_um))
    shown = np.einsum("pi,pik->pk", test.sensing, effect.columns(path, "", {}))
    basis = orthonormal(test.nuisance, tolerance=1e-7)
    left = (shown - basis @ (basis.T @ shown)) / U_MM
    usual_um = np.array([p.usual for p in effect.amplitudes])
    amounts = np.array([*proposal.amounts_um.values()]) / usual_um
    u = np.array([*proposal.u_um.values()]) / usual_um
    gram = left.T @ left
    squared = amounts @ gram @ np.linalg.solve(np.eye(len(u)) + u[:, None] ** 2 * gram, amounts)
    return float(np.sqrt(squared))


def _labels(weighing: Weighing, finding: Finding) -> list[str]:
    """The rivals of a finding; of those that rival it as a team, every member."""
    rivals = {*finding.rivals.labels, *finding.rivals.in_sets}
    return [
        c.label
        for c in weighing.candidates
        if c.label != finding.label and (c.label in rivals or c.effect.name in finding.joint_rivals)
    ]


@dataclass(frozen=True)
class _Shown:
    """An effect with its fitted coefficients (K,), to be simulated in a test."""

    term: Term
    coefficients: np.ndarray


#: a test, and what displacements in it depend on
_Test = tuple[PlannedTest, Circumstances]


def _tests(job: Job) -> list[_Test]:
    """All that the machine can run."""
    return [(test, Circumstances(test.states, job)) for test in planned_tests(job)]


def _best_test(
    weighing: Weighing,
    tests: Sequence[_Test],
    one: _Shown,
    rivals: Sequence[str],
    *,
    is_true: bool,
) -> NextMeasurement | None:
    """The test that tells an effect from most of its rivals; of equals, the more powerful one.

    Its power is that against the weakest of the rivals that it tells apart.
    """
    best = None
    others = [_Shown(*weighing.fitted_alone(weighing.index_of(label))) for label in rivals]
    for test, path in tests:
        powers = [_power(test, path, *((one, r) if is_true else (r, one))) for r in others]
        told = {label: p for label, p in zip(rivals, powers, strict=True) if p > _USEFUL}
        worth = len(told), min(told.values(), default=0.0)
        if told and (best is None or worth > best[0]):
            best = worth, test, tuple(told)
    if best is None:
        return None
    (_, power), test, labels = best
    text = (
        f"{test.text}: {one.term.label} and {' or '.join(labels)} differ there by "
        f"{power:.0f} standard uncertainties{' or more' if len(labels) > 1 else ''}"
    )
    separates = (one.term.label, *labels)
    return NextMeasurement(separates, text, write_program(test, weighing.survey.job), power)


def _for_unknown(weighing: Weighing) -> NextMeasurement:
    """The test that tells the leading candidates apart best, its weakest pair counted."""
    job, gains = weighing.survey.job, weighing.gains(weighing.alone)
    leading = [k for k in np.argsort(gains)[::-1] if gains[k] > CLEARLY][:_LEADING]
    shown = [_Shown(*weighing.fitted_alone(k)) for k in leading]
    pairs = list(itertools.permutations(shown, 2))
    tests = _tests(job)
    powers = [min((_power(*test, a, b) for a, b in pairs), default=0.0) for test in tests]
    power, (test, _) = max(zip(powers, tests, strict=True), key=lambda both: both[0])
    if power <= _USEFUL:
        return _map_without_cutting(job)
    labels = tuple(one.term.label for one in shown)
    text = (
        f"{test.text}: nothing known explains the readings; of what comes nearest "
        f"({', '.join(labels)}) any two differ there by {power:.0f} standard uncertainties or more"
    )
    return NextMeasurement(labels, text, write_program(test, job), power)


def _map_without_cutting(job: Job) -> NextMeasurement:
    """Where nothing known comes near: it tells the machine from the cut."""
    test = next(test for test in planned_tests(job) if test.maps_work_space)
    text = (
        f"{test.text}: what shows again without cutting belongs to the machine, the rest to "
        "tool, cut or part"
    )
    return NextMeasurement(("machine", "cut"), text, write_program(test, job), 0.0)


def _power(test: PlannedTest, path: Circumstances, one: _Shown, rival: _Shown) -> float:
    """What the rival, fitted anew, cannot imitate of an effect's signature, in uncertainties."""
    shown = _on_test(test, path, one.term, one.term.inner) @ one.coefficients
    places = _few(list(rival.term.effect.inner_grid(path, rival.term.target)))
    least = np.inf
    for inner in places:
        imitation = _on_test(test, path, rival.term, inner)
        basis = orthonormal(np.hstack([test.nuisance, imitation]), tolerance=1e-7)
        left = shown - basis @ (basis.T @ shown)
        least = min(least, float(np.linalg.norm(left)))
    return least / U_MM if np.isfinite(least) else 0.0


def _few(grid: list) -> list:
    return grid[:: max(1, len(grid) // _MOST_PLACES)]


def _on_test(test: PlannedTest, path: Circumstances, term: Term, inner) -> np.ndarray:
    """What one usual size of each coefficient does to the test's readings, (n, K) mm."""
    effect = term.effect
    if effect.needs_surface:
        return np.zeros((len(test.sensing), max(len(effect.amplitudes), 1)))
    moved = effect.columns(path, term.target, inner)
    if not effect.shows_on(test.states):
        moved = np.zeros_like(moved)
    return np.einsum("pi,pik->pk", test.sensing, moved)
