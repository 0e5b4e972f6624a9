"""The probability of readings, worked out here in full with dense covariances."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.linalg import null_space
from scipy.stats import multivariate_normal, norm

from tests.unit.test_diagnosis_verdicts import stretched_and_loose, tip_job
from vmach.diagnosis.gates.parameters_in_bounds import log_factor_of_bounds
from vmach.diagnosis.inference.other_sets import otherwise
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.verdicts import infer
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue
from vmach.errors import InputError
from vmach.fit.base import Base, root_of_precision
from vmach.fit.deletion_residuals import deletion_residuals
from vmach.fit.evidence import WIDTHS
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes
from vmach.fit.uncertainty import Otherwise, parameter_uncertainty


@pytest.fixture(scope="module")
def weighing(tmp_path_factory):
    job = tip_job(tmp_path_factory.mktemp("job"), stretched_and_loose)
    wanted = [catalogue()[name] for name in ("scale", "backlash", "squareness")]
    return prepare_weighing(survey_job(job), wanted)


def explained(weighing, *labels):
    found = weighing.nothing()
    for label in labels:
        found = weighing.extend(found, weighing.index_of(label))
    return found


def dense_noise(noise):
    """Covariance of single readings, mm², from the definition."""
    names, number = np.unique(noise.group, return_inverse=True)
    covariance = np.diag((1.0 - noise.share) / noise.weight)
    for k in range(len(names)):
        rows = np.flatnonzero(number == k)
        apart = np.abs(np.subtract.outer(np.arange(len(rows)), np.arange(len(rows))))
        covariance[np.ix_(rows, rows)] += noise.share * noise.correlation**apart
    return covariance * np.outer(noise.u_mm, noise.u_mm)


def dense_covariance(noise, members, sizes, columns):
    """Covariance of readings with members of given sizes and effects' columns, mm²."""
    covariance = sizes.factor**2 * dense_noise(noise) + columns @ columns.T
    covariance += members.fixed_mm @ members.fixed_mm.T
    for size, member in zip(sizes.members, members.columns_mm, strict=True):
        covariance += size**2 * member @ member.T
    return covariance


@pytest.mark.parametrize(("share", "tails"), [(0.0, False), (0.6, False), (0.6, True)])
def test_probability_is_that_of_a_normal_distribution(weighing, share, tails):
    """Readings off the nuisance; a difference of two models, as constants are left out."""
    survey, members = weighing.survey, weighing.members
    random = np.random.default_rng(3)
    weight = random.uniform(0.2, 1.0, len(survey)) if tails else np.ones(len(survey))
    noise = FeatureNoise(survey.u_mm, survey.group, weight, share, 0.8)
    base = Base(survey, noise, members)
    scale = weighing.candidates[weighing.index_of("scale X")].signatures_mm[:, 0]
    free = null_space(survey.nuisance.T)

    def both(sizes, columns):
        covariance = dense_covariance(noise, members, sizes, columns)
        dense = multivariate_normal.logpdf(
            free.T @ survey.residual_mm, cov=free.T @ covariance @ free
        )
        ours = Posterior(base, sizes, Effects(base.columns(columns))).log_probability
        return dense, ours - sizes.log_prior(*members.prior_of_sizes)

    count = len(members.names)
    one = both(Sizes(1.0, (0.3,) * count), np.zeros((len(survey), 0)))
    other = both(Sizes(1.4, tuple(np.linspace(0.0, 2.0, count))), 1.5 * scale)
    assert one[1] - other[1] == pytest.approx(one[0] - other[0], rel=1e-6)


@pytest.mark.parametrize("share", [0.0, 0.6])
@pytest.mark.parametrize("beside", [(), ("scale X",)])
def test_products_of_whitened_columns_are_those_by_the_dense_inverse(weighing, share, beside):
    survey, members = weighing.survey, weighing.members
    noise = FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey)), share, 0.8)
    base = Base(survey, noise, members)
    sizes = Sizes(1.4, tuple(np.linspace(0.0, 2.0, len(members.names))))
    signature = {c.label: 1.5 * c.signatures_mm[:, 0] for c in weighing.candidates}
    columns = np.hstack([np.zeros((len(survey), 0)), *(signature[label] for label in beside)])
    tested = np.column_stack([*signature.values(), survey.residual_mm])
    posterior = Posterior(base, sizes, Effects(base.columns(columns)))
    ours = posterior.whiten(tested)
    free = null_space(survey.nuisance.T)
    dense = free.T @ dense_covariance(noise, members, sizes, columns) @ free
    expected = tested.T @ free @ np.linalg.solve(dense, free.T @ tested)
    np.testing.assert_allclose(ours.T @ ours, expected, rtol=1e-6, atol=1e-8 * expected.max())
    gram, seen = posterior.products(base.columns(tested))
    np.testing.assert_allclose(gram, expected, rtol=1e-6, atol=1e-8 * expected.max())
    np.testing.assert_allclose(seen, expected[:, -1], rtol=1e-6, atol=1e-8 * expected.max())


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_deletion_residuals_are_those_beside_all_other_readings(weighing, share):
    """The others' conditional mean and variance, and the noise of a reading of full weight."""
    survey, members = weighing.survey, weighing.members
    weight = np.random.default_rng(4).uniform(0.2, 1.0, len(survey))
    noise = FeatureNoise(survey.u_mm, survey.group, weight, share, 0.8)
    base = Base(survey, noise, members)
    sizes = Sizes(1.4, tuple(np.linspace(0.0, 2.0, len(members.names))))
    columns = 1.5 * weighing.candidates[weighing.index_of("scale X")].signatures_mm[:, 0]
    ours = deletion_residuals(Posterior(base, sizes, Effects(base.columns(columns))))
    dense = dense_covariance(noise, members, sizes, columns)
    free = null_space(survey.nuisance.T)
    inverse = free @ np.linalg.solve(free.T @ dense @ free, free.T)
    lighter = (sizes.factor * survey.u_mm) ** 2 * (1.0 - share) * (1.0 - 1.0 / weight)
    for k in (0, 5, len(survey) - 1):
        # a flat prior of the nuisance: least squares with every other reading, by one dropped
        others = np.delete(np.arange(len(survey)), k)
        given, own = dense[np.ix_(others, others)], dense[others, k]
        basis, mine = survey.nuisance[others], survey.nuisance[k]
        solved = np.linalg.solve(given, np.column_stack([own, survey.residual_mm[others], basis]))
        gram = basis.T @ solved[:, 2:]
        pose = np.linalg.lstsq(gram, basis.T @ solved[:, 1], rcond=1e-10)[0]
        expected = mine @ pose + own @ (solved[:, 1] - solved[:, 2:] @ pose)
        lever = mine - basis.T @ solved[:, 0]
        variance = dense[k, k] - own @ solved[:, 0]
        variance += lever @ np.linalg.lstsq(gram, lever, rcond=1e-10)[0]
        assert 1.0 / inverse[k, k] == pytest.approx(variance, rel=1e-6)
        away = (survey.residual_mm[k] - expected) / np.sqrt(variance + lighter[k])
        assert ours[k] == pytest.approx(away, rel=1e-4)


def test_a_parameter_beside_other_effects_is_that_of_a_dense_fit(weighing):
    """Backlash X alone, and with each other effect beside it; mean and variance in full."""
    survey, members = weighing.survey, weighing.members
    found = explained(weighing, "backlash X")
    at_least = [i for i, odds in enumerate(weighing.gains(found)) if odds > np.log(0.005)]
    own = weighing.index_of("backlash X")
    expected = [i for i in at_least if i != own]
    (others,) = otherwise(weighing, found)
    assert expected and len(others) >= len(expected)
    # members up to a fortieth of u count as absent
    present = [size if size > 0.025 else 0.0 for size in found.posterior.sizes.members]
    sizes, none = Sizes(found.posterior.sizes.factor, tuple(present)), np.zeros((len(survey), 0))
    dense = dense_covariance(weighing.base.noise, members, sizes, none)
    free = null_space(survey.nuisance.T)
    precision = free @ np.linalg.solve(free.T @ dense @ free, free.T)
    widths, evidence = weighing.prior_widths(found.fit), weighing.evidence(found)
    one = found.fit.open.mm * widths

    def first(columns):
        """Mean and covariance of the effect's own coefficients among given columns."""
        covariance = np.linalg.inv(columns.T @ precision @ columns + np.eye(columns.shape[1]))
        mean, k = covariance @ columns.T @ precision @ survey.residual_mm, len(widths)
        return mean[:k] * widths, covariance[:k, :k] * np.outer(widths, widths)

    before = first(one)
    for i, other in zip(expected, others, strict=False):
        place, width = evidence.best[i, 0], WIDTHS[evidence.best_width[i, 0]]
        after = first(np.hstack([one, width * weighing.candidates[i].signatures_mm[:, place]]))
        assert other.weight == pytest.approx(min(np.exp(weighing.gains(found)[i]), 1.0))
        np.testing.assert_allclose(other.moved, after[0] - before[0], rtol=1e-4, atol=1e-7)
        np.testing.assert_allclose(other.more, after[1] - before[1], rtol=1e-4, atol=1e-9)


def beside_another(weighing, weight, away):
    """Fit of a reversal value, its spread alone, and beside an effect that moves it so many u."""
    fit = weighing.careful(explained(weighing, "backlash X"))
    alone = parameter_uncertainty(fit, 0)["reversal_um"]
    slope = fit.slope(0)[:, list(fit.parameters(0)).index("reversal_um")]
    moved = np.zeros(len(slope))
    moved[0] = away * alone.u / slope[0]
    other = Otherwise(weight, moved, np.zeros((len(slope),) * 2))
    return fit, alone, parameter_uncertainty(fit, 0, [other])["reversal_um"]


def test_other_effects_widen_an_interval_as_often_as_they_are_there(weighing):
    """Drawn from both sets: of the draws 95 % lie between the ends."""
    fit, alone, both = beside_another(weighing, 0.25, 5.0)
    random = np.random.default_rng(5)
    centre, sigma = 0.5 * (alone.low + alone.high), 0.5 * (alone.high - alone.low) / norm.ppf(0.975)
    drawn = centre + sigma * random.standard_normal(200_000)
    drawn += 5.0 * alone.u * (random.random(len(drawn)) < 0.2)
    assert both.low <= alone.low + 1e-9
    assert np.mean(drawn > both.high) == pytest.approx(0.025, abs=0.002)
    assert both.u == pytest.approx(
        np.sqrt(np.mean((drawn - fit.parameters(0)["reversal_um"]) ** 2)), rel=0.02
    )


def test_an_improbable_effect_far_away_widens_neither_interval_nor_uncertainty(weighing):
    _, alone, both = beside_another(weighing, 0.004, 1000.0)
    assert both.high - both.low < 1.1 * (alone.high - alone.low)
    assert both.u < 1.2 * alone.u


def test_its_slope_is_that_of_differences(weighing):
    found = explained(weighing, "scale X")
    at = Sizes(1.3, (0.4, 0.2, 0.7, 1.5, 0.3, 0.6)[: len(weighing.members.names)])
    effects, base = found.posterior.effects, weighing.base
    slope, _ = Posterior(base, at, effects).slope_and_information()
    for k in range(len(slope)):
        step = 1e-5 * np.eye(len(slope))[k]
        up, down = (
            Posterior(base, Sizes.at(at.logarithms + way * step), effects).log_probability
            for way in (1.0, -1.0)
        )
        assert slope[k] == pytest.approx((up - down) / 2e-5, rel=1e-3, abs=1e-3)


def test_slope_of_an_absent_member_is_that_of_a_small_one(weighing):
    """To first order in the square of its size; the prior hardly matters there."""
    effects, base = explained(weighing, "scale X").posterior.effects, weighing.base
    slopes = [
        Posterior(base, Sizes(1.3, (size, 0.5, *more)), effects).slope_and_information()[0][1]
        for more in [(0.2,) * (len(weighing.members.names) - 2)]
        for size in (0.024, 0.026)
    ]
    assert slopes[0] == pytest.approx((0.024 / 0.026) ** 2 * slopes[1], rel=0.02)


@pytest.mark.parametrize("size", [0.3, None])
def test_evidence_of_a_candidate_is_what_it_adds(weighing, size):
    """The bank's short cut against a posterior with the candidate among its effects."""
    found, k = explained(weighing, "backlash Y"), weighing.index_of("scale X")
    sizes = found.posterior.sizes
    if size is not None:
        sizes = Sizes(sizes.factor, (size,) * len(sizes.members))
    here = replace(found, posterior=replace(found.posterior, sizes=sizes))
    evidence = weighing.evidence(here).log_factor[k, 0]
    signature = weighing.candidates[k].signatures_mm[:, 0].astype(float)
    gains = []
    for width in (0.1, 0.4, 1.5, 6.0):
        columns = np.hstack([here.posterior.effects.columns.mm, width * signature])
        effects = Effects(weighing.base.columns(columns), here.posterior.effects.log_prior)
        more = Posterior(weighing.base, sizes, effects)
        gains.append(more.log_probability - here.score)
    mean = np.logaddexp.reduce(gains) - np.log(len(gains))
    assert evidence == pytest.approx(mean, abs=1e-6)


@pytest.mark.parametrize("beside", [(), ("scale Y",)])
def test_gain_of_a_pair_is_what_both_add(weighing, beside):
    """The first as it is best alone; the second at every place and width, as it adds to that."""
    here = explained(weighing, *beside)
    evidence, gains = weighing.evidence(here), weighing.gains(here)
    i, j = map(weighing.index_of, ("backlash X", "scale X"))
    first, second = (weighing.candidates[k].signatures_mm for k in (i, j))
    first = WIDTHS[evidence.best_width[i, 0]] * first[:, evidence.best[i, 0]]
    own, base, sizes = here.posterior.effects.columns, weighing.base, here.posterior.sizes

    def log_probability(*columns):
        more = base.columns(np.hstack(columns))
        return Posterior(base, sizes, Effects(own.beside(more))).log_probability

    both = [log_probability(first, w * second[:, 0]) - log_probability(first) for w in WIDTHS]
    factor = np.log(np.mean(np.exp(np.array(both) - max(both)))) + max(both)
    one_more = explained(weighing, *beside, "backlash X")
    prior = weighing.gains(one_more)[j] - weighing.evidence(one_more).log_factor[j, 0]
    assert weighing.pair_gains(here)[i, j] == pytest.approx(gains[i] + factor + prior, abs=1e-6)


def test_gains_of_pairs_leave_out_what_is_there(weighing):
    here = explained(weighing, "scale X")
    gains = weighing.pair_gains(here)
    there = weighing.index_of("scale X")
    other = np.delete(np.delete(gains, there, axis=0), there, axis=1)
    assert np.isneginf(gains[there]).all() and np.isneginf(gains[:, there]).all()
    assert np.isfinite(other[~np.eye(len(other), dtype=bool)]).all()


def test_score_does_not_depend_on_the_way_to_a_set(weighing):
    one, other = ("scale X", "backlash Y"), ("backlash Y", "scale X")
    scores = explained(weighing, *one).score, explained(weighing, *other).score
    assert scores[0] == pytest.approx(scores[1], abs=0.2)


def test_a_needless_effect_lowers_the_score(weighing):
    pair = explained(weighing, "scale X", "backlash Y")
    more = explained(weighing, "scale X", "backlash Y", "squareness C0Y")
    assert more.score < pair.score - 1.0


def test_without_any_candidate_nothing_is_named(tmp_path):
    found = infer(prepare_weighing(survey_job(tip_job(tmp_path, stretched_and_loose)), []))
    assert found.explanation.terms == ()
    assert found.is_structure


def wave(inexact):
    """A slow wave, the law's own or times what wanders by a third: Matern 3/2 over 1500 s."""

    def hidden(q, side, time):
        apart = np.sqrt(3.0) * np.abs(np.subtract.outer(time, time)) / 1500.0
        covariance = (1.0 + apart) * np.exp(-apart) + 1e-9 * np.eye(len(time))
        wanders = np.linalg.cholesky(covariance) @ np.random.default_rng(8).standard_normal(
            len(time)
        )
        height = 30.0 * np.sin(2.0 * np.pi * time / 3400.0) * (1.0 + inexact * wanders)
        return np.column_stack([0.0 * time, 0.0 * time, height])

    return hidden


@pytest.mark.parametrize(("inexact", "scale"), [(0.0, 0.2), (0.3, 1.0)])
def test_readings_tell_how_inexact_a_law_is(tmp_path, inexact, scale):
    job = tip_job(tmp_path, wave(inexact), count=300)
    weighing = prepare_weighing(survey_job(job), [catalogue()["ambient_drift"]])
    found = weighing.small()
    found = weighing.extend(found, weighing.index_of("ambient_drift Z"))
    assert found.fit.slack_scale == scale
    told = weighing.careful(found)
    sizes = [np.std(fit.explained_mm(0)) for fit in (found.fit, told)]
    assert sizes[1] == pytest.approx(sizes[0], rel=0.3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_sizes_are_weighed_by_half_a_normal_distribution(weighing, sign):
    """Against a sum over the amplitude, of readings by dense covariances."""
    survey, members = weighing.survey, weighing.members
    base = Base(survey, FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey))), members)
    column = weighing.candidates[weighing.index_of("backlash X")].signatures_mm[:, 0]
    column = sign * 0.2 * column.astype(float)
    sizes = Sizes(1.4, (0.5,) * len(members.names))
    posterior = Posterior(base, sizes, Effects(base.columns(column)))
    size = SimpleNamespace(is_size=True)
    term = SimpleNamespace(effect=SimpleNamespace(amplitudes=(size,)), free_parameters=())
    ours = log_factor_of_bounds(
        SimpleNamespace(terms=(term,), coefficients=(np.ones(1),)), posterior
    )
    free = null_space(survey.nuisance.T)
    dense = free.T @ dense_covariance(base.noise, members, sizes, 0.0 * column) @ free
    amount = np.linspace(-6.0, 6.0, 48001)
    left = free.T @ (survey.residual_mm[:, None] - column * amount)
    log = norm.logpdf(amount) - 0.5 * np.sum(left * np.linalg.solve(dense, left), axis=0)
    density = np.exp(log - log.max())
    share = np.trapezoid(density[amount >= 0.0]) / np.trapezoid(density)
    assert ours == pytest.approx(np.log(2.0 * share), abs=2e-3)


@pytest.mark.parametrize(("low", "high"), [(0.5, 4.0), (1.9, 2.1), (2.0, 60.0), (0.01, 2.0)])
def test_inner_parameters_are_weighed_between_their_bounds(weighing, low, high):
    """Against a sum over amplitude and inner parameter, of readings by dense covariances."""
    survey, members = weighing.survey, weighing.members
    base = Base(survey, FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey))), members)
    columns = [
        weighing.candidates[weighing.index_of(label)].signatures_mm[:, 0].astype(float)
        for label in ("backlash X", "scale X")
    ]
    columns = np.hstack(columns) * [0.2, 0.002]
    sizes, spread, usual, here = Sizes(1.4, (0.5,) * len(members.names)), 0.7, 1.5, 2.0
    posterior = Posterior(base, sizes, Effects(base.columns(columns)))
    inner = SimpleNamespace(name="way_mm", low=low, high=high, usual=usual, spread=spread)
    effect = SimpleNamespace(amplitudes=(SimpleNamespace(is_size=False),))
    term = SimpleNamespace(effect=effect, free_parameters=(inner,), inner={"way_mm": here})
    ours = log_factor_of_bounds(
        SimpleNamespace(terms=(term,), coefficients=(np.ones(1),)), posterior
    )
    free = null_space(survey.nuisance.T)
    dense = free.T @ dense_covariance(base.noise, members, sizes, 0.0 * columns) @ free
    white = np.linalg.solve(np.linalg.cholesky(dense), free.T @ np.c_[survey.residual_mm, columns])
    amounts = np.linspace(-8.0, 8.0, 2001)
    both = np.stack(np.meshgrid(amounts, amounts, indexing="ij"))
    left = white[:, :1].T @ white[:, :1] - 2.0 * np.tensordot(white[:, 1:].T @ white[:, 0], both, 1)
    gram = white[:, 1:].T @ white[:, 1:]
    left = left + np.einsum("kij,kl,lij->ij", both, gram, both)
    log = -0.5 * (left + np.sum(both**2, axis=0))
    below = cumulative_trapezoid(np.exp(log - log.max()).sum(axis=0), amounts, initial=0.0)
    ends = np.log([low, high])
    share = np.diff(np.interp((ends - np.log(here)) / spread, amounts, below))[0] / below[-1]
    before = np.diff(norm.cdf(ends, np.log(usual), spread))[0]
    # a cell of the sum is 0.008 wide, and errors go with its square
    assert ours == pytest.approx(np.log(share / before), abs=1e-4)


def test_sizes_that_rounding_hides_are_told_in_one_message():
    gram = np.array([[1.0, 1.0 + 1e-9], [1.0 + 1e-9, 1.0]])  # as rounding makes of twins
    with pytest.raises(InputError, match="out of all proportion to their uncertainty"):
        root_of_precision(gram, np.full(2, 1e6))
