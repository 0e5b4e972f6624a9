"""An explanation over the surface that its own effects leave.

Of several contacts that compete for a point, the lowest one makes it. Signatures are of the
contacts that the model alone would choose; effects as large as those that were fitted may choose
others. A linear law holds between two choices.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmach.diagnosis.fitted_parameters import fitted_values
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.effects import EffectInstance
from vmach.fit.candidates import gather_candidates
from vmach.fit.survey import Survey

__all__ = ["over_own_contacts"]

#: what other contacts change of the readings, in stated uncertainties, before they matter
_NOTABLE = 0.25


def over_own_contacts(weighing: Weighing, found: Explanation) -> tuple[Weighing, Explanation]:
    """The weighing over those contacts, and the explanation there; as given where none is better.

    The readings decide: contacts that make them less probable are not the ones that were.
    """
    if found.fit is None:
        return weighing, found
    survey, fit = weighing.survey, found.fit
    acting = [
        EffectInstance(term.effect, term.target, fitted_values(fit, k), survey.job)
        for k, term in enumerate(fit.terms)
    ]
    moved = survey.made_beside(acting)
    change = _foretold_mm(moved, acting) - _foretold_mm(survey, acting)
    if not np.any(np.abs(change) > _NOTABLE * survey.u_mm):
        return weighing, found
    known, noise = weighing.candidates, weighing.base.noise
    other = Weighing(moved, known, excluded=weighing.excluded, noise=noise)
    if other.explain(found.terms, found.posterior.sizes).score <= found.score:
        return weighing, found
    effects = dict.fromkeys(candidate.effect for candidate in known)
    weighing.release()
    other = other.with_candidates(gather_candidates(moved, effects)[0])
    return other, other.explain(found.terms, found.posterior.sizes)


def _foretold_mm(survey: Survey, acting: Sequence[EffectInstance]) -> np.ndarray:
    """What model and effects foretell of the readings, (n,)."""
    total = np.concatenate([m.predicted_mm for m in survey.measurements])
    for effect in acting:
        parts = [
            m.sensed(effect.at(path, effect.parameters)[:, :, None])[:, 0]
            if effect.effect.shows_on(m.seen_states)
            else np.zeros(len(m))
            for path, m in zip(survey.seen_paths, survey.measurements, strict=True)
        ]
        total += np.concatenate(parts)
    return total
