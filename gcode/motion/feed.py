"""Feed of a block: whether there is one, and what F means in inverse time mode.

Source: NISTIR 6556 (RS274/NGC), G93; LinuxCNC, G-Codes.
"""

from __future__ import annotations

from gcode.errors import ProgramError
from gcode.state.block_values import Values
from gcode.state.controller import Controller

__all__ = ["check_feed", "set_inverse_time_feed"]


def check_feed(controller: Controller, block: Values, name: str) -> None:
    """Raise ProgramError where a feed move has no feed."""
    if controller.feed_mode == "inverse":
        if "f" not in block.words:
            raise ProgramError(
                f"{name} without F in inverse time mode (G93)", hint="every move needs its own F"
            )
        return
    if controller.feed == 0.0:
        raise ProgramError(f"{name} with feed zero", hint="give a feed first, for example F500")
    if controller.feed_mode == "revolution" and controller.speed == 0.0:
        raise ProgramError(
            f"{name} with feed per revolution and spindle speed zero", hint="give a speed with S"
        )


def set_inverse_time_feed(controller: Controller, block: Values, length: float) -> None:
    """G93: turn F (moves a minute) into a feed for a move of this length."""
    if controller.feed_mode != "inverse":
        return
    rate = 0.1 if length == 0.0 else length * block.words["f"]
    controller.queue.say(lambda: controller.record.set_feed(rate))
    controller.feed = rate
