"""How the uncertainty of a result is worked out."""

from enum import StrEnum

__all__ = ["UncertaintyMethod"]


class UncertaintyMethod(StrEnum):
    """Ways to a standard uncertainty."""

    FIRST_ORDER = "first-order"  #: the law of propagation, JCGM 100
    MONTE_CARLO = "monte-carlo"  #: propagation of distributions, JCGM 101
