"""Which model of the machine's errors is meant."""

from enum import StrEnum

__all__ = ["Variant"]


class Variant(StrEnum):
    """How the arms of angular errors are measured."""

    NONE = "none"  #: no machine error at all
    HTM = "htm"  #: from the origin of the machine
    ABBE = "abbe"  #: from the reflector of each measurement
