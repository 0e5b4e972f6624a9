"""Intervals over what stands beside an effect, against integrals by brute force."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm

from tests.hidden_effects.shop_tests import make_plate
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import Effect, along, linear
from vmach.fit import other_sizes
from vmach.fit.base import Base
from vmach.fit.joint_fit import fit_terms
from vmach.fit.marginal_likelihood import Effects, Posterior, best_sizes
from vmach.fit.noise.discrepancy import Members, members_of
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes
from vmach.fit.terms import Term
from vmach.fit.uncertainty import parameter_uncertainty

COUNT, NOISE, USUAL = 60, 0.5, 10.0
PLACE = np.linspace(-1.0, 1.0, COUNT)
RAMP = np.sqrt(3.0) * PLACE
#: a drift that bends, in part a ramp; one that is a ramp; and one that is none
BENT = 0.8 * RAMP + np.sin(2.0 * np.pi * PLACE)
OTHER = 0.5 * RAMP + np.cos(4.0 * np.pi * PLACE)


class Ramp(Effect):
    """A straight line of some height."""

    name = "ramp"
    title = "ramp"
    parameters = (linear("height_um", "height", usual=USUAL),)
    targets = ("",)

    def displacement(self, path, target, height_um):
        return along("Z", height_um * RAMP)


class OneSeries:
    """The part of a survey that a fit asks for: one series of readings, nothing left free."""

    def __init__(self, readings):
        self.residual_mm = readings
        self.nuisance = np.zeros((len(readings), 0))

    def __len__(self):
        return len(self.residual_mm)

    def signature(self, effect, target, inner_values):
        return effect.displacement(None, target, USUAL)[:, 2:]

    def told_apart(self, effect, inner):
        return np.ones(len(inner), dtype=bool)

    def places(self, effect, target, inner_values):
        return [], np.zeros(0)


def members_like(*shapes):
    """Members whose size of one makes one u."""
    columns = tuple(NOISE * shape[:, None] for shape in shapes)
    return Members(np.zeros((COUNT, 0)), tuple(f"member {k}" for k in range(len(shapes))), columns)


def interval(monkeypatch, readings, searched, opened):
    """Ends of the interval that a fit beside some members gives, over others."""
    monkeypatch.setattr(other_sizes, "open_members", lambda survey, searched: opened)
    noise = FeatureNoise(np.full(COUNT, NOISE), np.full(COUNT, "one"), np.ones(COUNT))
    base = Base(OneSeries(readings), noise, searched)
    (columns,) = base.signatures([(Ramp(), "", {})])
    start = Sizes(1.0, (0.3,) * len(searched.names))
    sizes = best_sizes(base, start, Effects(columns.scaled(30.0))).sizes
    beside = Posterior(base, sizes, Effects(base.no_columns))
    fit = fit_terms(beside, [Term(Ramp(), "", {})])
    (of_sizes,) = other_sizes.beside_other_sizes(fit)
    spread = parameter_uncertainty(fit, 0, (), of_sizes)["height_um"]
    return np.array([spread.low, spread.high]), beside.sizes.factor


def integrated(readings, shapes, factor):
    """The same by normal models at every node of a grid of sizes, whose prior is as documented."""
    nodes = np.linspace(0.0, 6.0, 601) if len(shapes) == 1 else np.linspace(0.0, 4.0, 81)
    grid = np.stack(np.meshgrid(*[nodes] * len(shapes), indexing="ij"), -1)
    log, mean, sigma = [], [], []
    for sizes in grid.reshape(-1, len(shapes)):
        covariance = (factor * NOISE) ** 2 * np.eye(COUNT)
        for size, shape in zip(sizes, shapes, strict=True):
            covariance += (NOISE * size) ** 2 * np.outer(shape, shape)
        inverse = np.linalg.inv(covariance)
        # 30 usual sizes beforehand
        precision = RAMP @ inverse @ RAMP + (30.0 * USUAL) ** -2.0
        seen = RAMP @ inverse @ readings
        half = -0.5 * readings @ inverse @ readings + 0.5 * seen**2 / precision
        half += 0.5 * np.linalg.slogdet(inverse)[1] - 0.5 * np.log(precision)
        log.append(half - 2.5 * np.log1p((sizes / 0.6) ** 2).sum())
        mean.append(seen / precision)
        sigma.append(precision**-0.5)
    weight, mean, sigma = np.exp(np.array(log) - max(log)), np.array(mean), np.array(sigma)
    weight /= weight.sum()
    return np.array([
        brentq(lambda x, s=share: weight @ norm.cdf((x - mean) / sigma) - s, -50.0, 50.0)
        for share in (0.025, 0.975)
    ])  # fmt: skip


@pytest.mark.parametrize("hidden", [0.0, 1.5])
@pytest.mark.parametrize("shape", [BENT, RAMP], ids=["a bent drift", "a drift like the effect"])
def test_a_size_is_integrated_over(monkeypatch, shape, hidden):
    """Where it is found to be absent too, and where the search had no such member."""
    random = np.random.default_rng(7)
    readings = 3.0 * RAMP + hidden * NOISE * shape + NOISE * random.standard_normal(COUNT)
    searched = members_like() if shape is RAMP else members_like(shape)
    found, factor = interval(monkeypatch, readings, searched, members_like(shape))
    expected = integrated(readings, [shape], factor)
    np.testing.assert_allclose(found, expected, atol=0.04 * np.ptp(expected))


def test_sizes_of_several_members_add_up(monkeypatch):
    random = np.random.default_rng(8)
    readings = 3.0 * RAMP + 0.3 * NOISE * OTHER + NOISE * random.standard_normal(COUNT)
    both = members_like(BENT, OTHER)
    found, factor = interval(monkeypatch, readings, both, both)
    expected = integrated(readings, [BENT, OTHER], factor)
    np.testing.assert_allclose(found, expected, atol=0.06 * np.ptp(expected))


def test_what_is_surely_absent_leaves_an_interval_as_it_is(monkeypatch):
    """A wave that the readings show not to be there, and that is nothing like the effect."""
    random = np.random.default_rng(9)
    readings = 3.0 * RAMP + NOISE * random.standard_normal(COUNT)
    wave = np.cos(4.0 * np.pi * PLACE)
    (low, high), factor = interval(monkeypatch, readings, members_like(), members_like(wave))
    u = factor * NOISE / np.linalg.norm(RAMP)
    assert high - low == pytest.approx(2.0 * 1.96 * u, rel=0.05)


def test_a_smooth_field_does_half_along_plain_laws_of_what_it_did(tmp_path):
    """Of its variance along stretches and shears of a plate: none, a quarter, all."""
    make_plate(tmp_path / "plate", 17000)
    survey = survey_job(tmp_path / "plate" / "job.toml")
    (x, y), sensing = np.vstack([p.nose_mm for p in survey.paths])[:, :2].T, survey.sensing
    strains = np.column_stack([sensing[:, 0] * x, sensing[:, 0] * y, sensing[:, 1] * y])
    strains, _ = np.linalg.qr(strains - survey.aligned(strains))
    searched = prepare_weighing(survey).members
    variances = []
    for members in (searched, other_sizes.open_members(survey, searched), members_of(survey)):
        field = members.columns_mm[members.names.index("field")]
        along = strains.T @ (field - survey.aligned(field))
        variances.append(np.sum(along**2))
    assert variances[0] < 1e-12 * variances[2]
    assert variances[1] == pytest.approx(0.25 * variances[2], rel=1e-3)
