"""PLANE: whether a working plane is the machine's own.

HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "The PLANE function".
"""

from __future__ import annotations

import re
from collections.abc import Callable

from gcode.dialects.heidenhain.parameters import NUMBER

__all__ = ["is_flat_plane"]

_KIND = re.compile(r"PLANE\s+(SPATIAL|AXIAL|EULER|PROJECTED|RELATIVE?|VECTOR)\b")
#: angles of the kinds that have them
_ANGLE = re.compile(rf"\b(SP[ABC]|EUL(?:PR|NU|ROT)|PRO(?:PR|MIN)|ROT|[ABC])\s*({NUMBER})(?!\w)")
_VECTOR = re.compile(rf"\b([BN][XYZ])\s*({NUMBER})(?!\w)")
#: base vector along X and normal along Z
_LEVEL = {"BX": 1.0, "BY": 0.0, "BZ": 0.0, "NX": 0.0, "NY": 0.0, "NZ": 1.0}


def is_flat_plane(content: str, value: Callable[[str], float]) -> bool:
    """Whether a PLANE block leaves the plane XY as it is: all angles zero, or normal along Z."""
    kind = _KIND.match(content)
    if kind is None:
        return False
    if kind[1] == "VECTOR":
        return {name: value(said) for name, said in _VECTOR.findall(content)} == _LEVEL
    angles = _ANGLE.findall(content[kind.end() :])
    return bool(angles) and not any(value(said) for _, said in angles)
