"""Clock: when each move starts and how long it takes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode.errors import ProgramError

__all__ = ["MachineLimits", "path_lengths"]


@dataclass(frozen=True)
class MachineLimits:
    """What the machine's drives can do.

    Attributes
    ----------
    rapid_mm_per_min : float
        Speed along the path of a rapid.
    acceleration_mm_per_s2 : float or None
        Along the path; None for infinite.
    tool_change_s : float
        Time that M6 takes.
    rapid_deg_per_min : float
        Speed of a rapid in which only rotary axes move.
    """

    rapid_mm_per_min: float = 20000.0
    acceleration_mm_per_s2: float | None = None
    tool_change_s: float = 0.0
    rapid_deg_per_min: float = 3600.0

    def __post_init__(self) -> None:
        for name in ("rapid_mm_per_min", "rapid_deg_per_min"):
            if not getattr(self, name) > 0.0:
                raise ProgramError(f"{name} is {getattr(self, name)}", accepted="a positive number")
        if self.acceleration_mm_per_s2 is not None and not self.acceleration_mm_per_s2 > 0.0:
            raise ProgramError(f"acceleration_mm_per_s2 is {self.acceleration_mm_per_s2}",
                               accepted="a positive number, or None for infinite")
        if not self.tool_change_s >= 0.0:
            raise ProgramError(f"tool_change_s is {self.tool_change_s}", accepted="0 or more")


def path_lengths(
    start_mm: np.ndarray, end_mm: np.ndarray, *, centre_mm: np.ndarray, axis: np.ndarray,
    sweep_rad: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Length of straight moves and arcs, (N,) mm; spirals with the mean radius."""
    delta = end_mm - start_mm
    lengths = np.sqrt(np.einsum("ij,ij->i", delta, delta))
    arcs = np.flatnonzero(sweep_rad)
    if len(arcs):
        along = axis[arcs]
        rise = np.einsum("ij,ij->i", delta[arcs], along)
        radii = []
        for point in (start_mm[arcs], end_mm[arcs]):
            arm = point - centre_mm[arcs]
            arm = arm - along * np.einsum("ij,ij->i", arm, along)[:, None]
            radii.append(np.sqrt(np.einsum("ij,ij->i", arm, arm)))
        lengths[arcs] = np.hypot(0.5 * (radii[0] + radii[1]) * np.abs(sweep_rad[arcs]), rise)
    return lengths
