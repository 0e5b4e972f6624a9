"""Frames and tool data that a program writes into the control.

They are no variables of the machine's builder: whatever a job says of them, the moves behind would
not follow. Work offsets that are shifted alone are set by `gcode.dialects.sinumerik.frames`.
"""

from __future__ import annotations

import re

from gcode.errors import ProgramError

__all__ = ["HELD", "obey_held_data"]

HELD = re.compile(r"\$P_\w*FR(?:AME)?|\$TC_DP\d+", re.IGNORECASE)
_WRITTEN = re.compile(
    rf"({HELD.pattern})\s*(?:\[((?:[^\[\]]|\[[^\[\]]*\])*)\])?\s*=(?!=)\s*(.*?)"
    r"(?=\s+(?:\$|R\d+\s*=)|\s*$)",
    re.IGNORECASE,
)
#: those that TRANS, ROT and G54 change, which nothing resets here
_PRESENT = ("$P_PFRAME", "$P_IFRAME", "$P_ACTFRAME")
_NOTHING = {"TR": 0.0, "FI": 0.0, "RT": 0.0, "MI": 0.0, "SC": 1.0}


def obey_held_data(content: str) -> str:
    """Leave out what changes nothing.

    Raises
    ------
    ProgramError
        It turns, mirrors, scales or shifts, or gives a tool other data.
    """
    return _WRITTEN.sub(_left_out, content) if "$" in content else content


def _left_out(found: re.Match) -> str:
    name, index, value = found[1].upper(), (found[2] or "").upper(), found[3].strip()
    component = index.rpartition(",")[2].strip() if "," in index else ""
    if name == "$P_UIFR" and component in ("", "TR"):
        return found[0]
    if name.startswith("$TC"):
        raise ProgramError(f"{name}[{index}] is written: data of a tool",
                           accepted="the tool table of the job")  # fmt: skip
    if name not in _PRESENT and _is_nothing(component, value):
        return ""
    raise ProgramError(
        f"{name}{f'[{index}]' if index else ''}={value} is not read: a frame",
        accepted="$P_UIFR[1,X,TR]=..., $P_UIFR[1]=CTRANS(...), TRANS, ROT, MIRROR, SCALE",
    )


def _is_nothing(component: str, value: str) -> bool:
    if re.fullmatch(r"CTRANS\s*\(\s*\)", value, re.IGNORECASE):
        return not component
    try:
        return component in _NOTHING and float(value) == _NOTHING[component]
    except ValueError:
        return False
