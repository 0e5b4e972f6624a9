"""The motion of a test that is given by its readings: where, when, from which side.

Source: closed form derived here: an approach against the motion overruns and turns back.
"""

from __future__ import annotations

import numpy as np

from gcode import MoveKind, Moves
from vmach.path.toolpath import PathStates

__all__ = ["MotionRecord", "stop_and_go"]

#: how far an axis overruns to come from the side that the file states
_OVERRUN_MM = 2.0
#: no move takes less time, however close the readings are
_QUICKEST_S = 1e-3


class MotionRecord:
    """Moves written down one after the other; times in s from the cold start."""

    def __init__(
        self,
        start_mm: np.ndarray,
        *,
        tool_length_mm: float,
        start_s: float = 0.0,
        rotary_deg: np.ndarray | None = None,
    ) -> None:
        self._rows: list[dict] = []
        self._nose = np.asarray(start_mm, dtype=float)
        self._rotary = np.zeros(3) if rotary_deg is None else rotary_deg
        self._time = start_s
        self._length = tool_length_mm

    @property
    def nose_mm(self) -> np.ndarray:
        """Where the spindle nose is now, (3,)."""
        return self._nose

    def stand(self, *, until_s: float, rpm: float = 0.0) -> int:
        """The axes stand still; returns the move's index."""
        return self._add(MoveKind.DWELL, self._nose, until_s, rpm=rpm)

    def line(
        self, end_mm: np.ndarray, *, until_s: float, rotary_deg: np.ndarray | None = None
    ) -> int:
        """Straight to `end_mm` and to angles of A, B, C, (3,) each; returns the move's index."""
        return self._add(MoveKind.LINE, end_mm, until_s, rotary_deg=rotary_deg)

    def arc(
        self,
        end_mm: np.ndarray,
        *,
        centre_mm: np.ndarray,
        axis: np.ndarray,
        sweep_rad: float,
        until_s: float,
    ) -> int:
        """Along a circle, to `end_mm` about `centre_mm`, (3,) each; returns the move's index."""
        return self._add(
            MoveKind.ARC, end_mm, until_s, centre_mm=centre_mm, axis=axis, sweep_rad=sweep_rad
        )

    def _add(self, kind, end_mm, until_s, *, rpm=0.0, centre_mm=None, axis=None, sweep_rad=0.0,
             rotary_deg=None):  # fmt: skip
        until_s = max(until_s, self._time + _QUICKEST_S)
        rotary_deg = self._rotary if rotary_deg is None else rotary_deg
        end = np.asarray(end_mm, dtype=float)
        self._rows.append(
            {
                "kind": kind,
                "start_mm": self._nose,
                "end_mm": end,
                "centre_mm": np.zeros(3) if centre_mm is None else centre_mm,
                "axis": np.zeros(3) if axis is None else axis,
                "sweep_rad": sweep_rad,
                "rotary_start_deg": self._rotary,
                "rotary_end_deg": rotary_deg,
                "spindle_rpm": rpm,
                "start_s": self._time,
                "duration_s": until_s - self._time,
            }
        )
        self._nose, self._time, self._rotary = end, until_s, rotary_deg
        return len(self._rows) - 1

    def states(self, move: np.ndarray, parameter: np.ndarray) -> PathStates:
        """States at moves and parameters, both (P,); the reading is taken at the tool's tip."""
        rows, count = self._rows, len(self._rows)

        def column(name: str) -> np.ndarray:
            return np.array([row[name] for row in rows])

        offset = np.zeros((count, 3))
        offset[:, 2] = self._length
        moves = Moves(
            **{name: column(name) for name in rows[0]},
            line=np.arange(1, count + 1),
            feed_mm_per_min=np.zeros(count),
            tool=np.ones(count),
            tool_offset_mm=offset,
            work_offset=np.ones(count),
            exact_stop=np.ones(count),
        )
        return PathStates(
            moves=moves,
            tool_lengths_mm=np.array([np.nan, self._length]),
            move=np.asarray(move, dtype=np.int64),
            parameter=np.asarray(parameter, dtype=float),
            contact_mm=np.zeros((len(move), 3)),
        )


def stop_and_go(
    nose_mm: np.ndarray,
    time_s: np.ndarray,
    *,
    side: np.ndarray,
    tool_length_mm: float,
    rpm: np.ndarray | None = None,
    rotary_deg: np.ndarray | None = None,
) -> PathStates:
    """States at positions that the machine drives to and stands at while the reading is taken.

    Parameters
    ----------
    nose_mm : (P, 3) float64
    time_s : (P,) float64
        When each reading is taken.
    side : (P, 3) float64
        Sign of the last motion of each axis; 0 where it is not known. Where the way from the
        position before comes from the other side, the axis overruns and turns back.
    tool_length_mm : float
    rpm : (P,) float64, optional
        Spindle speed at the reading and until the next one; it stands where left out.
    rotary_deg : (P, 3) float64, optional
        Angles of A, B and C at the readings, which turn on the way; zero where left out.
    """
    rpm = np.zeros(len(time_s)) if rpm is None else rpm
    angle = np.zeros_like(nose_mm) if rotary_deg is None else rotary_deg
    record = MotionRecord(nose_mm[0], tool_length_mm=tool_length_mm, rotary_deg=angle[0])
    last_side = np.zeros(3)
    stops = np.empty(len(time_s), dtype=np.int64)
    for k, (nose, wanted) in enumerate(zip(nose_mm, side, strict=True)):
        way = nose - record.nose_mm
        natural = np.where(way != 0, np.sign(way), last_side)
        wrong = (wanted != 0) & (natural != wanted)
        arrival = float(time_s[k])
        begin = time_s[k - 1] if k else arrival
        if wrong.any():
            around = nose - np.where(wrong, wanted, 0.0) * _OVERRUN_MM
            record.line(around, until_s=begin + 0.8 * (arrival - begin))
        if wrong.any() or way.any() or (k and (angle[k] != angle[k - 1]).any()):
            record.line(nose, until_s=arrival, rotary_deg=angle[k])
        last_side = np.where(wrong, wanted, natural)
        leave = time_s[k + 1] if k + 1 < len(time_s) else arrival + 1.0
        still = not np.any(nose_mm[min(k + 1, len(nose_mm) - 1)] != nose)
        stops[k] = record.stand(
            until_s=arrival + (1.0 if still else 0.2) * (leave - arrival), rpm=rpm[k]
        )
    return record.states(stops, np.zeros(len(stops)))
