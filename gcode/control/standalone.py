"""Quirks of LinuxCNC's stand-alone interpreter, which a machine does not share.

That interpreter has no machine to ask. After a tool change it takes the last straight move's
coordinates for the position and reads the tool table anew. It keeps the number of the tool
offset when the unit changes. Only comparison with its output needs this (`preview`).
"""

from __future__ import annotations

from gcode.state.controller import Controller

__all__ = ["after_tool_change", "keep_tool_offset"]


def after_tool_change(controller: Controller) -> None:
    """Put position and tool table back to what the interpreter remembers."""
    controller.refresh = False
    controller.loaded = controller.tool
    if controller.preview:
        controller.position = list(controller.record.last_straight)
        controller.offsets = dict(controller.first_offsets)


def keep_tool_offset(controller: Controller, factor: float) -> None:
    """Undo the scaling of the tool offset by a change of units."""
    if controller.preview:
        controller.tool_offset[:3] = [v / factor for v in controller.tool_offset[:3]]
