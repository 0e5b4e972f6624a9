"""Cycles of a TNC program in DIN/ISO as those of Klartext.

Source: HEIDENHAIN TNC 426/430 User's Manual ISO Programming: G83 to G85 and G74 to G78 are cycles
1, 2, 17 and 3 to 5 with parameters P01, P02, ...; G54, G28, G72, G73 transform coordinates; G37 and
G120 to G125 are cycles 14 and 20 to 25. Those from G200 on keep their number.
"""

from __future__ import annotations

import re

from gcode.errors import ProgramError

__all__ = ["CYCLES", "cycle_lines"]

_SIZE = r"[+-]?\s*(?:\d+\.?\d*|\.\d+|Q\d+)"
_PARAMETER = re.compile(rf"P\s*0?(\d+)\s*[XYZ]?\s*({_SIZE})")
#: G code -> lines of the cycle in Klartext with P01 as {1}
_WITH_PARAMETERS = {
    83: (1, ("SET UP {1}", "DEPTH {2}", "PECKG {3}", "DWELL {4}", "F {5}")),
    84: (2, ("SET UP {1}", "DEPTH {2}", "DWELL {3}", "F {4}")),
    85: (17, ("SET UP {1}", "DEPTH {2}", "PITCH {3}")),
    74: (3, ("SET UP {1}", "DEPTH {2}", "PECKG {3} F {4}", "X {5}", "Y {6}", "F {7}")),
    75: (4, ("SET UP {1}", "DEPTH {2}", "PECKG {3} F {4}", "X {5}", "Y {6}", "F {7} DR-")),
    76: (4, ("SET UP {1}", "DEPTH {2}", "PECKG {3} F {4}", "X {5}", "Y {6}", "F {7} DR+")),
    77: (5, ("SET UP {1}", "DEPTH {2}", "PECKG {3} F {4}", "RADIUS {5}", "F {6} DR-")),
    78: (5, ("SET UP {1}", "DEPTH {2}", "PECKG {3} F {4}", "RADIUS {5}", "F {6} DR+")),
}
_CONTOURS = {120: 20, 121: 21, 122: 22, 123: 23, 124: 24, 125: 25}
_OTHERS = {4, 28, 36, 37, 54, 62, 72, 73}
#: G codes below 200 that are cycles
CYCLES = frozenset((*_WITH_PARAMETERS, *_CONTOURS, *_OTHERS))


def cycle_lines(code: int, body: str, *, absolute: bool) -> list[str]:
    """Blocks of Klartext for a cycle.

    Parameters
    ----------
    code : int
        Of its G word.
    body : str
        What stands behind that.
    absolute : bool
        G90 is in force.

    Raises
    ------
    ProgramError
        A parameter is missing.
    """
    if code >= 200:
        return [f"CYCL DEF {code} {body}".rstrip()]
    if code in _CONTOURS:
        return [f"CYCL DEF {_CONTOURS[code]} {body}".rstrip()]
    if code in _WITH_PARAMETERS:
        return _old_cycle(code, body)
    if code == 4:
        return ["CYCL DEF 9.0 DWELL", f"CYCL DEF 9.1 DWELL {_number(code, 'F', body)}"]
    if code == 28:
        axes = " ".join(re.findall(r"[XYZ]", body))
        return ["CYCL DEF 8.0 MIRROR IMAGE", f"CYCL DEF 8.1 {axes}".rstrip()]
    if code == 36:
        return ["CYCL DEF 13.0 ORIENTATION"]
    if code == 62:
        return ["CYCL DEF 32.0 TOLERANCE"]
    if code == 37:
        labels = " /".join(value for _, value in _PARAMETER.findall(body))
        return ["CYCL DEF 14.0 CONTOUR", f"CYCL DEF 14.1 CONTOUR LABEL {labels}"]
    incremental = "G91" in body or (not absolute and "G90" not in body)
    return _transformation(code, body, "I" if incremental else "")


def _transformation(code: int, body: str, prefix: str) -> list[str]:
    if code == 54:
        places = re.findall(rf"([XYZABC])\s*({_SIZE})", body)
        said = [f"CYCL DEF 7.{k} {prefix}{a}{value}" for k, (a, value) in enumerate(places, 1)]
        return ["CYCL DEF 7.0 DATUM SHIFT", *said]
    if code == 72:
        return ["CYCL DEF 11.0 SCALING", f"CYCL DEF 11.1 SCL {_number(code, 'F', body)}"]
    return ["CYCL DEF 10.0 ROTATION", f"CYCL DEF 10.1 {prefix}ROT {_number(code, 'H', body)}"]


def _number(code: int, letter: str, body: str) -> str:
    found = re.search(rf"{letter}\s*({_SIZE})", body)
    if found is None:
        raise ProgramError(f"G{code:02d} without {letter}")
    return found[1]


def _old_cycle(code: int, body: str) -> list[str]:
    cycle, forms = _WITH_PARAMETERS[code]
    given = {int(number): value for number, value in _PARAMETER.findall(body)}
    lines = [f"CYCL DEF {cycle}.0"]
    try:
        sizes = [given[k] for k in range(1, 1 + max(given))]
        lines += [
            f"CYCL DEF {cycle}.{k} {form.format(None, *sizes)}" for k, form in enumerate(forms, 1)
        ]
    except (IndexError, KeyError, ValueError):
        raise ProgramError(f"G{code} lacks a parameter P", accepted="P01, P02, ...") from None
    return lines
