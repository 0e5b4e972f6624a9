"""Is the stated uncertainty of the readings right? By what an explanation leaves of them.

All measurements share one unknown factor of their uncertainties, and each has one of its own where
its readings show it. A wrong one is asked about all the same: it may hide what nobody models.

Source: closed form derived here: the median of absolute normal values is 0.6745 of their standard
deviation.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.base.note import Kind, Note
from vmach.diagnosis.inference.verdicts import Inference
from vmach.fit.noise.own_scale import AS_STATED, EXACT, FEW
from vmach.measurements import MEDIAN_OF_NORMAL

__all__ = ["TOO_LOUD", "doubtful_uncertainty"]

#: scatter in stated uncertainties outside which u_um is doubtful
_TOO_QUIET, TOO_LOUD = 1.0 / 3.0, 1.5
#: the same of one measurement among others; chosen: what it sees alone makes it louder
_ONE_TOO_LOUD = 2.5
#: times that the scatter of one measurement differs from that of all others where it is its own
_OF_ITS_OWN = 2.0


def doubtful_uncertainty(found: Inference) -> Iterator[Note]:
    """Notes where the rest scatters far less or more than the readings' uncertainty says."""
    yield from _of_all(found)
    measurements = found.weighing.survey.measurements
    if len(measurements) > 1:
        scatter, is_own = _scatter(found), not found.weighing.base.noise.own_scale.is_as(AS_STATED)
        for k, measurement in enumerate(measurements):
            others = np.concatenate(scatter[:k] + scatter[k + 1 :])
            yield from _of_one(measurement.name, scatter[k], others, is_own=is_own)


def _of_all(found: Inference) -> Iterator[Note]:
    factor = found.told.posterior.sizes.factor
    if factor < _TOO_QUIET:
        said = (
            f"what is left scatters {1.0 / factor:.3g} times less than u_um says: is u_um "
            "too large? Effects may then stay unseen, and intervals are too wide"
        )
        yield Note.question(Kind.SCATTER, said, float(factor), "1", place="u_um")
    if factor > TOO_LOUD:
        said = (
            f"readings scatter {factor:.3g} times more than u_um says: the scatter that they "
            "show is what counted"
        )
        yield Note.plain(Kind.SCATTER, said, float(factor), "1", place="u_um")


def _scatter(found: Inference) -> list[np.ndarray]:
    """What is left of the readings of each measurement, in stated standard uncertainties."""
    posterior, survey = found.told.posterior, found.weighing.survey
    noise = found.weighing.base.noise
    left = np.abs(noise.standardised(posterior.left)) * noise.own_scale.of_readings
    return [posterior.sizes.factor * left[rows] for rows in survey.rows]


def _of_one(name: str, own: np.ndarray, others: np.ndarray, *, is_own: bool) -> Iterator[Note]:
    """A question where one measurement scatters otherwise than it says, and the others do not.

    Its own scatter may have counted.
    """
    if min(len(own), len(others)) < FEW:
        return
    here, there = (float(np.median(values)) / MEDIAN_OF_NORMAL for values in (own, others))
    if here < min(_TOO_QUIET, there / _OF_ITS_OWN):
        how, size, whose = f"{1.0 / max(here, EXACT):.3g} times less", "large", "of the others"
    elif here > max(_ONE_TOO_LOUD, there * _OF_ITS_OWN):
        how, size, whose = f"{here:.3g} times more", "small", "of these readings"
    else:
        return
    counted = f"an effect may be told for the noise {whose}"
    if is_own:
        counted = "the scatter that they show is what counted"
    said = (
        f"its readings scatter {how} than its u_um says, those of the other measurements "
        f"{there:.2g} times what theirs says: is its u_um too {size}? Here {counted}"
    )
    yield Note.question(Kind.SCATTER, said, here, "1", place="u_um", file=name)
