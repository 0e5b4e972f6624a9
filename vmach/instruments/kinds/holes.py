"""Holes, bores and bosses of the part, each measured as a position and a diameter.

Source: ISO 14405-1, least squares size (GG); ISO 1101, position.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from vmach.base.note import Kind, Note, in_file
from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.files.toml_file import Positive
from vmach.instruments.drawing import against, end_of_scale
from vmach.instruments.readings import in_stretches
from vmach.measurements import Contacts, Measurement
from vmach.measurements.columns import Columns
from vmach.measurements.instrument import Instrument, ModelOfTest
from vmach.measurements.plausibility.odd_uncertainty import odd_uncertainty_notes
from vmach.measurements.repeats import check_degrees, mean_of_repeats
from vmach.nominal.points import FINEST_U_UM, WHEN, when_measured
from vmach.path.hole_making import CONTACTS, CircularFeature, HoleContacts, hole_contacts
from vmach.path.toolpath import PathStates

__all__ = ["Holes"]

#: a hole further away than this, or another one of another size, is not the one of the drawing
_FARTHEST_MM = 1.0
#: a pose takes three numbers
_FEWEST = 3
#: what is read of a hole: column of the nominal value, of the measured one, and the words for it
_READ = {"X": ("x", "mx"), "Y": ("y", "my"), "Z": ("z", "mz"), "diameter": ("d", "md")}


class Holes(Instrument):
    """Positions and diameters, as a coordinate measuring machine gives them (ISO 1101).

    A position is the mean displacement of the wall all round, a diameter its mean growth: what
    turns with the surface, as the radius of a tool, shows in the diameter alone.

    Source: closed form derived here: least-squares circle through equally spaced points,
    x = (2/n) sum r cos, y = (2/n) sum r sin, d = (2/n) sum r.
    """

    name = "holes"
    title = "Holes, bores and bosses"
    columns = ("x", "y", "mx", "my")
    optional_columns = ("id", "feature", "z", "mz", "d", "md", "u_um", "clamping", *WHEN)
    text_columns = ("id", "feature", "clamping")
    follows_program = True
    readings = ("mx", "my")
    sign_meaning = "a deviation is measured minus nominal"
    left_free = "pose of the part"
    shows_law_band = True

    tool_length_mm: Positive | None = None
    u_um: Positive | None = None

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Nothing that the section says: tools and places are those of the program."""
        return iter(())

    def read(self, table, model):
        given = table.numbers
        read = [(axis, *both) for axis, both in _READ.items() if all(n in given for n in both)]
        u_mm = self._u_mm(table)
        deviation = {axis: _deviation_mm(table, nominal, own) for axis, nominal, own in read}
        made = hole_contacts(model.preparation, _features(table))
        holes = np.flatnonzero(made.found)
        _check_found(made.found, table, model)
        seen = _states_seen(made, with_bottom="Z" in deviation)
        share = _shares(made, list(deviation))
        per_hole, count = len(deviation), len(holes)
        alone = _alone(made, table.vectors("xy")[holes], model)
        states = alone[np.repeat(np.arange(count), per_hole)]
        unit = {**dict(zip("XYZ", np.eye(3), strict=True)), "diameter": np.zeros(3)}
        sensing = np.tile([unit[axis] for axis in deviation], (count, 1))
        contacts = Contacts(seen, share)
        predicted = contacts.sensed(model.moved_mm(seen)[:, :, None])[:, 0]
        clamping, when = table.text.get("clamping"), when_measured(given, table.path)
        found = Measurement(
            instrument=type(self),
            name=table.path.name,
            id=_names(table, holes, list(deviation)),
            states=states,
            sensing=sensing,
            measured_mm=np.column_stack(list(deviation.values()))[holes].ravel(),
            predicted_mm=predicted,
            u_mm=np.repeat(u_mm[holes], per_hole),
            group=_groups(table, holes, alone.tool, list(deviation)),
            nuisance=_pose(states, sensing),
            notes=in_file((*_left_out(made.found, table), *_odd(table)), table.path),
            contacts=contacts,
            clamping=None if clamping is None else np.repeat(clamping[holes], per_hole),
            measured_at=None if when is None else np.repeat(when[holes], per_hole),
        )
        nominal = np.column_stack([given[name] for name, _ in _READ.values() if name in given])
        which = np.repeat(nominal[holes], per_hole, axis=0), np.tile(np.arange(per_hole), count)
        found = mean_of_repeats(found, which)
        check_degrees(found, table.path)
        # neighbours are those that were measured, or else made, one after the other
        order = found.states.time_s if found.measured_at is None else found.measured_at
        return found.keep(np.argsort(order, kind="stable"))

    def _u_mm(self, table: Columns) -> np.ndarray:
        """Standard uncertainty of every hole: of its row, else of the section."""
        if "u_um" in table.numbers:
            own = table.numbers["u_um"]
            if (own < FINEST_U_UM).any():
                raise InputError(
                    f"u_um is {own[own < FINEST_U_UM][0]:g}",
                    file=table.path,
                    line=table.line_of(own < FINEST_U_UM),
                    accepted=f"a standard uncertainty of {FINEST_U_UM:g} um or more",
                )
            return mm_from_um(own)
        if self.u_um is None:
            raise InputError(
                "no uncertainty is stated of these holes",
                file=table.path,
                line=1,
                accepted="u_um of the section, or a column u_um",
            )
        return np.full(len(table.lines), mm_from_um(self.u_um))

    @classmethod
    def blocks(cls, measurement):
        return in_stretches(measurement)

    @classmethod
    def plots(cls, curves):
        """Each deviation over X and over Y."""
        end, found = end_of_scale(curves), []
        place = curves.path.on_part_mm
        what = np.array([name.rsplit(" ", 1)[-1] for name in curves.measurement.id])
        for axis in dict.fromkeys(what.tolist()):
            for k, over in enumerate("XY"):
                drawn = against(curves, what == axis, place[:, k], f"{over}, mm", end)
                found.append((f"{axis} over {over}", drawn))
        return found


def _deviation_mm(table: Columns, nominal: str, own: str) -> np.ndarray:
    """Measured minus nominal, (P,).

    Raises
    ------
    InputError
        With the first that is too far away to be of this hole.
    """
    apart = table.numbers[own] - table.numbers[nominal]
    wrong = np.abs(apart) > _FARTHEST_MM
    if wrong.any():
        raise InputError(
            f"{own} is {table.numbers[own][wrong][0]:g} where {nominal} is "
            f"{table.numbers[nominal][wrong][0]:g}, {np.count_nonzero(wrong)} of {len(wrong)} rows "
            "are that far away",
            file=table.path,
            line=table.line_of(wrong),
            accepted=f"measured values within {_FARTHEST_MM:g} mm of the nominal ones, all in mm",
            hint="is the part aligned, are rows and columns those of the drawing?",
        )
    return apart


def _features(table: Columns) -> list[CircularFeature]:
    unknown = np.full(len(table.lines), np.nan)
    z, d = table.numbers.get("z", unknown), table.numbers.get("d", unknown)
    return [CircularFeature(*one) for one in zip(table.vectors("xy"), z, d, strict=True)]


def _check_found(found: np.ndarray, table: Columns, model: ModelOfTest) -> None:
    """Refuse a file of which the program made no hole, or too few to take the pose off."""
    if np.count_nonzero(found) >= _FEWEST:
        return
    row = int(np.argmin(found))
    x, y = table.vectors("xy")[row]
    missing = "" if found.all() else f"; none is at X{x:g} Y{y:g}"
    raise InputError(
        f"{np.count_nonzero(found)} of {len(found)} holes are in the program "
        f"{model.preparation.program.path.name}{missing}",
        file=table.path,
        line=int(table.lines[row]),
        accepted=f"{_FEWEST} or more holes that a tool plunges into or goes round at feed",
        hint="x and y are nominal, in mm, from the workpiece zero of the job",
    )


def _left_out(found: np.ndarray, table: Columns) -> tuple[Note, ...]:
    lost = np.flatnonzero(~found)
    if not len(lost):
        return ()
    lines = ", ".join(str(line) for line in table.lines[lost[:6]])
    more = f" and {len(lost) - 6} more" if len(lost) > 6 else ""
    said = (
        f"left out because the program makes no hole there ({len(lost)} of {len(found)}): "
        f"lines {lines}{more}"
    )
    return (Note.plain(Kind.UNCUT, said, len(lost), "1"),)


def _odd(table: Columns) -> tuple[Note, ...]:
    """Doubts about rows whose uncertainty is far from that of the others."""
    own = table.numbers.get("u_um")
    return () if own is None else odd_uncertainty_notes(own, table.lines)


def _states_seen(made: HoleContacts, *, with_bottom: bool) -> PathStates:
    """All contacts; behind them, for heights, the tip at the bottom of every hole."""
    if not with_bottom:
        return made.states
    last = np.arange(CONTACTS - 1, len(made.states), CONTACTS)
    bottom = made.states[last]
    rows = len(made.states), len(last)
    states = made.states[np.concatenate([np.arange(rows[0]), last])]
    contact, normal = states.contact_mm.copy(), states.normal.copy()
    contact[rows[0] :], normal[rows[0] :] = 0.0, [0.0, 0.0, 1.0]
    parameter = np.concatenate([made.states.parameter, np.ones_like(bottom.parameter)])
    return replace(states, contact_mm=contact, normal=normal, parameter=parameter)


def _shares(made: HoleContacts, what: list[str]) -> csr_array:
    """What each contact adds to each reading, hole after hole, (P, 3 S)."""
    count = len(made.states) // CONTACTS
    rows, columns, values = [], [], []
    contact = np.arange(count * CONTACTS).reshape(count, CONTACTS)
    for k, axis in enumerate(what):
        row = np.arange(count) * len(what) + k
        if axis == "Z":
            weight = np.tile([0.0, 0.0, 1.0], (count, 1, 1))
            own = count * CONTACTS + np.arange(count)[:, None]
        else:
            turned = 1.0 if axis == "diameter" else made.outward[:, "XY".index(axis)]
            weight = (2.0 / CONTACTS) * np.reshape(turned, (-1, 1)) * made.outward
            weight, own = weight.reshape(count, CONTACTS, 3), contact
        rows.append(np.broadcast_to(row[:, None, None], weight.shape).ravel())
        columns.append((3 * own[:, :, None] + np.arange(3)).ravel())
        values.append(weight.ravel())
    size = count * (CONTACTS + ("Z" in what))
    places = np.concatenate(rows), np.concatenate(columns)
    return csr_array((np.concatenate(values), places), shape=(count * len(what), 3 * size))


def _alone(made: HoleContacts, centre_mm: np.ndarray, model: ModelOfTest) -> PathStates:
    """One state that stands for each hole, at its centre: (H,) with a normal of no direction."""
    states = made.states[np.arange(CONTACTS - 1, len(made.states), CONTACTS)]
    tip = states.nose_mm + states.tool_mm - model.preparation.zero_mm
    contact = np.column_stack([centre_mm - tip[:, :2], np.zeros(len(tip))])
    return replace(states, contact_mm=contact, normal=np.zeros_like(contact))


def _pose(states: PathStates, sensing: np.ndarray) -> np.ndarray:
    """Columns of the part's shift and rotation, those that these readings see, (P, K)."""
    place = states.nose_mm + states.tool_mm + states.contact_mm
    every = np.hstack([sensing, np.cross(place - place.mean(axis=0), sensing)])
    return every[:, np.abs(every).max(axis=0) > 1e-9]


def _names(table: Columns, holes: np.ndarray, what: list[str]) -> np.ndarray:
    own = table.text.get("id", np.arange(1, len(table.lines) + 1).astype(str))[holes]
    return np.array([f"{name} {axis}" for name in own for axis in what])


def _groups(table: Columns, holes: np.ndarray, tool: np.ndarray, what: list[str]) -> np.ndarray:
    """Readings of one kind of the feature that the file names, else of one tool."""
    own = table.text["feature"][holes] if "feature" in table.text else [f"T{k}" for k in tool]
    return np.array([f"{axis} of {name}" for name in own for axis in what])
