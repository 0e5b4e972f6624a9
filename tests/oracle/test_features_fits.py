"""Limits of fits against published limit deviations, and against the formula of the grades."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.features.drawing.fits import fit_limits_mm, standard_tolerance_um

#: lower and upper limit deviations, um, as ISO 286-2 and the handbooks of machine elements print
PUBLISHED = {
    (35, "H7"): (0, 25), (35, "K7"): (-18, 7), (35, "M7"): (-25, 0), (35, "N7"): (-33, -8),
    (35, "P7"): (-42, -17), (35, "S7"): (-59, -34), (35, "J7"): (-11, 14), (35, "K6"): (-13, 3),
    (35, "F8"): (25, 64), (35, "G7"): (9, 34), (35, "D10"): (80, 180), (35, "H8"): (0, 39),
    (35, "JS7"): (-12.5, 12.5), (35, "P6"): (-37, -21), (35, "N9"): (-62, 0),
    (25, "g6"): (-20, -7), (25, "f7"): (-41, -20), (25, "h6"): (-13, 0), (25, "k6"): (2, 15),
    (25, "m6"): (8, 21), (25, "n6"): (15, 28), (25, "p6"): (22, 35), (25, "r6"): (28, 41),
    (25, "s6"): (35, 48), (25, "js6"): (-6.5, 6.5), (25, "e8"): (-73, -40), (25, "h11"): (-130, 0),
    (25, "j6"): (-4, 9), (60, "r6"): (41, 60), (60, "s6"): (53, 72), (100, "c11"): (-390, -170),
    (100, "H7"): (0, 35), (3, "H7"): (0, 10), (3, "K7"): (-10, 0), (3, "n6"): (4, 10),
    (3.001, "H7"): (0, 12), (10, "H9"): (0, 36), (18, "u6"): (33, 44), (500, "H6"): (0, 40),
    (300, "M6"): (-41, -9), (50, "t6"): (54, 70), (50, "R7"): (-50, -25), (80, "U7"): (-121, -91),
}  # fmt: skip


@pytest.mark.parametrize(("size", "text"), list(PUBLISHED))
def test_limits_are_those_published(size, text):
    found = np.array(fit_limits_mm(size, text)) * 1e3
    assert found == pytest.approx(PUBLISHED[size, text], abs=1e-9)


@pytest.mark.parametrize(("grade", "units"), [(6, 10), (7, 16), (8, 25), (9, 40), (10, 64),
                                              (11, 100), (12, 160)])  # fmt: skip
def test_grades_follow_the_tolerance_unit(grade, units):
    """i = 0.45 D^(1/3) + 0.001 D, D the geometric mean of the range; values are rounded."""
    ends = [3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500]
    for low, high in pairwise(ends):
        mean = np.sqrt(low * high)
        unit = 0.45 * np.cbrt(mean) + 1e-3 * mean
        assert standard_tolerance_um(high, grade) == pytest.approx(units * unit, rel=0.06, abs=0.8)


def test_a_hole_and_a_shaft_of_one_letter_mirror_each_other():
    for size in (2.0, 15.0, 47.0, 260.0):
        for letter in "abcdefgh":
            low, high = fit_limits_mm(size, f"{letter}9")
            assert fit_limits_mm(size, f"{letter.upper()}9") == pytest.approx((-high, -low))


@pytest.mark.parametrize(("size", "text", "message"), [
    (600, "H7", "sizes above 0 up to 500 mm"), (20, "H19", "IT1 to IT18"),
    (20, "Z7", "a letter from A to H"), (20, "t6", "above 24 mm"), (20, "7H", "a letter"),
    (20, "J9", "J6, J7, J8"), (20, "K9", "K up to K8"),
])  # fmt: skip
def test_classes_beyond_the_tables_are_refused(size, text, message):
    with pytest.raises(InputError, match=message):
        fit_limits_mm(size, text)
