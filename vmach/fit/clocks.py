"""Surveys by other clocks, where nobody noted the times of a test.

Which side the runs of such a test began from matters beside what warms: a stretch of the axis from
one run to the next passes as lost motion, and twice that lies between the two orders. The readings
tell them apart, as what warms goes on smoothly from run to run in the one that was.

Source: closed form derived here: a drift d from run to run, read on the way there and back, makes
the mean reversal value (ISO 230-2) differ by 2 d between the two orders.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from vmach.base.note import Kind
from vmach.effects.wandering import wandering
from vmach.fit.base import Base
from vmach.fit.marginal_likelihood import Effects, best_sizes
from vmach.fit.noise.discrepancy import Members, members_of
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.measurements import Measurement

__all__ = ["OtherClock", "by_other_clocks", "in_likeliest_order"]

#: bends that what warms makes in the time of a test
_WAVES = 6.0
#: size in u that the members start from
_START = 0.3
#: prior deviation of lost motion, slope and bend, mm: wide, as they are only to be out of the way
_WIDE_MM = 0.03


@dataclass(frozen=True)
class OtherClock:
    """A survey with one test by another clock, its readings in the same rows.

    `weight` is how likely the clock is beforehand, relative to the one that is taken.
    """

    weight: float
    survey: Survey


def in_likeliest_order(survey: Survey) -> Survey:
    """The survey with runs of each test in the order that makes its readings more probable."""
    return replace(survey, measurements=tuple(_likelier(survey, m) for m in survey.measurements))


def by_other_clocks(survey: Survey) -> Iterator[OtherClock]:
    """Surveys in which one test has another clock that is possible."""
    for k, m in enumerate(survey.measurements):
        if (known := m.assumed) is None:
            continue
        before, after = survey.measurements[:k], survey.measurements[k + 1 :]
        for one in known.others():
            other = one.measurement()
            alike = other.keep(_rows_of(m, other))
            weight = one.clock.weight / known.clock.weight
            yield OtherClock(weight, replace(survey, measurements=(*before, alike, *after)))


def _likelier(survey: Survey, m: Measurement) -> Measurement:
    """A measurement, or that with runs from the other side where this is more probable."""
    turned = None if m.assumed is None else m.assumed.turned()
    if turned is None:
        return m
    other = turned.measurement()
    if _log_probability(survey, other) <= _log_probability(survey, m):
        return m
    told = (note for note in m.notes if note.kind is not Kind.CLOCK)
    return replace(other, notes=tuple(dict.fromkeys((*other.notes, *told))))


def _rows_of(m: Measurement, other: Measurement) -> np.ndarray:
    """Where each reading of a measurement stands in another order, (n,) int."""
    rows = np.empty(len(m), dtype=int)
    rows[np.argsort(m.id)] = np.argsort(other.id)
    return rows


def _log_probability(survey: Survey, m: Measurement) -> float:
    """Of one test, beside what may warm in its time: a shift and a stretch that wander."""
    alone = replace(survey, measurements=(m,))
    (path,) = alone.paths
    nose = m.states.nose_mm
    axis = int(np.argmax(np.ptp(nose, axis=0)))
    middle, half = 0.5 * (nose[:, axis].min() + nose[:, axis].max()), 0.5 * np.ptp(nose[:, axis])
    place = ((nose[:, axis] - middle) / max(half, 1.0))[:, None]
    wave = wandering(path.time_s, max(float(np.ptp(path.time_s)), 1.0) / _WAVES)
    warming = float(np.median(m.u_mm)) * np.hstack([wave, place * wave])
    members = members_of(alone)
    beside = Members(members.fixed_mm, (*members.names, ""), (*members.columns_mm, warming))
    base = Base(alone, FeatureNoise(m.u_mm, alone.group, np.ones(len(m))), beside)
    plain = np.hstack([path.play_side[:, [axis]], place, place**2])
    effects = Effects(base.columns(_WIDE_MM * plain))
    sizes = Sizes(1.0, (_START,) * len(beside.names))
    prior = 0.0 if m.assumed is None else float(np.log(m.assumed.clock.weight))
    return best_sizes(base, sizes, effects).log_probability + prior
