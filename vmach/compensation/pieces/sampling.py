"""The error along every move that the program makes, at places close enough to see it bend.

Source: closed form derived here: sagitta between samples from second differences.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gcode import MoveKind, Moves
from stock.compiled import njit_kernel
from vmach.path.geometry import move_length_mm

__all__ = ["ErrorAlongMoves", "sample_error"]

#: first distance of the places; where the error bends, they move closer by this factor, so often
_SPACING_MM = 1.0
_CLOSER = 4
_TIMES = 2
#: fewest intervals of an arc; a multiple of two, so that there is a middle
_FEWEST_ON_ARC = 32

#: error of the tool at moves and parameters, (P, 3) mm
ErrorAt = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class ErrorAlongMoves:
    """Samples of M moves, one after the other.

    Attributes
    ----------
    move : (M,) int64
        Rows of the nominal moves.
    length_mm : (M,) float64
    first : (M + 1,) int64
        Samples of move k are ``first[k]`` to ``first[k + 1] - 1``, equally spaced.
    parameter : (P,) float64
    error_mm : (P, 3) float64
    """

    move: np.ndarray
    length_mm: np.ndarray
    first: np.ndarray
    parameter: np.ndarray
    error_mm: np.ndarray

    def of(self, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Parameters, (S,), and errors, (S, 3) mm, of one move."""
        part = slice(self.first[index], self.first[index + 1])
        return self.parameter[part], self.error_mm[part]

    def off_chord_mm(self) -> np.ndarray:
        """Largest distance of every move's error from the straight line between its ends, (M,)."""
        found = np.zeros(len(self.move))
        _fill_off_chord(self.first, self.parameter, self.error_mm, found)
        return found

    def largest_mm(self) -> np.ndarray:
        """Largest component of every move's error, (M,)."""
        found = np.zeros(len(self.move))
        _fill_largest(self.first, self.error_mm, found)
        return found

    def bend_mm(self) -> np.ndarray:
        """Largest sagitta between neighbouring samples of every move, (M,)."""
        found = np.zeros(len(self.move))
        _fill_bend(self.first, self.error_mm, found)
        return found


@njit_kernel()
def _fill_off_chord(first, parameter, error, found):
    for k in range(len(found)):
        start, last = first[k], first[k + 1] - 1
        for i in range(start, last + 1):
            square = 0.0
            for j in range(3):
                chord = error[start, j] + parameter[i] * (error[last, j] - error[start, j])
                square += (error[i, j] - chord) ** 2
            found[k] = max(found[k], math.sqrt(square))


@njit_kernel()
def _fill_largest(first, error, found):
    for k in range(len(found)):
        for i in range(first[k], first[k + 1]):
            for j in range(3):
                found[k] = max(found[k], abs(error[i, j]))


@njit_kernel()
def _fill_bend(first, error, found):
    for k in range(len(found)):
        for i in range(first[k] + 1, first[k + 1] - 1):
            square = 0.0
            for j in range(3):
                on, back = error[i + 1, j] - error[i, j], error[i, j] - error[i - 1, j]
                square += (on - back) ** 2
            found[k] = max(found[k], math.sqrt(square) / 8.0)


def sample_error(
    moves: Moves, used: np.ndarray, error_at: ErrorAt, *, tolerance_mm: float
) -> ErrorAlongMoves:
    """Sample the error of the moves `used`, (U,), straight between samples within a thirtieth."""
    length = move_length_mm(moves)[used]
    count = np.maximum(np.ceil(0.5 * length / _SPACING_MM).astype(np.int64), 1) * 2
    count = np.where(moves.kind[used] == MoveKind.ARC, np.maximum(count, _FEWEST_ON_ARC), count)
    count[(moves.kind[used] == MoveKind.RAPID) | (length == 0)] = 1
    found = _sampled(used, length, count, error_at)
    for _ in range(_TIMES):
        bent = found.bend_mm() > tolerance_mm / 30.0
        if not bent.any():
            break
        count = np.where(bent, count * _CLOSER, count)
        found = _sampled(used, length, count, error_at)
    return found


def _sampled(
    used: np.ndarray, length: np.ndarray, count: np.ndarray, error_at: ErrorAt
) -> ErrorAlongMoves:
    first = np.concatenate([[0], np.cumsum(count + 1)])
    parameter = np.arange(first[-1], dtype=np.float64)  # in place: there are many samples
    parameter -= np.repeat(first[:-1], count + 1)
    parameter /= np.repeat(count, count + 1)
    error = error_at(np.repeat(used, count + 1), parameter)
    return ErrorAlongMoves(used, length, first, parameter, error)
