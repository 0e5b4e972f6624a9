"""What stands beside effects when their intervals are worked out: with what is like them.

A search leaves to an effect whatever does the same: else a drift of unknown size takes its place.
How large the effect is, is known no better than what is like it. So the measuring machine may drift
at one speed: row by row of a plate that is a squareness, or a scale.
"""

from __future__ import annotations

import numpy as np

from vmach.fit.noise.discrepancy import Members
from vmach.fit.noise.measuring_machine import steady_drifts_of_device
from vmach.fit.survey import Survey

__all__ = ["open_members"]


def open_members(survey: Survey, searched: Members) -> Members:
    """The members of a search by their names, and what readings cannot tell from effects."""
    columns = dict(zip(searched.names, searched.columns_mm, strict=True))
    unit = float(np.median(survey.u_mm))
    drifts = {name: unit * own for name, own in steady_drifts_of_device(survey).items()}
    columns |= {name: own for name, own in drifts.items() if own.any()}
    return Members(searched.fixed_mm, tuple(columns), tuple(columns.values()))
