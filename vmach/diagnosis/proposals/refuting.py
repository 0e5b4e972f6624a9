"""What to do that would refute a form: what it depends on is varied, and all else stays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from vmach.diagnosis.proposals.states import State
from vmach.machine import LINEAR_AXES

__all__ = ["ELSEWHERE", "TILT", "refuting_tests"]

#: where a form depends on nothing but places
ELSEWHERE = (
    "clamp the part elsewhere on the table and cut it again: it has to change with the place"
)
#: of a form that turns the tool, as a level sees it
TILT = (
    "read the tilts again while nothing else changes, with what it depends on twice as large or "
    "turned round: they have to follow"
)
#: by kind of state
_TESTS = {
    "direction": "cut the same surfaces in the opposite direction: the sign has to turn",
    "speed": "cut the same surfaces at twice the feed: it has to double",
    "low speed": "cut the same surfaces at three times the feed: it has to fade",
    "acceleration": "cut the same path with half the acceleration of the axes: it has to halve",
    "travel since reversal": "let the axis run further before it comes to the surface: it has to "
    "fade",
    "ringing": "cut the same surfaces at half the feed: the period has to stay, in seconds",
    "position": ELSEWHERE,
    "time": "let the program wait half an hour in its middle: what is cut after it has to move by "
    "as much as the time says",
    "order of measuring": "measure the same points in the opposite order: it has to turn with them",
    "warm-up": "cut the part again on the warm machine: the change has to be gone",
    "time since tool change": "wait ten minutes after the tool change before cutting: the first "
    "surfaces have to be like the last",
    "spindle": "let the spindle run for an hour before cutting: the change has to be gone",
    "spindle speed": "cut the same surfaces at half the spindle speed and the same feed: it has to "
    "halve",
    "cutting length": "put in a new tool in the middle: it has to begin anew",
    "feed per tooth": "cut the same surfaces at twice the feed per tooth: it has to double",
    "depth": "cut the same walls half as deep: it has to follow the depth",
    "tool": "cut the same surfaces with another tool of that kind: it has to be gone",
    "tool change": "cut the same surfaces in another order of the tools: it has to follow the "
    "tool change",
    "height above the tip": "cut the same walls in twice as many passes: it has to follow the "
    "height above the tip",
    "chip load": "leave half the allowance on the same walls: it has to halve",
    "side of the wall": "cut a boss and a bore of one diameter: they have to differ by twice as "
    "much",
    "direction of the wall": "cut the part turned by 45 degrees: it has to stay with the "
    "directions of the walls",
    "spot": "clamp the part elsewhere on the table and cut it again: the spot has to stay where "
    "it is said to be, in the machine or on the part",
    "stretch of time": "cut the features in another order: it has to come at the same time, on "
    "other features",
    "wave in time": "cut the part at half the feed: the period has to stay, in seconds",
    "wave in cutting length": "cut the part at half the feed: the period has to stay, in mm of cut",
    **{
        f"wave in {axis}": f"clamp the part half a period further along {axis}: the wave has to "
        "stay in the machine"
        for axis in LINEAR_AXES
    },
}


#: what has to be seen where the test changes two states of a product
_OF_BOTH = {"double": "grow to four times", "halve": "fall to a quarter"}


def refuting_tests(states: Sequence[State]) -> str:
    """What to do, and what has to be seen if a product of states is true.

    A test that changes both states changes their product twice.
    """
    told = []
    for test, count in Counter(_TESTS[state.kind] for state in states).items():
        do, _, seen = test.rpartition(": ")
        if test == _TESTS["direction"] and sum(state.turns for state in states) % 2 == 0:
            seen = "the sign has to stay"
        if count > 1:
            for one, both in _OF_BOTH.items():
                seen = seen.replace(one, both)
        told.append(f"{do}: {seen}")
    return "; ".join(told)
