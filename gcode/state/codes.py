"""Vocabulary of RS274/NGC: which G and M codes exist and in which modal group each one is.

G codes are written ten times their number, so that G38.2 is 382.
"""

from __future__ import annotations

__all__ = ["AXES", "CYCLES", "G_GROUPS", "IRRELEVANT_M", "M_GROUPS", "code_name"]

#: Axis words in the order of every position of six numbers.
AXES = "xyzabc"

_G_MEMBERS = {
    "nonmodal": (40, 53, 100, 280, 281, 300, 301, 520, 530, 920),
    "motion": (0, 10, 20, 30, 50, 51, 52, 330, 331, 382, 383, 384, 385, 730, 740, 760,
               *range(800, 900, 10)),
    "plane": (170, 180, 190),
    "distance": (900, 910),
    "arc_distance": (901, 911),
    "feed_mode": (930, 940, 950),
    "units": (200, 210),
    "compensation": (400, 410, 411, 420, 421),
    "tool_length": (430, 431, 432, 490),
    "retract": (980, 990),
    "system": (540, 550, 560, 570, 580, 590, 591, 592, 593),
    "control": (610, 611, 640),
    "spindle_mode": (960, 970),
    "diameter": (70, 80),
    "g92_applied": (921, 922, 923),
}  # fmt: skip

#: G code times ten -> name of its modal group.
G_GROUPS: dict[int, str] = {code: group for group, codes in _G_MEMBERS.items() for code in codes}

_M_MEMBERS = {
    "stop": (0, 1, 2, 30, 60, 99),
    "io": (62, 63, 64, 65, 66, 67, 68),
    "tool_change": (6, 61),
    "spindle": (3, 4, 5, 19, 70, 71, 72, 73),
    "coolant": (7, 8, 9),
    "override": (48, 49, 50, 51, 52, 53),
}

#: M code -> name of its modal group.
M_GROUPS: dict[int, str] = {code: group for group, codes in _M_MEMBERS.items() for code in codes}

#: M codes that do not change where the tool goes; they are noted, not obeyed.
IRRELEVANT_M: dict[int, str] = {
    0: "program stop",
    1: "optional stop",
    60: "pallet shuttle and stop",
    7: "mist coolant",
    8: "flood coolant",
    9: "coolant off",
    19: "spindle orientation",
    48: "enable overrides",
    49: "disable overrides",
    50: "feed override",
    51: "spindle override",
    52: "adaptive feed",
    53: "feed stop",
    62: "output",
    63: "output",
    64: "output",
    65: "output",
    67: "analog output",
    68: "analog output",
}

#: Canned cycles, times ten.
CYCLES = frozenset((730, 740, *range(810, 900, 10)))


def code_name(code: int) -> str:
    """Write a G code times ten as in a program, for example ``G38.2``."""
    whole, tenth = divmod(code, 10)
    return f"G{whole}.{tenth}" if tenth else f"G{whole}"
