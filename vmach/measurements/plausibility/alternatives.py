"""Would readings agree with the model far better under another assumption about the files?

A sign, a letter or a unit that is wrong gives readings which no effect explains. Each of these
mistakes is tried: the model is asked again with it put right.

Source: closed form derived here: what grows in proportion with the place is taken off before both
are compared.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.machine import LINEAR_AXES, Machine
from vmach.measurements.measurement import Measurement

__all__ = ["Alternative", "alternative_notes", "exchanged", "exchanged_tables", "is_doubtful"]

#: readings further away than so many standard uncertainties are worth a question
_CLEAR_U = 2.0
#: readings that agree so many times better the other way round are suspicious
_BETTER = 2.0
#: where they do not come as close as so many standard uncertainties, so many times better: an
#: effect may have brought them there
_CLOSE_U, _FAR_BETTER = 4.0, 5.0
#: and so many times better once displacements that grow in proportion with the place are taken
#: off: a scale or a squareness may bring readings of one axis near the tables of another
_BETTER_BENT = 2.0
#: readings beyond the number of what is free, below which nothing can be said
_FEWEST_LEFT = 12


@dataclass(frozen=True)
class Alternative:
    """What the model would predict if one thing in the files were different.

    Attributes
    ----------
    what : str
        The thing put right, after "with".
    question : str
        What the user should look at.
    predicted_mm : (P,) float64
        Of the readings.
    """

    what: str
    question: str
    predicted_mm: np.ndarray


def is_doubtful(test: Measurement) -> bool:
    """Whether readings are further from the model than their uncertainty says."""
    if test.degrees < _FEWEST_LEFT:
        return False
    apart = test.variation_mm(test.measured_mm - test.predicted_mm)
    return apart >= _CLEAR_U * float(np.median(test.u_mm))


def alternative_notes(test: Measurement, others: Iterable[Alternative]) -> tuple[Note, ...]:
    """A note where readings would agree far better under an alternative assumption.

    Parameters
    ----------
    test : Measurement
    others : iterable of Alternative
        What may be wrong beside the sign of the readings.

    Returns
    -------
    tuple of Note
        Empty where all looks right, or where the model says too little to tell.
    """
    if not is_doubtful(test):
        return ()
    plain, bent = _apart_mm(test, test.predicted_mm)
    close = _CLOSE_U * float(np.median(test.u_mm))
    found = []
    for other in (_other_sign(test), *others):
        apart, apart_bent = _apart_mm(test, other.predicted_mm)
        if apart > close and plain < _FAR_BETTER * apart:
            continue
        if plain >= _BETTER * apart and bent >= _BETTER_BENT * apart_bent:
            found.append((apart, other))
    if not found:
        return ()
    apart, best = min(found, key=lambda pair: pair[0])
    said = (
        f"with {best.what} the readings would agree with the model within {um_from_mm(apart):.2f} "
        f"um instead of {um_from_mm(plain):.2f} um (rms): {best.question}"
    )
    size_um = float(um_from_mm(plain))
    return (Note.question(Kind.EXCHANGED, said, size_um, "um", place=best.what, file=test.name),)


def _other_sign(test: Measurement) -> Alternative:
    meaning = f"{test.instrument.sign_meaning}, and the error tables use the same sign"
    return Alternative("the other sign", meaning, -test.predicted_mm)


def _apart_mm(test: Measurement, predicted_mm: np.ndarray) -> tuple[float, float]:
    """Root mean square of measured minus predicted: what is free taken off; and what is even."""
    residual = test.measured_mm - predicted_mm
    place = test.states.nose_mm - test.states.nose_mm.mean(axis=0)
    even = [test.sensing[:, :1] * place, test.sensing[:, 1:2] * place, test.sensing[:, 2:] * place]
    free = np.hstack([test.nuisance, *even])
    left = residual - free @ np.linalg.lstsq(free, residual, rcond=None)[0]
    degrees = max(len(test) - int(np.linalg.matrix_rank(free)), 1)
    return test.variation_mm(residual), float(np.sqrt(left @ left / degrees))


def exchanged_tables(machine: Machine) -> Iterator[tuple[str, Machine]]:
    """The machine with forward and backward exchanged in the tables of one axis, or of all.

    None where the mean of both acts.
    """
    if not machine.separate_directions:
        return
    for axes in (*LINEAR_AXES, LINEAR_AXES):
        yield " and ".join(axes), _exchanged(machine, axes)


def exchanged(axes: str, predicted_mm: np.ndarray) -> Alternative:
    """What the model says with such tables, (P,) mm."""
    return Alternative(
        f"forward and backward of {axes} exchanged",
        "is approach the sign of the last motion, and are the columns of the error tables in "
        "their order?",
        predicted_mm,
    )


def _exchanged(machine: Machine, axes: Sequence[str]) -> Machine:
    components = {
        name: replace(table, forward=table.backward, backward=table.forward)
        if name[-1] in axes
        else table
        for name, table in machine.components.items()
    }
    return replace(machine, components=components)
