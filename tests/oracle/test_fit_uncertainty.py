"""Uncertainty of bent parameters against a dense integral, and its coverage on simulated data."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import logsumexp

from vmach.effects import Effect, along, catalogue, inner, linear
from vmach.fit.base import Base
from vmach.fit.joint_fit import fit_terms
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.discrepancy import Members
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes
from vmach.fit.terms import FREE, JointFit, Term, pull_of_prior
from vmach.fit.uncertainty import parameter_uncertainty

TIME_S = np.linspace(0.0, 1000.0, 40)
NOISE = 0.5


class Warming(Effect):
    """a (1 - exp(-t / tau)) in um, over a time that shows only its beginning."""

    name = "warming"
    title = "warming"
    parameters = (
        linear("growth_um", "final value", usual=10.0),
        inner("tau_s", "time constant", (300.0, 600.0, 1200.0), usual=600.0, spread=0.7),
    )
    targets = ("",)

    def displacement(self, path, target, growth_um, tau_s):
        return along("Z", growth_um * (1.0 - np.exp(-path / tau_s)))


class OneSeries:
    """The part of a survey that a fit asks for: one series of readings, nothing left free."""

    def __init__(self, readings, free=0):
        self.residual_mm = readings
        self.nuisance = np.ones((len(readings), free))

    def __len__(self):
        return len(self.residual_mm)

    def told_apart(self, effect, inner):
        return np.ones(len(inner), dtype=bool)

    def signature(self, effect, target, inner_values):
        return effect.displacement(TIME_S, target, 10.0, **inner_values)[:, 2:]

    def places(self, effect, target, inner_values):
        return [], np.zeros(0)


def beside_noise(survey):
    """Nothing but white noise and what is left free."""
    count = len(survey)
    noise = FeatureNoise(np.full(count, NOISE), np.full(count, "one"), np.ones(count))
    base = Base(survey, noise, Members(np.zeros((count, 0)), (), ()))
    return Posterior(base, Sizes(1.0, ()), Effects(base.no_columns))


def fitted(growth, tau, random):
    clean = growth * (1.0 - np.exp(-TIME_S / tau))
    survey = OneSeries(clean + NOISE * random.standard_normal(len(TIME_S)))
    fit = fit_terms(beside_noise(survey), [Term(Warming(), "", {"tau_s": 600.0})])
    return survey, fit, parameter_uncertainty(fit, 0)


def dense_moments(survey, stated):
    """Mean square distance of tau and growth, on a fine grid of tau, profile of the amplitude."""
    tau = np.exp(np.linspace(np.log(75.0), np.log(4800.0), 4001))
    shape = 1.0 - np.exp(-TIME_S / tau[:, None])
    precision = (shape**2).sum(axis=1) / NOISE**2
    growth = shape @ survey.residual_mm / NOISE**2 / precision
    log = 0.5 * growth**2 * precision - 0.5 * (np.log(tau / 600.0) / 0.7) ** 2
    weight = np.exp(log - log.max())
    weight = weight / weight.sum()
    of_tau = weight @ (tau - stated["tau_s"]) ** 2
    of_growth = weight @ ((growth - stated["growth_um"]) ** 2 + 1.0 / precision)
    return {"tau_s": np.sqrt(of_tau), "growth_um": np.sqrt(of_growth)}


@pytest.mark.parametrize("tau", [250.0, 900.0])
def test_spread_is_that_of_a_dense_integral(tau):
    survey, fit, spread = fitted(8.0, tau, np.random.default_rng(3))
    expected = dense_moments(survey, fit.parameters(0))
    for name, value in expected.items():
        assert spread[name].u == pytest.approx(value, rel=0.06), name
        assert spread[name].low < fit.parameters(0)[name] < spread[name].high


def test_intervals_cover_parameters_drawn_from_the_prior():
    """200 series: between 92 and 98 % of the 95 % intervals hold the truth."""
    random = np.random.default_rng(11)
    inside = []
    for _ in range(200):
        truth = {
            "growth_um": random.uniform(5.0, 15.0),
            "tau_s": 600.0 * np.exp(0.7 * random.standard_normal()),
        }
        truth["tau_s"] = float(np.clip(truth["tau_s"], 100.0, 4000.0))
        _, _, spread = fitted(truth["growth_um"], truth["tau_s"], random)
        inside += [spread[n].low <= v <= spread[n].high for n, v in truth.items()]
    assert 0.92 < np.mean(inside) < 0.98


def test_what_the_readings_do_not_show_is_said():
    """A ramp that has only begun: neither its end nor its time constant can be seen."""
    random = np.random.default_rng(5)
    count = len(TIME_S)
    short = OneSeries(0.3 * random.standard_normal(count))
    short.signature = lambda effect, target, inner_values: np.full((count, 1), 1e-3)
    fit = fit_terms(beside_noise(short), [Term(Warming(), "", {"tau_s": 600.0})])
    spread = parameter_uncertainty(fit, 0)
    assert not spread["growth_um"].is_shown and not spread["tau_s"].is_shown


class Step(Effect):
    """From one moment on everything is higher."""

    name = "step"
    title = "step"
    parameters = (
        linear("height_um", "of the step", usual=5.0),
        inner("time_s", "when it happened", (0.0, 1e6), usual=500.0),
    )
    targets = ("",)

    def displacement(self, path, target, height_um, time_s):
        return along("Z", height_um * (path > time_s))


class OneSeriesWithPauses(OneSeries):
    """Readings with pauses between them, in any of which a step may have happened."""

    def __init__(self, readings, time_s):
        super().__init__(readings, free=1)
        self.time_s = time_s

    def signature(self, effect, target, inner_values):
        return effect.displacement(self.time_s, target, 5.0, **inner_values)[:, 2:]

    def places(self, effect, target, inner_values):
        length = np.diff(self.time_s)
        moments = self.time_s[:-1] + 0.5 * length
        return [{"time_s": float(m)} for m in moments], np.log(length / length.sum())


def test_the_height_of_a_step_carries_that_its_moment_is_not_known():
    """300 series with steps at any time; with the moment taken as known 91 % would be held."""
    random = np.random.default_rng(8)
    count, inside = 30, []
    for _ in range(300):
        time = np.cumsum(random.exponential(40.0, count))
        when = random.uniform(time[0], time[-1])
        height = 0.8 * random.choice([-1, 1])
        readings = height * (time > when) + NOISE * random.standard_normal(count)
        survey = OneSeriesWithPauses(readings, time)
        fit = fit_terms(beside_noise(survey), [Term(Step(), "", {"time_s": 0.5 * time[-1]})])
        spread = parameter_uncertainty(fit, 0)["height_um"]
        inside.append(spread.low <= height <= spread.high)
    assert 0.93 < np.mean(inside) < 0.97


def test_an_angle_has_a_slope_where_it_jumps_by_a_turn():
    """Of the phase at the coefficients -1 and 0: that of a circle of radius one."""
    term = Term(catalogue()["cyclic_pitch"], "X", {"pitch_mm": 10.0})
    fit = SimpleNamespace(terms=(term,), coefficients=(np.array([-1.0, -1e-9]),))
    fit.parameters = lambda k: term.effect.settle(fit.coefficients[k], term.inner)
    slope = JointFit.slope(fit, 0)
    phase = list(fit.parameters(0)).index("phase_rad")
    np.testing.assert_allclose(slope[:2, phase], [0.0, -1.0], atol=1e-4)


def test_evidence_beside_tangents_is_that_of_an_integral(tmp_path):
    """Over the logarithm of a time constant that readings pull away from its usual value."""
    survey = OneSeries(Warming().displacement(TIME_S, "", 2.0, 100.0)[:, 2] / 1.0)
    posterior = beside_noise(survey)
    fit = fit_terms(posterior, [Term(Warming(), "", {"tau_s": 300.0})])
    term, spread = fit.terms[0], 0.7
    open_ = fit.open.scaled(np.array([term.prior_width, spread]))
    ours = replace(posterior, effects=Effects(open_)).log_probability
    ours -= 0.5 * float(term.unusual @ term.unusual) + pull_of_prior(fit, 0)
    steps = np.linspace(-4.0, 4.0, 2001)
    logs = []
    for step in steps:  # amplitude in closed form, its logarithm by brute force
        own = survey.signature(Warming(), "", {"tau_s": 600.0 * np.exp(spread * step)})
        column = posterior.base.columns(own * FREE)
        logs.append(replace(posterior, effects=Effects(column)).log_probability)
    logs = np.array(logs) - 0.5 * steps**2 - 0.5 * np.log(2.0 * np.pi)
    exact = logsumexp(logs) + np.log(steps[1] - steps[0])
    assert ours == pytest.approx(exact, abs=0.15)
