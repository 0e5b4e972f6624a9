"""A proposal as the file of an effect, ready for ``vmach diagnose --effect-file`` and ``add``."""

from __future__ import annotations

from vmach.diagnosis.proposals.proposal import Proposal

__all__ = ["effect_text"]

_TEXT = '''"""Proposed for what no effect of the catalogue explains.

{formula}
"""

import numpy as np

from vmach.effects import Effect, linear


class {kind}(Effect):
    """Proposed with {amount:.3g} um (u = {u:.2g}); log odds {odds:.0f}."""

    name = "{name}"
    title = "{formula}"
    parameters = (linear("amount_um", "displacement at states of one", usual=5.0),)
    targets = ("",)
    needs_surface = {needs_surface}
    usual_size = "{amount:.3g} um where it was proposed"
    confirm = (
        "{refute},"
        " {direction_words}"
    )
    cure = "find what does it, then mend or compensate it"

    def displacement(self, path, target, amount_um):
        state = np.ones(len(path))
{states}
        direction = {direction}
        return 1e-3 * amount_um * np.nan_to_num(state)[:, None] * direction
'''


def effect_text(proposal: Proposal, *, name: str) -> str:
    """Python of an effect of this name."""
    form = proposal.form
    return _TEXT.format(
        formula=form.formula,
        kind="".join(word.capitalize() for word in name.split("_")),
        name=name,
        amount=proposal.amount_um,
        u=proposal.u_um,
        odds=proposal.odds,
        needs_surface=form.direction.needs_surface,
        refute=form.refute,
        direction_words=form.direction.words,
        states="\n".join(f"        state *= {s.code}" for s in form.states),
        direction=form.direction.code,
    )
