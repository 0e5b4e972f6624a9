"""Waves fitted by least squares beside the alignment, many at once: frequencies uphill from peaks.

Source: M. Zechmeister and M. Kürster, Astron. Astrophys. 496 (2009) 577 (the frequency of least
squares, beside a mean; here beside the alignment).
"""

from __future__ import annotations

import numpy as np

__all__ = ["FINER", "WaveFits"]

#: frequencies of a periodogram in one of independent ones
FINER = 4
#: steps to the frequency of least squares, in cells of the periodogram; the last one turns a wave
#: by 1/64 over the whole way
_STEPS = (1.0, 0.25, 0.0625)
#: share of a wave's squares; what readings see beside the alignment below that is rounding: the
#: square of single precision, 1e-14, with room for few readings
_RCOND = 1e-9
#: turns that are worked on together, so few that they stay near the processor
_CACHED = 100_000


class WaveFits:
    """W waves, each along something of its own, in D directions that readings sense.

    Parameters
    ----------
    along : (W, m) float64
        What each goes along.
    sensed : (W, m, D) float64
        How readings sense a unit displacement, in their uncertainties.
    left : (W, m) float64
        What is not explained, in their uncertainties.
    alignment : (m, a) float64
        Orthonormal columns of the alignment.
    """

    def __init__(
        self, along: np.ndarray, sensed: np.ndarray, left: np.ndarray, alignment: np.ndarray
    ) -> None:
        self._along, self._directions = along, sensed.shape[2]
        shared = np.broadcast_to(alignment, (len(along), *alignment.shape))
        beside = np.concatenate([left[:, :, None], shared], axis=2)
        # products of a sine and a cosine with these are all that a frequency asks for
        self._squares = _products(sensed, sensed)
        self._beside = _products(sensed, beside)
        self._aligned = left @ alignment

    def refined(self, frequencies: np.ndarray, gains: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """The frequencies of least squares next to some, uphill in ever smaller steps, (W, F).

        To a sixteenth of a cell of the periodogram, so that what is found again is known.

        Parameters
        ----------
        frequencies, gains : (W, F) float64
            Where to start, and what is explained there.
        cells : (W,) float64
            Of the periodogram, in frequency.
        """
        best, most = np.zeros(frequencies.shape), gains.copy()
        for step in _STEPS:
            sides = np.multiply.outer([-step, step], np.ones(frequencies.shape))
            moving = np.ones(frequencies.shape, dtype=bool)
            while moving.any():
                some = np.flatnonzero(moving.any(axis=1))
                trials = np.clip(best[some] + sides[:, some], -FINER, FINER)
                asked = frequencies[some] + trials * cells[some, None]
                found = np.stack([self.gains(one, some) for one in asked])
                trial, gain, ahead = _of_highest(found, trials, found, sides[:, some])
                is_higher = moving[some] & (gain > most[some])
                best[some] = np.where(is_higher, trial, best[some])
                most[some] = np.where(is_higher, gain, most[some])
                moving[:] = False
                moving[some] = is_higher
                # on the other side it came from lower
                sides = sides[:1]
                sides[0, some] = ahead
        return frequencies + best * cells[:, None]

    def gains(self, frequencies: np.ndarray, waves: np.ndarray | None = None) -> np.ndarray:
        """Sums of squares that waves of F frequencies each explain beside the alignment, (w, F).

        Parameters
        ----------
        frequencies : (w, F) float64
        waves : (w,) int, optional
            Which waves are meant; all where left out.
        """
        waves = np.arange(len(frequencies)) if waves is None else waves
        many = max(_CACHED // (frequencies.shape[1] * self._along.shape[1]), 1)
        found = np.empty(frequencies.shape)
        for some in (slice(k, k + many) for k in range(0, len(waves), many)):
            products, moments = self._normal_equations(frequencies[some], waves[some])
            amounts = np.linalg.solve(products, moments[..., None])[..., 0]
            found[some] = np.sum(moments * amounts, axis=-1)
        return found

    def _normal_equations(
        self, frequencies: np.ndarray, waves: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Of sine and cosine beside the alignment, (w, F, 2 D, 2 D) and (w, F, 2 D)."""
        (some, count), wide = frequencies.shape, self._directions
        # of a part of a turn single precision is enough, and ten times as fast
        turns = frequencies[:, :, None] * self._along[waves, None]
        angle = (2.0 * np.pi * (turns - np.rint(turns))).astype(np.float32)
        sine, cosine = np.sin(angle).astype(np.float64), np.cos(angle).astype(np.float64)
        pairs = np.concatenate([sine * sine, sine * cosine, cosine * cosine], axis=1)
        pairs = (pairs @ self._squares[waves]).reshape(some, 3, count, wide, wide)
        ss, sc, cc = pairs.swapaxes(0, 1)
        products = np.block([[ss, sc], [sc, cc]])
        both = np.concatenate([sine, cosine], axis=1) @ self._beside[waves]
        both = both.reshape(some, 2, count, wide, -1).swapaxes(1, 2)
        both = both.reshape(some, count, 2 * wide, -1)
        seen, aligned = both[..., 0], both[..., 1:]
        least = _RCOND * np.trace(products, axis1=-2, axis2=-1)[..., None, None]
        products += np.maximum(least, 1e-300) * np.eye(2 * wide)
        products -= aligned @ aligned.swapaxes(-1, -2)
        return products, seen - (aligned @ self._aligned[waves][:, None, :, None])[..., 0]


def _of_highest(gains: np.ndarray, *values: np.ndarray) -> list[np.ndarray]:
    """Of values (S, w, F) those of the side, of S, with the largest gain, (w, F) each."""
    side = gains.argmax(axis=0)[None]
    return [np.take_along_axis(own, side, axis=0)[0] for own in values]


def _products(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Of the numbers (W, m, A) and (W, m, B) of the same reading, (W, m, A B)."""
    return (first[:, :, :, None] * second[:, :, None, :]).reshape(*first.shape[:2], -1)
