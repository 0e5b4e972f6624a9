"""Units: there and back is the same number, and one known value each."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vmach.base import units

PAIRS = [
    (units.mm_from_um, units.um_from_mm, 1500.0, 1.5),
    (units.rad_from_urad, units.urad_from_rad, 20.0, 2e-5),
]


@pytest.mark.parametrize(("forth", "back", "outside", "inside"), PAIRS)
def test_known_value(forth, back, outside, inside):
    assert forth(outside) == pytest.approx(inside, rel=1e-15)
    assert back(inside) == pytest.approx(outside, rel=1e-15)
    np.testing.assert_allclose(forth(np.array([0.0, outside])), [0.0, inside], rtol=1e-15)


def test_speed_of_a_feed():
    assert units.mm_per_s_from_mm_per_min(1200.0) == 20.0


@pytest.mark.parametrize(
    ("plain", "shown"),
    [
        ("took away [1.2, 3] um, 4 urad", "took away [1.2, 3] µm, 4 µrad"),
        ("u_um of um.csv is 3 um/m", "u_um of um.csv is 3 µm/m"),
        ("vacuum, 30 umbrellas", "vacuum, 30 umbrellas"),
    ],
)
def test_micro_sign_replaces_units_and_no_names(plain, shown):
    assert units.with_micro_sign(plain) == shown


@pytest.mark.parametrize("pair", PAIRS)
@given(value=st.floats(-1e6, 1e6))
def test_there_and_back(pair, value):
    forth, back, *_ = pair
    assert back(forth(value)) == pytest.approx(value, rel=1e-15, abs=1e-300)
