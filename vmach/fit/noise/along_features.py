"""Readings that are correlated along their features, in a time that grows with their number.

Of one feature, in units of u, let reading i be a first-order autoregression and scatter of its own,

    y_i = x_i + v_i,    x_(i+1) = r x_i + w_i,    var x_i = s,    var v_i = q_i

Kalman's filter foretells y_i from those before it with the variance d_i², by the gain g_i. What is
new in each, divided by d_i, is white: the filter is the inverse of a Cholesky factor L of the
covariance. So L^-1, its transpose and that of L are recursions of first order.

Source: A. Harvey, Forecasting, Structural Time Series Models and the Kalman Filter (1989), section
3.2; transposes derived here. P. de Jong, Biometrika 75 (1988) 594 (a reading given all others).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from stock.compiled import njit_kernel, read_only
from stock.threads import run_in_parts

__all__ = ["AlongFeatures"]

#: columns that are worked out together: none waits for another
_AT_ONCE = 8
#: numbers that are worth a thread
_WORTH_A_THREAD = 200_000


@dataclass(frozen=True)
class _Recursion:
    """A map of readings, one after the other: out = a x + b t, then the state t = c t + d x.

    Attributes
    ----------
    order : (n,) int64
        The readings as they follow each other.
    own, of_state : (n,) float64
        What is made of a reading and of the state, a and b, in that order.
    kept, taken : (n,) float64
        What of the state and of the reading goes into the next state, c and d.
    """

    order: np.ndarray
    own: np.ndarray
    of_state: np.ndarray
    kept: np.ndarray
    taken: np.ndarray

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """The map of columns (n, k), each by itself."""
        lying: Literal["F", "C"] = "F" if columns.flags.f_contiguous else "C"
        found = np.empty(columns.shape, order=lying)
        (count, many), (down, across) = columns.shape, (s // 8 for s in found.strides)
        # one kind of numbers: the kernel is compiled once for each
        given = read_only(columns.ravel(lying).astype(np.float64, copy=False))
        made = found.ravel(lying)
        rule = (self.order, self.own, self.of_state, self.kept, self.taken)
        state = np.zeros(many)
        run_in_parts(
            lambda begin, end: _run(given, made, (down, across), rule, state, begin, end),
            many,
            block=_AT_ONCE,
            least=max(_AT_ONCE, _WORTH_A_THREAD // max(count, 1)),
        )
        return found


@dataclass(frozen=True)
class AlongFeatures:
    """The covariance of n readings, and its Cholesky factor L.

    Attributes
    ----------
    u_mm : (n,) float64
        Stated standard uncertainty.
    group : (n,) str
        Feature or run; readings follow each other within it.
    own : (n,) float64
        Variance of each reading by itself, in units of u.
    share, correlation : float
        Variance that is correlated, in units of u, and from one reading to the next.
    """

    u_mm: np.ndarray
    group: np.ndarray
    own: np.ndarray
    share: float
    correlation: float

    @cached_property
    def white(self) -> _Recursion:
        """L^-1, of readings in mm."""
        own, goes_on = 1.0 / self._new, ~self._is_last
        kept, taken = self._kept * goes_on, self._taken * goes_on / self._u_mm
        return _Recursion(self._order, own / self._u_mm, -own, kept, taken)

    @cached_property
    def back(self) -> _Recursion:
        """L^-T, of what is white."""
        own, of_state = 1.0 / self._new, self._taken / self._u_mm
        return self._backwards(own / self._u_mm, of_state, self._kept, -own)

    @cached_property
    def deviations(self) -> _Recursion:
        """L^T, of weights for readings in mm."""
        correlation = np.full(len(self.own), self.correlation)
        of_state = self._taken * self._new
        return self._backwards(self._new * self._u_mm, of_state, correlation, self._u_mm)

    @property
    def precisions(self) -> np.ndarray:
        """Of every reading, given all others: the diagonal of the inverse, (n,) mm^-2."""
        rule = self.back
        coefficients = (rule.own, rule.of_state, rule.kept, rule.taken)
        sums_of_squares = _Recursion(rule.order, *(values**2 for values in coefficients))
        return sums_of_squares(np.ones((len(self.own), 1)))[:, 0]

    @property
    def log_determinant(self) -> float:
        """Of the covariance in units of u."""
        return 2.0 * float(np.log(self._new).sum())

    def _backwards(
        self, own: np.ndarray, of_state: np.ndarray, kept: np.ndarray, taken: np.ndarray
    ) -> _Recursion:
        """From the last reading to the first; no state goes on from one feature to another."""
        goes_on = ~self._is_first
        rule = (self._order, own, of_state, kept * goes_on, taken * goes_on)
        return _Recursion(*(values[::-1].copy() for values in rule))

    @cached_property
    def _order(self) -> np.ndarray:
        """Readings feature by feature, (n,)."""
        return np.argsort(self._number, kind="stable")

    @cached_property
    def _number(self) -> np.ndarray:
        """Of every reading's feature, (n,)."""
        return np.unique(self.group, return_inverse=True)[1]

    @property
    def _is_first(self) -> np.ndarray:
        """Whether a feature begins, in that order, (n,)."""
        number = self._number[self._order]
        return np.append(True, number[1:] != number[:-1])[: len(number)]

    @property
    def _u_mm(self) -> np.ndarray:
        """Of the readings in that order, (n,)."""
        return self.u_mm[self._order]

    @property
    def _is_last(self) -> np.ndarray:
        return np.roll(self._is_first, -1)

    @cached_property
    def _gain(self) -> np.ndarray:
        """Share of what is new in a reading that is of the autoregression, (n,)."""
        own, gain = self.own[self._order], np.empty(len(self.own))
        _filter(own, self._is_first, (self.share, self.correlation), gain)
        return gain

    @cached_property
    def _new(self) -> np.ndarray:
        """Standard deviation of what is new in a reading, (n,), in units of u."""
        return np.sqrt(self.own[self._order] / (1.0 - self._gain))

    @property
    def _kept(self) -> np.ndarray:
        return self.correlation * (1.0 - self._gain)

    @property
    def _taken(self) -> np.ndarray:
        return self.correlation * self._gain


@njit_kernel()
def _filter(own, is_first, law, gain):  # type: ignore[no-untyped-def]
    """Kalman's gain of each reading, from its own variance."""
    share, correlation = law
    variance = share
    for i in range(len(own)):
        if is_first[i]:
            variance = share
        gain[i] = variance / (variance + own[i])
        variance = share + correlation**2 * (variance * (1.0 - gain[i]) - share)


@njit_kernel()
def _run(given, made, steps, rule, state, begin, end):  # type: ignore[no-untyped-def]
    """The recursion of columns `begin` to `end`, some at once."""
    (order, own, of_state, kept, taken), (down, across) = rule, steps
    for first in range(begin, end, _AT_ONCE):
        last = min(first + _AT_ONCE, end)
        for i in range(len(order)):
            row = order[i] * down
            for column in range(first, last):
                value, before = given[row + column * across], state[column]
                made[row + column * across] = own[i] * value + of_state[i] * before
                state[column] = kept[i] * before + taken[i] * value
