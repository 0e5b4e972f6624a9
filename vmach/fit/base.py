"""Readings of a survey and the members beside them, as inner products.

Readings y in units of their feature noise, nuisance projected out, with members' columns Z: what
effects are weighed beside needs only products of these with each other, whatever the sizes.

Source: closed form derived here: the precision of normal variables of unit variance, 1 + S G S.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy.linalg import LinAlgError
from scipy.linalg.blas import dtrmm
from scipy.linalg.lapack import dpotrf, dpotri, dtrtri, dtrtrs

from vmach.effects import Effect
from vmach.fit.columns import Columns
from vmach.fit.discrepancy import Members
from vmach.fit.feature_noise import FeatureNoise
from vmach.fit.means import Means
from vmach.fit.remembered import Remembered
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.whitening import thin_product

__all__ = ["Base", "SizedMembers", "raised", "root_of_precision", "solved"]

#: members up to this size, in u, take nothing
_GONE = 0.025
#: numbers that roots of sized members may take up while they are remembered
_ROOM = 10_000_000
#: numbers that signatures with their products may take up while they are remembered
_ROOM_OF_COLUMNS = 34_000_000


class Base:
    """Readings of a survey in the units of one feature noise, nuisance projected out.

    Beside means of readings there are as many rows as means.

    Attributes
    ----------
    y : (n,) float64
    z : (n, q) float64
        Members' columns.
    gram : (q, q) float64
        Products of these with each other.
    seen : (q,) float64
        With the readings.
    square : float
        Of the readings with themselves.
    """

    def __init__(self, survey: Survey, noise: FeatureNoise | Means, members: Members) -> None:
        self.survey, self.noise, self.members = survey, noise, members
        nuisance = noise.white(survey.nuisance)
        norms = np.linalg.norm(nuisance, axis=0)
        left, size, _ = np.linalg.svd(nuisance / np.where(norms > 0, norms, 1.0), False)
        seen = size > 1e-9 * max(np.max(size, initial=0.0), 1e-300)
        self._free = left[:, seen]
        self.constant = -0.5 * noise.log_determinant - float(np.log(size[seen]).sum())
        self.constant -= float(np.log(norms[norms > 0]).sum())
        self.y = self.white(survey.residual_mm[:, None])[:, 0]
        self.z = self.white(np.hstack([members.fixed_mm, *members.columns_mm]))
        counts = [members.fixed_mm.shape[1], *(c.shape[1] for c in members.columns_mm)]
        self.member_of = np.repeat(np.arange(len(counts)), counts)
        self.degrees = len(self.y) - self._free.shape[1]
        self.gram, self.seen = self.z.T @ self.z, self.z.T @ self.y
        self.square = float(self.y @ self.y)
        # a root, and the raised one
        self._sized = Remembered[SizedMembers](_ROOM / max(2 * self.gram.size, 1))
        self._alike: dict[Hashable, Hashable] = {}
        self._columns = Remembered[Columns](_ROOM_OF_COLUMNS, lambda columns: columns.size)

    def white(self, columns_mm: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise without what the nuisance can explain."""
        white = self.noise.white(columns_mm)
        if white.flags.c_contiguous:
            white -= self._free @ (self._free.T @ white)
        else:
            white.T[:] -= (white.T @ self._free) @ self._free.T
        return white

    def columns(self, columns_mm: np.ndarray) -> Columns:
        """Columns (n, K) mm with their products."""
        white = self.white(columns_mm)
        return Columns(columns_mm, white, thin_product(self.z.T, white), white.T @ self.y)

    @cached_property
    def no_columns(self) -> Columns:
        """None at all."""
        return self.columns(np.zeros((len(self.survey), 0)))

    def signature(self, effect: Effect, target: str, inner: Mapping[str, float]) -> Columns:
        """What one usual size of each coefficient of an effect does; the last are remembered."""
        return self.signatures(effect, target, [inner])[0]

    def signatures(
        self, effect: Effect, target: str, inner: Sequence[Mapping[str, float]]
    ) -> list[Columns]:
        """The same at several places; those that are new are worked out together.

        Many moments of a sudden effect have the same signature, which is worked out once.
        """
        known: dict[Hashable, Columns] = {}
        new: dict[Hashable, np.ndarray] = {}
        asked = [(effect, target, tuple(values.items())) for values in inner]
        for one, values in zip(asked, inner, strict=True):
            columns_mm = None
            if one not in self._alike:
                columns_mm = self.survey.signature(effect, target, values)
                self._alike[one] = effect, target, hash(columns_mm.tobytes())
            key = self._alike[one]
            if key in self._columns:
                known[key] = self._columns[key]
            elif key not in new:
                if columns_mm is None:
                    columns_mm = self.survey.signature(effect, target, values)
                new[key] = columns_mm
        if new:
            together = self.columns(np.hstack(list(new.values())))
            known |= zip(new, together.split(len(new)), strict=True)
            for key in new:
                self._columns[key] = known[key]
        return [known[self._alike[one]] for one in asked]

    def forget(self) -> None:
        """Signatures and roots, which take the most room."""
        self._columns.clear()
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
        self._base, self.sizes = base, sizes
        size = sizes.each[base.member_of]
        self.here, self.absent = np.flatnonzero(size > _GONE), np.flatnonzero(size <= _GONE)
        self.scale = size[self.here] / sizes.factor

    @cached_property
    def root(self) -> np.ndarray:
        """Lower Cholesky factor of 1 + S G S, the precision in prior deviations, (p, p)."""
        return root_of_precision(self._base.gram[np.ix_(self.here, self.here)], self.scale)

    @cached_property
    def seen(self) -> np.ndarray:
        """What the readings say, by the root: L^-1 S Z^T y, (p,)."""
        return self.taken(self._base.seen) / self.sizes.factor

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

    @cached_property
    def _inverse(self) -> np.ndarray:
        """Of the root."""
        inverse, failed = dtrtri(self.root, lower=True)
        assert not failed
        return inverse


def root_of_precision(gram: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of 1 + S G S, (k, k), from products G and prior deviations S (k,)."""
    precision = gram * scale
    precision *= scale[:, None]
    precision[np.diag_indices(len(precision))] += 1.0
    # symmetric: its transpose lies in memory as LAPACK wants it
    root, failed = dpotrf(precision.T, lower=True, overwrite_a=True)
    if failed:
        raise LinAlgError("the posterior precision has to be positive definite")
    return root


def solved(root: np.ndarray, right: np.ndarray, *, transposed: bool = False) -> np.ndarray:
    """Root^-1 or root^-T times the right side (k,) or (k, m), which may be overwritten."""
    if right.size == 0:
        return right
    # called directly: most right sides are single columns, and a wrapper costs more than they do
    found, failed = dtrtrs(root, right, lower=True, trans=int(transposed), overwrite_b=True)
    if failed:
        raise LinAlgError("the root of a precision has to be regular")
    return found


def inverse_of(root: np.ndarray) -> np.ndarray:
    """Lower triangle of the inverse of the matrix with this root (k, k), which is overwritten."""
    if root.size == 0:  # no member and no effect is there; LAPACK refuses such a matrix
        return root
    inverse, failed = dpotri(root, lower=True, overwrite_c=True)
    if failed:
        raise LinAlgError("the posterior precision has to be regular")
    return inverse


def raised(root: np.ndarray) -> np.ndarray:
    """A root (k, k) with one more on its diagonal."""
    more = root.copy(order="F")
    more[np.diag_indices(len(more))] += 1.0
    return more
