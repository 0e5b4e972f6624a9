"""What stands beside effects when their intervals are worked out: with what is like them.

A search leaves to an effect whatever does the same: else a field or a drift of unknown size takes
its place. How large the effect is, is known no better than what is like it. So the smooth field
has a share of what plain laws do again, and the measuring machine may drift at one speed: row by
row of a plate that is a squareness, or a scale.

Source: M. Plumlee, J. Am. Stat. Assoc. 112 (2017) 1274, what is flexible made orthogonal to what
is plain, of which a share is kept here.
"""

from __future__ import annotations

import numpy as np

from vmach.fit.noise.discrepancy import Members, members_of
from vmach.fit.noise.measuring_machine import steady_drifts_of_device
from vmach.fit.survey import Survey

__all__ = ["open_members"]

#: share of what the smooth field does along plain laws. Its size is told by waves of twice the
#: frequency, half as high: it is taken to be no higher where they do not tell it
_LIKE_EFFECTS = 0.5


def open_members(survey: Survey, searched: Members) -> Members:
    """The members of a search, and what readings cannot tell from effects.

    Those of the search have the names that they had.
    """
    members = members_of(survey, searched.plain_mm, kept=_LIKE_EFFECTS)
    columns = dict(zip(members.names, members.columns_mm, strict=True))
    unit = float(np.median(survey.u_mm))
    drifts = {name: unit * own for name, own in steady_drifts_of_device(survey).items()}
    columns |= {name: own for name, own in drifts.items() if own.any()}
    return Members(members.fixed_mm, tuple(columns), tuple(columns.values()))
