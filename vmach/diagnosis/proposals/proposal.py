"""A form that would explain what remains, with what speaks for it."""

from __future__ import annotations

from dataclasses import dataclass

from vmach.diagnosis.proposals.form import Form

__all__ = ["Proposal"]


@dataclass(frozen=True)
class Proposal:
    """A form for what remains.

    Attributes
    ----------
    form : Form
    amount_um, u_um : float
        Amplitude with its standard uncertainty.
    odds : float
        Log odds beside the effects that are shown and the discrepancy.
    remains_um : float
        What would remain with it.
    held_out_um : (float, float)
        Root mean square of features that were not fitted, without and with it.
    """

    form: Form
    amount_um: float
    u_um: float
    odds: float
    remains_um: float
    held_out_um: tuple[float, float]
