"""The numbers of an effect: amplitudes, and parameters inside its law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["Parameter", "inner", "linear"]


@dataclass(frozen=True)
class Parameter:
    """A number of an effect; its unit stands at the end of its name.

    Attributes
    ----------
    name : str
    meaning : str
        What it is, for the documentation and for messages.
    low, high : float
        What is accepted.
    usual : float
        Usual size, in the parameter's unit. For amplitudes it sets the scale on which "no such
        effect" and "some of it" are weighed.
    grid : tuple of float
        Empty for an amplitude, which the displacement is proportional to. Otherwise the values
        that a fit starts from.
    spread : float
        Of an inner parameter: how far from the usual value it may well be, as the standard
        deviation of its logarithm; infinite where any value is as good as another.
    optional : bool
        Whether a job may leave it out; it then has its usual value.
    cycle : float
        Values this far apart mean the same, as with angles.
    is_size : bool
        A size in nature, which cannot be below zero.
    most : float
        The largest amount that nature has.
    at_most : str
        Name of another amplitude of the effect that nature does not let it exceed.
    is_essential : bool
        What makes the effect: without it the others describe something else.
    """

    name: str
    meaning: str
    low: float
    high: float
    usual: float
    grid: tuple[float, ...] = ()
    spread: float = math.inf
    optional: bool = False
    cycle: float = math.inf
    is_size: bool = False
    most: float = math.inf
    at_most: str = ""
    is_essential: bool = False

    @property
    def is_bounded(self) -> bool:
        """Whether nature sets bounds to an amplitude."""
        return self.is_size or math.isfinite(self.most) or bool(self.at_most)

    @property
    def is_linear(self) -> bool:
        """Whether the displacement is proportional to it."""
        return not self.grid


def linear(name: str, meaning: str, *, usual: float, is_size: bool = False) -> Parameter:
    """An amplitude up to a thousand times its usual size, of either sign where it is no size.

    Examples
    --------
    >>> import vmach
    >>> rise = vmach.linear("rise_um_per_m", "rise of the tool per metre along X", usual=10.0)
    >>> rise.is_linear, rise.low, rise.high
    (True, -10000.0, 10000.0)
    """
    most = 1000.0 * usual
    return Parameter(name, meaning, -most, most, usual, is_size=is_size)


def inner(
    name: str,
    meaning: str,
    grid: Sequence[float],
    *,
    usual: float,
    spread: float = 3.0,
    optional: bool = False,
    cycle: float = math.inf,
    within: tuple[float, float] | None = None,
) -> Parameter:
    """A parameter inside the function: time constant, pitch, exponent.

    Accepted `within` bounds; up to four times beyond the grid where none are given.

    Examples
    --------
    >>> import vmach
    >>> time = vmach.inner("time_constant_s", "of the warming", (300.0, 3000.0), usual=900.0)
    >>> time.is_linear, time.grid
    (False, (300.0, 3000.0))
    """
    values = tuple(float(value) for value in grid)
    low, high = within or (0.25 * min(values), 4.0 * max(values))
    if math.isfinite(cycle):
        low, high = -cycle, cycle
    return Parameter(name, meaning, low, high, usual, values, spread, optional, cycle)
