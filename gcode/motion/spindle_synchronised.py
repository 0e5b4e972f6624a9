"""Moves synchronised with the spindle: G33, G33.1 and the threading cycle G76.

Source: LinuxCNC, G-Codes: G33, G33.1, G76.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.motion.interpolation import block_end, traverse
from gcode.state.block_values import Values
from gcode.state.controller import Controller
from gcode.state.record import Call

__all__ = ["run_threading", "synchronised"]


def synchronised(controller: Controller, block: Values, motion: str) -> None:
    """G33 (one pass) and G33.1 (rigid tapping: to the end and back)."""
    controller.motion = motion
    controller.straight_only = False
    end = block_end(controller, block)
    controller.require_no_compensation(f"use {motion}")
    controller.require_spindle(motion)
    record, feed = controller.record, controller.record.feed_mm_per_min
    pitch_mm = abs(block.words["k"]) * controller.unit_mm
    record.feed_mm_per_min = pitch_mm * controller.speed
    if motion == "G33":
        traverse(controller, end, Call.FEED)
    else:
        record.straight(Call.TAP, end)
        controller.position[3:] = end[3:]
    record.feed_mm_per_min = feed


def run_threading(controller: Controller, block: Values) -> None:
    """G76: passes of increasing depth along X-Z, with taper and spring passes."""
    words = block.words
    controller.require_no_compensation("use G76")
    controller.motion = "G76"
    controller.straight_only = False
    end = block_end(controller, block)
    controller.require_spindle("G76")
    scale = 0.5 if controller.diameter_mode else 1.0
    i, j, k = (words[letter] * scale for letter in "ijk")
    if i == 0.0 or j <= 0.0 or k <= j or words["p"] <= 0.0:
        raise ProgramError(
            f"G76 with I{i:g} J{j:g} K{k:g} P{words['p']:g}",
            accepted="I offset, not 0; J first cut above 0; K full depth above J; P pitch above 0",
        )
    if end[3:] != controller.position[3:]:
        raise ProgramError("rotary axes in G76")
    thread = _Thread(controller, block, end, depths=(abs(i), abs(j), abs(k)), boring=i > 0.0)
    thread.run()
    traverse(controller, end)


class _Thread:
    """Geometry of one G76 block; depths are measured from the drive line."""

    def __init__(
        self, controller: Controller, block: Values, end: list[float], *,
        depths: tuple[float, float, float], boring: bool,
    ) -> None:  # fmt: skip
        words = block.words
        self.controller, self.end = controller, end
        self.start = list(controller.position)
        self.outer, self.cut, self.height = depths
        self.sign = 1.0 if boring else -1.0
        self.full = self.height + self.outer
        backwards = end[2] > self.start[2]
        angle = math.radians(words.get("q", 0.0))
        self.slope = math.tan(-angle if backwards else angle)
        self.spring = int(words.get("h", 0.0))
        self.degression = max(words.get("r", 1.0), 1.0)
        taper = max(words.get("e", 0.0), 0.0)
        pitch = words["p"]
        self.pitch = pitch
        self.taper_pitch = pitch * math.hypot(taper, self.height) / taper if taper else pitch
        self.taper = -taper if backwards else taper
        flags = int(words.get("l", 0.0))
        self.entry, self.exit = bool(flags & 1), bool(flags & 2)
        self.target_z = end[2] + self.height * self.slope

    def run(self) -> None:
        """All passes."""
        depth, count = self.outer + self.cut, 1
        while depth < self.full:
            self._pass(depth)
            count += 1
            if count > 100_000:
                raise ProgramError("G76 makes more than 100000 passes", hint="check J, K, R")
            depth = self.outer + self.cut * count ** (1.0 / self.degression)
        for _ in range(self.spring + 1):
            self._pass(self.full)

    def _go(self, call: Call, x: float, z: float, *, pitch: float = 0.0) -> None:
        record = self.controller.record
        end = list(self.controller.position)
        end[0], end[2] = x, z
        feed = record.feed_mm_per_min
        if call is Call.FEED:
            record.feed_mm_per_min = pitch * self.controller.unit_mm * self.controller.speed
        traverse(self.controller, end, call)
        record.feed_mm_per_min = feed

    def _pass(self, depth: float) -> None:
        x, z = self.start[0], self.start[2]
        offset = (depth - self.outer) * self.slope
        cutting = x + self.sign * depth
        clear, shallow = cutting - self.sign * self.full, cutting - self.sign * self.height
        target = self.target_z - offset
        self._go(Call.TRAVERSE, clear, z - offset)
        if self.taper and self.entry:
            self._go(Call.FEED, shallow, z - offset, pitch=self.taper_pitch)
            self._go(Call.FEED, cutting, z - offset - self.taper, pitch=self.taper_pitch)
        else:
            self._go(Call.TRAVERSE, cutting, z - offset)
        if self.taper and self.exit:
            self._go(Call.FEED, cutting, target + self.taper, pitch=self.pitch)
            self._go(Call.FEED, shallow, target, pitch=self.taper_pitch)
        else:
            self._go(Call.FEED, cutting, target, pitch=self.pitch)
        self._go(Call.TRAVERSE, clear, target)
