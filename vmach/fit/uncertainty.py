"""Standard uncertainty of an effect's parameters, where the readings bend the law's curves.

Close to the best fit an inner parameter (a time constant, a width) is not always described by a
tangent: the readings may allow it a long way up but not down. So its probability is worked out on
a grid of values, with amplitudes and the other effects eliminated at each: a profile. How wide the
amplitudes are at a node adds to their uncertainty and not to the node's weight, else laws that the
readings hardly see would gain by their freedom. The uncertainty is the root of the mean square
distance from the value that is stated.

The sizes of what stands beside the effects are no better known: what a term is beside others is
averaged over (`vmach/fit/other_sizes.py`).

Source: JCGM 101:2008, intervals from a distribution; closed form derived here: normal amplitudes
at every node of the grid.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy  # its parts are loaded when they are first used
from scipy.special import ndtr, ndtri

from vmach.fit.columns import Columns
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.terms import FREE, JointFit, Term

__all__ = ["Otherwise", "Spread", "parameter_uncertainty"]

#: nodes on each side of the best value, in standard deviations, by number of inner parameters
_NODES = {
    1: np.linspace(-4.0, 4.0, 17),
    2: np.linspace(-3.5, 3.5, 11),
    3: np.linspace(-3.0, 3.0, 7),
}
#: passes at most; each sets its grid by the spread that the one before found
_PASSES = 4
#: a grid is right when it finds the spread that it was made for, up to this factor
_RIGHT = 1.3
#: share of its width that the next grid has at least
_NARROWEST = 0.2
#: readings at all nodes that are worked out together
_AT_ONCE = 1_000_000
#: step of coefficients in a derivative
_STEP = 1e-4
#: share of what was open before; a parameter that stays that open is not shown by the readings
_HARDLY = 0.8


@dataclass(frozen=True)
class Spread:
    """What the readings leave open of one parameter.

    Attributes
    ----------
    u : float
        Root of the mean square distance from the stated value; of other effects that are possible,
        as far as the interval reaches.
    low, high : float
        Ends of the interval that holds 95 %.
    is_shown : bool
        False where the readings say hardly more than was known before.
    """

    u: float
    low: float
    high: float
    is_shown: bool = True


@dataclass(frozen=True)
class Otherwise:
    """What a term is where other effects act beside it than in the fit.

    Attributes
    ----------
    weight : float
        How probable they are, relative to those of the fit.
    moved : (K + I,) float64
        Change of its coefficients and the logarithms of its free inner parameters.
    more : (K + I, K + I) float64
        Change of their covariance.
    """

    weight: float
    moved: np.ndarray
    more: np.ndarray


def parameter_uncertainty(
    fit: JointFit, k: int, others: Sequence[Otherwise] = (), sizes: Sequence[Otherwise] = ()
) -> dict[str, Spread]:
    """Uncertainty of every parameter of term k.

    Parameters
    ----------
    fit : JointFit
    k : int
    others : sequence of Otherwise
        What term k is beside other effects that are possible.
    sizes : sequence of Otherwise
        What it is beside members of other sizes, all that are possible.
    """
    over_sizes = _averaged(_beside_its_own(fit, k), fit, k, sizes, own=0.0)
    return _averaged(over_sizes, fit, k, others, own=1.0)


def _averaged(
    spreads: dict[str, Spread], fit: JointFit, k: int, others: Sequence[Otherwise], *, own: float
) -> dict[str, Spread]:
    """Spreads over what a fit is itself, with a weight of its own, and otherwise.

    Each is a normal distribution. Neither interval nor uncertainty becomes narrower. The latter is
    no larger than the farther end of the interval says: else it would be that of an improbable
    set far away.
    """
    if not others:
        return spreads
    slope, wide = fit.slope(k), float(ndtri(0.975))
    weight = np.array([own, *(other.weight for other in others)])
    weight /= weight.sum()
    moved = np.array([np.zeros(len(slope)), *(other.moved for other in others)]) @ slope
    more = np.stack([np.zeros((len(slope),) * 2), *(other.more for other in others)])
    more_squared = np.einsum("ij,gik,kj->gj", slope, more, slope, optimize=True)
    found, accepted = {}, {p.name: (p.low, p.high) for p in fit.terms[k].effect.parameters}
    for j, (name, value) in enumerate(fit.parameters(k).items()):
        here = spreads[name]
        middle, sigma = 0.5 * (here.low + here.high) - value, 0.5 * (here.high - here.low) / wide
        away = middle + moved[:, j]
        spread = np.sqrt(np.maximum(sigma**2 + more_squared[:, j], 0.0))
        low, high = _quantiles(weight, away, spread)
        low, high = np.clip([value + low, value + high], *accepted[name]).tolist()
        # of its own set it is known better than as a normal distribution
        low, high = min(low, here.low), max(high, here.high)
        u = float(np.sqrt(weight[0] * here.u**2 + weight[1:] @ (away**2 + spread**2)[1:]))
        u = max(here.u, min(u, max(high - value, value - low) / wide))
        found[name] = replace(here, u=u, low=low, high=high)
    return found


def _beside_its_own(fit: JointFit, k: int) -> dict[str, Spread]:
    """Uncertainty of every parameter of term k beside the effects of the fit."""
    term, survey = fit.terms[k], fit.posterior.base.survey
    places, log_prior = survey.places(term.effect, term.target, term.inner)
    if places:
        return _spreads(fit, k, _OneTerm.of(fit, k).at_places(places, log_prior))
    if len(term.free_parameters) not in _NODES:
        return _straight(fit, k)
    amplitudes, spread = len(fit.coefficients[k]), term.spread_of_inner
    guess = np.minimum(fit.covariance[k][amplitudes:, amplitudes:], np.outer(spread, spread))
    distribution, deviation = _OneTerm.of(fit, k).on_its_own_grid(guess)
    found = _spreads(fit, k, distribution)
    for name, share in zip(term.free_inner, deviation / spread, strict=True):
        found[name] = replace(found[name], is_shown=bool(share < _HARDLY))
    return found


def _straight(fit: JointFit, k: int) -> dict[str, Spread]:
    """Along tangents, as for parameters that enter in proportion."""
    stated, u = fit.parameters(k), fit.uncertainty(k)
    wide, prior = float(ndtri(0.975)), _prior_u(fit.terms[k])
    return {
        n: Spread(u[n], v - wide * u[n], v + wide * u[n], u[n] < _HARDLY * prior[n])
        for n, v in stated.items()
    }


def _prior_u(term: Term) -> dict[str, float]:
    """What is known of each parameter before; infinite for those that are no amplitudes."""
    return {p.name: FREE * p.usual if p.is_linear else np.inf for p in term.effect.parameters}


def _grid(centre: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Nodes (G, D) along the principal axes of a covariance."""
    squared, axes = np.linalg.eigh(covariance)
    steps = np.meshgrid(*[_NODES[len(centre)]] * len(centre), indexing="ij")
    unit = np.stack([s.ravel() for s in steps], axis=1)
    return centre + unit @ (axes * np.sqrt(np.maximum(squared, 1e-12))).T


@dataclass(frozen=True)
class _Distribution:
    """Probability of one term's parameters: a normal distribution at each of G places.

    Attributes
    ----------
    inner : sequence of dict
        The inner parameters at each place.
    weight : (G,) float64
        Its probability; they add up to one.
    mean : (G, K) float64
        Of the coefficients there.
    covariance : (G, K, K) float64
    """

    inner: Sequence[Mapping[str, float]]
    weight: np.ndarray
    mean: np.ndarray
    covariance: np.ndarray

    def __iter__(self) -> Iterator[tuple[Mapping[str, float], np.ndarray, np.ndarray]]:
        """Inner parameters, mean and covariance of the coefficients of every place."""
        return zip(self.inner, self.mean, self.covariance, strict=True)


@dataclass(frozen=True)
class _OneTerm:
    """Probability of the D inner parameters of one term, as steps of their logarithms.

    Attributes
    ----------
    term : Term
    beside : Posterior
        Of what counts as noise, the other terms with it, their inner parameters along tangents.
    """

    term: Term
    beside: Posterior

    @classmethod
    def of(cls, fit: JointFit, k: int) -> _OneTerm:
        """Of term k, the other terms eliminated."""
        parts = [fit.posterior.effects.columns]
        for i, term in enumerate(fit.terms):
            if i != k:
                parts.append(fit.signatures[i].scaled(term.prior_width))
                parts.append(fit.tangents[i].scaled(term.spread_of_inner))
        return cls(fit.terms[k], replace(fit.posterior, effects=Effects(Columns.joined(parts))))

    def on_its_own_grid(self, covariance: np.ndarray) -> tuple[_Distribution, np.ndarray]:
        """The distribution on a grid that is as wide as itself, and its deviations (D,).

        Parameters
        ----------
        covariance : (D, D) float64
            Of the logarithms, as a first guess.
        """
        centre = np.zeros(len(covariance))
        for _ in range(_PASSES):
            nodes = self.within(_grid(centre, covariance))
            inner = [self.term.inner_at(step) for step in nodes]
            found = self.at(inner, self.log_prior(nodes))
            before = np.sqrt(np.diag(covariance))
            centre = found.weight @ nodes
            apart = nodes - centre
            covariance = (found.weight[:, None] * apart).T @ apart
            after = np.sqrt(np.diag(covariance))
            if np.all(np.abs(np.log(np.maximum(after, 1e-9) / before)) < np.log(_RIGHT)):
                break
            # where one node of a coarse grid has all the weight, no width is left
            covariance += np.diag((_NARROWEST * before) ** 2)
        return found, after

    def within(self, nodes: np.ndarray) -> np.ndarray:
        """The nodes (G, D) inside the parameters' bounds; the best fit alone where none is."""
        low, high = np.log([(p.low, p.high) for p in self.term.free_parameters]).T
        here = self._here
        inside = ((here + nodes >= low) & (here + nodes <= high)).all(axis=1)
        return nodes[inside] if inside.any() else np.zeros((1, nodes.shape[1]))

    def log_prior(self, nodes: np.ndarray) -> np.ndarray:
        """Logarithm of how usual each node is, (G,)."""
        usual = np.log([p.usual for p in self.term.free_parameters])
        off = (self._here + nodes - usual) / self.term.spread_of_inner
        return -0.5 * (off**2).sum(axis=1)

    @property
    def _here(self) -> np.ndarray:
        """Logarithms of the best fit, (D,)."""
        return np.log([self.term.inner[name] for name in self.term.free_inner])

    def at(self, inner: Sequence[Mapping[str, float]], log_prior: np.ndarray) -> _Distribution:
        """The distribution over G nodes whose log prior is (G,)."""
        effect, target, base = self.term.effect, self.term.target, self.beside.base
        many = max(_AT_ONCE // len(base.y), 1)
        found = []
        for k in range(0, len(inner), many):
            asked = [(effect, target, values) for values in inner[k : k + many]]
            found += [self.beside.products(own) for own in base.signatures(asked)]
        precision, seen = map(np.stack, zip(*found, strict=True))
        return _weighed(inner, precision, seen, log_prior)

    def at_places(
        self, inner: Sequence[Mapping[str, float]], log_prior: np.ndarray
    ) -> _Distribution:
        """The same where neighbours are much alike, as moments of a sudden effect are."""
        effect, target, base = self.term.effect, self.term.target, self.beside.base
        precision, seen = self.beside.products_at(base.places(effect, target, inner))
        return _weighed(inner, precision, seen, log_prior)


def _weighed(
    inner: Sequence[Mapping[str, float]],
    precision: np.ndarray,
    seen: np.ndarray,
    log_prior: np.ndarray,
) -> _Distribution:
    """The distribution from products at every node, (G, K, K) and (G, K)."""
    covariance = np.linalg.inv(precision + np.eye(precision.shape[1]) / FREE**2)
    mean = np.einsum("gkl,gl->gk", covariance, seen)
    log = log_prior + 0.5 * np.einsum("gk,gk->g", seen, mean)
    weight = np.exp(log - log.max())
    return _Distribution(inner, weight / weight.sum(), mean, covariance)


def _spreads(fit: JointFit, k: int, distribution: _Distribution) -> dict[str, Spread]:
    """Spread of every parameter: at each node a normal distribution, its weight the node's."""
    term, stated = fit.terms[k], fit.parameters(k)
    weight = distribution.weight
    away = np.empty((len(weight), len(stated)))
    local = np.empty_like(away)
    for g, (inner, mean, covariance) in enumerate(distribution):
        here = term.effect.settle(mean, inner)
        away[g] = [term.apart(name, here[name], stated[name]) for name in stated]

        def settled(c: np.ndarray, inner: Mapping[str, float] = inner) -> dict[str, float]:
            return term.effect.settle(c, inner)

        slope = _slopes(term, settled, mean)
        local[g] = np.einsum("kj,kl,lj->j", slope, covariance, slope)
    found, prior = {}, _prior_u(term)
    for j, (name, value) in enumerate(stated.items()):
        u = float(np.sqrt(weight @ (away[:, j] ** 2 + local[:, j])))
        low, high = _quantiles(weight, away[:, j], np.sqrt(local[:, j]))
        # a value that lies at its bound lies at the interval's end
        low, high = value + min(low, 0.0), value + max(high, 0.0)
        found[name] = Spread(u, low, high, u < _HARDLY * prior[name])
    return found


def _quantiles(weight: np.ndarray, mean: np.ndarray, sigma: np.ndarray) -> tuple[float, float]:
    """Ends of the middle 95 % of a mixture of normal distributions."""
    sigma = np.maximum(sigma, 1e-12 + 1e-6 * np.ptp(mean))
    low, high = np.min(mean - 6.0 * sigma), np.max(mean + 6.0 * sigma)

    def excess(x: float, share: float) -> float:
        return float(weight @ ndtr((x - mean) / sigma)) - share

    return tuple(
        scipy.optimize.brentq(excess, low, high, args=(share,)) for share in (0.025, 0.975)
    )


def _slopes(
    term: Term, settle: Callable[[np.ndarray], dict[str, float]], mean: np.ndarray
) -> np.ndarray:
    """Derivative of every parameter by every coefficient, (K, parameters)."""
    centre, rows = settle(mean), []
    for unit in np.eye(len(mean)):
        near = settle(mean + _STEP * unit)
        rows.append([term.apart(name, near[name], centre[name]) / _STEP for name in centre])
    return np.array(rows)
