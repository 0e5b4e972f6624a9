"""Lengths between places of the part, as callipers give them: a square's sides and diagonals.

Source: closed form derived here: a length between two places that move by e1 and e2 grows by
(e2 - e1) . n along its direction n. A square's diagonals tell skew, as printers' firmware
calculates it (Marlin, ``Configuration.h``, "Bed Skew Compensation"; Klipper, "Skew correction").
"""

import numpy as np
from scipy.sparse import csr_array

from gcode import MoveKind
from vmach.base.note import Note, in_file
from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.files.toml_file import NonNegative, Positive
from vmach.instruments.drawing import against, end_of_scale
from vmach.measurements import Contacts, Measurement
from vmach.measurements.columns import Columns
from vmach.measurements.instrument import Instrument, ModelOfTest
from vmach.measurements.plausibility.motion_check import check_travel
from vmach.measurements.plausibility.motion_doubts import inch_notes
from vmach.path.instrument_motion import stop_and_go

__all__ = ["Calliper"]

#: shorter lengths say nothing of a direction, and a longer error is another length, mm
_SHORTEST_MM, _FARTHEST_MM = 1.0, 3.0
#: one place after the other
_PACE_S = 60.0


class Calliper(Instrument):
    """Lengths from place to place, whatever made the places: the machine's geometry alone.

    All lengths may be off by the same amount: the zero of the callipers, a tool that is too large.
    """

    name = "calliper"
    title = "Calliper lengths"
    columns = ("x1", "y1", "x2", "y2", "length_mm")
    optional_columns = ("id", "z1", "z2")
    text_columns = ("id",)
    follows_program = True
    readings = ("length_mm",)
    sign_meaning = "a deviation is the measured length minus the nominal one"
    left_free = "an offset that all lengths share"

    tool_length_mm: Positive
    u_um: Positive
    scale_u_ppm: NonNegative = 0.0

    def read(self, table, model):
        ends = [_places(table, k) + model.preparation.zero_mm for k in "12"]
        way = ends[1] - ends[0]
        nominal = np.linalg.norm(way, axis=1)
        apart = table.numbers["length_mm"] - nominal
        _check(table, nominal, apart)
        count = len(nominal)
        nose = np.vstack(ends)
        nose[:, 2] += self.tool_length_mm
        check_travel(nose, _twice(table), model.travel_mm)
        along = way / nominal[:, None]
        states = stop_and_go(
            nose,
            _PACE_S * np.arange(len(nose)),
            side=np.zeros_like(nose),
            tool_length_mm=self.tool_length_mm,
        )
        contacts = Contacts(states, _shares(along))
        return Measurement(
            instrument=type(self),
            name=table.path.name,
            id=table.text.get("id", np.arange(1, count + 1).astype(str)),
            states=states[np.arange(count)],
            sensing=along,
            measured_mm=apart,
            predicted_mm=contacts.sensed(model.moved_mm(states)[:, :, None])[:, 0],
            u_mm=np.full(count, mm_from_um(self.u_um)),
            group=np.full(count, "lengths"),
            nuisance=np.ones((count, 1)),
            notes=in_file(_doubts(np.vstack(ends), model), table.path),
            contacts=contacts,
            scale_u_mm=1e-6 * self.scale_u_ppm * nominal,
        )

    @classmethod
    def blocks(cls, measurement):
        return measurement.id.astype(str)

    @classmethod
    def plots(cls, curves):
        """Deviations over the direction of the length."""
        along = curves.measurement.sensing
        angle = np.degrees(np.arctan2(along[:, 1], along[:, 0]))
        rows = np.ones(len(angle), dtype=bool)
        drawn = against(curves, rows, angle, "direction from +X, deg", end_of_scale(curves))
        return [("deviation over direction", drawn)]


def _places(table: Columns, end: str) -> np.ndarray:
    """Nominal places of one end of every length, (P, 3) mm, from the workpiece zero."""
    z = table.numbers.get(f"z{end}", np.zeros(len(table.lines)))
    return np.column_stack([table.numbers[f"x{end}"], table.numbers[f"y{end}"], z])


def _check(table: Columns, nominal: np.ndarray, apart: np.ndarray) -> None:
    """Refuse a length of nothing, and one that is another.

    Raises
    ------
    InputError
        With the line.
    """
    wrong = (nominal < _SHORTEST_MM) | (np.abs(apart) > _FARTHEST_MM)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(
            f"length_mm is {nominal[row] + apart[row]:g} where the places are {nominal[row]:g} mm "
            "apart",
            file=table.path,
            line=int(table.lines[row]),
            accepted=f"lengths of {_SHORTEST_MM:g} mm or more, within {_FARTHEST_MM:g} mm of the "
            "distance of their places",
            hint="x1 y1 and x2 y2 are nominal, in mm, from the workpiece zero",
        )


def _doubts(place_mm: np.ndarray, model: ModelOfTest) -> tuple[Note, ...]:
    """A note where places, machine coordinates without the tool, are a spot of the program's."""
    prepared = model.preparation
    moves = prepared.program.moves
    cuts = moves.end_mm[moves.kind != MoveKind.RAPID, :2] - prepared.zero_mm[:2]
    room = np.array([cuts.min(axis=0), cuts.max(axis=0)])
    return inch_notes(place_mm[:, :2] - prepared.zero_mm[:2], room, "what the program goes over")


def _twice(table: Columns) -> Columns:
    """The table with the lines of both ends below each other."""
    return Columns(table.path, np.tile(table.lines, 2), {}, {})


def _shares(along: np.ndarray) -> csr_array:
    """What each end adds to each length, (P, 6 P): all first ends, then all second ones."""
    count = len(along)
    row = np.repeat(np.arange(count), 3)
    column = 3 * row + np.tile(np.arange(3), count)
    values = np.concatenate([-along.ravel(), along.ravel()])
    places = np.tile(row, 2), np.concatenate([column, column + 3 * count])
    return csr_array((values, places), shape=(count, 6 * count))
