"""What remains beside effects and noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.linalg import norm

from vmach.base.units import um_from_mm
from vmach.diagnosis.inference.rules import CLEARLY, STRUCTURE, TRUST
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.noise.discrepancy import TIME
from vmach.fit.noise.measuring_machine import CLAMPINGS, DRIFT, WARMING
from vmach.fit.whitening import orthonormal

__all__ = [
    "OF_DEVICE",
    "effects_mm",
    "is_structure",
    "remains_mm",
    "remains_um",
    "rms_um",
    "sizes_um",
    "taken_mm",
    "usual_u_um",
    "where_they_act_um",
]

#: members that are of the measurement, whatever their size
OF_DEVICE = (CLAMPINGS, DRIFT, WARMING)
#: normals that lean less out of the plane than this are those of walls: steeper than 60 degrees
_WALL = 0.5
#: fewer readings say nothing of a variance: of 20 it is uncertain by a third (GUM, table E.1)
_FEW = 20
#: share of u down to which sizes are told apart; chosen: an exact reading has no logarithm
_LEAST = 0.01


def is_structure(weighing: Weighing, size_um: float) -> bool:
    """Whether something of that root mean square is more than the uncertainty of one reading."""
    return size_um > STRUCTURE * usual_u_um(weighing)


def usual_u_um(weighing: Weighing) -> float:
    """Median stated uncertainty."""
    return float(um_from_mm(np.median(weighing.survey.u_mm)))


def remains_mm(weighing: Weighing, found: Explanation) -> np.ndarray:
    """What the discrepancy takes of the readings, alignment and zeros taken off, (n,).

    What clampings and drift of the measuring machine make is of the measurement, and no rest.
    """
    names = [name for name in weighing.members.names if name not in OF_DEVICE]
    return taken_mm(weighing, found, names)


def taken_mm(weighing: Weighing, found: Explanation, names: Sequence[str]) -> np.ndarray:
    """What some members of unknown size take of the aligned readings, (n,)."""
    members = weighing.members
    counts = np.array([members.names.index(name) + 1 for name in names], dtype=int)
    own = np.isin(weighing.base.member_of, counts)
    taken = members.every_mm[:, own] @ found.posterior.amounts[own]
    return taken - weighing.survey.aligned(taken[:, None])[:, 0]


def remains_um(
    weighing: Weighing, found: Explanation, *, noise: float = TRUST, count: int | None = None
) -> float:
    """Root mean square of the discrepancy, and of scatter that is no noise.

    Parameters
    ----------
    weighing : Weighing
    found : Explanation
    noise : float
        Scatter that is noise, in stated uncertainties; where it is known, as from a fuller
        explanation. More than `TRUST` is none.
    count : int, optional
        So many of its terms, the first, are shown; what the others do remains.
    """
    others = [] if count is None else effects_mm(weighing, found)[count:]
    scatter_um = _scatter_um(weighing, found, noise)
    return float(np.hypot(rms_um(sum(others, remains_mm(weighing, found))), scatter_um))


def where_they_act_um(
    weighing: Weighing, found: Explanation, count: int
) -> tuple[Sequence[float], Sequence[float]]:
    """Size of the first effects where they act, and what remains there, root mean squares.

    Each reading weighs as the square of what the effect does to it. Scatter is no rest: an
    imitation leaves structure, and single readings have scatter of their own; but scatter that
    knows the axes is the machine's. Nor is what other terms do a rest; but one that follows the
    travel of an axis is a doubt about an effect that does, where it acts most where that does: the
    mean of such a cause is an effect of motion beside its form. What remains as a wandering in
    time, or as offsets of an instrument's runs, is a doubt about an effect as far as that is one.
    """
    every = [um_from_mm(own) for own in effects_mm(weighing, found)]
    left, terms = um_from_mm(remains_mm(weighing, found)), found.terms
    wandering, of_wandering = _in_time(weighing, found)
    zeros = weighing.survey.zeros_of_runs(left - wandering)
    uneven = _uneven(weighing, found) * um_from_mm(weighing.survey.u_mm) ** 2
    sizes, rests = [], []
    for term, own in zip(terms[:count], every, strict=False):
        beside = zip(terms[count:], every[count:], strict=True)
        moved = [o for t, o in beside if t.travel_axes & term.travel_axes]
        alike = [o for o in moved if _rms_where(o, own) > np.sqrt(np.mean(o**2))]
        as_zeros = norm(weighing.survey.zeros_of_runs(own)) / max(norm(own), 1e-300)
        in_time = norm(of_wandering.T @ own) / max(norm(own), 1e-300)
        rest = sum(alike, left) - (1.0 - in_time) * wandering - (1.0 - as_zeros) * zeros
        sizes.append(_rms_where(own, own))
        rests.append(_rms_where(np.sqrt(rest**2 + uneven), own))
    return sizes, rests


def _in_time(weighing: Weighing, found: Explanation) -> tuple[np.ndarray, np.ndarray]:
    """What remains as a wandering in time, (n,) um, and orthonormal columns of all that is one."""
    members = weighing.members
    if TIME not in members.names:
        return np.zeros(len(weighing.survey)), np.zeros((len(weighing.survey), 0))
    columns = members.columns_mm[members.names.index(TIME)]
    beside = orthonormal(columns - weighing.survey.aligned(columns))
    return um_from_mm(taken_mm(weighing, found, [TIME])), beside


def _rms_where(values: np.ndarray, effect: np.ndarray) -> float:
    """Root mean square of values (n,), weighed by the square of an effect (n,)."""
    weight = effect**2
    return float(np.sqrt(weight @ values**2 / max(float(weight.sum()), 1e-300)))


def _scatter_um(weighing: Weighing, found: Explanation, noise: float) -> float:
    """Scatter that is no noise, root mean square."""
    scale = weighing.base.noise.own_scale.of_readings
    shown = (found.posterior.sizes.factor * scale) ** 2
    beyond = np.maximum(shown - np.minimum(noise * scale, TRUST) ** 2, 0.0)
    squared_um2 = um_from_mm(weighing.survey.u_mm) ** 2
    each = (float(np.mean(own * squared_um2)) for own in (beyond, _uneven(weighing, found)))
    return float(np.sqrt(max(each)))


def _uneven(weighing: Weighing, found: Explanation) -> np.ndarray:
    """Mean square, in stated u, of scatter of walls along one axis that the other has not, (n,).

    No device and no surface knows how a wall lies to X and Y; the axes do. It counts where walls
    along both clearly scatter otherwise: by the logarithm, which few odd readings do not move.
    """
    on_wall = np.concatenate(
        [m.on_part & (np.abs(m.sensing[:, 2]) < _WALL) for m in weighing.survey.measurements]
    )
    left = weighing.base.noise.standardised(found.posterior.left)
    factor = found.posterior.sizes.factor * weighing.base.noise.own_scale.of_readings
    size = np.abs(factor * left)
    along_x, along_y = np.abs(weighing.survey.sensing[:, :2]).T
    groups = [on_wall & here for here in (along_x > along_y, along_x <= along_y)]
    none = np.zeros(len(size))
    if min(np.count_nonzero(group) for group in groups) < _FEW:
        return none
    logs = [np.log(np.maximum(size[group], _LEAST)) for group in groups]
    apart = logs[0].mean() - logs[1].mean()
    if 0.5 * apart**2 < CLEARLY * sum(own.var() / len(own) for own in logs):
        return none
    means = [np.mean(size[group] ** 2) for group in groups]
    return sum((np.where(g, m - min(means), 0.0) for g, m in zip(groups, means, strict=True)), none)


def rms_um(values_mm: np.ndarray) -> float:
    """Root mean square of values (n,) mm."""
    return float(um_from_mm(np.sqrt(np.mean(values_mm**2))))


def sizes_um(weighing: Weighing, found: Explanation) -> Sequence[float]:
    """Root mean square of what each effect does to the aligned readings."""
    return tuple(map(rms_um, effects_mm(weighing, found)))


def effects_mm(weighing: Weighing, found: Explanation) -> Sequence[np.ndarray]:
    """What each effect does to the readings, alignment and zeros taken off, (n,) each."""
    if found.fit is None:
        return ()
    explained = [found.fit.explained_mm(k) for k in range(len(found.terms))]
    return tuple(e - weighing.survey.aligned(e[:, None])[:, 0] for e in explained)
