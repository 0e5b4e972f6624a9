"""Clock: when each move starts and how long it takes.

Source: closed form derived here: a trapezoidal speed profile: v^2 = 2 a s; G95 feeds by rpm, G93
by minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode.errors import ProgramError
from gcode.state.codes import PATH_CONTROL

__all__ = ["Geometry", "MachineLimits", "durations"]


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
    corner_tolerance_mm : float
        How far corners may be rounded under G64 without P, and where no mode is given.
    """

    rapid_mm_per_min: float = 20000.0
    acceleration_mm_per_s2: float | None = None
    tool_change_s: float = 0.0
    rapid_deg_per_min: float = 3600.0
    corner_tolerance_mm: float = 0.01

    def __post_init__(self) -> None:
        for name in ("rapid_mm_per_min", "rapid_deg_per_min"):
            if not getattr(self, name) > 0.0:
                raise ProgramError(f"{name} is {getattr(self, name)}", accepted="a positive number")
        if self.acceleration_mm_per_s2 is not None and not self.acceleration_mm_per_s2 > 0.0:
            raise ProgramError(
                f"acceleration_mm_per_s2 is {self.acceleration_mm_per_s2}",
                accepted="a positive number, or None for infinite",
            )
        for name in ("tool_change_s", "corner_tolerance_mm"):
            if not getattr(self, name) >= 0.0:
                raise ProgramError(f"{name} is {getattr(self, name)}", accepted="0 or more")


@dataclass(frozen=True)
class Geometry:
    """Moves as far as the clock needs them; N moves, mm, rad, degrees.

    Attributes
    ----------
    start_mm, end_mm, centre_mm, axis : (N, 3) float64
        As in `Moves`.
    sweep_rad : (N,) float64
        As in `Moves`.
    turned_deg : (N,) float64
        Distance in A B C.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    centre_mm: np.ndarray
    axis: np.ndarray
    sweep_rad: np.ndarray
    turned_deg: np.ndarray

    def lengths(self) -> np.ndarray:
        """Length of straight moves and arcs, (N,) mm; spirals with the mean radius."""
        delta = self.end_mm - self.start_mm
        lengths = np.sqrt(np.einsum("ij,ij->i", delta, delta))
        arcs = np.flatnonzero(self.sweep_rad)
        if len(arcs):
            rise = np.einsum("ij,ij->i", delta[arcs], self.axis[arcs])
            radius = 0.5 * (self.radii(arcs, self.start_mm) + self.radii(arcs, self.end_mm))
            lengths[arcs] = np.hypot(radius * np.abs(self.sweep_rad[arcs]), rise)
        return lengths

    def _arms(self, arcs: np.ndarray, point: np.ndarray) -> np.ndarray:
        along = self.axis[arcs]
        arm = point[arcs] - self.centre_mm[arcs]
        return arm - along * np.einsum("ij,ij->i", arm, along)[:, None]

    def radii(self, arcs: np.ndarray, point: np.ndarray) -> np.ndarray:
        """Distance of one point a move, (M, 3) mm, from the axes of the moves `arcs`, (N,)."""
        return np.sqrt((self._arms(arcs, point) ** 2).sum(axis=1))

    def directions(self, point: np.ndarray) -> np.ndarray:
        """Unit direction of motion, (N, 3), at `point`, the start or the end of every move."""
        delta = self.end_mm - self.start_mm
        arcs = np.flatnonzero(self.sweep_rad)
        if len(arcs):
            along, sweep = self.axis[arcs], self.sweep_rad[arcs]
            rise = np.einsum("ij,ij->i", delta[arcs], along)
            turning = np.cross(along, self._arms(arcs, point)) * sweep[:, None]
            delta[arcs] = turning + along * rise[:, None]
        size = np.sqrt((delta**2).sum(axis=1))
        return delta / np.where(size > 0.0, size, 1.0)[:, None]


def durations(
    geometry: Geometry, feed_mm_per_min: np.ndarray, *, rapid: np.ndarray,
    path_control: np.ndarray, blend_mm: np.ndarray, limits: MachineLimits,
) -> np.ndarray:  # fmt: skip
    """Seconds that every move takes, (N,).

    The feed holds along X Y Z, or in degrees where only rotary axes move. With finite
    acceleration the speed follows a trapezoid between the corners.

    Parameters
    ----------
    geometry : Geometry
        The moves.
    feed_mm_per_min : (N,) float64
        Commanded speed; 0 where the axes stand.
    rapid : (N,) bool
        Which moves are rapids.
    path_control : (N,) int
        As in `gcode.state.codes.PATH_CONTROL`: exact path, exact stop; otherwise blending.
    blend_mm : (N,) float64
        P of G64: how far corners may be rounded; 0 leaves it to `limits`.
    limits : MachineLimits
        Drives.
    """
    lengths = geometry.lengths()
    distance = np.where((lengths > 1e-7) | rapid, lengths, geometry.turned_deg)
    if limits.acceleration_mm_per_s2 is None:
        with np.errstate(divide="ignore", invalid="ignore"):
            seconds = np.where(distance > 0.0, distance / feed_mm_per_min * 60.0, 0.0)
    else:
        seconds = _trapezoids(geometry, lengths, distance, feed=feed_mm_per_min / 60.0,
                              path_control=path_control, blend_mm=blend_mm,
                              limits=limits)  # fmt: skip
    turning = geometry.turned_deg / limits.rapid_deg_per_min * 60.0
    return np.where(rapid, np.maximum(seconds, turning), seconds)


def _trapezoids(
    geometry: Geometry, lengths: np.ndarray, distance: np.ndarray, *, feed: np.ndarray,
    path_control: np.ndarray, blend_mm: np.ndarray, limits: MachineLimits,
) -> np.ndarray:  # fmt: skip
    from gcode.moves.look_ahead import corner_speeds, travel_times  # loads the compiler

    acceleration = float(limits.acceleration_mm_per_s2)
    leaving = geometry.directions(geometry.end_mm)
    entering = geometry.directions(geometry.start_mm)
    tolerance = np.where(blend_mm > 0.0, blend_mm, limits.corner_tolerance_mm)
    tolerance[path_control == PATH_CONTROL["G61"]] = 0.0
    corners = corner_speeds(
        leaving,
        np.roll(entering, -1, axis=0),
        acceleration_mm_per_s2=acceleration,
        tolerance_mm=tolerance,
    )
    standing = (lengths <= 1e-7) | (feed <= 0.0)
    corners[(path_control == PATH_CONTROL["G61.1"]) | standing | np.roll(standing, -1)] = 0.0
    speeds = np.where(distance > 0.0, feed, 0.0)
    arcs = np.flatnonzero(geometry.sweep_rad)
    radii = np.minimum(geometry.radii(arcs, geometry.start_mm),
                       geometry.radii(arcs, geometry.end_mm))  # fmt: skip
    speeds[arcs] = np.minimum(speeds[arcs], np.sqrt(acceleration * radii))
    return travel_times(distance, speeds, corners, acceleration)
