"""Depths of the pecks of a drilling cycle.

Source: FANUC B-64484EN-2, "Peck drilling cycle": Q, and alarm PS0045 where it is missing; Haas Mill
Operator's Manual 96-8000 (June 1999), page 191: I J K; G73: K beside Q.
"""

from __future__ import annotations

from collections.abc import Mapping

from gcode.errors import ProgramError

__all__ = ["PECKING", "peck_depths"]

#: more pecks than this are a mistake
_MOST_PECKS = 100_000
_LEAST = 1e-9
#: whose Q or I J K must be said: high-speed and deep-hole drilling
PECKING = (73.0, 83.0)


def peck_depths(code: float, words: Mapping[str, float], depth: float) -> list[float]:
    """How far below R the pecks of a hole end, but for the last.

    Parameters
    ----------
    code : float
        As 83.0.
    words : mapping
        Q of the cycle; I, J and K are those of Haas.
    depth : float
        From R to the bottom, program units.

    Raises
    ------
    ProgramError
        Nothing says how deep a peck is, or there are too many.
    """
    if "k" in words and "q" not in words:
        return _reduced(code, words, depth)
    size = abs(words.get("q", 0.0))
    if size == 0.0:
        if code in PECKING:
            raise ProgramError(
                f"G{code:g} without Q word",
                accepted="Q with the depth of a peck",
                hint="I goes with J and K, on a Haas alone (--control haas)"
                if "i" in words
                else None,
            )
        return []
    if depth / size > _MOST_PECKS:
        raise ProgramError(f"pecks of Q{size:g} make {depth / size:.0f} steps")
    found = [size * k for k in range(1, int(depth / size) + 1)]
    return [down for down in found if depth - down > _LEAST]


def _reduced(code: float, words: Mapping[str, float], depth: float) -> list[float]:
    """The first peck is I, each further one J smaller, none smaller than K."""
    first, less, least = (abs(words.get(letter, 0.0)) for letter in "ijk")
    if first == 0.0 or least == 0.0:
        raise ProgramError(f"G{code:g} with K, but without Q or I", accepted="Q, or I J K")
    if depth / least > _MOST_PECKS:
        raise ProgramError(f"pecks of K{least:g} make {depth / least:.0f} steps")
    found, down, size = [], first, first
    while depth - down > _LEAST:
        found.append(down)
        size = max(size - less, least)
        down += size
    return found
