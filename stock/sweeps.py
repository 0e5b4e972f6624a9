"""Sweeps: short pieces of displaced tool motion, what the removal engine works on."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from stock.errors import StockError

__all__ = ["Sweeps"]

_COLUMNS: dict[str, tuple[type, tuple[int, ...]]] = {
    "start_mm": (np.float64, (3,)),
    "end_mm": (np.float64, (3,)),
    "centre_mm": (np.float64, (3,)),
    "axis": (np.float64, (3,)),
    "sweep_rad": (np.float64, ()),
    "tool": (np.int32, ()),
    "move": (np.int64, ()),
    "shift_mm": (np.float64, (2, 3)),
    "shift_slope_mm": (np.float64, (2, 3)),
    "tilt_rad": (np.float64, (2, 3)),
    "tilt_slope_rad": (np.float64, (2, 3)),
}


@dataclass(frozen=True)
class Sweeps:
    """M elementary sweeps in cutting order, in workpiece coordinates, mm and rad.

    Let s go from 0 to 1 along a sweep. The nominal tool tip is on the straight line from
    `start_mm` to `end_mm`. Where `sweep_rad` is not zero, it is on the arc (helix, spiral) about
    `axis` through `centre_mm`. The displaced tool is the nominal one, axis along +Z of the
    workpiece frame, moved by a small rigid motion: the tool point c (from the tip) is at

        tip(s) + c + shift(s) + tilt(s) x c

    where shift and tilt are the cubic Hermite curves given by their values and their
    derivatives with respect to s at both ends.

    Attributes
    ----------
    start_mm, end_mm, centre_mm, axis : (M, 3) float64
        `centre_mm` at the axial height of the start; both zero for straight sweeps.
    sweep_rad : (M,) float64
        Signed angle about `axis`, right-handed; 0 for straight sweeps.
    tool : (M,) int32
        Index into the sequence of tools that goes with the sweeps.
    move : (M,) int64
        Which move of the program this sweep is a piece of.
    shift_mm, tilt_rad : (M, 2, 3) float64
        Displacement of the tip, and rotation vector of the tool about it, at s = 0 and s = 1.
    shift_slope_mm, tilt_slope_rad : (M, 2, 3) float64
        Their derivatives with respect to s at s = 0 and s = 1.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    centre_mm: np.ndarray
    axis: np.ndarray
    sweep_rad: np.ndarray
    tool: np.ndarray
    move: np.ndarray
    shift_mm: np.ndarray
    shift_slope_mm: np.ndarray
    tilt_rad: np.ndarray
    tilt_slope_rad: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.start_mm)
        for field in fields(self):
            dtype, tail = _COLUMNS[field.name]
            array = np.ascontiguousarray(getattr(self, field.name), dtype=dtype)
            if array.shape != (count, *tail):
                raise ValueError(
                    f"Sweeps.{field.name} has shape {array.shape}; expected {(count, *tail)}"
                )
            if dtype is np.float64 and not np.isfinite(array).all():
                raise ValueError(f"Sweeps.{field.name} holds values that are not finite")
            array.setflags(write=False)
            object.__setattr__(self, field.name, array)

    def __len__(self) -> int:
        return len(self.start_mm)

    def check_tools(self, tool_count: int) -> None:
        """Raise `StockError` where a sweep points to none of so many tools."""
        bad = np.flatnonzero((self.tool < 0) | (self.tool >= tool_count))
        if len(bad):
            raise StockError(
                f"sweep {bad[0]} (move {self.move[bad[0]]}) has tool {self.tool[bad[0]]}",
                accepted=f"0 to {tool_count - 1}" if tool_count else "no sweeps without tools",
            )

    def nominal_tip_at(self, sweep: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Tip without displacement, (P, 3) mm; arguments as in `displacement_at`."""
        s = parameter[:, None]
        start, end = self.start_mm[sweep], self.end_mm[sweep]
        tip = (1 - s) * start + s * end
        arcs = np.flatnonzero(self.sweep_rad[sweep] != 0)
        if arcs.size:
            tip[arcs] = self._tip_on_arc(sweep[arcs], parameter[arcs])
        tip[parameter == 1.0] = end[parameter == 1.0]
        return tip

    def _tip_on_arc(self, sweep: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        s, axis = parameter[:, None], self.axis[sweep]
        first = self.start_mm[sweep] - self.centre_mm[sweep]
        last = self.end_mm[sweep] - self.centre_mm[sweep]
        rise = np.einsum("ij,ij->i", last - first, axis)[:, None]
        radii = []
        for arm in (first, last):
            across = arm - np.einsum("ij,ij->i", arm, axis)[:, None] * axis
            radii.append(np.linalg.norm(across, axis=1, keepdims=True))
        scale = 1 + s * np.divide(radii[1], radii[0], out=np.ones_like(s), where=radii[0] > 0) - s
        angle = s * self.sweep_rad[sweep][:, None]
        turned = np.cos(angle) * first + np.sin(angle) * np.cross(axis, first)
        return self.centre_mm[sweep] + scale * turned + s * rise * axis

    def displacement_at(
        self, sweep: np.ndarray, parameter: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Shift (P, 3) mm and tilt (P, 3) rad at given places.

        Parameters
        ----------
        sweep : (P,) int
        parameter : (P,) float64
            From 0 at the start of the sweep to 1 at its end.
        """
        shift = _hermite(self.shift_mm[sweep], self.shift_slope_mm[sweep], parameter)
        tilt = _hermite(self.tilt_rad[sweep], self.tilt_slope_rad[sweep], parameter)
        return shift, tilt


def _hermite(values: np.ndarray, slopes: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Cubic with given values and derivatives (P, 2, 3) at 0 and 1."""
    s = parameter[:, None]
    rise = values[:, 1] - values[:, 0]
    start, end = slopes[:, 0] - rise, slopes[:, 1] - rise
    return values[:, 0] + s * rise + s * (1 - s) * ((1 - s) * start - s * end)
