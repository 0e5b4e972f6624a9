"""Fanuc's blocks in the fast lane."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.cycles import DrillingCycle
from gcode.fast.fast_lane import FastLane
from gcode.fast.lane_state import give_back, hand_over

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["FanucLane"]


class FanucLane(FastLane):
    """Compiled reading of one program.

    Parameters
    ----------
    blocks : BlockRunner
        What it remembers beside the controller is handed over as well.
    data : bytes
        The program.
    """

    is_sequential = True

    def __init__(self, blocks: BlockRunner, data: bytes) -> None:
        super().__init__(blocks.controller, data)
        self.blocks = blocks

    def hand_over(self) -> bool:
        """Put the state of controller and blocks into the record."""
        blocks, s = self.blocks, self.state[0]
        cycle, controller, settings = blocks.cycle, self.controller, blocks.settings
        if controller.trace is not None:
            return False
        if not blocks.is_plain or (cycle is not None and cycle.words.keys() - {"q"}):
            return False
        if not hand_over(controller, self.state):
            return False
        unit_mm = controller.unit_mm
        s["h"] = math.nan if blocks.offsets.h is None else blocks.offsets.h
        s["length_sign"] = blocks.offsets.length_sign
        s["increment"] = blocks.increments.of("x", unit_mm=unit_mm)
        s["degree_increment"] = blocks.increments.of("a", unit_mm=unit_mm)
        s["takes_pointless"] = blocks.takes_pointless
        s["peck_clearance"] = settings.peck_clearance_mm / unit_mm
        s["pointed_p_is_seconds"] = settings.pointed_p_is_seconds
        s["dwell_p_s"] = settings.dwell_p_s
        s["repeats_in_k"] = not settings.haas_cycles
        s["cycle"] = 0 if cycle is None else round(10.0 * cycle.code)
        if cycle is not None:
            s["cycle_initial"], s["cycle_p"] = cycle.initial, cycle.dwell_s
            s["cycle_r"] = math.nan if cycle.r is None else cycle.r
            s["cycle_bottom"] = math.nan if cycle.bottom is None else cycle.bottom
            s["cycle_q"] = cycle.words.get("q", math.nan)
        return True

    def give_back(self) -> None:
        """Take the state of controller and blocks over from the record."""
        give_back(self.controller, self.state)
        blocks, s = self.blocks, self.state[0]
        h = float(s["h"])
        blocks.offsets.h = None if math.isnan(h) else h
        blocks.offsets.length_sign = int(s["length_sign"])
        blocks.cycle = None
        if s["cycle"]:
            r, bottom, q = (float(s["cycle_" + name]) for name in ("r", "bottom", "q"))
            cycle = DrillingCycle(int(s["cycle"]) / 10.0, float(s["cycle_initial"]), None)
            cycle.r = None if math.isnan(r) else r
            cycle.bottom = None if math.isnan(bottom) else bottom
            cycle.dwell_s = float(s["cycle_p"])
            cycle.words = {} if math.isnan(q) else {"q": q}
            blocks.cycle = cycle
