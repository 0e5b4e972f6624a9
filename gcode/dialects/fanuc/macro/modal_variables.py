"""System variables #4001 to #4120: the modes of the control (B-64484EN, "System variables")."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["modal_variables"]

_PLANES = {1: 17.0, 2: 19.0, 3: 18.0}
_FEED_MODES = {"minute": 94.0, "revolution": 95.0, "inverse": 93.0}
_SIDES = {0: 40.0, 1: 41.0, -1: 42.0}


def modal_variables(runner: BlockRunner) -> dict[int, Callable[[], float]]:
    """Number of the variable -> what gives its value at the time of reading."""
    c, offsets = runner.controller, runner.offsets
    return {
        4001: lambda: float((c.motion or "G0")[1:]),
        4002: lambda: _PLANES[c.plane],
        4003: lambda: 90.0 if c.absolute else 91.0,
        4005: lambda: _FEED_MODES[c.feed_mode],
        4006: lambda: 21.0 if c.unit_mm == 1.0 else 20.0,
        4007: lambda: _SIDES[c.side],
        4010: lambda: 98.0 if c.retract_to_initial else 99.0,
        4012: lambda: 53.0 + min(c.system, 6),
        4014: lambda: 53.0 + min(c.system, 6),
        4107: lambda: offsets.d or 0.0,
        4109: lambda: c.feed,
        4111: lambda: offsets.h or 0.0,
        4119: lambda: c.speed,
        4120: lambda: float(c.selected_tool or c.tool),
    }
