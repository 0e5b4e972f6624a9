"""What a measuring machine that drifts steadily would show as an effect of the machine tool."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.base.note import Kind, Note
from vmach.diagnosis.inference.verdicts import Inference
from vmach.fit.noise.measuring_machine import steady_drifts_of_device
from vmach.fit.whitening import orthonormal, share_within

__all__ = ["like_drift"]

#: cosine from which on an effect is told as like a drift; chosen: of such an effect more than four
#: fifths of the variance are what a drift does
_ALIKE = 0.9


def like_drift(found: Inference) -> Iterator[Note]:
    """A note on each effect that is shown and looks like a drift while the part was measured."""
    fit = found.fit
    if fit is None:
        return
    base = fit.posterior.base
    drifts = orthonormal(base.white(np.hstack([*steady_drifts_of_device(base.survey).values()])))
    for k, term in enumerate(fit.terms[: len(found.supports)]):
        own = fit.signatures[k].white @ fit.coefficients[k]
        if share_within(orthonormal(own[:, None]), drifts) > _ALIKE:
            said = (
                f"{term.label} looks like a steady drift while the part was measured: the "
                "interval counts one; measured again in another order, the two are told apart"
            )
            yield Note.plain(Kind.CLOCK, said, place=term.label)
