"""What no model holds: shape of features and part, wandering in time, smooth fields.

A discrepancy in the sense of Kennedy and O'Hagan (J. R. Statist. Soc. B 63 (2001) 425): its size
is estimated together with the effects. What is stated of the machine that measured stands beside.

Source: M. Kennedy and A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from vmach.effects.wandering import wandering
from vmach.fit.noise.measuring_machine import (
    CLAMPINGS,
    DRIFT,
    WARMING,
    clampings,
    drift_of_device,
    stated_of_device,
    warming_of_instruments,
)
from vmach.fit.sizes import USUAL_SIZE
from vmach.fit.survey import Survey
from vmach.fit.whitening import condensed, orthonormal
from vmach.measurements import Measurement
from vmach.path.circumstances import Circumstances

__all__ = ["TIME", "Members", "members_of"]

#: name of what wanders in time
TIME = "time"
#: bends that a wandering makes in the time of a measurement
_WAVES_IN_TIME = 6.0
#: size, as a multiple of the noise that readings show, from which on a wandering in time is
#: improbable as what nobody models: it is an ambient drift (ISO 230-3, environmental temperature
#: variation error), which is an effect; chosen: about twice the usual size of a member
_NO_DRIFT = 1.5
#: degree of the smooth field: half waves over the volume that was visited
_FIELD_DEGREE = 3
#: a feature whose normals are that much along Z is a floor
_UPRIGHT = 0.7
#: a cause whose largest signature is this share of u is left out
_BLIND = 1e-3
#: what a direction of the causes of known size adds to all readings together, in squared u, at
#: least: without it the log probability of one direction is wrong by v²/4 = 0.003 for v = 0.1
_LEAST_VARIANCE = 0.1
#: the same for a discrepancy of unit size; one of ten u is wrong by 0.15 in such a direction
_NOTHING = 0.01
#: decimals of mm, and of what is sensed, to which places are the same
_SAME_PLACE = 4
#: times that each is visited at least: from three on what all have in common shows
_VISITS = 3
#: more places than a test along an axis has (ISO 230-2: five a metre at least) are a curve
_MOST_PLACES = 100
#: half the length of the smallest part that bends, mm: points on one place tell no curvature
_LEAST_HALF_MM = 25.0


@dataclass(frozen=True)
class Members:
    """Columns of unit variance that stand beside the effects; views of one array.

    Attributes
    ----------
    fixed_mm : (n, q) float64
        Of known size: tables' uncertainty, effects of the job, the device.
    names : tuple of str
        Of the members of unknown size.
    columns_mm : tuple of (n, k) float64
        Of each; a size of one makes about one median `u_um`.
    plain_mm : (n, k) float64 or None
        What plain laws do that the smooth field was made free of, where it was.
    every_mm : (n, q) float64
        Those of known size, and all others.
    """

    fixed_mm: np.ndarray
    names: tuple[str, ...]
    columns_mm: tuple[np.ndarray, ...]
    plain_mm: np.ndarray | None = None
    every_mm: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        parts = [self.fixed_mm, *self.columns_mm]
        every = np.hstack(parts)
        ends = np.cumsum([part.shape[1] for part in parts])[:-1]
        fixed, *others = np.split(every, ends, axis=1)
        object.__setattr__(self, "every_mm", every)
        object.__setattr__(self, "fixed_mm", fixed)
        object.__setattr__(self, "columns_mm", tuple(others))

    @cached_property
    def prior_of_sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Of each member the usual size, and that from which on it is an effect.

        The former in u, the latter in the noise that readings show. A part lies anyhow in each of
        several clampings, as in one: no shift is less likely than another.
        """
        usual = [np.inf if name == CLAMPINGS else USUAL_SIZE for name in self.names]
        limits = [_NO_DRIFT if name == TIME else np.inf for name in self.names]
        return np.array(usual), np.array(limits)


def members_of(survey: Survey, plain_mm: np.ndarray | None = None, *, kept: float = 0.0) -> Members:
    """All that may differ without being an effect.

    Parameters
    ----------
    survey : Survey
    plain_mm : (n, k) float64, optional
        What plain laws do that every machine has and nobody measured. The smooth field has none
        of it: a scale is by definition the linear part of a positioning error, a squareness that
        of two straightness errors (ISO 230-1), and a field is what lies beyond them.
    kept : float
        Share of that which the field has nevertheless.

    References
    ----------
    M. Plumlee, J. Am. Stat. Assoc. 112 (2017) 1274: a discrepancy that is orthogonal to the model.
    """
    unit = float(np.median(survey.u_mm))
    found = {
        **{name: unit * columns for name, columns in _offsets(survey).items()},
        "form": unit * _seen(_forms(survey)),
        TIME: _told_apart(survey, unit * _in_time(survey)),
        "places": unit * _places(survey),
        "reversals": unit * _reversals(survey),
        "field": _told_apart(survey, _beyond(survey, unit * _field(survey), plain_mm, kept)),
        "bend": unit * _bend(survey),
        CLAMPINGS: unit * clampings(survey),
        DRIFT: _told_apart(survey, unit * drift_of_device(survey)),
        WARMING: _told_apart(survey, unit * warming_of_instruments(survey)),
    }
    device = np.hstack([*stated_of_device(survey).values()])
    fixed = condensed(np.hstack([survey.factors, device]), survey.u_mm, least=_LEAST_VARIANCE)
    there = {name: c for name, c in found.items() if c.shape[1]}
    return Members(fixed, tuple(there), tuple(there.values()), plain_mm)


def _offsets(survey: Survey) -> dict[str, np.ndarray]:
    """An offset of each group of readings: floors, walls and runs have a size of their own."""
    names, number = survey.groups
    inside = _beyond_size_of_tools(survey, np.eye(len(names))[number])
    on_part = np.concatenate([np.full(len(m), m.on_part) for m in survey.measurements])
    upright = np.bincount(number, np.abs(survey.sensing[:, 2])) / np.bincount(number) > _UPRIGHT
    of_part = np.bincount(number, on_part) > 0
    return {
        "floors": _seen(inside[:, of_part & upright]),
        "walls": _seen(inside[:, of_part & ~upright]),
        "runs": inside[:, ~of_part],
    }


def _beyond_size_of_tools(survey: Survey, offsets: np.ndarray) -> np.ndarray:
    """Offsets (n, k) of groups, those of diameters about the mean of all that a tool made.

    That mean is no offset: it is the size of the tool.
    """
    tool = np.concatenate([path.tool for path in survey.paths])
    of_holes = [np.full(len(m), m.contacts is not None) for m in survey.measurements]
    is_diameter = np.concatenate(of_holes) & ~survey.sensing.any(axis=1)
    for one in np.unique(tool[is_diameter]):
        rows = is_diameter & (tool == one)
        offsets[rows] -= offsets[rows].mean(axis=0)
    return offsets


def _forms(survey: Survey) -> np.ndarray:
    """Slope and bend of each group of readings, (n, K); holes are no surface that has any."""
    names, number = survey.groups
    has_form = np.concatenate([np.full(len(m), m.contacts is None) for m in survey.measurements])
    inside, slope, bend = np.eye(len(names))[number], np.zeros(len(survey)), np.zeros(len(survey))
    for k in range(len(names)):
        rows = np.flatnonzero((number == k) & has_form)
        if len(rows) > 2:
            place = np.linspace(-1.0, 1.0, len(rows))
            slope[rows], bend[rows] = np.sqrt(3.0) * place, np.sqrt(5.0) * (1.5 * place**2 - 0.5)
    return np.hstack([inside * shape[:, None] for shape in (slope, bend)])


def _places(survey: Survey) -> np.ndarray:
    """An offset of each place that an instrument comes back to, (n, K).

    What a short piece of a screw or of a scale does is the same in every run; repeated runs are no
    further evidence of what it follows (ISO 230-2, mean deviation of a position). About a straight
    line, as a slope is no error of single places.
    """
    blocks = []
    for m in survey.measurements:
        place = _place_of(m)
        # of an instrument that does not come back no place counts
        own = np.eye(place.max() + 1)[:, slice(None if place.any() else 0)]
        nose = np.zeros((len(own), 3))
        nose[place] = m.states.nose_mm
        line = orthonormal(np.column_stack([np.ones(len(own)), nose]))
        blocks.append((own - line @ (line.T @ own))[place])
    return block_diag(*blocks)


def _reversals(survey: Survey) -> np.ndarray:
    """How lost motion varies along what an instrument comes back to, as a smooth curve, (n, K).

    About the mean of all places, as that is the lost motion of the axis.

    Source: ISO 230-2, the reversal value of a position, and the mean reversal value of an axis.
    """
    blocks = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        place, degrees = _place_of(m), np.arange(1, _FIELD_DEGREE + 1)
        last = max(int(place.max()), 1)
        waves = np.cos(np.outer(np.arange(last + 1), np.pi * degrees / last))
        waves -= waves.mean(axis=0)
        side = _lost_with(path, m)
        blocks.append(side[:, None] * waves[place] * bool(place.any()))
    return _seen(block_diag(*blocks))


def _lost_with(path: Circumstances, m: Measurement) -> np.ndarray:
    """Side of the play that shows in each reading, (m,); of a tilt that of the axis that moves."""
    if m.states.arm_mm is None:
        return np.sum(path.play_side * m.sensing, axis=1)
    return path.play_side @ (np.ptp(m.states.nose_mm, axis=0) > 0.0)


def _place_of(measurement: Measurement) -> np.ndarray:
    """Number of the place of each reading, in their order along the travel, (m,).

    Zero throughout where an instrument does not come back to its places, or has very many.
    """
    nose = np.round(measurement.states.nose_mm, _SAME_PLACE)
    sensing = np.round(measurement.sensing, _SAME_PLACE)
    places, number = np.unique(np.hstack([nose, sensing]), axis=0, return_inverse=True)
    seldom = len(measurement) < _VISITS * len(places)
    stays = not np.ptp(nose, axis=0).any()
    if measurement.on_part or seldom or stays or len(places) > _MOST_PLACES:
        return np.zeros(len(measurement), dtype=int)
    return number.ravel()


def _in_time(survey: Survey) -> np.ndarray:
    """Wandering of the tool along X, Y and Z, new in every measurement, (n, K)."""
    blocks = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        seconds = path.time_s
        waves = wandering(seconds, max(float(np.ptp(seconds)), 1.0) / _WAVES_IN_TIME)
        waves = waves[:, np.abs(waves).max(axis=0) > 0.05]
        blocks.append((m.sensing[:, :, None] * waves[:, None, :]).reshape(len(m), -1))
    return _seen(block_diag(*blocks))


def _field(survey: Survey) -> np.ndarray:
    """Smooth displacement of the tool over the volume, along X, Y and Z, (n, K); no tilt of it."""
    of_tilts = [np.full(len(m), m.states.arm_mm is not None) for m in survey.measurements]
    sensing = np.where(np.concatenate(of_tilts)[:, None], 0.0, survey.sensing)
    nose = np.vstack([path.nose_mm for path in survey.paths])
    low, high = nose.min(axis=0), nose.max(axis=0)
    share = (nose - low) / np.maximum(high - low, 50.0)
    parts = []
    for degrees in itertools.product(range(_FIELD_DEGREE + 1), repeat=3):
        if 1 <= sum(degrees) <= _FIELD_DEGREE:
            wave = np.cos(np.pi * share * np.array(degrees)).prod(axis=1)
            parts.append(sensing * wave[:, None] / sum(degrees))
    return _seen(np.hstack(parts))


def _bend(survey: Survey) -> np.ndarray:
    """Bend along X and Y, and twist, of a part that springs back when it is released, (n, 3).

    As a plate: what is at height z turns with the slope of the deflection w, and so moves by
    (-z dw/dx, -z dw/dy, w). Unit curvature lifts an end of the part by one.

    Source: closed form derived here: a thin plate whose normals stay normal (Kirchhoff).
    """
    parts = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        place = path.on_part_mm
        low, high = place.min(axis=0), place.max(axis=0)
        half = max(0.5 * float(np.ptp(place, axis=0)[:2].max()), _LEAST_HALF_MM)
        x, y, z = ((place - 0.5 * (low + high)) / half).T
        none = np.zeros(len(m))
        lifts = [x * x, y * y, x * y]
        slopes = [(2.0 * x, none), (none, 2.0 * y), (y, x)]
        moves = [
            np.stack([-z * along_x, -z * along_y, lift])
            for lift, (along_x, along_y) in zip(lifts, slopes, strict=True)
        ]
        parts.append(np.einsum("ni,kin->nk", m.sensing, moves) * m.on_part)
    return _seen(np.vstack(parts))


def _beyond(
    survey: Survey, columns: np.ndarray, plain_mm: np.ndarray | None, kept: float
) -> np.ndarray:
    """Columns (n, k) with a share of what plain laws beside an alignment do, by least squares."""
    if plain_mm is None:
        return columns
    u = survey.u_mm[:, None]
    own = orthonormal((plain_mm - survey.aligned(plain_mm)) / u)
    beside = (columns - survey.aligned(columns)) / u
    return columns - (1.0 - kept) * u * (own @ (own.T @ beside))


def _told_apart(survey: Survey, columns: np.ndarray) -> np.ndarray:
    """The same covariance by as many columns as readings tell apart beside an alignment."""
    beside = (columns - survey.aligned(columns)) / survey.u_mm[:, None]
    squared, vectors = np.linalg.eigh(beside.T @ beside)
    return columns @ vectors[:, squared > _NOTHING]


def _seen(columns: np.ndarray) -> np.ndarray:
    return columns[:, np.abs(columns).max(axis=0) > _BLIND]
