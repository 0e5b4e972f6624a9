"""A form that would explain what remains, with what speaks for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from vmach.diagnosis.proposals.form import Form

__all__ = ["Proposal"]


@dataclass(frozen=True)
class Proposal:
    """A form for what remains.

    Attributes
    ----------
    form : Form
    amounts_um, u_um : mapping of str to float
        Amplitudes with their standard uncertainties.
    size_um : float
        Root mean square of what it does to the aligned readings.
    odds : float
        Log odds beside the effects that are shown and the discrepancy.
    remains_um : float
        What would remain with it.
    held_out_um : (float, float)
        Root mean square of features that were not fitted, without and with it.
    """

    form: Form
    amounts_um: Mapping[str, float]
    u_um: Mapping[str, float]
    size_um: float
    odds: float
    remains_um: float
    held_out_um: tuple[float, float]

    def share_left(self, noise_um: float) -> float:
        """Share of what is beyond noise that it leaves of features that were not fitted."""
        without, left = (max(held**2 - noise_um**2, 0.0) for held in self.held_out_um)
        return math.sqrt(left / without) if without > 0.0 else 1.0

    @property
    def amount_um(self) -> float:
        """The amplitude; of several the root of the sum of their squares."""
        values = list(self.amounts_um.values())
        return values[0] if len(values) == 1 else math.hypot(*values)

    @property
    def words(self) -> str:
        """Formula and size for people; several amounts have no size in common but what they do."""
        done = f"{self.size_um:.2f} um RMS of these readings"
        if len(self.amounts_um) > 1:
            return f"{self.form.formula}: {done}"
        amount = f"{self.amount_um:.3g} um (u = {self.amount_u_um:.2g})"
        return f"{amount} x {self.form.formula}: {done}"

    @property
    def of_each(self) -> dict[str, str]:
        """What each of several amounts is of, by its name; empty where there is one."""
        if len(self.amounts_um) == 1:
            return {}
        return dict(zip(self.amounts_um, self.form.each, strict=True))

    @property
    def clear_amounts(self) -> list[str]:
        """Names of those of several amounts that are not zero, by 95 % intervals (GUM, 6.3.3)."""
        return [n for n in self.of_each if abs(self.amounts_um[n]) > 2.0 * self.u_um[n]]

    @property
    def amount_u_um(self) -> float:
        """Its standard uncertainty, of several the largest."""
        return max(self.u_um.values())
