"""What terms of a fit are beside members of other sizes than the most probable ones.

The readings tell a size roughly: a drift that is most probably absent may be there. Each size has
a distribution, worked out on a grid with the others where they are. What they do to the terms adds
up, as the causes are independent: means move by sums, and covariances grow by sums.

Source: H. Rue, S. Martino and N. Chopin, J. R. Statist. Soc. B 71 (2009) 319, sizes integrated on a
grid; the sum over independent sizes is derived here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.fit.base import Base
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.open_members import open_members
from vmach.fit.sizes import ABSENT, Sizes
from vmach.fit.terms import JointFit
from vmach.fit.uncertainty import Otherwise

__all__ = ["beside_other_sizes"]

#: sizes in median u at which a member is looked at, besides where it is; far beyond the usual one
_GRID = (0.0, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.4, 2.0, 3.0, 4.5)
#: log probability below the best from which on a size counts for nothing
_IMPROBABLE = 12.0
#: draws of all sizes together; ends of an interval are then right within a fiftieth of its width
_DRAWS = 128
#: square roots of primes: multiples of them fill the unit cube evenly (Kronecker's sequence)
_FIRST_PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71)


@dataclass(frozen=True)
class _Size:
    """The distribution of one member's size over G nodes, and what it does to E coefficients.

    Attributes
    ----------
    weight : (G,) float64
        They add up to one.
    moved : (G, E) float64
        Change of the mean.
    more : (G, E, E) float64
        Change of the covariance.
    """

    weight: np.ndarray
    moved: np.ndarray
    more: np.ndarray


def beside_other_sizes(fit: JointFit) -> Sequence[Sequence[Otherwise]]:
    """Of each term what it is beside members of sizes that are possible, evenly drawn.

    Parameters
    ----------
    fit : JointFit
    """
    open_fit = _OpenFit.of(fit)
    wide = open_fit.wide
    here = _mean_and_covariance(open_fit.best, len(wide))
    sizes = list(open_fit.sizes())
    picked = [
        np.searchsorted(np.cumsum(size.weight)[:-1], share)
        for size, share in zip(sizes, _evenly(len(sizes)), strict=True)
    ]
    searched = Posterior(fit.posterior.base, fit.posterior.sizes, open_fit.own)
    found = _mean_and_covariance(searched, len(wide))
    start = [open_here - own for open_here, own in zip(here, found, strict=True)]
    moved, more = np.tile(start[0], (_DRAWS, 1)), np.tile(start[1], (_DRAWS, 1, 1))
    for size, node in zip(sizes, picked, strict=True):
        moved += size.moved[node]
        more += size.more[node]
    moved, more = moved * wide, more * np.outer(wide, wide)
    draws = list(zip(moved, more, strict=True))
    return [
        [
            Otherwise(1.0 / _DRAWS, mean[at], covariance[np.ix_(at, at)])
            for mean, covariance in draws
        ]
        for at in fit.places
    ]


@dataclass(frozen=True)
class _OpenFit:
    """A fit beside members that hold what is like its effects.

    Attributes
    ----------
    best : Posterior
        Beside members of the most probable sizes; what is like the effects is absent.
    own : Effects
        Coefficients, inner logarithms and slack over the base of the fit.
    wide : (E,) float64
        Prior deviations of coefficients and inner logarithms.
    """

    best: Posterior
    own: Effects
    wide: np.ndarray

    @classmethod
    def of(cls, fit: JointFit) -> _OpenFit:
        searched, terms = fit.posterior, fit.terms
        counts = [len(coefficients) for coefficients in fit.coefficients]
        amplitudes = np.repeat([term.prior_width for term in terms], counts)
        wide = np.concatenate([amplitudes, *(term.spread_of_inner for term in terms)])
        own = Effects(fit.open.scaled(wide).beside(searched.effects.columns))
        members = open_members(searched.base.survey, searched.base.members)
        base = Base(searched.base.survey, searched.base.noise, members)
        known = dict(zip(searched.base.members.names, searched.sizes.members, strict=True))
        sizes = Sizes(searched.sizes.factor, tuple(known.get(n, 0.0) for n in members.names))
        return cls(Posterior(base, sizes, own.on(base)), own, wide)

    def sizes(self) -> Iterator[_Size]:
        """The distribution of each member's size, the others as they are."""
        count = len(self.wide)
        here = _mean_and_covariance(self.best, count)
        for k, own in enumerate(self.best.sizes.members):
            nodes = np.unique([*_GRID, own])
            trials = [self._with_size(k, size) for size in nodes.tolist()]
            log = np.array([trial.log_probability for trial in trials])
            weight = np.exp(log - log.max()) * _stretches(nodes)
            near = np.flatnonzero(log > log.max() - _IMPROBABLE)
            found = [_mean_and_covariance(trials[i], count) for i in near]
            means, covariances = map(np.stack, zip(*found, strict=True))
            weight = weight[near] / weight[near].sum()
            yield _Size(weight, means - here[0], covariances - here[1])

    def _with_size(self, k: int, size: float) -> Posterior:
        members = list(self.best.sizes.members)
        members[k] = max(size, ABSENT)
        sizes = Sizes(self.best.sizes.factor, tuple(members))
        return Posterior(self.best.base, sizes, self.best.effects)


def _mean_and_covariance(posterior: Posterior, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Of the first E coefficients, in prior deviations, (E,) and (E, E)."""
    inverse = np.linalg.inv(posterior.bordered.own)[:, :count]
    return posterior.mean[1][:count], inverse.T @ inverse


def _stretches(nodes: np.ndarray) -> np.ndarray:
    """How much of an axis each of several nodes on it stands for, (G,)."""
    apart = np.diff(nodes)
    return 0.5 * (np.append(apart, 0.0) + np.append(0.0, apart))


def _evenly(count: int) -> np.ndarray:
    """Numbers between 0 and 1 that fill the cube of some dimensions evenly, (count, draws)."""
    steps = np.sqrt(np.array(_FIRST_PRIMES[:count], dtype=float))
    return (np.outer(steps, np.arange(_DRAWS) + 0.5)) % 1.0
