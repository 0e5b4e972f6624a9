"""The noise of single readings, estimated from what an explanation leaves of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.base import Base
from vmach.fit.marginal_likelihood import best_sizes
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.noise.heavy_tails import ROUNDING, WORTH, weights_of
from vmach.fit.noise.own_scale import own_scale_of

__all__ = ["beside_own_noise", "noise_after", "noise_before", "score_with_tails"]

#: logarithm by which a weight has to differ to count as another
_OTHER = 0.3
_CORRELATIONS = (0.3, 0.98)
#: standard deviations from which a reading may be an odd one; below, little is gained by that
_ODD = 3.0


def noise_before(weighing: Weighing) -> FeatureNoise:
    """The noise before any effect is looked for: readings apart from all neighbours weigh less.

    A sudden effect could take up one of them.
    """
    weight, log_prior, degrees = _weights(weighing, weighing.nothing(), weighing.base.noise)
    return replace(weighing.base.noise, weight=weight, log_prior=log_prior, degrees=degrees)


def noise_after(weighing: Weighing, explanation: Explanation) -> FeatureNoise | None:
    """The noise that the rest of an explanation shows; None where it is the one assumed.

    Readings that are what was predicted, as a table of nominal values is, show no noise.
    """
    noise = weighing.base.noise
    if np.median(np.abs(noise.standardised(explanation.posterior.left))) < ROUNDING:
        return None
    scaled, gain = _with_own_scales(weighing, explanation)
    tailed, _ = _with_tails(weighing, explanation, scaled, gain)
    correlated = _correlated(weighing, explanation, tailed)
    return None if correlated is noise else correlated


def beside_own_noise(weighing: Weighing, found: Explanation) -> tuple[Weighing, Explanation]:
    """The weighing with the noise that an explanation leaves, and the explanation there.

    Or that without one of its effects, where that is more probable beside the noise that it leaves
    itself: an effect may stand for a few odd readings. As given where the noise is as assumed.
    """
    found = _without_odd(weighing, found)
    noise = noise_after(weighing, found)
    if noise is None:
        return weighing, found
    weighing = weighing.with_noise(noise)
    return weighing, weighing.explain(found.terms, found.posterior.sizes)


def _without_odd(weighing: Weighing, found: Explanation) -> Explanation:
    """An explanation without the effect that odd readings alone speak for; as given if none is."""
    best, most = found, score_with_tails(weighing, found, -np.inf)
    for k in range(len(found.terms)):
        fewer = weighing.without(found, [k])
        if (score := score_with_tails(weighing, fewer, most)) > most:
            best, most = fewer, score
    return best


def score_with_tails(weighing: Weighing, explanation: Explanation, least: float) -> float:
    """Score beside the tails that an explanation leaves; roughly where it is below the least."""
    score, away = explanation.score, np.abs(weighing.deletion_residuals(explanation))
    # what is set aside brings no more than it costs now, unless others are set aside already
    most = 0.5 * float(np.sum(away[away > _ODD] ** 2)) if weighing.base.noise.is_plain else np.inf
    if np.median(away) < ROUNDING or score + most < least:
        return score
    return score + _with_tails(weighing, explanation, weighing.base.noise)[1]


def _with_own_scales(weighing: Weighing, explanation: Explanation) -> tuple[FeatureNoise, float]:
    """The noise with the scale of each test, and the log probability that it brings.

    As assumed where scales are the same, or the readings are no more probable with others.
    """
    noise, rows = weighing.base.noise, weighing.survey.rows
    left = weighing.deletion_residuals(explanation) * noise.own_scale.of_readings
    own = own_scale_of(explanation.posterior.sizes.factor * left, rows)
    if np.abs(np.log(own.of_readings / noise.own_scale.of_readings)).max() <= _OTHER:
        return noise, 0.0
    scaled = replace(noise, own_scale=own)
    gain = _log_probability(weighing, explanation, scaled) - explanation.posterior.log_probability
    return (scaled, gain) if gain > WORTH * (len(rows) - 1) else (noise, 0.0)


def _with_tails(
    weighing: Weighing, explanation: Explanation, noise: FeatureNoise, gain: float = 0.0
) -> tuple[FeatureNoise, float]:
    """A noise with the tails that an explanation leaves, and the log probability that both bring.

    As given where they are the same, or the readings are no more probable with them.
    """
    weight, log_prior, degrees = _weights(weighing, explanation, noise)
    if np.abs(np.log(weight / noise.weight)).max() <= _OTHER:
        return noise, gain
    tailed = replace(noise, weight=weight, log_prior=log_prior, degrees=degrees)
    with_tails = _log_probability(weighing, explanation, tailed)
    with_tails -= explanation.posterior.log_probability
    return (tailed, with_tails) if with_tails > gain else (noise, gain)


def _log_probability(weighing: Weighing, explanation: Explanation, noise: FeatureNoise) -> float:
    """Of the readings beside another noise, with the effects of an explanation as they are."""
    base = Base(weighing.survey, noise, weighing.members)
    effects = explanation.posterior.effects.on(base)
    return best_sizes(base, explanation.posterior.sizes, effects).log_probability


def _weights(
    weighing: Weighing, explanation: Explanation, noise: FeatureNoise
) -> tuple[np.ndarray, float, float]:
    """Weight of every reading beside the tails that an explanation leaves, and what it costs."""
    left = weighing.deletion_residuals(explanation) / _scaled(weighing, noise)
    return weights_of(left, weighing.survey.group)


def _scaled(weighing: Weighing, noise: FeatureNoise) -> np.ndarray:
    """Scales of another noise, in those of the one assumed."""
    return noise.own_scale.of_readings / weighing.base.noise.own_scale.of_readings


def _correlated(weighing: Weighing, explanation: Explanation, noise: FeatureNoise) -> FeatureNoise:
    """The noise with the correlation along features that makes the readings most probable."""
    left = weighing.base.noise.standardised(explanation.posterior.left)
    left = left / _scaled(weighing, noise)
    pairs = [noise.autocorrelation(left, lag) for lag in (1, 2)]
    if noise.share == 0.0 and pairs[0] * np.sqrt(len(left)) < 3.0:
        return noise
    low, high = _CORRELATIONS
    correlation = noise.correlation or float(np.clip(pairs[1] / max(pairs[0], 1e-3), 0.5, high))
    share = noise.share or float(np.clip(pairs[0] / correlation, 0.1, 0.95))

    def log_probability(trial: FeatureNoise) -> float:
        return _log_probability(weighing, explanation, trial)

    start = replace(noise, share=share, correlation=correlation)
    plain = log_probability(replace(noise, share=0.0))
    best, found = log_probability(start), start
    for step in (0.6, 0.3):
        for way in ((step, 0), (-step, 0), (0, step), (0, -step)):
            trial = replace(
                found,
                share=_moved(found.share, way[0], 0.02, 0.98),
                correlation=_moved(found.correlation, way[1], low, high),
            )
            if (here := log_probability(trial)) > best + 0.1:
                best, found = here, trial
    if best < plain + WORTH:
        return noise if noise.share == 0.0 else replace(noise, share=0.0)
    moved = max(abs(found.share - noise.share), abs(found.correlation - noise.correlation))
    return noise if noise.share > 0.0 and moved < 0.1 else found


def _moved(share: float, step: float, low: float, high: float) -> float:
    odds = np.log(share / (1.0 - share)) + 2.0 * step
    return float(np.clip(1.0 / (1.0 + np.exp(-odds)), low, high))
