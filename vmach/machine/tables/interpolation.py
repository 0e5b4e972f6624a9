"""Curves through the points of an error table; every method ends as one piecewise cubic.

One form for all methods keeps evaluation fast and simple. Linear, PCHIP and splines are piecewise
cubics already; Legendre and Fourier series are sampled finely enough that the cubics between the
samples follow them within 1e-7 of their amplitude.

Source: F. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300 (PCHIP); C. de Boor, A
Practical Guide to Splines (1978).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts are loaded when they are first used
from numpy.polynomial import Legendre

from vmach.errors import InputError

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

__all__ = ["LINEAR", "Extrapolation", "Interpolation", "Method", "PiecewiseCubic"]


class Method(StrEnum):
    """How an error is found between the positions where it was measured."""

    LINEAR = "linear"
    PCHIP = "pchip"  #: cubic, keeps monotonic stretches monotonic
    CUBIC = "cubic"  #: spline through every point
    SMOOTHING = "smoothing"  #: spline near the points, smoothness by generalised cross-validation
    LEGENDRE = "legendre"  #: polynomial of degree `order`, least squares
    FOURIER = "fourier"  #: line and `order` harmonics of `period_mm`, least squares


class Extrapolation(StrEnum):
    """What holds beyond the ends of a table."""

    REFUSE = "refuse"  #: an error that names component, position and range
    HOLD = "hold"  #: the value at the end
    LINEAR = "linear"  #: on along the tangent at the end


@dataclass(frozen=True)
class PiecewiseCubic:
    """A curve of cubic pieces, with one piece more beyond either end.

    Attributes
    ----------
    breaks : (K,) float64
        Increasing positions. Piece 0 lies below ``breaks[0]``, piece k between
        ``breaks[k - 1]`` and ``breaks[k]``, piece K beyond the last.
    coefficients : (K + 1, 4) float64
        ``y = sum_n coefficients[k, n] (x - origin_k)^n`` with origin_0 = ``breaks[0]`` and
        origin_k = ``breaks[k - 1]``.
    """

    breaks: np.ndarray
    coefficients: np.ndarray

    @property
    def origins(self) -> np.ndarray:
        """Where each piece's local coordinate is zero, (K,): at its break."""
        return np.concatenate((self.breaks[:1], self.breaks))

    def __call__(self, position: np.ndarray) -> np.ndarray:
        """Value at the positions, same shape."""
        piece = np.searchsorted(self.breaks, position, side="right")
        local = position - self.origins[piece]
        c = self.coefficients[piece]
        return c[..., 0] + local * (c[..., 1] + local * (c[..., 2] + local * c[..., 3]))

    def on(self, breaks: np.ndarray) -> PiecewiseCubic:
        """The same curve on finer breaks, (K,), which include those of this curve."""
        origins = np.concatenate((breaks[:1], breaks))
        inside = np.concatenate(([breaks[0] - 1.0], breaks))
        piece = np.searchsorted(self.breaks, inside, side="right")
        h = (origins - self.origins[piece])[:, None]
        c0, c1, c2, c3 = np.split(self.coefficients[piece], 4, axis=1)
        moved = (c0 + h * (c1 + h * (c2 + h * c3)), c1 + h * (2 * c2 + 3 * h * c3), c2 + 3 * h * c3)
        return PiecewiseCubic(breaks, np.hstack((*moved, c3)))


@dataclass(frozen=True)
class Interpolation:
    """A method with its parameters.

    Attributes
    ----------
    method : Method
    order : int or None
        Degree of the Legendre polynomial, number of Fourier harmonics.
    period_mm : float or None
        Longest period of the Fourier series; the length of the table by default.
    """

    method: Method = Method.LINEAR
    order: int | None = None
    period_mm: float | None = None

    def __str__(self) -> str:
        return self.method if self.order is None else f"{self.method}({self.order})"

    def fit(
        self, position: np.ndarray, value: np.ndarray, extrapolation: Extrapolation
    ) -> PiecewiseCubic:
        """Curve through or near the points.

        Parameters
        ----------
        position : (K,) float64
            Increasing.
        value : (K,) float64
        extrapolation : Extrapolation
            `REFUSE` gives the same curve as `HOLD`; refusing is up to the caller, who knows
            which positions are asked for.

        Raises
        ------
        InputError
            Too few points for the method, or an order that is missing or too high.
        """
        return _with_ends(_FITS[self.method](self, position, value), extrapolation)

    def _checked_order(self, count: int, points: int) -> int:
        """The order, where `count` coefficients for each do not exceed the points."""
        if self.order is None or self.order < 1:
            raise InputError(
                f"interpolation '{self.method}' with order {self.order}",
                accepted="order = 1, 2 ...",
            )
        if count > points:
            raise InputError(
                f"interpolation '{self}' needs {count} points, the table has {points}",
                hint="a lower order, or 'pchip'",
            )
        return self.order


LINEAR = Interpolation()


@dataclass(frozen=True)
class _Lines:
    """What `_with_ends` asks of a curve, of straight lines: SciPy takes a while to load.

    Attributes
    ----------
    x : (K,) float64
    c : (2, K - 1) float64
        Slope and first value of each.
    """

    x: np.ndarray
    c: np.ndarray

    def __call__(self, position: np.ndarray) -> np.ndarray:
        """Values at positions of the table, (P,)."""
        piece = np.clip(np.searchsorted(self.x, position, side="right") - 1, 0, len(self.x) - 2)
        return self.c[1, piece] + self.c[0, piece] * (position - self.x[piece])

    def derivative(self) -> _Lines:
        """Their slopes, without a slope of their own."""
        return _Lines(self.x, np.stack([np.zeros_like(self.c[0]), self.c[0]]))


def _linear(_: Interpolation, position: np.ndarray, value: np.ndarray) -> _Lines:
    return _Lines(position, np.array([np.diff(value) / np.diff(position), value[:-1]]))


def _pchip(_: Interpolation, position: np.ndarray, value: np.ndarray) -> PPoly:
    return scipy.interpolate.PchipInterpolator(position, value)


def _cubic(_: Interpolation, position: np.ndarray, value: np.ndarray) -> PPoly:
    return scipy.interpolate.CubicSpline(position, value)


def _smoothing(_: Interpolation, position: np.ndarray, value: np.ndarray) -> PPoly:
    if len(position) < 5:
        raise InputError(f"interpolation 'smoothing' needs 5 points, the table has {len(position)}")
    # SciPy searches its smoothing parameter in bounds meant for steps of about one
    step = (position[-1] - position[0]) / (len(position) - 1)
    smooth = scipy.interpolate.make_smoothing_spline((position - position[0]) / step, value)
    curve = scipy.interpolate.PPoly.from_spline(smooth)
    powers = np.arange(len(curve.c))[::-1, None]
    return scipy.interpolate.PPoly(curve.c / step**powers, position[0] + step * curve.x)


def _legendre(chosen: Interpolation, position: np.ndarray, value: np.ndarray) -> PPoly:
    count = 1 + (chosen.order or 0)
    degree = chosen._checked_order(count, len(position))
    series = Legendre.fit(position, value, degree)
    return _sampled(series, series.deriv(), position, pieces=64 * degree)


def _fourier(chosen: Interpolation, position: np.ndarray, value: np.ndarray) -> PPoly:
    harmonics = chosen._checked_order(2 + 2 * (chosen.order or 0), len(position))
    low, length = position[0], position[-1] - position[0]
    period = chosen.period_mm or length
    waves = 2.0 * np.pi / period * np.arange(1, harmonics + 1)

    def basis(x: np.ndarray) -> np.ndarray:
        phase = (x - low)[:, None] * waves
        return np.column_stack((np.ones_like(x), (x - low) / length, np.cos(phase), np.sin(phase)))

    def slopes(x: np.ndarray) -> np.ndarray:
        phase = (x - low)[:, None] * waves
        line = np.full_like(x, 1.0 / length)
        return np.column_stack(
            (np.zeros_like(x), line, -waves * np.sin(phase), waves * np.cos(phase))
        )

    # the shortest solution: a harmonic that the positions cannot tell from the line stays small
    weights = np.linalg.lstsq(basis(position), value, rcond=None)[0]
    pieces = int(np.ceil(64 * harmonics * max(1.0, length / period)))
    return _sampled(
        lambda x: basis(x) @ weights, lambda x: slopes(x) @ weights, position, pieces=pieces
    )


def _sampled(curve: Callable, slope: Callable, position: np.ndarray, *, pieces: int) -> PPoly:
    """Cubics with the values and slopes of a smooth curve at the ends of equal pieces."""
    x = np.linspace(position[0], position[-1], pieces + 1)
    return scipy.interpolate.CubicHermiteSpline(x, curve(x), slope(x))


def _with_ends(curve: PPoly | _Lines, extrapolation: Extrapolation) -> PiecewiseCubic:
    """Lowest power first, and one piece added beyond either end."""
    inner = np.zeros((len(curve.x) - 1, 4))
    inner[:, : len(curve.c)] = curve.c[::-1].T
    keep = np.diff(curve.x) > 0  # splines repeat their end knots
    breaks = np.append(curve.x[:-1][keep], curve.x[-1])
    ends = np.zeros((2, 4))
    ends[:, 0] = curve(breaks[[0, -1]])
    if extrapolation is Extrapolation.LINEAR:
        ends[:, 1] = curve.derivative()(breaks[[0, -1]])
    return PiecewiseCubic(breaks, np.vstack((ends[:1], inner[keep], ends[1:])))


_FITS: dict[Method, Callable[[Interpolation, np.ndarray, np.ndarray], PPoly | _Lines]] = {
    Method.LINEAR: _linear,
    Method.PCHIP: _pchip,
    Method.CUBIC: _cubic,
    Method.SMOOTHING: _smoothing,
    Method.LEGENDRE: _legendre,
    Method.FOURIER: _fourier,
}
