"""Limits of sizes with a tolerance class, such as 35H7.

Source: ISO 286-1:2010: standard tolerance grades IT1 to IT18 (Table 1), fundamental deviations of
shafts (Tables 4 and 5). Holes follow them by the general rule EI = -es, ES = -ei. K, M and N up to
IT8, and P to U up to IT7, have the addition Delta = ITn - IT(n-1). The values were compared with
Narayana, Kannaiah and Venkata Reddy, Machine Drawing, tables 15.1 to 15.3, and with the package
isofits 1.0; b and c up to 120 mm, which are in neither, agree with rf-tolerance 1.0.0 (DIN 286).
"""

from __future__ import annotations

import re

import numpy as np

from vmach.errors import InputError

__all__ = ["fit_limits_mm", "standard_tolerance_um"]

#: upper ends of the ranges of nominal size, mm
_RANGES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
_FINE = (3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280,
         315, 355, 400, 450, 500)  # fmt: skip

#: standard tolerances by grade, um, one for each of `_RANGES`
_IT = {
    1: (0.8, 1, 1, 1.2, 1.5, 1.5, 2, 2.5, 3.5, 4.5, 6, 7, 8),
    2: (1.2, 1.5, 1.5, 2, 2.5, 2.5, 3, 4, 5, 7, 8, 9, 10),
    3: (2, 2.5, 2.5, 3, 4, 4, 5, 6, 8, 10, 12, 13, 15),
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400),
    12: (100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630),
    13: (140, 180, 220, 270, 330, 390, 460, 540, 630, 720, 810, 890, 970),
    14: (250, 300, 360, 430, 520, 620, 740, 870, 1000, 1150, 1300, 1400, 1550),
    15: (400, 480, 580, 700, 840, 1000, 1200, 1400, 1600, 1850, 2100, 2300, 2500),
    16: (600, 750, 900, 1100, 1300, 1600, 1900, 2200, 2500, 2900, 3200, 3600, 4000),
    17: (1000, 1200, 1500, 1800, 2100, 2500, 3000, 3500, 4000, 4600, 5200, 5700, 6300),
    18: (1400, 1800, 2200, 2700, 3300, 3900, 4600, 5400, 6300, 7200, 8100, 8900, 9700),
}

#: -es of shafts a to h, um
_ABOVE = {
    "a": (270, 270, 280, 290, 290, 300, 300, 310, 320, 340, 360, 380, 410, 460, 520, 580, 660,
          740, 820, 920, 1050, 1200, 1350, 1500, 1650),
    "b": (140, 140, 150, 150, 150, 160, 160, 170, 180, 190, 200, 220, 240, 260, 280, 310, 340,
          380, 420, 480, 540, 600, 680, 760, 840),
    "c": (60, 70, 80, 95, 95, 110, 110, 120, 130, 140, 150, 170, 180, 200, 210, 230, 240, 260,
          280, 300, 330, 360, 400, 440, 480),
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68),
    "g": (2, 4, 5, 6, 7, 9, 10, 12, 14, 15, 17, 18, 20),
    "h": (0,) * 13,
}  # fmt: skip

#: ei of shafts k to u, um; k for grades IT4 to IT7, 0 for others
_BELOW = {
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
    "r": (10, 15, 19, 23, 23, 28, 28, 34, 34, 41, 43, 51, 54, 63, 65, 68, 77, 80, 84, 94, 98,
          108, 114, 126, 132),
    "s": (14, 19, 23, 28, 28, 35, 35, 43, 43, 53, 59, 71, 79, 92, 100, 108, 122, 130, 140, 158,
          170, 190, 208, 232, 252),
    "t": (None, None, None, None, None, None, 41, 48, 54, 66, 75, 91, 104, 122, 134, 146, 166,
          180, 196, 218, 240, 268, 294, 330, 360),
    "u": (18, 23, 28, 33, 33, 41, 48, 60, 70, 87, 102, 124, 144, 170, 190, 210, 236, 258, 284,
          315, 350, 390, 435, 490, 540),
}  # fmt: skip

#: -ei of shafts j5 and j6, and j7; upper deviations of holes J6, J7, J8, um
_SHAFT_J = {
    5: (2, 2, 2, 3, 4, 5, 7, 9, 11, 13, 16, 18, 20),
    6: (2, 2, 2, 3, 4, 5, 7, 9, 11, 13, 16, 18, 20),
    7: (4, 4, 5, 6, 8, 10, 12, 15, 18, 21, 26, 28, 32),
}
_HOLE_J = {
    6: (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    7: (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
    8: (6, 10, 12, 15, 20, 24, 28, 34, 41, 47, 55, 60, 66),
}

_CLASS = re.compile(r"([A-Za-z]{1,2})(\d{1,2})")
_ACCEPTED = (
    "a letter from A to H, J, JS, K, M, N, P, R, S, T, U (shafts in small letters) and a grade "
    "from 1 to 18, for sizes up to 500 mm"
)


def standard_tolerance_um(nominal_mm: float, grade: int) -> float:
    """Standard tolerance IT of a grade, 1 to 18, um.

    Raises
    ------
    InputError
        Another grade, or a nominal size beyond the table.
    """
    if grade not in _IT:
        raise InputError(f"tolerance grade IT{grade}", accepted="IT1 to IT18")
    return float(_IT[grade][_range(nominal_mm, _RANGES)])


def fit_limits_mm(nominal_mm: float, tolerance_class: str) -> tuple[float, float]:
    """Lower and upper limit deviation, mm, of a size with a class such as ``H7`` or ``js6``.

    Raises
    ------
    InputError
        A class that the tables do not have, or a size that they do not reach.
    """
    match = _CLASS.fullmatch(tolerance_class)
    if not match:
        raise InputError(f"tolerance class {tolerance_class!r}", accepted=_ACCEPTED)
    letters, grade = match.group(1), int(match.group(2))
    width = standard_tolerance_um(nominal_mm, grade)
    is_hole, letter = letters[0].isupper(), letters.lower()
    if letter == "js":
        low, high = -width / 2.0, width / 2.0
    elif letter == "j":
        low, high = _about_zero(nominal_mm, grade, width, is_hole, tolerance_class)
    elif is_hole:
        low, high = _hole(nominal_mm, letter, grade, width, tolerance_class)
    else:
        low, high = _shaft(nominal_mm, letter, grade, width, tolerance_class)
    return round(low, 4) / 1e3, round(high, 4) / 1e3


def _shaft(nominal_mm: float, letter: str, grade: int, width: float, text: str):
    if letter in _ABOVE:
        high = -_entry(_ABOVE[letter], nominal_mm, text)
        return high - width, high
    low = _lower_of_shaft(nominal_mm, letter, grade, text)
    return low, low + width


def _lower_of_shaft(nominal_mm: float, letter: str, grade: int, text: str) -> float:
    if letter not in _BELOW:
        raise InputError(f"tolerance class {text!r}", accepted=_ACCEPTED)
    if letter == "k" and not 4 <= grade <= 7:
        return 0.0
    return _entry(_BELOW[letter], nominal_mm, text)


def _hole(nominal_mm: float, letter: str, grade: int, width: float, text: str):
    if letter in _ABOVE:
        low = _entry(_ABOVE[letter], nominal_mm, text)
        return low, low + width
    if letter in "kmn" and grade > 8:
        high = _coarse_hole(nominal_mm, letter, text)
    else:
        shaft = _BELOW.get(letter)
        if shaft is None:
            raise InputError(f"tolerance class {text!r}", accepted=_ACCEPTED)
        high = -_entry(shaft, nominal_mm, text) + _addition(nominal_mm, letter, grade)
    if text == "M6" and 250.0 < nominal_mm <= 315.0:
        high = -9.0  # an exception that the standard makes
    return high - width, high


def _coarse_hole(nominal_mm: float, letter: str, text: str) -> float:
    """ES of K, M and N from IT9 on."""
    if letter == "k":
        raise InputError(f"tolerance class {text!r}", accepted="K up to K8")
    if letter == "n" and nominal_mm > 3.0:
        return 0.0
    return -_entry(_BELOW[letter], nominal_mm, text)


def _addition(nominal_mm: float, letter: str, grade: int) -> float:
    """Delta: holes are paired with shafts of the next finer grade."""
    largest = 8 if letter in "kmn" else 7
    if nominal_mm <= 3.0 or not 3 <= grade <= largest:
        return 0.0
    finer = standard_tolerance_um(nominal_mm, grade - 1)
    return standard_tolerance_um(nominal_mm, grade) - finer


def _about_zero(nominal_mm: float, grade: int, width: float, is_hole: bool, text: str):
    table = (_HOLE_J if is_hole else _SHAFT_J).get(grade)
    if table is None:
        accepted = "J6, J7, J8" if is_hole else "j5, j6, j7"
        raise InputError(f"tolerance class {text!r}", accepted=f"{accepted}, or JS and js")
    value = _entry(table, nominal_mm, text)
    return (value - width, value) if is_hole else (-value, width - value)


def _entry(table: tuple, nominal_mm: float, text: str) -> float:
    value = table[_range(nominal_mm, _FINE if len(table) == len(_FINE) else _RANGES)]
    if value is None:
        raise InputError(f"{text} of {nominal_mm:g} mm", accepted="T and t above 24 mm")
    return float(value)


def _range(nominal_mm: float, ends: tuple[int, ...]) -> int:
    if not 0.0 < nominal_mm <= ends[-1]:
        raise InputError(
            f"a tolerance class for {nominal_mm:g} mm",
            accepted=f"sizes above 0 up to {ends[-1]} mm",
        )
    return int(np.searchsorted(ends, nominal_mm))
