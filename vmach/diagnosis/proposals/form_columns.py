"""Signatures of all forms over the readings of a survey, some at a time."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from vmach.base.alike_rows import alike_rows
from vmach.diagnosis.proposals.form import Form, FormEffect
from vmach.diagnosis.proposals.form_rows import Rows, form_rows
from vmach.diagnosis.proposals.spots import Spots
from vmach.diagnosis.proposals.states import (
    ALL_AXES,
    CONSTANT,
    CUT,
    DIRECTIONS,
    HALF_TURNS,
    SWELLING,
    TILTS,
    TURNS,
    Direction,
    State,
    bend_about,
    curve_in,
    states_of,
)
from vmach.diagnosis.proposals.stretches import stretch_states
from vmach.diagnosis.proposals.touched_zeros import TouchedZeros
from vmach.diagnosis.proposals.waves import wave_states
from vmach.fit.candidates import Candidate
from vmach.fit.signature_group import CACHED
from vmach.fit.survey import Survey
from vmach.fit.whitening import orthonormal

__all__ = ["FormColumns"]

#: kinds of what may push along all axes at once, by another amount each
_ALONG_ALL = ("time", "warm-up", "time since tool change", "spindle", "tool change", "tool")
#: kinds of what may be more or less along an axis
_ALONG_AN_AXIS = ("direction", "travel since reversal", "speed", "warm-up", "tool", "tool change")
#: kinds of what may heat or cool the part
_HEATS_PART = ("time", "warm-up", "time since tool change", "cutting length")
#: a curve along an axis is tried where readings go further than this, mm
_LEAST_SPAN_MM = 50.0
#: share of the span that no reading may leave out: half the shortest wave of the curve
_WIDEST_GAP = 1.0 / HALF_TURNS
#: a tilt that follows the places of readings to that share of its squares is an angular error
#: motion, which is of places by definition (ISO 230-1); chosen: a wave in time as long as runs out
#: and back does so to 0.99, one that has nothing to do with them to 0.8 at most
_OF_TABLE = 0.9
#: a form that differs by less than this among the readings, mm, does not show
_BLIND_MM = 1e-9


class FormColumns:
    """Every product of two states into every direction, and states of several numbers alone.

    Parameters
    ----------
    survey : Survey
    """

    def __init__(self, survey: Survey) -> None:
        self._survey = survey
        self._looked_at: set[bytes] = set()
        self._states = _states(survey)
        self._zeros = TouchedZeros(survey)
        places = np.concatenate([p.on_part_mm for p in survey.paths])
        self._bend = bend_about(0.5 * (places.min(axis=0) + places.max(axis=0)))
        every = (*DIRECTIONS, ALL_AXES, *TURNS, SWELLING, self._bend, *TILTS)
        reads = {path.states.arm_mm is not None for path in survey.paths}
        # what reads tilts senses no displacement; tilts are asked for where something reads them
        self._sensed = {d: _sensed(survey, d) for d in every if d.turns_tool in reads}
        self._spots = Spots(survey, self._sensed)
        # in the order in which they came; each once
        listed = itertools.chain(self._plain(), self._of_several(), self._along_axes())
        self._forms = dict.fromkeys(form for form in listed if form.direction in self._sensed)
        #: of those that were added
        self._formulas: set[str] = set()

    def _plain(self) -> Iterator[Form]:
        """Those of one amount."""
        single = [state for state, value in self._states.items() if value.shape[1] == 1]
        directions = [d for d in (*DIRECTIONS, *TILTS) if d in self._sensed]
        for pair in itertools.combinations_with_replacement(single, 2):
            if pair[0] is not pair[1] or _has_square(self._states[pair[0]]):
                yield from (Form(*pair, direction) for direction in directions)

    def _of_several(self) -> Iterator[Form]:
        """Those of several amounts: steps and waves, drifts along all axes, turns, heat, a bend."""
        for state, value in self._states.items():
            if value.shape[1] > 1:
                yield from (Form(CONSTANT, state, d) for d in (*DIRECTIONS, *TILTS))
            if state.kind in _ALONG_ALL and state.words != "":
                yield Form(CONSTANT, state, ALL_AXES)
            if value.shape[1] == 1 and state is not CONSTANT:
                yield from (Form(CONSTANT, state, turn) for turn in TURNS)
            if state.kind in _HEATS_PART:
                yield Form(CONSTANT, state, SWELLING)
        yield Form(CONSTANT, CONSTANT, self._bend)

    def _along_axes(self) -> Iterator[Form]:
        """States that do more at one place of an axis than at another."""
        single = [s for s, v in self._states.items() if v.shape[1] == 1]
        for k, place in enumerate(np.vstack([path.nose_mm for path in self._survey.paths]).T):
            low, high, gap = place.min(), place.max(), np.diff(np.sort(place)).max(initial=0.0)
            if high - low < _LEAST_SPAN_MM or gap > _WIDEST_GAP * (high - low):
                continue
            curve = curve_in(k, low, high)
            self._states[curve] = _values(self._survey, curve)
            for state in (s for s in single if s.kind in _ALONG_AN_AXIS):
                yield from (Form(state, curve, d) for d in (*DIRECTIONS[:3], *TILTS))

    def add_conspicuous(self, left_mm: np.ndarray, rest_mm: np.ndarray) -> None:
        """Add what shows of waves, spots and stretches of time.

        Parameters
        ----------
        left_mm : (n,) float64
            What effects leave of the readings: spots, stretches and slow waves are smooth.
        rest_mm : (n,) float64
            What no discrepancy takes of that: waves of high frequency are not.
        """
        asked = left_mm.tobytes() + rest_mm.tobytes()
        if asked in self._looked_at:  # what shows is on the list
            return
        self._looked_at.add(asked)
        tools = [(s, value[:, 0]) for s, value in self._states.items() if s.kind == "tool"]
        found = [
            *wave_states(self._survey, rest_mm, self._sensed, smooth_mm=left_mm),
            *self._spots.states(left_mm),
        ]
        forms = [Form(CONSTANT, *one) for one in found]
        forms += [Form(*one) for one in stretch_states(self._survey, left_mm, self._sensed, tools)]
        for form in forms:
            # forms are told apart by their words: of places and periods that round alike the first
            if form.formula in self._formulas:
                continue
            self._formulas.add(form.formula)
            self._forms[form] = None
            if form.second not in self._states:
                self._states[form.second] = _values(self._survey, form.second)

    @property
    def forms(self) -> list[Form]:
        """All of them, new ones last."""
        return [*self._forms]

    def __len__(self) -> int:
        return len(self._forms)

    def columns(self, form: Form) -> np.ndarray:
        """Signatures of a usual amount each over the readings, (n, K) mm."""
        return self._rows([form], slice(None))[0].T

    def _rows(self, forms: Sequence[Form], rows: Rows) -> np.ndarray:
        """Signatures of forms of one shape over some of the readings, (M, K, n) mm."""
        found = form_rows(forms, self._states, self._sensed, rows)
        if self._zeros:
            for own, form in zip(found, forms, strict=True):
                if not form.needs_surface and not form.direction.turns_tool:
                    own -= self._zeros.columns_mm(form)[rows].T
        return found

    def near(self, form: Form) -> list[Form]:
        """The form with other ways and times of its states, each in turn."""
        firsts = (replace(form, first=state) for state in form.first.near)
        seconds = (replace(form, second=state) for state in form.second.near)
        forms = [*firsts, *seconds]
        for one in forms:
            for state in one.states:
                if state not in self._states:
                    self._states[state] = _values(self._survey, state)
        return forms

    def simpler(self, form: Form) -> list[Form]:
        """Forms on the list with one of its states alone, or along an axis in place of a turn."""
        states = [s for s in form.states if len(form.states) > 1] or [form.second]
        directions = DIRECTIONS[:3] if form.direction in TURNS else (form.direction,)
        fewer = (Form(CONSTANT, state, d) for state in states for d in directions)
        listed = (one for one in fewer if one in self._forms and one != form)
        return [one for one in listed if self._are_shown([one], self._rows([one], slice(None)))[0]]

    def space_of(self, form: Form) -> np.ndarray:
        """Orthonormal basis of the signatures with alignment taken off, (n, r)."""
        columns = self.columns(form)
        return orthonormal(columns - self._survey.aligned(columns))

    def held(self, form: Form) -> Form:
        """The form, with states of one number held at the ends of what was seen of them."""
        first, second = (
            state.held(value) if np.ptp(value) and value.shape[1] == 1 else state
            for state, value in ((s, self._states[s]) for s in (form.first, form.second))
        )
        return replace(form, first=first, second=second)

    def candidate(self, form: Form) -> Candidate:
        """The form as a candidate of a search."""
        columns = self.columns(form)
        effect = FormEffect(form, columns.shape[1])
        return Candidate(effect, form.formula, [{}], np.zeros(1), columns[:, None, :])

    def shown(
        self, forms: Sequence[Form], rows: Rows
    ) -> Iterator[tuple[list[int], list[np.ndarray]]]:
        """Which of some forms the readings show, and their signatures over some, (m, K, n) mm.

        Those of one shape together, in their order; signatures in blocks.
        """
        alike: dict[tuple[int, ...], list[int]] = {}
        for k, form in enumerate(forms):
            values = self._sensed[form.direction], *(self._states[s] for s in form.both)
            alike.setdefault(tuple(value.shape[1] for value in values), []).append(k)
        for shape, own in alike.items():
            many = max(CACHED // (len(self._survey) * int(np.prod(shape))), 1)
            numbers, blocks = [], []
            for some in (own[k : k + many] for k in range(0, len(own), many)):
                found = self._rows([forms[k] for k in some], rows)
                is_shown = self._are_shown([forms[k] for k in some], found)
                numbers += np.array(some)[is_shown].tolist()
                blocks.append(found if is_shown.all() else found[is_shown])
            if numbers:
                yield numbers, blocks

    def _are_shown(self, forms: Sequence[Form], signatures_mm: np.ndarray) -> np.ndarray:
        """Whether readings show forms with signatures (M, K, n) mm; of tilts what no table says."""
        is_shown = np.ptp(signatures_mm, axis=2).max(axis=1) > _BLIND_MM
        for k, form in enumerate(forms):
            if is_shown[k] and form.direction.turns_tool:
                # of several amounts none, as that one would stand for a table
                share = np.linalg.norm(self._places.T @ self.space_of(form), 2) ** 2
                is_shown[k] = share < _OF_TABLE
        return is_shown

    @cached_property
    def _places(self) -> np.ndarray:
        """Orthonormal columns, one of each place of each measurement, (n, q)."""
        blocks = []
        for path in self._survey.paths:
            place = alike_rows([path.nose_mm])[1]
            blocks.append(np.eye(place.max() + 1)[place] / np.sqrt(np.bincount(place)))
        return block_diag(*blocks)


def _states(survey: Survey) -> dict[State, np.ndarray]:
    """All states that differ among the readings, with their values (n, C)."""
    listed = dict.fromkeys(state for path in survey.paths for state in states_of(path))
    if not survey.has_part:
        listed = {state: None for state in listed if state.kind not in CUT}
    found: dict[State, np.ndarray] = {CONSTANT: np.ones((len(survey), 1))}
    for state in listed:
        value = _values(survey, state)
        if np.ptp(value, axis=0).max() > 0.0:
            found[state] = value
    return found


def _has_square(value: np.ndarray) -> bool:
    """Whether its square says more than it does: a sign or a switch has none. Of (n, 1)."""
    return np.ptp(value) == 0.0 or not np.isin(value, (-1.0, 0.0, 1.0)).all()


def _values(survey: Survey, state: State) -> np.ndarray:
    """A state of every reading, (n, C); zero where a reading cannot have it."""
    parts = [
        state.at(path) if m.on_part or not state.needs_surface else None
        for path, m in zip(survey.paths, survey.measurements, strict=True)
    ]
    wide = next((part.shape[1] for part in parts if part is not None), 1)
    blank = [np.zeros((len(m), wide)) for m in survey.measurements]
    return np.concatenate([b if p is None else p for p, b in zip(parts, blank, strict=True)])


def _sensed(survey: Survey, direction: Direction) -> np.ndarray:
    """How readings sense a unit displacement into directions, (n, D), or a tilt."""
    parts = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        if direction.needs_surface and not m.on_part:
            parts.append(np.zeros((len(m), 1)))
        else:
            each = direction.at(path).transpose(2, 0, 1)
            seen = [path.states.seen_mm(direction.of_tool(one)) for one in each]
            parts.append(np.einsum("pi,dpi->pd", m.sensing, np.stack(seen)))
    wide = max(part.shape[1] for part in parts)
    return np.concatenate([np.broadcast_to(part, (len(part), wide)) for part in parts])
