"""A proposal as the file of an effect, ready for ``vmach diagnose --effect-file`` and ``add``."""

from __future__ import annotations

from vmach.diagnosis.proposals.form import USUAL_UM
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.proposals.states import CONSTANT

__all__ = ["effect_text"]

#: what a single amount is of
_ONE = "displacement per unit of its states"
_TEXT = '''"""Proposed for what no effect of the catalogue explains.

{formula}
"""

import numpy as np

from vmach.effects import Effect, linear


class {kind}(Effect):
    """Proposed with {size}; log odds {odds:.0f}."""

    name = "{name}"
    title = "{formula}"
    parameters = (
{parameters}
    )
    targets = ("",)
    needs_surface = {needs_surface}
    usual_size = "{size} where it was proposed"
    confirm = (
        "{refute}"
    )
    cure = "find what does it, then mend or compensate it"

    def displacement(self, path, target, **amount_um):
        state = np.ones((len(path), 1))
{states}
        directions = np.reshape({direction}, (len(path), 3, -1))
        # each number of the state into each direction has an amount of its own
        moved = directions[:, :, :, None] * np.nan_to_num(state)[:, None, None, :]
        amounts = np.array([amount_um[p.name] for p in self.parameters])
        return 1e-3 * moved.reshape(len(path), 3, -1) @ amounts
'''


def effect_text(proposal: Proposal, *, name: str) -> str:
    """Python of an effect of this name."""
    form = proposal.form
    states = [s for s in (form.first, form.second) if s is not CONSTANT]
    return _TEXT.format(
        formula=form.formula,
        kind="".join(word.capitalize() for word in name.split("_")),
        name=name,
        size=_size(proposal),
        odds=proposal.odds,
        parameters="\n".join(
            f'        linear("{name}", "{of or _ONE}", usual={USUAL_UM}),'
            for name, of in zip(proposal.amounts_um, form.each, strict=True)
        ),
        needs_surface=form.needs_surface,
        refute=form.refute,
        states="\n".join(
            f"        state = state * np.reshape({s.code}, (len(path), -1))" for s in states
        ),
        direction=form.direction.code,
    )


def _size(proposal: Proposal) -> str:
    """Its amount; of several, that have no size in common, what they do to the readings."""
    if len(proposal.amounts_um) > 1:
        return f"{proposal.size_um:.3g} um RMS"
    return f"{proposal.amount_um:.3g} um (u = {proposal.amount_u_um:.2g})"
