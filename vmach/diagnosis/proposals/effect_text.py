"""A proposal as the file of an effect, ready for ``vmach diagnose --effect-file`` and ``add``."""

from __future__ import annotations

from vmach.diagnosis.proposals.form import USUAL_UM, Form
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.proposals.states import CONSTANT

__all__ = ["effect_text"]

#: what a single amount is of
_ONE = "displacement per unit of its states"
#: what is given back of a tilt, about the tip
_TILTED = "RigidDisplacement(np.zeros_like(moved), moved)"
_ONE_AMOUNT = """\
    def displacement(self, path, target, amount_um):
        size_um = amount_um * {states}
        moved = 1e-3 * size_um[:, None] * {direction}
        return {done}"""
_SEVERAL_AMOUNTS = """\
    def displacement(self, path, target, **amount_um):
        amounts = np.array([amount_um[p.name] for p in self.parameters])
        states = {states}
        directions = {direction}
        # each number of the states into each direction has an amount of its own
        moved = directions.reshape(len(path), 3, -1, 1) * states.reshape(len(path), 1, 1, -1)
        moved = 1e-3 * moved.reshape(len(path), 3, -1) @ amounts
        return {done}"""
_TEXT = '''"""Proposed for what no effect of the catalogue explains.

{formula}
"""

import numpy as np

from vmach.effects import Effect, linear
{imported}

class {kind}(Effect):
    """Proposed with {size}; log odds {odds:.0f}."""

    name = "{name}"
    title = "{formula}"
    law = "amount x {formula}"
    shows_as = "{formula}"
    source = "proposed from measurements"
    parameters = (
{parameters}
    )
    targets = ("",)
    needs_surface = {needs_surface}
{more}    usual_size = "{size} where it was proposed"
    confirm = (
        "{refute}"
    )
    cure = "find what does it, then mend or compensate it"

{displacement}
'''


def effect_text(proposal: Proposal, *, name: str) -> str:
    """Python of an effect of this name."""
    form = proposal.form
    return _TEXT.format(
        formula=form.formula,
        kind="".join(word.capitalize() for word in name.split("_")),
        name=name,
        size=_size(proposal),
        odds=proposal.odds,
        parameters="\n".join(
            f'        linear("{amount}", "{of or _ONE}", usual={USUAL_UM}),'
            for amount, of in zip(proposal.amounts_um, form.each, strict=True)
        ),
        needs_surface=form.needs_surface,
        more="    turns_tool = True\n" * form.direction.turns_tool
        + "    follows_travel = True\n" * form.follows_travel,
        imported="from vmach.machine import RigidDisplacement\n" * form.direction.turns_tool,
        refute=form.refute,
        displacement=_displacement(form),
    )


def _displacement(form: Form) -> str:
    """The method that works out what one form does."""
    is_wide = any(len(state.each) > 1 for state in form.states)
    states = [
        f"np.nan_to_num({state.code})" + "[:, None]" * (is_wide and len(state.each) == 1)
        for state in form.states
    ]
    text = _ONE_AMOUNT if len(form.each) == 1 else _SEVERAL_AMOUNTS
    product = " * ".join(states or [CONSTANT.code])
    done = _TILTED if form.direction.turns_tool else "moved"
    return text.format(states=product, direction=form.direction.code, done=done)


def _size(proposal: Proposal) -> str:
    """Its amount; of several, that have no size in common, what they do to the readings."""
    if len(proposal.amounts_um) > 1:
        return f"{proposal.size_um:.3g} um RMS"
    return f"{proposal.amount_um:.3g} um (u = {proposal.amount_u_um:.2g})"
