"""Whether a value that was read from JSON is a number."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["is_number"]


def is_number(value: Any, most: float) -> bool:
    """Whether a value of JSON is a finite number, at most so large."""
    is_one = isinstance(value, int | float) and not isinstance(value, bool)
    return is_one and math.isfinite(value) and abs(value) <= most
