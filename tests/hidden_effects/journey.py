"""The axes in a test without cutting: straight ways, circles and stops, as nodes in time."""

from __future__ import annotations

import numpy as np

from .program_writer import Path3

__all__ = ["Journey"]

#: nodes on a circle; readings lie between them, exactly on the circle
NODES_A_TURN = 360


class Journey:
    """A cold start at one place and everything after; positions are those of the nose, mm."""

    def __init__(self, start_mm: np.ndarray):
        self.here = np.asarray(start_mm, float)
        self.clock = 0.0
        self._nose, self._time, self._rpm = [self.here], [0.0], [0.0]

    @property
    def node(self) -> int:
        """Index of the last node."""
        return len(self._nose) - 1

    def go(self, target_mm: np.ndarray, *, feed_mm_min: float) -> None:
        """Straight, spindle at rest."""
        target = np.asarray(target_mm, float)
        self._put(target, float(np.linalg.norm(target - self.here)) / feed_mm_min * 60)

    def wait(self, seconds: float, *, rpm: float = 0.0) -> None:
        """Axes at rest."""
        self._put(self.here, seconds, rpm)

    def circle(self, centre_mm: np.ndarray, sweep_rad: float, *, feed_mm_min: float) -> tuple:
        """Round a centre in XY from here on; first and last node of it."""
        first, arm = self.node, self.here - centre_mm
        start, radius = np.arctan2(arm[1], arm[0]), np.hypot(*arm[:2])
        count = int(np.ceil(abs(sweep_rad) / 2 / np.pi * NODES_A_TURN))
        for k in range(1, count + 1):
            a = start + sweep_rad * k / count
            way = radius * abs(sweep_rad) / count
            nose = centre_mm + np.array([radius * np.cos(a), radius * np.sin(a), arm[2]])
            self._put(nose, way / feed_mm_min * 60)
        return first, self.node

    def path(self) -> Path3:
        """The nodes; nothing is cut, the tip is not asked for."""
        nose = np.array(self._nose)
        idle = np.zeros(len(nose), dtype=bool)
        return Path3(nose, nose, np.array(self._time), idle, np.array(self._rpm))

    def _put(self, nose: np.ndarray, seconds: float, rpm: float = 0.0) -> None:
        self.here, self.clock = nose, self.clock + seconds
        self._nose.append(nose)
        self._time.append(self.clock)
        self._rpm.append(rpm)
