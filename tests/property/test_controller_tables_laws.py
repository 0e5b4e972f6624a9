"""Laws of compensation tables on any machine."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.machine_cases import ALL_CHAINS, make_machine, random_components, random_squareness
from vmach.controller_tables import FORMATS, make_tables
from vmach.controller_tables.formats.linuxcnc import read_linuxcnc, write_linuxcnc
from vmach.controller_tables.knots import Knots, hat_matrix
from vmach.controller_tables.projection import AxisTable, Term
from vmach.controller_tables.table_task import task_of_machine
from vmach.machine import Variant

seeds = st.integers(0, 2**32 - 1)


def made_on(seed, chain, formats, *, scale=1.0):
    rng = np.random.default_rng(seed)
    machine = make_machine(
        chain,
        random_components(rng, shift_mm=0.02 * scale, angle_rad=2e-5 * scale),
        squareness_rad=random_squareness(rng, 2e-5 * scale),
    )
    one = task_of_machine(machine, Variant.ABBE, tool_length_mm=100.0, tolerance_mm=2e-4)
    with TemporaryDirectory() as folder:
        made = make_tables(one, Path(folder), formats=formats)
    return {found.name: found for found in made}


@pytest.mark.parametrize(("seed", "chain"), [(1, ALL_CHAINS[2]), (2, ALL_CHAINS[17])])
def test_who_holds_more_leaves_less(seed, chain):
    found = made_on(seed, chain, [name for name in FORMATS if name != "grid"])
    left = {name: one.after.rms_mm for name, one in found.items()}
    assert left["linuxcnc"] < found["linuxcnc"].before.rms_mm
    assert left["linuxcnc"] == pytest.approx(left["sinumerik-enc"], abs=1e-6)
    assert left["sinumerik-cec"] < left["linuxcnc"]
    assert left["heidenhain"] == pytest.approx(left["sinumerik-cec"], abs=1e-6)
    assert left["sinumerik-cec-products"] < left["sinumerik-cec"]
    for name in ("sinumerik-cec-products", "isg", "components"):
        assert left[name] < 3e-4, name  # about the tolerance of the lines between entries


@pytest.mark.parametrize(("seed", "chain"), [(3, ALL_CHAINS[7]), (4, ALL_CHAINS[20])])
def test_twice_the_errors_leave_twice_as_much(seed, chain):
    once, twice = (
        made_on(seed, chain, ["linuxcnc"], scale=scale)["linuxcnc"] for scale in (1.0, 2.0)
    )
    assert twice.before.rms_mm == pytest.approx(2.0 * once.before.rms_mm, rel=1e-9)
    assert twice.after.rms_mm == pytest.approx(2.0 * once.after.rms_mm, rel=1e-3)


@given(
    low=st.floats(-1e4, 1e4), span=st.floats(1.0, 1e4), intervals=st.integers(1, 300),
)  # fmt: skip
def test_knots_span_the_travel_in_whole_steps(low, span, intervals):
    knots = Knots.over(low, low + span, intervals)
    position = knots.position_mm
    assert len(position) == intervals + 1
    assert position[0] <= low + 1e-8 and position[-1] >= low + span - 1e-8
    assert position[-1] - (low + span) < 1e-4 * (intervals + 2)
    assert np.diff(position) == pytest.approx(np.full(intervals, knots.step_mm), abs=1e-9)
    assert position == pytest.approx(np.round(position, 4), abs=1e-12)


@settings(deadline=None)
@given(seed=seeds)
def test_hats_are_linear_interpolation(seed):
    rng = np.random.default_rng(seed)
    knots = Knots.over(-100.0, 250.0, int(rng.integers(1, 40)))
    values, at = rng.normal(size=knots.intervals + 1), rng.uniform(-150, 300, 50)
    expected = np.interp(at, knots.position_mm, values)
    assert hat_matrix(knots.position_mm, at) @ values == pytest.approx(expected)


@settings(deadline=None, max_examples=30)
@given(seed=seeds, file_type=st.sampled_from([0, 1]))
def test_linuxcnc_entries_come_back_to_the_nanometre(seed, file_type):
    rng = np.random.default_rng(seed)
    position = Knots.over(*np.sort(rng.uniform(-2000, 2000, 2)), 20).position_mm
    forward, backward = rng.uniform(-1, 1, (2, 21))
    with TemporaryDirectory() as folder:
        write_linuxcnc(
            Path(folder),
            [AxisTable(Term(1, 1, True), position, forward, backward)],
            file_type=file_type,
        )
        entries = read_linuxcnc(Path(folder)).joints[1]
    assert np.array_equal(entries[:, 0], position)
    assert entries[:, 1] == pytest.approx(forward, abs=5.1e-7)
    assert entries[:, 2] == pytest.approx(backward, abs=5.1e-7)
