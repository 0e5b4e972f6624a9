"""Canonical record to moves: frames, geometry of arcs, clock.

Source: NISTIR 6556 (RS274/NGC), canonical machining functions.
"""

from __future__ import annotations

import numpy as np

from gcode.errors import ProgramError
from gcode.moves.clock import Geometry, MachineLimits, durations
from gcode.moves.moves import MoveKind, Moves
from gcode.state.codes import PATH_CONTROL
from gcode.state.record import Call, Path, Record

__all__ = ["to_moves"]

#: An angle below this is a full circle rather than nothing, rad.
_FULL_CIRCLE = 1e-6
#: rows between two events from which on it is quicker to add to each stretch by itself
_LONG_STRETCH = 100

_KIND = {Call.TRAVERSE: MoveKind.RAPID, Call.FEED: MoveKind.LINE, Call.ARC: MoveKind.ARC,
         Call.DWELL: MoveKind.DWELL, Call.CHANGE_TOOL: MoveKind.DWELL, Call.PROBE: MoveKind.LINE,
         Call.TAP: MoveKind.LINE}  # fmt: skip


class _Modal:
    """Values of events as columns over the rows."""

    def __init__(self, record: Record, count: int) -> None:
        self.record, self.count = record, count

    def column(self, name: str, width: int = 1, *, skip: int = 0) -> np.ndarray:
        """(N, width) last values of an event before each row, zero before the first.

        Parameters
        ----------
        name : str
            Event.
        width : int
            How many values.
        skip : int
            How many values to leave out before them.
        """
        values, ends = self._stretches(name, width, skip)
        return np.repeat(values, np.diff(ends, prepend=0), axis=0)

    def add(self, name: str, rows: np.ndarray, *, skip: int = 0) -> None:
        """Add to every row (N, width) what `column` gives for it; nothing else is made."""
        values, ends = self._stretches(name, rows.shape[1], skip)
        if len(ends) * _LONG_STRETCH > self.count:
            rows += self.column(name, rows.shape[1], skip=skip)
            return
        for value, begin, end in zip(values, (0, *ends), ends, strict=False):
            rows[begin:end] += value

    def _stretches(self, name: str, width: int, skip: int) -> tuple[np.ndarray, np.ndarray]:
        """Values (K, width) of the stretches of rows between events, and where they end, (K,)."""
        at, told = self.record.events_of(name)
        values = np.zeros((len(at) + 1, width))
        if len(at):
            values[1:] = told[:, skip : skip + width]
        return values, np.concatenate((at, [self.count])).astype(np.int64)


def to_moves(record: Record, *, limits: MachineLimits, home_mm: np.ndarray | None) -> Moves:
    """Resolve a record to moves in machine coordinates.

    Parameters
    ----------
    record : Record
        Rows and events.
    limits : MachineLimits
        For the clock.
    home_mm : (3,) array or None
        Nose position at the start; None where it is unknown, then the first rapid starts where
        it ends.

    Raises
    ------
    ProgramError
        Where a move has no speed, so that it has no end.
    """
    path = record.path()
    count = len(path.call)
    modal = _Modal(record, count)
    offset = modal.column("tool_offset", 3)
    end, rotary = _machine_ends(path, modal)
    still = (path.call == Call.DWELL) | (path.call == Call.CHANGE_TOOL)
    start_point = _start_point(path, end, home_mm)
    _hold(end, still, start_point)
    _hold(rotary, still, np.zeros(3))
    points = np.concatenate((start_point[None], end))  # starts and ends share their memory
    start, end = points[:-1], points[1:]
    rotary_start = np.concatenate((np.zeros((1, 3)), rotary[:-1])) if count else rotary
    kind = np.array([_KIND[call] for call in Call], np.int8)[path.call]
    centre, axis, sweep = _arcs(record, modal, start=start, end=end, offset=offset)
    feed = np.where(kind == MoveKind.RAPID, limits.rapid_mm_per_min, path.feed_mm_per_min)
    feed[still] = 0.0
    turned = np.zeros(count)
    if rotary.any():
        turned = np.sqrt(((rotary - rotary_start) ** 2).sum(axis=1))
    path_control, tolerance = modal.column("path_control", 2).T
    duration = durations(Geometry(start, end, centre, axis, sweep, turned), feed,
                         rapid=kind == MoveKind.RAPID, path_control=path_control,
                         blend_mm=tolerance, limits=limits)  # fmt: skip
    _set_pauses(duration, record, path, limits)
    if not np.isfinite(duration).all():
        line = int(path.line[np.flatnonzero(~np.isfinite(duration))[0]])
        raise ProgramError(
            "move with feed zero never ends",
            line=line,
            hint="give the spindle a speed, or the move a feed",
        )
    return Moves(
        kind=kind,
        line=path.line,
        start_mm=start,
        end_mm=end,
        centre_mm=centre,
        axis=axis,
        sweep_rad=sweep,
        rotary_start_deg=rotary_start,
        rotary_end_deg=rotary,
        feed_mm_per_min=feed,
        spindle_rpm=modal.column("spindle")[:, 0],
        tool=modal.column("change_tool")[:, 0],
        tool_offset_mm=offset,
        work_offset=modal.column("set_g5x_offset")[:, 0],
        exact_stop=path_control == PATH_CONTROL["G61.1"],
        start_s=np.concatenate(([0.0], np.cumsum(duration)[:-1])) if count else duration,
        duration_s=duration,
    )


def _rotations(angle_deg: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))


def _machine_ends(path: Path, modal: _Modal) -> tuple[np.ndarray, np.ndarray]:
    """Ends in machine coordinates: R (program + G92) + G5x + tool offset."""
    point, rotary = _turned(modal, path.point_mm.copy(), slice(None)), path.rotary_deg.copy()
    modal.add("set_g92_offset", point)
    angle = modal.column("set_xy_rotation")[:, 0]
    if angle.any():
        cosine, sine = _rotations(angle)
        x, y = point[:, 0].copy(), point[:, 1].copy()
        point[:, 0] = x * cosine - y * sine
        point[:, 1] = x * sine + y * cosine
    modal.add("set_g5x_offset", point, skip=1)
    modal.add("tool_offset", point)
    for name, skip in (("set_g92_offset", 3), ("set_g5x_offset", 4), ("tool_offset", 3)):
        modal.add(name, rotary, skip=skip)
    return point, rotary


def _turned(modal: _Modal, point: np.ndarray, rows: slice | np.ndarray) -> np.ndarray:
    """Points after the mirror image and rotation of the programmable frame of their rows."""
    if not len(modal.record.events_of("set_turn")[0]):
        return point
    angle, x, y = modal.column("set_turn", 3)[rows].T
    x, y = np.where(x == 0.0, 1.0, x), np.where(y == 0.0, 1.0, y)
    quarter = np.round(angle / 90.0) * 90.0 == angle
    cosine, sine = _rotations(angle)
    cosine = np.where(quarter, np.round(cosine), cosine)
    sine = np.where(quarter, np.round(sine), sine)
    first, second = point[:, 0] * x, point[:, 1] * y
    return np.stack([first * cosine - second * sine, first * sine + second * cosine,
                     point[:, 2]], axis=1)  # fmt: skip


def _signs_of(modal: _Modal, rows: np.ndarray) -> np.ndarray:
    """Signs of the mirror images of X and Y in some rows, (K, 2)."""
    signs = modal.column("set_turn", 2, skip=1)[rows]
    return np.where(signs == 0.0, 1.0, signs)


def _start_point(path: Path, end: np.ndarray, home_mm: np.ndarray | None) -> np.ndarray:
    if home_mm is not None:
        return np.asarray(home_mm, np.float64)
    moving = np.flatnonzero((path.call != Call.DWELL) & (path.call != Call.CHANGE_TOOL))
    return end[moving[0]] if len(moving) else np.zeros(3)


def _hold(end: np.ndarray, still: np.ndarray, start: np.ndarray) -> None:
    """Give rows that stand still the end of the last row that moves."""
    rows, moving = np.flatnonzero(still), np.flatnonzero(~still)
    before = np.searchsorted(moving, rows)
    end[rows] = start
    end[rows[before > 0]] = end[moving[before[before > 0] - 1]]


def _arcs(
    record: Record, modal: _Modal, *, start: np.ndarray, end: np.ndarray, offset: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centre, axis and swept angle of every arc; zero elsewhere."""
    count = len(start)
    centre, axis, sweep = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count)
    table = record.arcs
    if not len(table):
        return centre, axis, sweep
    rows, plane = table[:, 0].astype(int), table[:, 1].astype(int)
    first = np.array([0, 0, 1, 2])[plane]
    normal = (first + 2) % 3
    along = np.zeros((len(rows), 3))
    along[np.arange(len(rows)), normal] = 1.0
    middle = np.zeros((len(rows), 3))
    middle[np.arange(len(rows)), first] = table[:, 4]
    middle[np.arange(len(rows)), (first + 1) % 3] = table[:, 5]
    middle = _turned(modal, middle, rows) + modal.column("set_g92_offset", 3)[rows]
    along = _turned(modal, along, rows)
    turns = table[:, 6] * np.prod(_signs_of(modal, rows), axis=1)
    cosine, sine = _rotations(modal.column("set_xy_rotation")[rows, 0])
    for vector in (middle, along):
        x, y = vector[:, 0].copy(), vector[:, 1].copy()
        vector[:, 0], vector[:, 1] = x * cosine - y * sine, x * sine + y * cosine
    middle += modal.column("set_g5x_offset", 3, skip=1)[rows] + offset[rows]
    rise = np.einsum("ij,ij->i", start[rows] - middle, along)
    middle += along * rise[:, None]
    centre[rows], axis[rows] = middle, along
    sweep[rows] = _sweeps(start[rows] - middle, end[rows] - middle, along=along, turns=turns)
    return centre, axis, sweep


def _sweeps(
    from_centre: np.ndarray, to_centre: np.ndarray, *, along: np.ndarray, turns: np.ndarray
) -> np.ndarray:
    """Signed swept angles, (K,) rad; start and end at one place make a full circle."""
    cross = np.einsum("ij,ij->i", np.cross(from_centre, to_centre), along)
    flat = to_centre - along * np.einsum("ij,ij->i", to_centre, along)[:, None]
    sense = np.sign(turns)
    angle = sense * np.arctan2(cross, np.einsum("ij,ij->i", from_centre, flat))
    angle = np.where(angle < _FULL_CIRCLE, angle + 2.0 * np.pi, angle)
    return sense * (angle + (np.abs(turns) - 1.0) * 2.0 * np.pi)


def _set_pauses(duration: np.ndarray, record: Record, path: Path, limits: MachineLimits) -> None:
    duration[path.call == Call.CHANGE_TOOL] = limits.tool_change_s
    dwells = record.dwells
    duration[dwells[:, 0].astype(np.int64)] = dwells[:, 1]
