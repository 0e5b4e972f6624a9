"""Whether a value conforms, as far as its uncertainty lets it be told.

Source: ISO 14253-1:2017: conformance is proven where its probability is 95 % or more,
nonconformance likewise; a value between can prove neither. The value is taken as normal.
"""

from __future__ import annotations

import math
from enum import StrEnum

__all__ = ["PROBABILITY", "Verdict", "verdict", "verdict_of"]

#: default limit of probability of ISO 14253-1:2017
PROBABILITY = 0.95


class Verdict(StrEnum):
    """What can be said of a value and its limits."""

    CONFORMS = "conforms"
    FAILS = "does not conform"
    OPEN = "cannot be told"


def verdict(value: float, u: float, lower: float, upper: float) -> Verdict:
    """Judge a value with standard uncertainty `u`; limits may be infinite."""
    return verdict_of(_below(upper, value, u) - _below(lower, value, u))


def verdict_of(inside: float) -> Verdict:
    """Judge by the probability, 0 to 1, that the true value is within its limits."""
    if inside >= PROBABILITY:
        return Verdict.CONFORMS
    return Verdict.FAILS if 1.0 - inside >= PROBABILITY else Verdict.OPEN


def _below(limit: float, value: float, u: float) -> float:
    """Probability that the true value is not above a limit."""
    if math.isinf(limit):
        return 1.0 if limit > 0.0 else 0.0
    if u == 0.0:
        return 1.0 if value <= limit else 0.0
    return 0.5 * math.erfc((value - limit) / (u * math.sqrt(2.0)))
