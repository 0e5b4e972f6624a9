"""Strokes: straight pieces of displaced tool motion that the virtual part is cut with.

Source: closed form derived here: chords of an arc of radius r keep within r (1 - cos(a / 2)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stock.compiled import njit_maker, njit_part
from stock.sweeps import Sweeps

__all__ = ["Strokes", "strokes_of"]

#: a joint closer than this joins two strokes
JOINT_MM = 1e-9
#: nodes of a straight move are dropped where the displaced path stays within this of its chord
STRAIGHT_MM = 1e-4


@dataclass(frozen=True)
class Strokes:
    """S straight pieces in cutting order; the displaced tool goes linearly from start to end.

    Attributes
    ----------
    start_mm, end_mm : (S, 3) float64
        Displaced tool tip.
    start_tilt_rad, end_tilt_rad : (S, 3) float64
        Rotation vector of the tool about its tip.
    tool : (S,) int32
    move : (S,) int64
    joined : (S,) bool
        The stroke begins exactly where the one before ended, with the same tool.
    """

    start_mm: np.ndarray
    end_mm: np.ndarray
    start_tilt_rad: np.ndarray
    end_tilt_rad: np.ndarray
    tool: np.ndarray
    move: np.ndarray
    joined: np.ndarray

    def __len__(self) -> int:
        return len(self.start_mm)

    def only(self, kept: np.ndarray) -> Strokes:
        """Those of the strokes that are `kept`, (S,) bool; paths end where one is left out."""
        joined = self.joined.copy()
        joined[1:] &= kept[:-1]
        return Strokes(
            start_mm=self.start_mm[kept],
            end_mm=self.end_mm[kept],
            start_tilt_rad=self.start_tilt_rad[kept],
            end_tilt_rad=self.end_tilt_rad[kept],
            tool=self.tool[kept],
            move=self.move[kept],
            joined=joined[kept],
        )

    def before(self, i: int) -> np.ndarray:
        """Motion (3,) of the stroke that stroke i continues, zero where it begins a path."""
        if not self.joined[i]:
            return np.zeros(3)
        return self.end_mm[i - 1] - self.start_mm[i - 1]

    def ends(self, i: int) -> np.ndarray:
        """Whether stroke i begins and whether it ends a path, (2,) bool."""
        last = i + 1 == len(self) or not self.joined[i + 1]
        return np.array([not self.joined[i], last])


def strokes_of(sweeps: Sweeps, tolerance_mm: float) -> Strokes:
    """Straight strokes that follow the sweeps, arcs by chords of at most the given sagitta.

    Straight sweeps of one move are merged where their nodes lie on one line to `STRAIGHT_MM`.
    """
    pieces = _chords(sweeps, tolerance_mm)
    first = np.concatenate([[0], np.cumsum(pieces)])
    index = np.repeat(np.arange(len(sweeps)), pieces)
    begin = (np.arange(first[-1]) - first[index]) / pieces[index]
    end = (np.arange(first[-1]) - first[index] + 1) / pieces[index]
    start_mm, start_tilt = _placement(sweeps, index, begin)
    end_mm, end_tilt = _placement(sweeps, index, end)
    tool, move = sweeps.tool[index], sweeps.move[index]
    joined = np.zeros(len(index), dtype=bool)
    joined[1:] = (
        (np.abs(start_mm[1:] - end_mm[:-1]).max(axis=1) < JOINT_MM)
        & (np.abs(start_tilt[1:] - end_tilt[:-1]).max(axis=1) < JOINT_MM)
        & (tool[1:] == tool[:-1])
    )
    straight = sweeps.sweep_rad[index] == 0
    keep = _run_starts(
        np.hstack([start_mm, 100.0 * start_tilt]),
        np.hstack([end_mm, 100.0 * end_tilt]),
        move=move,
        mergeable=joined & straight,
    )
    last = np.concatenate([keep[1:], [len(index)]]) - 1 if len(keep) else keep
    return Strokes(
        start_mm=start_mm[keep],
        end_mm=end_mm[last],
        start_tilt_rad=start_tilt[keep],
        end_tilt_rad=end_tilt[last],
        tool=tool[keep],
        move=move[keep],
        joined=joined[keep],
    )


def _chords(sweeps: Sweeps, tolerance_mm: float) -> np.ndarray:
    """Number of straight pieces of each sweep."""
    radius = np.maximum(
        _distance_from_axis(sweeps, sweeps.start_mm), _distance_from_axis(sweeps, sweeps.end_mm)
    )
    ratio = np.clip(1 - tolerance_mm / np.maximum(radius, tolerance_mm), -1.0, 1.0)
    step = np.clip(2 * np.arccos(ratio), 1e-6, np.pi / 4)
    return np.maximum(np.ceil(np.abs(sweeps.sweep_rad) / step - 1e-9), 1).astype(np.int64)


def _distance_from_axis(sweeps: Sweeps, point_mm: np.ndarray) -> np.ndarray:
    arm = point_mm - sweeps.centre_mm
    along = np.einsum("ij,ij->i", arm, sweeps.axis)
    return np.linalg.norm(arm - along[:, None] * sweeps.axis, axis=1)


def _placement(sweeps: Sweeps, index: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displaced tip and tilt, each (P, 3), at parameter s (P,) of the sweeps `index` (P,)."""
    shift, tilt = sweeps.displacement_at(index, s)
    return sweeps.nominal_tip_at(index, s) + shift, tilt


@njit_maker()
def _run_starts(
    start: np.ndarray, end: np.ndarray, move: np.ndarray, mergeable: np.ndarray
) -> np.ndarray:
    """First piece of each run of pieces whose nodes lie on one chord."""
    first = np.empty(len(start), dtype=np.int64)
    runs = 0
    for i in range(len(start)):
        follows = i > 0 and mergeable[i] and move[i] == move[i - 1]
        if not (follows and _on_chord(start, end, first[runs - 1], i)):
            first[runs] = i
            runs += 1
    return first[:runs]


@njit_part()
def _on_chord(start: np.ndarray, end: np.ndarray, first: int, last: int) -> bool:
    """Whether the nodes between piece `first` and piece `last` lie on their common chord."""
    origin, target = start[first], end[last]
    squared = 0.0
    for n in range(3):
        squared += (target[n] - origin[n]) ** 2
    length = np.sqrt(squared)
    if length == 0.0:
        return False
    for k in range(first + 1, last + 1):
        along = 0.0
        for n in range(3):
            along += (start[k, n] - origin[n]) * (target[n] - origin[n])
        share = along / length**2
        for n in range(start.shape[1]):
            arm, chord = start[k, n] - origin[n], target[n] - origin[n]
            if abs(arm - share * chord) > STRAIGHT_MM:
                return False
    return True
