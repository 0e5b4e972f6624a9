"""What the foreign causes depend on, in the words of states that a proposal may name.

Of burrs, single features and thin walls it is the feature, which is no state of the machine: these
have no entry.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["TRUE_STATES", "names_true_states"]

_TIME = r"time|warm-up|order of measuring|spindle|tool change"
_PLACE = r"[XYZ]²? in 100 mm|mm in [XYZ]"
_REVERSAL = r"direction of [XYZ]|after [XYZ] turned"
_WALL = r"round the walls|look inwards"
_CUT = r"cutting length"

#: one pattern for each state that the cause needs
TRUE_STATES: dict[str, tuple[str, ...]] = {
    "bump_field": (_PLACE,),
    "checkerboard": (_PLACE,),
    "chatter": (f"{_PLACE}|{_CUT}",),
    "mirror": (_WALL,),
    "loose_collet": (rf"tool \d|{_TIME}|{_CUT}",),
    "hot_spot": (_PLACE,),
    "waves_along_the_feed": (_CUT,),
    "springback": (_PLACE,),
    "chiller": (_TIME,),
    "lobed_probe": (_WALL,),
    "press_next_door": (_TIME,),
    "yaw_play": (_REVERSAL, _PLACE),
    "ringing": (_REVERSAL,),
    "divided_wrongly": (_PLACE,),
    "tapered_tool": (r"tool \d", r"height above the tip|depth below"),
    "worn_screw": (_REVERSAL, _PLACE),
    "loosening_nut": (_REVERSAL, _TIME),
    "stick_slip": (r"speed", _REVERSAL),
    "swinging_head": (r"acceleration",),
    "nodding_column": (r"speed", _PLACE),
    "loose_gib": (_REVERSAL, _PLACE),
    "swelling_walls": (r"depth below|height above", _TIME),
    "pulsing_oil": (_TIME,),
}


def names_true_states(kind: str, proposals: Sequence[dict], *, first: int = 3) -> bool:
    """Whether one of the first proposals holds all states that a cause of this kind needs."""
    return any(
        all(any(re.search(one, words) for words in proposal["states"]) for one in TRUE_STATES[kind])
        for proposal in proposals[:first]
    )
