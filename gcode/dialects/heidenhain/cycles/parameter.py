"""The Q parameters that a cycle was defined with."""

from __future__ import annotations

from collections.abc import Mapping

from gcode.errors import ProgramError

__all__ = ["cycle_parameter"]


def cycle_parameter(
    data: Mapping[str, float], cycle: int, number: int, default: float | None = None
) -> float:
    """A parameter by its number; raises ProgramError where it is missing and has no default."""
    value = data.get(str(number), default)
    if value is None:
        raise ProgramError(f"Q{number} of cycle {cycle} is missing")
    return value
