"""Readings of a survey and the members beside them, as inner products.

Readings y in units of their feature noise, nuisance projected out, with members' columns Z: what
effects are weighed beside needs only products of these with each other, whatever the sizes.

Source: closed form derived here: the precision of normal variables of unit variance, 1 + S G S.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy.linalg.blas import dtrmm
from scipy.linalg.lapack import dlauum, dpotrf, dtrtri, dtrtrs

from vmach.effects import Effect
from vmach.errors import InputError
from vmach.fit.columns import Columns
from vmach.fit.noise.discrepancy import Members
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.places import Inner, Places, Step, steps_along
from vmach.fit.remembered import Remembered
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.whitening import thin_product

__all__ = ["Base", "SizedMembers", "raised", "root_of_precision", "solved"]

#: an effect, its target and inner parameters
Asked = tuple[Effect, str, Mapping[str, float]]
#: members up to this size, in u, take nothing
_GONE = 0.025
#: numbers that roots of sized members may take up while they are remembered
_ROOM = 10_000_000
#: numbers that signatures with their products may take up while they are remembered
_ROOM_OF_COLUMNS = 12_000_000
#: share of the largest norm that is what rounding leaves of a column
_ROUNDING = 1e-12
#: half the size of a triangle from which on its halves are inverted one by one
_LARGE = 50


class Base:
    """Readings of a survey in the units of one feature noise, nuisance projected out.

    Parameters
    ----------
    survey : Survey
    noise : FeatureNoise
    members : Members

    Attributes
    ----------
    free : (r, f) float64
        An orthonormal basis of what the nuisance can explain.
    y : (r,) float64
    gram : (q, q) float64
        Products of members' columns with each other.
    seen : (q,) float64
        With the readings.
    square : float
        Of the readings with themselves.
    """

    def __init__(
        self,
        survey: Survey,
        noise: FeatureNoise,
        members: Members,
    ) -> None:
        self.survey, self.noise, self.members = survey, noise, members
        nuisance = noise.white(survey.nuisance)
        norms = np.linalg.norm(nuisance, axis=0)
        there = norms > _ROUNDING * norms.max(initial=0.0)
        left, size, _ = np.linalg.svd(nuisance[:, there] / norms[there], False)
        seen = size > 1e-9 * max(np.max(size, initial=0.0), 1e-300)
        self.free = left[:, seen]
        self.constant = noise.log_prior + noise.own_scale.log_prior - 0.5 * noise.log_determinant
        self.constant -= float(np.log(size[seen]).sum())
        self.constant -= float(np.log(norms[there]).sum())
        self.y = self.white(survey.residual_mm[:, None])[:, 0]
        counts = [members.fixed_mm.shape[1], *(c.shape[1] for c in members.columns_mm)]
        self.member_of = np.repeat(np.arange(len(counts)), counts)
        self.stretches = list(itertools.starmap(slice, itertools.pairwise(np.cumsum([0, *counts]))))
        self.degrees = len(self.y) - self.free.shape[1]
        self.gram, self.seen = self.z.T @ self.z, self.z.T @ self.y
        self.square = float(self.y @ self.y)
        # a root, and the raised one
        self._sized = Remembered[SizedMembers](_ROOM / max(2 * self.gram.size, 1))
        self._columns = Remembered[Columns](_ROOM_OF_COLUMNS, lambda columns: columns.size)
        self._steps = Remembered[Step](_ROOM_OF_COLUMNS, lambda step: step.size)

    @cached_property
    def z(self) -> np.ndarray:
        """Members' columns, (r, q)."""
        return self.white(self.members.every_mm)

    def white(self, columns_mm: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise without what the nuisance can explain, (r, k)."""
        white = self.noise.white(columns_mm)
        if white.flags.c_contiguous:
            white -= self.free @ (self.free.T @ white)
        else:
            white.T[:] -= (white.T @ self.free) @ self.free.T
        return white

    def back(self, white: np.ndarray) -> np.ndarray:
        """Columns (r, k) by the transpose of the map that makes columns in mm white."""
        return self.noise.back(white)

    def columns(self, columns_mm: np.ndarray) -> Columns:
        """Columns (n, K) mm with their products."""
        white = self.white(np.asfortranarray(columns_mm))
        cross = thin_product(self.z.T, white)
        return Columns.of(lambda: columns_mm, white, cross, white.T @ self.y)

    @cached_property
    def no_columns(self) -> Columns:
        """None at all."""
        return self.columns(np.zeros((len(self.survey), 0)))

    def signatures(self, asked: Sequence[Asked]) -> list[Columns]:
        """What one usual size of each coefficient of effects does; the last are remembered.

        Those that are new are worked out together.
        """
        keys = [(effect, target, tuple(inner.items())) for effect, target, inner in asked]
        known = {key: self._columns[key] for key in keys if key in self._columns}
        new = {key: one for key, one in zip(keys, asked, strict=True) if key not in known}
        if new:
            columns_mm = [self.survey.signature(*one) for one in new.values()]
            together = self.columns(np.concatenate([own.T for own in columns_mm]).T)
            parts = together.split(columns_mm)
            for key, columns in zip(new, parts, strict=True):
                self._columns[key] = known[key] = columns
        return [known[key] for key in keys]

    def places(self, effect: Effect, target: str, inner: Sequence[Mapping[str, float]]) -> Places:
        """The same at many places, one beside the other; only what is new is worked out."""
        is_new = self.survey.told_apart(effect, inner)
        asked: list[Inner] = [
            tuple(values.items()) for values in itertools.compress(inner, is_new.tolist())
        ]
        pairs = list(zip([None, *asked[:-1]], asked, strict=True))
        keys = {pair: (effect, target, pair) for pair in pairs}
        known = {pair: self._steps[key] for pair, key in keys.items() if key in self._steps}
        new = [pair for pair in pairs if pair not in known]
        for pair, step in zip(new, steps_along(self, effect, target, new), strict=True):
            self._steps[keys[pair]] = known[pair] = step
        return Places(self.back, [known[pair] for pair in pairs], np.cumsum(is_new) - 1)

    def forget(self) -> None:
        """Members' columns, signatures and roots, which take the most room."""
        self.__dict__.pop("z", None)
        self._columns.clear()
        self._steps.clear()
        self._sized.clear()

    def sized(self, sizes: Sizes) -> SizedMembers:
        """The members at given sizes; the last ones are remembered."""
        return self._sized.get(sizes, lambda: SizedMembers(self, sizes))


class SizedMembers:
    """Members of a base at given sizes, those that are there: what all effects beside them share.

    Parameters
    ----------
    base : Base
    sizes : Sizes

    Attributes
    ----------
    here, absent : (p,), (a,) int
        Which of the base's columns are there, and which belong to members that are not.
    scale : (p,) float64
        Prior standard deviation of every column's coefficient in units of the factor.
    """

    def __init__(self, base: Base, sizes: Sizes) -> None:
        # not the base itself, which remembers this: large things that hold each other stay long
        self._gram, self._seen, self.sizes = base.gram, base.seen, sizes
        size = sizes.each[base.member_of]
        self.here, self.absent = np.flatnonzero(size > _GONE), np.flatnonzero(size <= _GONE)
        self.scale = size[self.here] / sizes.factor
        each = zip(base.stretches, sizes.each.tolist(), strict=True)
        self._each = [(own, size / sizes.factor) for own, size in each if size > _GONE]

    @cached_property
    def root(self) -> np.ndarray:
        """Lower Cholesky factor of 1 + S G S, the precision in prior deviations, (p, p)."""
        precision = np.empty((len(self.here),) * 2, order="F")
        ends = np.cumsum([0, *(own.stop - own.start for own, _ in self._each)]).tolist()
        for k, (first, scale) in enumerate(self._each):
            column = slice(ends[k], ends[k + 1])
            for i, (own, other) in enumerate(self._each[k:], k):
                block = precision[ends[i] : ends[i + 1], column]
                # symmetric: its transpose lies in memory like the block
                np.multiply(self._gram.T[own, first], scale * other, out=block)
        precision[np.diag_indices(len(precision))] += 1.0
        return _root(precision)

    @cached_property
    def seen(self) -> np.ndarray:
        """What the readings say, by the root: L^-1 S Z^T y, (p,)."""
        return self.taken(self._seen) / self.sizes.factor

    @cached_property
    def taken_of_absent(self) -> np.ndarray:
        """What is taken of the columns of members that are absent, (p, a)."""
        return self.taken(self._gram[self.absent].T)

    @cached_property
    def raised_root(self) -> np.ndarray:
        """The root with one more on its diagonal."""
        return raised(self.root)

    @cached_property
    def half_log_determinant(self) -> float:
        """Of the precision."""
        return float(np.log(np.diag(self.root)).sum())

    def taken(self, products: np.ndarray) -> np.ndarray:
        """L^-1 S of products (q,) or (q, k) with all of the base's columns, (p,) or (p, k)."""
        own = products[self.here]
        scaled = (own.T * self.scale).T
        if not len(self.here):
            return scaled
        if own.ndim == 1 or own.shape[1] < len(self.here):
            return solved(self.root, scaled)
        # many at once: BLAS multiplies by an inverse twice as fast as it solves
        return dtrmm(1.0, self._inverse, scaled, lower=True, overwrite_b=True)

    def given_back(self, taken: np.ndarray) -> np.ndarray:
        """S L^-T of what members take (p, k): so much of each column takes it, (p, k)."""
        return self.scale[:, None] * solved(self.root, taken.copy("F"), transposed=True)

    @cached_property
    def _inverse(self) -> np.ndarray:
        """Of the root."""
        return _inverse_of_triangle(self.root)


def root_of_precision(gram: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of 1 + S G S, (k, k), from products G and prior deviations S (k,)."""
    precision = gram * scale
    precision *= scale[:, None]
    precision[np.diag_indices(len(precision))] += 1.0
    # symmetric: its transpose lies in memory as LAPACK wants it
    return _root(precision.T)


def _root(precision: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of a matrix (k, k) whose lower triangle counts; it is overwritten."""
    root, failed = dpotrf(precision, lower=True, overwrite_a=True)
    if failed:
        raise _out_of_proportion()
    return root


def _out_of_proportion() -> InputError:
    """What is said where sizes lie so far apart that rounding hides the smaller ones."""
    return InputError(
        "the readings are out of all proportion to their uncertainty: rounding hides what they say",
        accepted="readings within 0.25 mm of what is predicted, u_um from 0.02 to 100",
        hint="look at the units of the readings and of u_um",
    )


def solved(root: np.ndarray, right: np.ndarray, *, transposed: bool = False) -> np.ndarray:
    """Root^-1 or root^-T times the right side (k,) or (k, m), which may be overwritten."""
    if right.size == 0:
        return right
    # called directly: most right sides are single columns, and a wrapper costs more than they do
    found, failed = dtrtrs(root, right, lower=True, trans=int(transposed), overwrite_b=True)
    if failed:
        raise _out_of_proportion()
    return found


def inverse_of(root: np.ndarray) -> np.ndarray:
    """Lower triangle of the inverse of the matrix with this root (k, k), which is overwritten."""
    if root.size == 0:  # no member and no effect is there; LAPACK refuses such a matrix
        return root
    return dlauum(_inverse_of_triangle(root), lower=True, overwrite_c=True)[0]


def _inverse_of_triangle(root: np.ndarray) -> np.ndarray:
    """Of a lower triangle (k, k); by its halves, which BLAS multiplies faster than it inverts."""
    half = len(root) // 2
    if half < _LARGE:
        inverse, failed = dtrtri(root, lower=True)
        if failed:
            raise _out_of_proportion()
        return inverse
    inverse = np.zeros(root.shape, order="F")
    above, below = slice(half), slice(half, None)
    inverse[above, above] = first = _inverse_of_triangle(root[above, above])
    inverse[below, below] = last = _inverse_of_triangle(root[below, below])
    beside = dtrmm(-1.0, last, root[below, above], lower=True)
    inverse[below, above] = dtrmm(1.0, first, beside, side=1, lower=True, overwrite_b=True)
    return inverse


def raised(root: np.ndarray) -> np.ndarray:
    """A root (k, k) with one more on its diagonal."""
    more = root.copy(order="F")
    more[np.diag_indices(len(more))] += 1.0
    return more
