"""Probability of all readings with what is unknown integrated out, and sizes that make it largest.

Readings y in units of their feature noise, nuisance projected out (its prior is flat), are

    y = Z D^(1/2) f + X c + k e

with unit-variance f of members whose sizes D are known (tables, device) or unknown (discrepancy),
effects X c, and a factor k on the stated uncertainty. Everything but k and the sizes is integrated
in closed form; only inner products enter, so a trial of other sizes costs no pass over readings.

Source: C. Rasmussen and C. Williams, Gaussian Processes for Machine Learning (2006), eq. 5.8, the
marginal likelihood; closed forms derived here: f and c integrated as normal variables; the
information, 1/2 tr(C^-1 dC C^-1 dC), from the covariance of both; and where 1 + F^T F = L L^T,
1 - F (L^T + 1)^-1 L^-1 F^T is a root of (1 + F F^T)^-1.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.fit.base import Base, SizedMembers, inverse_of, raised, root_of_precision, solved
from vmach.fit.columns import Columns
from vmach.fit.places import Places
from vmach.fit.sizes import ABSENT, Sizes
from vmach.fit.whitening import thin_product

__all__ = ["Bordered", "Effects", "Posterior", "best_sizes"]

#: steps at most towards the best sizes, none longer than this; multiples of a step that are tried
_STEPS, _STRIDE, _TIMID, _BOLD = 20, 1.5, 0.05, 4.0
#: log probability that a further step has to promise
_GAIN = 0.01
#: a member up to this size cannot shrink
_LEAST = (1.0 + 1e-9) * ABSENT


def best_sizes(base: Base, start: Sizes, effects: Effects) -> Posterior:
    """The posterior at the most probable sizes, by Fisher scoring on their logarithms.

    A member that is nearly absent moves as fast as any other: its information falls off with
    its slope.
    """
    low = np.log([0.1, *([ABSENT] * len(start.members))])
    place, boldness = np.maximum(start.logarithms, low), 1.0
    # only products count here, so that columns which do the same are one
    lean = Effects(effects.columns.told_apart(), effects.log_prior)
    here = Posterior(base, Sizes.at(place), lean)
    for _ in range(_STEPS):
        slope, information = here.slope_and_information()
        moves = (place > low) | (slope > 0.0)
        step = np.zeros(len(place))
        step[moves] = np.linalg.solve(information[np.ix_(moves, moves)], slope[moves])
        if slope @ (np.maximum(place + step, low) - place) < 2.0 * _GAIN:
            break
        while True:
            onward = np.maximum(place + np.clip(boldness * step, -_STRIDE, _STRIDE), low)
            trial = Posterior(base, Sizes.at(onward), lean)
            if trial.log_probability > here.log_probability:
                break
            if boldness < _TIMID:
                return replace(here, effects=effects)
            boldness *= 0.25
        place, here, boldness = onward, trial, min(2.0 * boldness, _BOLD)
    return replace(here, effects=effects)


@dataclass(frozen=True, eq=False)
class Effects:
    """Effects beside the members.

    Attributes
    ----------
    columns : Columns
        Of unit prior variance.
    log_prior : float
    """

    columns: Columns
    log_prior: float = 0.0

    def __len__(self) -> int:
        return len(self.columns)

    def on(self, base: Base) -> Effects:
        """The same over another base of the survey."""
        return Effects(base.columns(self.columns.make_mm()), self.log_prior)


class Bordered:
    """The root of the precision of members and effects, by blocks: effects border the members.

    Parameters
    ----------
    members : SizedMembers
    effects : Effects

    Attributes
    ----------
    border : (p, e) float64
        Transposed, what stands left of the effects' own block.
    own : (e, e) float64
        The effects' own block.
    seen_members, seen_effects : (p,), (e,) float64
        What the readings say, by the root.
    """

    def __init__(self, members: SizedMembers, effects: Effects) -> None:
        k = members.sizes.factor
        self.border = members.taken(effects.columns.cross) / k
        scale = np.full(len(effects), 1.0 / k)
        self.own = root_of_precision(
            effects.columns.gram - k**2 * self.border.T @ self.border, scale
        )
        self.seen_members = members.seen
        aim = effects.columns.seen / k**2 - self.border.T @ self.seen_members
        self.seen_effects = solved(self.own, aim)


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

    @property
    def members(self) -> SizedMembers:
        """At the sizes."""
        return self.base.sized(self.sizes)

    @cached_property
    def bordered(self) -> Bordered:
        """The root of the precision."""
        return Bordered(self.members, self.effects)

    @property
    def root(self) -> np.ndarray:
        """Lower Cholesky factor of the posterior precision, (k, k), in prior deviations."""
        root, border = self.members.root, self.bordered.border
        whole = np.zeros((sum(border.shape),) * 2, order="F")
        q = len(root)
        whole[:q, :q], whole[q:, :q], whole[q:, q:] = root, border.T, self.bordered.own
        return whole

    @cached_property
    def mean(self) -> tuple[np.ndarray, np.ndarray]:
        """Expected coefficients of members that are there, and of effects, in prior deviations."""
        of_effects = solved(self.bordered.own, self.bordered.seen_effects.copy(), transposed=True)
        rest = self.bordered.seen_members - self.bordered.border @ of_effects
        return solved(self.members.root, rest, transposed=True), of_effects

    @cached_property
    def deviation_of_effects(self) -> np.ndarray:
        """Standard deviations of the effects' coefficients, (e,), in prior deviations."""
        return np.linalg.norm(solved(self.bordered.own, np.eye(len(self.effects))), axis=0)

    @property
    def amounts(self) -> np.ndarray:
        """Expected coefficients of all members' columns, (q,)."""
        amount = np.zeros(len(self.base.member_of))
        amount[self.members.here] = self.members.scale * self.mean[0] * self.sizes.factor
        return amount

    @cached_property
    def log_probability(self) -> float:
        """Of readings and sizes, constants that all models of a survey share left out."""
        k, root = self.sizes.factor, self.bordered
        square = self.base.square / k**2
        square -= root.seen_members @ root.seen_members + root.seen_effects @ root.seen_effects
        half = 0.5 * square + self.base.degrees * np.log(k)
        half += self.members.half_log_determinant + np.log(np.diag(root.own)).sum()
        log_prior = self.sizes.log_prior(*self.base.members.prior_of_sizes) + self.effects.log_prior
        return float(self.base.constant - half + log_prior)

    def slope_and_information(self) -> tuple[np.ndarray, np.ndarray]:
        """By the logarithms of the sizes, (q,) and (q, q).

        The derivative of `log_probability`, and the information of Fisher with that of the prior.
        With P = 1 - V, V the posterior covariance in prior deviations: 2 |P_jl|² of the blocks of
        two members; the factor replaces one P by V.
        """
        inverse = inverse_of(self.root)
        count, mean = len(self.sizes.members) + 1, np.concatenate(self.mean)
        none = np.zeros(len(self.effects), dtype=int)
        member = np.concatenate([self.base.member_of[self.members.here], none])
        diagonal = np.diag(inverse).copy()
        slope = np.zeros(count)  # bincount of nothing counts in whole numbers
        slope += np.bincount(member, mean**2 + diagonal - 1.0, count)
        seen = float(self.seen @ self.seen)
        rest = self.base.square / self.sizes.factor**2 - seen - mean @ mean
        slope[0] = rest + len(diagonal) - diagonal.sum() - self.base.degrees
        # the lower triangle alone is there
        inverse *= inverse
        of_member = np.eye(count)[member]
        squared = of_member.T @ (inverse @ of_member)
        squared += squared.T
        squared -= np.diag(np.bincount(member, diagonal**2, count))
        variance = np.bincount(member, diagonal, count)
        found = squared + np.diag(np.bincount(member, minlength=count) - 2.0 * variance)
        found[0] = found[:, 0] = variance - squared.sum(axis=0)
        found[0, 0] = self.base.degrees - len(member) + squared.sum()
        self._add_absent(slope, found)
        prior, beforehand = self.sizes, self.base.members.prior_of_sizes
        information = 2.0 * found + prior.information_of_prior(*beforehand)
        return slope + prior.slope_of_prior(*beforehand), information

    def _add_absent(self, slope: np.ndarray, information: np.ndarray) -> None:
        """To both, what members that are absent would do if they were a little there.

        The information only of those that could grow; others stay at their smallest size.
        """
        absent, base = self.members.absent, self.base
        if not len(absent):
            return
        factor = self.sizes.factor
        taken = self._beside_effects(
            self.members.taken_of_absent / factor, self.effects.columns.cross[absent].T
        )
        member = base.member_of[absent]
        seen = base.seen[absent] / factor**2 - taken.T @ self.seen
        left = np.diag(base.gram)[absent] / factor**2 - np.sum(taken**2, axis=0)
        squared = self.sizes.each**2
        slope += squared * np.bincount(member, seen**2 - left, len(slope))
        for k in np.unique(member):
            if slope[k] > 0.0 or self.sizes.each[k] > _LEAST:
                rows = absent[member == k]
                own = slice(rows[0], rows[-1] + 1)
                of_member = taken[:, member == k]
                block = base.gram[own, own] / factor**2 - of_member.T @ of_member
                information[k, k] += squared[k] ** 2 * np.sum(block**2)

    def taken(self, columns: Columns) -> np.ndarray:
        """What members and effects take of K columns, by the root, (k, K)."""
        return self._taken(columns.cross, self.effects.columns.dot_with(columns))

    def _taken(self, cross: np.ndarray, with_effects: np.ndarray) -> np.ndarray:
        """The same from products with the members' and the effects' columns, (q, K), (e, K)."""
        return self._beside_effects(self.members.taken(cross) / self.sizes.factor, with_effects)

    def _beside_effects(self, of_members: np.ndarray, with_effects: np.ndarray) -> np.ndarray:
        """The same from what the members take, (p, K), in units of the factor."""
        root = self.bordered
        own = with_effects / self.sizes.factor**2 - root.border.T @ of_members
        return np.concatenate([of_members, solved(root.own, own)])

    def products(self, columns: Columns) -> tuple[np.ndarray, np.ndarray]:
        """Of K columns with each other and with the readings, (K, K) and (K,), in unit noise.

        Members and effects count as noise; what the nuisance can explain is taken out.
        """
        taken, factor = self.taken(columns), self.sizes.factor
        gram = columns.gram / factor**2 - taken.T @ taken
        return gram, columns.seen / factor**2 - taken.T @ self.seen

    def products_at(self, places: Places) -> tuple[np.ndarray, np.ndarray]:
        """The same of the K columns at each of G places, (G, K, K) and (G, K)."""
        taken = self._taken(places.cross, places.with_columns(self.effects.columns.white))
        factor, shape = self.sizes.factor, places.gram.shape[:2]
        by_place = taken.T.reshape(*shape, len(taken))
        gram = places.gram / factor**2 - by_place @ by_place.transpose(0, 2, 1)
        seen = places.seen / factor**2 - taken.T @ self.seen
        return gram[places.which], seen.reshape(shape)[places.which]

    def left_of(self, columns: Columns) -> np.ndarray:
        """What members and effects leave of white columns, (r, K), in squares of the factor.

        Their products with other white columns are those beside members and effects.
        """
        root, taken = self.bordered, self.taken(columns)
        count = len(self.members.here)
        of_effects = solved(root.own, taken[count:], transposed=True)
        amount = np.zeros((len(self.base.member_of), len(columns)))
        amount[self.members.here] = self.members.given_back(
            taken[:count] - root.border @ of_effects
        )
        factor = self.sizes.factor
        left = columns.white - factor * (self.base.z @ amount)
        return (left - self.effects.columns.summed(of_effects)) / factor**2

    @property
    def seen(self) -> np.ndarray:
        """What the readings say, by the root, (k,)."""
        return np.concatenate([self.bordered.seen_members, self.bordered.seen_effects])

    def whiten(self, columns_mm: np.ndarray) -> np.ndarray:
        """Columns in plain unit noise, members and effects counted as noise; (n,), (n, k) or more.

        What the nuisance can explain is taken out. Only products of such columns have a meaning.
        """
        white = self.base.white(columns_mm.reshape(len(columns_mm), -1))
        members, root, own = self.members, self.bordered, self.effects.columns
        taken = members.taken(thin_product(self.base.z.T, white))
        of_effects = own.dot(white) / self.sizes.factor - root.border.T @ taken
        of_effects = solved(root.own, of_effects)
        of_effects = solved(raised(root.own), of_effects, transposed=True)
        taken -= root.border @ of_effects
        amount = np.zeros((len(self.base.member_of), white.shape[1]))
        taken = solved(members.raised_root, taken, transposed=True)
        amount[members.here] = members.scale[:, None] * taken
        white -= thin_product(self.base.z, amount)
        white -= own.summed(of_effects) / self.sizes.factor
        white /= self.sizes.factor
        return white.reshape(len(white), *columns_mm.shape[1:])

    @property
    def left(self) -> np.ndarray:
        """What members and effects leave of the white readings, (r,), in units of the factor."""
        taken = self.base.z @ self.amounts + self.effects.columns.summed(self.mean[1])
        return (self.base.y - taken) / self.sizes.factor
