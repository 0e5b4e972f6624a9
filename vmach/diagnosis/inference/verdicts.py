"""A verdict for each effect, and what remains beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.base.units import um_from_mm
from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.moves import search
from vmach.diagnosis.inference.noise import noise_after
from vmach.diagnosis.inference.rules import DOMINATES, SHOWN, STRUCTURE, TRUST
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.terms import Term

__all__ = ["Inference", "Weak", "infer", "odds_of", "remains_um", "sizes_um"]

IMPOSSIBLE = "would need a size that nature does not have"
#: times that the noise of single readings is estimated anew
_PASSES = 2


@dataclass(frozen=True)
class Weak:
    """An effect that the readings speak for, though not clearly.

    Attributes
    ----------
    term : Term
    odds : float
        Log odds for it, given everything else, divided by the dispersion.
    why : str
        Why it is not shown.
    """

    term: Term
    odds: float
    why: str


@dataclass(frozen=True)
class Inference:
    """What was found.

    Attributes
    ----------
    weighing : Weighing
        With the noise that the readings show.
    explanation : Explanation
        By the effects that are shown.
    odds : tuple of float
        Log odds of each, given everything else, divided by the dispersion.
    weak : tuple of Weak
    remains_um : float
        Root mean square of what neither effects nor noise explain.
    is_structure : bool
        Whether that is more than the uncertainty of one reading.
    """

    weighing: Weighing
    explanation: Explanation
    odds: tuple[float, ...]
    weak: tuple[Weak, ...]
    remains_um: float
    is_structure: bool


def infer(weighing: Weighing) -> Inference:
    """Search, noise of single readings and effects in turn, and weigh what was found."""
    found = search(weighing)
    for _ in range(_PASSES):
        noise = noise_after(weighing, found)
        if noise is None:
            break
        weighing = weighing.with_noise(noise)
        found = search(weighing, weighing.explain(found.terms, found.posterior.sizes))
    return _weighed(weighing, found)


def _weighed(weighing: Weighing, found: Explanation) -> Inference:
    """Effects that are not shown are left out one by one, the weakest first."""
    weak: list[Weak] = []
    imitated = 0.0
    while True:
        odds = odds_of(weighing, found)
        remains = float(np.hypot(remains_um(weighing, found), imitated))
        is_structure = remains > STRUCTURE * _usual_u_um(weighing)
        sizes = sizes_um(weighing, found)
        least = DOMINATES * remains if is_structure else 0.0
        k, why = _least(weighing, found, odds, sizes, least)
        if k is None:
            break
        weak.append(Weak(found.terms[k], odds[k], why))
        if why == IMPOSSIBLE and odds[k] >= SHOWN:
            # it imitates something that is there
            imitated = float(np.hypot(imitated, sizes[k]))
        found = weighing.without(found, [k])
    return Inference(weighing, found, tuple(odds), tuple(weak), remains, is_structure)


def _least(
    weighing: Weighing,
    found: Explanation,
    odds: Sequence[float],
    sizes: Sequence[float],
    least: float,
) -> tuple[int | None, str]:
    """Which effect is the first that is not shown, and why; None where all are."""
    if min(odds, default=SHOWN) < SHOWN:
        return int(np.argmin(odds)), f"log odds below {SHOWN:g}"
    if min(sizes, default=least) < least:
        return int(np.argmin(sizes)), "smaller than what remains unexplained"
    fit = weighing.careful(found)
    wrong = impossible_terms(fit) if fit else []
    return min(wrong, key=lambda k: odds[k], default=None), IMPOSSIBLE


def _usual_u_um(weighing: Weighing) -> float:
    return float(um_from_mm(np.median(weighing.survey.u_mm)))


def odds_of(weighing: Weighing, found: Explanation) -> list[float]:
    """Log odds of every effect, given everything else.

    Where something remains whose law is not known, readings are no independent witnesses: log
    odds are divided by the dispersion, the variance of what is not explained in that of noise
    (McCullagh and Nelder, Generalized Linear Models, 1989, chapter 9).
    """
    fewer = [weighing.without(found, [k]) for k in range(len(found.terms))]
    noise = weighing.survey.u_mm * found.posterior.sizes.factor
    dispersion = 1.0 + float(np.mean((remains_mm(weighing, found) / noise) ** 2))
    return [(found.score - e.score) / dispersion for e in fewer]


def remains_mm(weighing: Weighing, found: Explanation) -> np.ndarray:
    """What the discrepancy takes of the readings, alignment and zeros taken off, (n,)."""
    posterior, members = found.posterior, weighing.members
    amount = posterior.scale * posterior.mean * posterior.sizes.factor
    columns = np.hstack([np.zeros((len(weighing.survey), 0)), *members.columns_mm])
    first = members.fixed_mm.shape[1]
    taken = columns @ amount[first : first + columns.shape[1]]
    return taken - weighing.survey.aligned(taken[:, None])[:, 0]


def remains_um(weighing: Weighing, found: Explanation) -> float:
    """Root mean square of the discrepancy, and of scatter beyond what noise may be."""
    beyond = max(found.posterior.sizes.factor**2 - TRUST**2, 0.0)
    scatter = beyond * _usual_u_um(weighing) ** 2
    return float(np.sqrt(_rms_um(remains_mm(weighing, found)) ** 2 + scatter))


def _rms_um(values_mm: np.ndarray) -> float:
    return float(um_from_mm(np.sqrt(np.mean(values_mm**2))))


def sizes_um(weighing: Weighing, found: Explanation) -> Sequence[float]:
    """Root mean square of what each effect does to the aligned readings."""
    if found.fit is None:
        return ()
    explained = [found.fit.explained_mm(k) for k in range(len(found.terms))]
    aligned = [e - weighing.survey.aligned(e[:, None])[:, 0] for e in explained]
    return tuple(_rms_um(a) for a in aligned)
