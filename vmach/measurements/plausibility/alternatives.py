"""Would readings agree with the model far better under another assumption about the files?

A sign, a letter or a unit that is wrong gives readings which no effect explains. Each of these
mistakes is tried: the model is asked again with it put right.

Source: closed form derived here: what grows in proportion with the place is taken off before both
are compared.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.measurements.measurement import Measurement

__all__ = [
    "BETTER",
    "CLEAR_U",
    "CLOSE_U",
    "FAR_BETTER",
    "FEWEST_LEFT",
    "WITHIN_U",
    "Alternative",
    "Mistake",
    "alternative_notes",
    "is_doubtful",
    "other_sign",
]

#: readings further away than so many standard uncertainties are worth a question
CLEAR_U = 2.0
#: readings that agree so many times better the other way round are suspicious
BETTER = 2.0
#: where they do not come as close as so many standard uncertainties, so many times better: an
#: effect may have brought them there
CLOSE_U, FAR_BETTER = 4.0, 5.0
#: and so many times better once displacements that grow in proportion with the place are taken
#: off: a scale or a squareness may bring readings of one axis near the tables of another
_BETTER_BENT = 2.0
#: what brings readings within so many standard uncertainties leaves nothing to an effect; it has to
#: be so many times better than a scale and a squareness would be; chosen: of readings that scatter
#: alike the logarithm of this is 1/6 each
WITHIN_U, _BETTER_THAN_BENT = 1.25, 1.2
#: so many times the nearest is as near: some mistakes do the same to all readings, up to rounding
_ALIKE = 1.001
#: readings beyond the number of what is free, below which nothing can be said
FEWEST_LEFT = 12


@dataclass(frozen=True)
class Mistake:
    """What may be wrong in the files.

    Attributes
    ----------
    what : str
        The thing put right, after "with".
    question : str
        What the user should look at.
    """

    what: str
    question: str


@dataclass(frozen=True)
class Alternative(Mistake):
    """What the model would predict if one thing in the files were different.

    Attributes
    ----------
    predicted_mm : (P,) float64
        Of the readings.
    """

    predicted_mm: np.ndarray


def other_sign(test: Measurement) -> Alternative:
    """The readings with their sign turned round."""
    meaning = f"{test.instrument.sign_meaning}, and the error tables use the same sign"
    return Alternative("the other sign", meaning, -test.predicted_mm)


def is_doubtful(test: Measurement) -> bool:
    """Whether readings are further from the model than their uncertainty says."""
    if test.degrees < FEWEST_LEFT:
        return False
    apart = test.variation_mm(test.measured_mm - test.predicted_mm)
    return apart >= CLEAR_U * float(np.median(test.u_mm))


def alternative_notes(test: Measurement, others: Iterable[Alternative]) -> tuple[Note, ...]:
    """A note where readings would agree far better under an alternative assumption.

    Parameters
    ----------
    test : Measurement
    others : iterable of Alternative
        What may be wrong. Of those that explain the readings alike the first is asked about.

    Returns
    -------
    tuple of Note
        Empty where all looks right, or where the model says too little to tell.
    """
    if not is_doubtful(test):
        return ()
    here, u_mm = _apart_mm(test, test.predicted_mm), float(np.median(test.u_mm))
    plain, _ = here
    found = []
    for other in others:
        there = _apart_mm(test, other.predicted_mm)
        if _is_far_better(here, there, u_mm) or _explains_all(here, there, u_mm):
            found.append((there[0], other))
    if not found:
        return ()
    alike = _ALIKE * min(apart for apart, _ in found)
    apart, best = next(pair for pair in found if pair[0] <= alike)
    said = (
        f"with {best.what} the readings would agree with the model within {um_from_mm(apart):.2f} "
        f"um instead of {um_from_mm(plain):.2f} um (rms): {best.question}"
    )
    size_um = float(um_from_mm(plain))
    return (Note.question(Kind.EXCHANGED, said, size_um, "um", place=best.what, file=test.name),)


def _is_far_better(here: tuple[float, float], there: tuple[float, float], u_mm: float) -> bool:
    """Whether readings are far closer there, also once what is even is taken off of both."""
    (plain, bent), (apart, apart_bent) = here, there
    is_close = apart <= CLOSE_U * u_mm or plain >= FAR_BETTER * apart
    return is_close and plain >= BETTER * apart and bent >= _BETTER_BENT * apart_bent


def _explains_all(here: tuple[float, float], there: tuple[float, float], u_mm: float) -> bool:
    """Whether nothing is left to explain there, and something here even without what is even."""
    (plain, bent), (apart, _) = here, there
    is_all = apart <= WITHIN_U * u_mm
    return is_all and plain >= BETTER * apart and bent >= _BETTER_THAN_BENT * apart


def _apart_mm(test: Measurement, predicted_mm: np.ndarray) -> tuple[float, float]:
    """Root mean square of measured minus predicted: what is free taken off; and what is even."""
    residual = test.measured_mm - predicted_mm
    place = test.states.nose_mm - test.states.nose_mm.mean(axis=0)
    even = [test.sensing[:, :1] * place, test.sensing[:, 1:2] * place, test.sensing[:, 2:] * place]
    free = np.hstack([test.nuisance, *even])
    left = residual - free @ np.linalg.lstsq(free, residual, rcond=None)[0]
    degrees = max(len(test) - int(np.linalg.matrix_rank(free)), 1)
    return test.variation_mm(residual), float(np.sqrt(left @ left / degrees))
