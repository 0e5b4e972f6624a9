"""Which effects do nearly the same as a given one, as far as readings show?

Source: closed form derived here: the share of one signature that least squares on another leaves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.effects import Effect, catalogue, label_of
from vmach.effects.trial_path import trial_path
from vmach.fit.candidates import Candidate, gather_candidates
from vmach.fit.survey import Survey
from vmach.fit.whitening import orthonormal
from vmach.measurements import Instrument, Measurement
from vmach.path.toolpath import PathStates

__all__ = ["Alike", "alike_effects", "trial_survey"]

#: an effect of which another one leaves less than this share cannot be told from it
_LITTLE = 0.2
#: standard uncertainty of every reading of the trial
_U_MM = 1e-3


@dataclass(frozen=True)
class Alike:
    """Another effect that does nearly the same.

    Attributes
    ----------
    target : str
        Of the effect that is compared.
    label : str
        Name and target of the other one.
    share_left : float
        Of the effect's signature, once the other one is fitted to it.
    """

    target: str
    label: str
    share_left: float


def alike_effects(survey: Survey, effect: Effect) -> tuple[Alike, ...]:
    """Effects of the catalogue that leave little of an effect, the closest first.

    What the instruments leave free, and what is uncertain of the tables, is taken off both.
    """
    own, _ = gather_candidates(survey, [effect])
    others, _ = gather_candidates(survey, [e for e in catalogue().values() if e is not effect])
    found = []
    for mine in own:
        wanted = survey.whiten(mine.signatures_mm[:, int(np.argmax(mine.log_prior))])
        for other in others:
            share = _share_left(survey, wanted, other)
            if share < _LITTLE:
                found.append(Alike(mine.target, label_of(other.effect.name, other.target), share))
    return tuple(sorted(found, key=lambda one: one.share_left))


def _share_left(survey: Survey, wanted: np.ndarray, other: Candidate) -> float:
    """Share of whitened columns (n, K) that the best of a candidate's signatures leaves."""
    signatures = survey.whiten(other.signatures_mm)
    left = []
    for g in range(signatures.shape[1]):
        basis = orthonormal(signatures[:, g])
        left.append(np.linalg.norm(wanted - basis @ (basis.T @ wanted)))
    return float(min(left) / np.linalg.norm(wanted))


def trial_survey() -> Survey:
    """The trial part, measured at its surfaces and at the tool's tip along its path."""
    path = trial_path()
    states, count = path.states, len(path)
    arm = path.on_part_mm - path.on_part_mm.mean(axis=0)
    part = _measurement(states, path.normal, np.hstack([path.normal, np.cross(arm, path.normal)]))
    bare = PathStates(
        states.moves, states.tool_lengths_mm, states.move, states.parameter, np.zeros((count, 3))
    )
    axes = np.tile(np.eye(3), (count, 1))
    tip = _measurement(bare[np.repeat(np.arange(count), 3)], axes, axes)
    return Survey(path.job, (part, tip))


def _measurement(states: PathStates, sensing: np.ndarray, nuisance: np.ndarray) -> Measurement:
    count = len(states)
    return Measurement(
        instrument=Instrument,
        name="trial",
        id=np.arange(1, count + 1).astype(str),
        states=states,
        sensing=sensing,
        measured_mm=np.zeros(count),
        predicted_mm=np.zeros(count),
        u_mm=np.full(count, _U_MM),
        group=np.full(count, "trial"),
        nuisance=nuisance,
    )
