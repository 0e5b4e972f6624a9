"""Probability of all readings with what is unknown integrated out, and sizes that make it largest.

Readings y in units of their feature noise, nuisance projected out (its prior is flat), are

    y = Z D^(1/2) f + X c + k e

with unit-variance f of members whose sizes D are known (tables, device) or unknown (discrepancy),
effects X c, and a factor k on the stated uncertainty. Everything but k and the sizes is integrated
in closed form; only inner products enter, so a trial of other sizes costs no pass over readings.

Source: C. Rasmussen and C. Williams, Gaussian Processes for Machine Learning (2006), eq. 5.8, the
marginal likelihood; closed form derived here: f and c integrated as normal variables, and the
information, 1/2 tr(C^-1 dC C^-1 dC), from the covariance of both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError, cho_solve
from scipy.linalg.lapack import dpotrf, dpotri

from vmach.fit.discrepancy import Members
from vmach.fit.feature_noise import FeatureNoise
from vmach.fit.survey import Survey

__all__ = ["Base", "Posterior", "Sizes"]

#: prior of the logarithm of the factor on u: stated uncertainties are right within a factor of 2
_LOG_FACTOR = float(np.log(2.0))
#: prior of a member's size, in u: falls off as the fifth power beyond this. What nobody models is
#: of the order of u; a lighter tail would leave it what slow effects do to a few floors. Imitations
#: of something larger are told by their size and by forms, not by this
_USUAL_SIZE, _POWER = 0.6, 2.5
#: a member of this size, in u, counts as absent; up to the second one its columns are left out
_ABSENT, _GONE = 0.02, 0.025
#: steps at most towards the best sizes, none longer than this; multiples of a step that are tried
_STEPS, _STRIDE, _TIMID, _BOLD = 20, 1.5, 0.05, 4.0
#: log probability that a further step has to promise
_GAIN = 0.01


@dataclass(frozen=True)
class Sizes:
    """Factor on u, and the size of each member of unknown size, in median u."""

    factor: float
    members: tuple[float, ...]

    @property
    def logarithms(self) -> np.ndarray:
        """Of the factor and of each member, (q,); a member that is absent has a finite one."""
        return np.log(np.maximum([self.factor, *self.members], 1.01 * _ABSENT))

    @classmethod
    def at(cls, logarithms: np.ndarray) -> Sizes:
        """Sizes of given logarithms, (q,)."""
        factor, *members = np.exp(logarithms).tolist()
        return cls(factor, tuple(members))

    @property
    def log_prior(self) -> float:
        """Logarithm of how likely they are beforehand, up to a constant."""
        usual = -0.5 * (np.log(self.factor) / _LOG_FACTOR) ** 2
        return float(usual - _POWER * np.log1p((np.array(self.members) / _USUAL_SIZE) ** 2).sum())

    @property
    def slope_of_prior(self) -> np.ndarray:
        """Derivative of `log_prior` by the logarithms, (q,)."""
        ratio = (np.array(self.members) / _USUAL_SIZE) ** 2
        return np.array(
            [-np.log(self.factor) / _LOG_FACTOR**2, *(-2 * _POWER * ratio / (1 + ratio))]
        )

    @property
    def information_of_prior(self) -> np.ndarray:
        """Second derivative of minus `log_prior` by the logarithms, (q,)."""
        ratio = (np.array(self.members) / _USUAL_SIZE) ** 2
        return np.array([1.0 / _LOG_FACTOR**2, *(4 * _POWER * ratio / (1 + ratio) ** 2)])


class Base:
    """Readings of a survey in the units of one feature noise, nuisance projected out.

    Attributes
    ----------
    y : (n,) float64
    z : (n, q) float64
        Members' columns.
    gram : (q, q) float64
        Products of these with each other.
    """

    def __init__(self, survey: Survey, noise: FeatureNoise, members: Members) -> None:
        self.survey, self.noise, self.members = survey, noise, members
        nuisance = noise.white(survey.nuisance)
        norms = np.linalg.norm(nuisance, axis=0)
        left, size, _ = np.linalg.svd(nuisance / np.where(norms > 0, norms, 1.0), False)
        seen = size > 1e-9 * max(size.max(initial=0.0), 1e-300)
        self._free = left[:, seen]
        self._constant = -0.5 * noise.log_determinant - float(np.log(size[seen]).sum())
        self._constant -= float(np.log(norms[norms > 0]).sum())
        self.y = self.white(survey.residual_mm[:, None])[:, 0]
        self.z = self.white(np.hstack([members.fixed_mm, *members.columns_mm]))
        counts = [members.fixed_mm.shape[1], *(c.shape[1] for c in members.columns_mm)]
        self.member_of = np.repeat(np.arange(len(counts)), counts)
        self.degrees = len(survey) - self._free.shape[1]
        self.gram, self._seen = self.z.T @ self.z, self.z.T @ self.y
        self._square = float(self.y @ self.y)

    def white(self, columns_mm: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise without what the nuisance can explain."""
        white = self.noise.white(columns_mm)
        return white - self._free @ (self._free.T @ white)

    def back(self, white: np.ndarray) -> np.ndarray:
        """Columns (n, k) whose product with raw ones is that of white ones with white ones."""
        return self.noise.back(white)

    def posterior(self, sizes: Sizes, effects: Effects) -> Posterior:
        """What the readings say with given sizes beside given effects."""
        return Posterior(self, sizes, effects)

    def best_sizes(self, start: Sizes, effects: Effects) -> Posterior:
        """The posterior at the most probable sizes, by Fisher scoring on their logarithms.

        A member that is nearly absent moves as fast as any other: its information falls off with
        its slope.
        """
        low = np.log([0.1, *([_ABSENT] * len(start.members))])
        place, boldness = np.maximum(start.logarithms, low), 1.0
        here = Posterior(self, Sizes.at(place), effects)
        for _ in range(_STEPS):
            slope = here.slope
            moves = (place > low) | (slope > 0.0)
            step = np.zeros(len(place))
            step[moves] = np.linalg.solve(here.information[np.ix_(moves, moves)], slope[moves])
            if slope @ (np.maximum(place + step, low) - place) < 2.0 * _GAIN:
                break
            while True:
                onward = np.maximum(place + np.clip(boldness * step, -_STRIDE, _STRIDE), low)
                trial = Posterior(self, Sizes.at(onward), effects)
                if trial.log_probability > here.log_probability:
                    break
                if boldness < _TIMID:
                    return here
                boldness *= 0.25
            place, here, boldness = onward, trial, min(2.0 * boldness, _BOLD)
        return here


class Effects:
    """Whitened columns of effects, of unit prior variance, and their products with a base."""

    def __init__(self, base: Base, columns_mm: np.ndarray, log_prior: float = 0.0) -> None:
        self.columns_mm, self.log_prior = columns_mm, log_prior
        self.x = base.white(columns_mm)
        cross = base.z.T @ self.x
        self.gram = np.block([[base.gram, cross], [cross.T, self.x.T @ self.x]])
        self.seen = np.concatenate([base._seen, self.x.T @ base.y])
        self.member_of = np.concatenate([base.member_of, np.zeros(self.x.shape[1], dtype=int)])

    def on(self, base: Base) -> Effects:
        """The same over another base of the survey."""
        return Effects(base, self.columns_mm, self.log_prior)


@dataclass(frozen=True)
class Posterior:
    """Members' and effects' coefficients, given sizes.

    Attributes
    ----------
    base : Base
    sizes : Sizes
    effects : Effects
    """

    base: Base
    sizes: Sizes
    effects: Effects

    @cached_property
    def scale(self) -> np.ndarray:
        """Prior standard deviation of every column's coefficient in units of the factor, (k,)."""
        each = np.array([1.0, *self.sizes.members])
        return each[self.effects.member_of] / self.sizes.factor

    @cached_property
    def root(self) -> np.ndarray:
        """Lower Cholesky factor of the posterior precision, (k, k), in prior deviations."""
        return _root_of_precision(self.effects.gram, self.scale)

    @cached_property
    def mean(self) -> np.ndarray:
        """Expected coefficients in prior standard deviations, (k,)."""
        aim = self.scale * self.effects.seen / self.sizes.factor
        return cho_solve((self.root, True), aim, check_finite=False)

    @cached_property
    def present(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Columns that are not absent (p,), their root (p, p) and mean (p,) without the others."""
        sizes = np.array([1.0, *self.sizes.members])[self.effects.member_of]
        here = np.flatnonzero(sizes > _GONE)
        if len(here) == len(sizes):
            return here, self.root, self.mean
        root = _root_of_precision(self.effects.gram[np.ix_(here, here)], self.scale[here])
        aim = self.scale[here] * self.effects.seen[here] / self.sizes.factor
        return here, root, cho_solve((root, True), aim, check_finite=False)

    @cached_property
    def log_probability(self) -> float:
        """Of readings and sizes, constants that all models of a survey share left out."""
        k = self.sizes.factor
        square = self.base._square / k**2
        square -= self.mean @ (self.scale * self.effects.seen) / k
        half = 0.5 * square + np.log(np.diag(self.root)).sum() + self.base.degrees * np.log(k)
        return float(self.base._constant - half + self.sizes.log_prior + self.effects.log_prior)

    @cached_property
    def covariance(self) -> np.ndarray:
        """Of the coefficients in prior deviations, lower triangle, (k, k)."""
        inverse, failed = dpotri(self.root, lower=True)
        if failed:
            raise LinAlgError("the posterior precision has to be regular")
        return inverse

    @cached_property
    def slope(self) -> np.ndarray:
        """Derivative of `log_probability` by the logarithms of the sizes, (q,)."""
        variance = np.diag(self.covariance)
        k, member = self.sizes.factor, self.effects.member_of
        amount = self.scale * self.mean
        rest = self.base._square / k**2 - 2 * amount @ self.effects.seen / k
        rest += amount @ self.effects.gram @ amount
        by_factor = -self.base.degrees + rest + len(variance) - variance.sum()
        by_size = np.bincount(member, self.mean**2 + variance - 1.0, len(self.sizes.members) + 1)
        return np.array([by_factor, *by_size[1:]]) + self.sizes.slope_of_prior

    @cached_property
    def information(self) -> np.ndarray:
        """Of Fisher about the logarithms of the sizes, with that of their prior, (q, q).

        With P = 1 - V, V the posterior covariance in prior deviations: 2 |P_jl|² of the blocks of
        two members; the factor replaces one P by V.
        """
        count, member = len(self.sizes.members) + 1, self.effects.member_of
        variance = np.bincount(member, np.diag(self.covariance), count)
        columns = np.bincount(member, minlength=count)
        of_member = np.eye(count)[member]
        squared = of_member.T @ (self.covariance**2 @ of_member)
        squared += squared.T
        squared -= np.diag(np.bincount(member, np.diag(self.covariance) ** 2, count))
        found = squared + np.diag(columns - 2.0 * variance)
        found[0] = found[:, 0] = variance - squared.sum(axis=0)
        found[0, 0] = self.base.degrees - len(member) + squared.sum()
        return 2.0 * found + np.diag(self.sizes.information_of_prior)

    @cached_property
    def left(self) -> np.ndarray:
        """What members and effects leave of the white readings, (n,), in units of the factor."""
        amount = self.scale * self.mean * self.sizes.factor
        of_members, of_effects = np.split(amount, [self.base.z.shape[1]])
        taken = self.base.z @ of_members + self.effects.x @ of_effects
        return (self.base.y - taken) / self.sizes.factor


def _root_of_precision(gram: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of 1 + S G S, (k, k), from products G and prior deviations S (k,)."""
    precision = gram * scale
    precision *= scale[:, None]
    precision[np.diag_indices(len(precision))] += 1.0
    # symmetric: its transpose lies in memory as LAPACK wants it
    root, failed = dpotrf(precision.T, lower=True, overwrite_a=True)
    if failed:
        raise LinAlgError("the posterior precision has to be positive definite")
    return root
