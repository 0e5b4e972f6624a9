"""Standard uncertainty of an effect's parameters, where the readings bend the law's curves.

Close to the best fit an inner parameter (a time constant, a width) is not always described by a
tangent: the readings may allow it a long way up but not down. So its probability is worked out on
a grid of values, amplitudes and the other effects eliminated at each, and the uncertainty is the
root of the mean square distance from the value that is stated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vmach.fit.joint_fit import JointFit, Term
from vmach.fit.survey import Survey
from vmach.fit.whitening import Whitening

__all__ = ["parameter_uncertainty"]

#: prior standard deviation of amplitudes, in usual sizes
_AMPLITUDE = 10.0
#: nodes on each side of the best value, in standard deviations, by number of inner parameters
_NODES = {1: np.linspace(-4.0, 4.0, 17), 2: np.linspace(-3.5, 3.5, 11)}
#: passes at most; each sets its grid by the spread that the one before found
_PASSES = 4
#: a grid is right when it finds the spread that it was made for, up to this factor
_RIGHT = 1.3
_STEP = 1e-4


def parameter_uncertainty(survey: Survey, fit: JointFit, k: int) -> dict[str, float]:
    """Standard uncertainties of the parameters of term k.

    Parameters
    ----------
    survey : Survey
    fit : JointFit
    k : int
    """
    dimensions = len(fit.terms[k].free_inner)
    if dimensions not in _NODES:
        return fit.uncertainty(k)
    posterior = _Posterior.of(survey, fit, k)
    spread = posterior.prior_spread
    amplitudes = len(fit.coefficients[k])
    covariance = fit.covariance[k][amplitudes:, amplitudes:]
    centre, covariance = np.zeros(dimensions), np.minimum(covariance, np.outer(spread, spread))
    for _ in range(_PASSES):
        nodes = posterior.within(_grid(centre, covariance))
        weight, amount, amount_covariance = posterior.at(nodes)
        before = np.sqrt(np.diag(covariance))
        centre = weight @ nodes
        apart = nodes - centre
        covariance = (weight[:, None] * apart).T @ apart
        after = np.sqrt(np.diag(covariance))
        if np.all(np.abs(np.log(np.maximum(after, 1e-9) / before)) < np.log(_RIGHT)):
            break
        covariance += np.diag((0.2 * before) ** 2)
    inner = [posterior.inner_at(step) for step in nodes]
    return _distance(fit, k, inner, (weight, amount, amount_covariance))


def _grid(centre: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Nodes (G, D) along the principal axes of a covariance."""
    squared, axes = np.linalg.eigh(covariance)
    steps = np.meshgrid(*[_NODES[len(centre)]] * len(centre), indexing="ij")
    unit = np.stack([s.ravel() for s in steps], axis=1)
    return centre + unit @ (axes * np.sqrt(np.maximum(squared, 1e-12))).T


@dataclass(frozen=True)
class _Posterior:
    """Probability of the inner parameters of one term, as steps of their logarithms."""

    survey: Survey
    term: Term
    whiten: Callable[[np.ndarray], np.ndarray]
    reading: np.ndarray

    @classmethod
    def of(cls, survey: Survey, fit: JointFit, k: int) -> _Posterior:
        """With the other terms of a fit eliminated, their inner parameters along tangents."""
        empty = np.zeros((len(survey), 0))
        free, random = [empty], [empty]
        for i, term in enumerate(fit.terms):
            if i == k:
                continue
            if term.width is None:
                free += [fit.signatures_mm[i], fit.tangents_mm[i]]
            else:
                random.append(term.width * fit.signatures_mm[i])
        random, free = fit.whiten(np.hstack(random)), fit.whiten(np.hstack(free))
        others = Whitening(np.ones(len(survey)), random, free)

        def absorb(columns: np.ndarray) -> np.ndarray:
            return others(fit.whiten(columns))

        return cls(survey, fit.terms[k], absorb, absorb(survey.residual_mm))

    @property
    def _free(self) -> list:
        return [p for p in self.term.effect.inner_parameters if p.low > 0]

    @property
    def prior_spread(self) -> np.ndarray:
        """Prior standard deviation of each logarithm, (D,)."""
        return np.array([p.spread for p in self._free])

    def within(self, nodes: np.ndarray) -> np.ndarray:
        """The nodes inside the parameters' bounds; the best fit itself among them."""
        here = np.log([self.term.inner[p.name] for p in self._free])
        low, high = np.log([(p.low, p.high) for p in self._free]).T
        inside = ((here + nodes >= low) & (here + nodes <= high)).all(axis=1)
        return nodes[inside] if inside.any() else np.zeros((1, nodes.shape[1]))

    def inner_at(self, step: np.ndarray) -> dict[str, float]:
        """Inner parameters at a node (D,)."""
        moved = {
            p.name: self.term.inner[p.name] * float(np.exp(s))
            for p, s in zip(self._free, step, strict=True)
        }
        return {**self.term.inner, **moved}

    def at(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Probability (G,), mean (G, K) and covariance (G, K, K) of the amplitudes at nodes."""
        effect, target = self.term.effect, self.term.target
        raw = [self.survey.signature(effect, target, self.inner_at(step)) for step in nodes]
        white = self.whiten(np.stack(raw, axis=1))
        rows = white.transpose(1, 2, 0)
        precision = rows @ rows.transpose(0, 2, 1)
        precision = precision + np.eye(precision.shape[1]) / _AMPLITUDE**2
        covariance = np.linalg.inv(precision)
        seen = rows @ self.reading
        mean = np.einsum("gkl,gl->gk", covariance, seen)
        usual = np.log([p.usual for p in self._free])
        here = np.log([self.term.inner[p.name] for p in self._free])
        log = 0.5 * np.einsum("gk,gk->g", seen, mean)
        log = log - 0.5 * (((here + nodes - usual) / self.prior_spread) ** 2).sum(axis=1)
        weight = np.exp(log - log.max())
        return weight / weight.sum(), mean, covariance


def _distance(fit: JointFit, k: int, inner_at: list[dict[str, float]], distribution) -> dict:
    """Root of the mean square distance of each parameter from its stated value."""
    term, stated = fit.terms[k], fit.parameters(k)
    cycle = {p.name: p.cycle for p in term.effect.parameters}
    total = dict.fromkeys(stated, 0.0)
    for inner, weight, mean, covariance in zip(inner_at, *distribution, strict=True):
        here = term.effect.settle(mean, inner)
        slope = _slopes(lambda c, i=inner: term.effect.settle(c, i), mean)
        for row, name in zip(slope.T, here, strict=True):
            away = here[name] - stated[name]
            if np.isfinite(cycle[name]):
                away -= cycle[name] * round(away / cycle[name])
            total[name] += weight * (away**2 + row @ covariance @ row)
    return {name: float(np.sqrt(value)) for name, value in total.items()}


def _slopes(settle: Callable[[np.ndarray], dict[str, float]], mean: np.ndarray) -> np.ndarray:
    """Derivative of every parameter by every coefficient, (K, parameters)."""
    centre = np.array(list(settle(mean).values()))
    near = [list(settle(mean + _STEP * unit).values()) for unit in np.eye(len(mean))]
    return (np.array(near) - centre) / _STEP
