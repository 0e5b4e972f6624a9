"""What compensation tables leave, against closed forms, the machine model and wrong signs.

The control's side (`applied_correction` of what was read back) and the machine's side
(`vmach.machine.displacement`) share no code; what is left after both is the check.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.machine_cases import ALL_CHAINS, make_machine, random_components, random_squareness
from vmach.controller_tables import FORMATS, make_tables
from vmach.controller_tables.formats.linuxcnc import read_linuxcnc
from vmach.controller_tables.table_task import task_of_machine
from vmach.machine import ComponentError, Variant

ENDS = np.array([-500.0, 500.0])
LINEAR = [name for name in random_components(np.random.default_rng(0)) if name[1] in "XYZ"]


def ramp(name, start, end, *, backward=0.0, at=(0.0, 0.0, 0.0)):
    """A straight error from `start` to `end` over the travel; moving back, `backward` more."""
    forward = np.array([start, end])
    point = None if name[1] in "ABC" else np.array(at)
    return ComponentError(name, ENDS, forward, forward + backward, point)


def machine_with(*components, chain="t (C) Z Y b X' w", **keywords):
    return make_machine(chain, {one.name: one for one in components}, **keywords)


def task(machine, tool_length_mm=150.0, variant=Variant.ABBE):
    return task_of_machine(machine, variant, tool_length_mm=tool_length_mm, tolerance_mm=2e-4)


def made(machine, folder, name, **keywords):
    return make_tables(task(machine, **keywords), folder, formats=[name])[0]


POSITIONING = [ramp("EXX", -0.02, 0.03), ramp("EYY", 0.01, -0.01), ramp("EZZ", 0.0, 0.02)]
STRAIGHTNESS = [
    ComponentError("EZX", np.linspace(-500, 500, 5), *np.tile([0, 9e-3, 4e-3, 9e-3, 0], (2, 1)),
                   np.zeros(3)),
    ramp("EXY", -0.01, 0.01),
]  # fmt: skip
ANGLES = [ramp("EBX", -3e-5, 3e-5), ramp("EAY", 1e-5, 4e-5)]
#: what each format claims to hold
HELD = {
    "linuxcnc": POSITIONING,
    "sinumerik-enc": POSITIONING,
    "sinumerik-cec": POSITIONING + STRAIGHTNESS,
    "sinumerik-cec-products": POSITIONING + STRAIGHTNESS + ANGLES,
    "heidenhain": POSITIONING + STRAIGHTNESS,
    "isg": POSITIONING + STRAIGHTNESS + ANGLES,
    "components": POSITIONING + STRAIGHTNESS + ANGLES,
    "grid": POSITIONING + STRAIGHTNESS + ANGLES,
}


def test_every_format_is_tested():
    assert HELD.keys() == FORMATS.keys()


@pytest.mark.parametrize("name", HELD)
def test_nothing_is_left_of_what_a_format_holds_and_a_wrong_sign_doubles_it(tmp_path, name):
    machine = machine_with(*HELD[name])
    found = made(machine, tmp_path, name)
    assert found.before.largest_mm > 0.02
    assert found.after.largest_mm < 2.5e-4
    check = task(machine).check
    read = FORMATS[name].read(tmp_path / name, {})
    correction = read.applied_correction(check.nose_mm, check.direction, check.tool_mm)
    wrong = np.linalg.norm(check.error_mm - correction, axis=1)
    assert wrong == pytest.approx(2.0 * np.linalg.norm(check.error_mm, axis=1), abs=3e-4)


@pytest.mark.parametrize("name", ["linuxcnc", "sinumerik-enc"])
def test_own_axis_tables_leave_straightness_and_squareness_alone(tmp_path, name):
    lean = np.zeros((3, 3))
    lean[1, 2] = 4e-5  # C0Y: x moves with y
    machine = machine_with(ramp("EZX", -0.01, 0.01), ramp("EXY", -0.01, 0.01), squareness_rad=lean)
    found = made(machine, tmp_path, name)
    assert found.after.rms_mm == pytest.approx(found.before.rms_mm, rel=1e-6)
    assert found.after.largest_mm == pytest.approx(found.before.largest_mm, rel=1e-6)


def test_cross_tables_hold_squareness(tmp_path):
    lean = random_squareness(np.random.default_rng(4))
    machine = machine_with(squareness_rad=lean)
    for name in ("sinumerik-cec", "heidenhain", "isg", "components"):
        found = made(machine, tmp_path, name)
        assert found.before.largest_mm > 5e-3
        assert found.after.largest_mm < 1e-5, name


def test_own_axis_table_of_an_angle_is_its_mean_over_the_other_axes(tmp_path):
    """EBX = a x moves x by a x (z - L) and z by nothing that matters here; the best table over X
    is a x (mean z - L), and a x (z - mean z) is left: rms a rms(x) std(z)."""
    a = 6e-8
    machine = machine_with(ramp("EBX", -500 * a, 500 * a), chain="t (C) Z Y X b w")
    found = made(machine, tmp_path, "linuxcnc", tool_length_mm=150.0)
    entries = read_linuxcnc(tmp_path / "linuxcnc").joints[0]
    assert entries[:, 1] == pytest.approx(a * entries[:, 0] * 150.0, abs=1e-6)
    grid = np.linspace(-500, 500, 23)
    assert found.after.rms_mm == pytest.approx(a * np.mean(grid**2), rel=1e-3)


def test_plain_cec_leaves_an_angle_and_products_take_it(tmp_path):
    machine = machine_with(*ANGLES)
    plain = made(machine, tmp_path, "sinumerik-cec")
    product = made(machine, tmp_path, "sinumerik-cec-products")
    assert plain.after.rms_mm > 0.2 * plain.before.rms_mm
    assert product.after.largest_mm < 2e-4
    # another tool length: the arm is 100 mm longer than the table knows
    assert product.with_longer_tool[1].largest_mm == pytest.approx(100 * 4e-5, rel=0.4)
    model = made(machine, tmp_path, "isg")
    assert model.with_longer_tool[1].largest_mm < 1e-4


@pytest.mark.parametrize("chain", ALL_CHAINS)
def test_tables_of_the_model_hold_every_chain(tmp_path, chain):
    """Order, side of the bed, reflectors: the matrices of the table's control see none of the
    arms of the machine model, and agree."""
    rng = np.random.default_rng(11)
    components = {
        name: replace(one, position_mm=ENDS, forward=one.forward[[0, -1]],
                      backward=one.backward[[0, -1]])
        for name, one in random_components(rng).items()
    }  # fmt: skip
    machine = make_machine(chain, components, squareness_rad=random_squareness(rng))
    for variant in (Variant.ABBE, Variant.HTM):
        for name in ("isg", "components"):
            place = tmp_path / variant
            found = made(machine, place, name, variant=variant)
            assert found.before.rms_mm > 0.01
            assert found.after.largest_mm < 1.5e-3
    # an angle times its own position is bent between the entries: as many as there can be
    fine = replace(task(machine), tolerance_mm=1e-6)
    refined = make_tables(fine, tmp_path / "fine", formats=["isg"])[0]
    assert refined.after.largest_mm < 1e-5


def test_reversal_goes_to_the_reverse_column(tmp_path):
    """Moving back, the axis stops 8 um short: two columns hold it, one leaves half of it."""
    short = ramp("EXX", 0.0, 0.02, backward=-0.008)
    machine = replace(machine_with(short), separate_directions=True)
    for name in ("linuxcnc", "heidenhain", "sinumerik-cec", "components"):
        assert made(machine, tmp_path, name).after.largest_mm < 1e-5, name
    for name in ("sinumerik-enc", "isg", "grid"):
        left = made(machine, tmp_path, name).after
        assert left.rms_mm == pytest.approx(0.004, rel=1e-2), name
        assert left.largest_mm == pytest.approx(0.004, rel=3e-2), name
    entries = read_linuxcnc(tmp_path / "linuxcnc").joints[0]
    assert entries[:, 2] - entries[:, 1] == pytest.approx(np.full(len(entries), 0.008), abs=2e-6)


def test_mean_acts_where_the_machine_file_does_not_keep_directions_apart(tmp_path):
    machine = machine_with(ramp("EXX", 0.0, 0.02, backward=-0.008))
    made(machine, tmp_path, "linuxcnc")
    entries = read_linuxcnc(tmp_path / "linuxcnc").joints[0]
    assert np.array_equal(entries[:, 1], entries[:, 2])


def test_no_other_entries_leave_less(tmp_path):
    """Brute force: any change of an entry by 0.1 um in either direction leaves more."""
    rng = np.random.default_rng(2)
    machine = make_machine("t (C) Z b Y' X' w", random_components(rng))
    one = task(machine)
    found = made(machine, tmp_path, "linuxcnc")
    read = read_linuxcnc(tmp_path / "linuxcnc")
    knots = one.knots(256)
    samples = one.fit_samples(knots)
    states = (samples.nose_mm, samples.direction, samples.tool_mm)

    def left(tables):
        after = samples.error_mm + tables.applied_correction(*states)
        return samples.weight @ (after**2).sum(axis=1)

    best = left(read)
    assert best < 0.9 * samples.weight @ (samples.error_mm**2).sum(axis=1)
    for entry in range(0, found.entries[1], 4):
        for change in (1e-4, -1e-4):
            joints = {k: values.copy() for k, values in read.joints.items()}
            joints[1][entry, 1:] += change
            assert left(replace(read, joints=joints)) > best


def test_what_is_left_of_each_component_is_what_its_own_machine_leaves(tmp_path):
    """The list comes from one linear fit; a machine with that error alone is the check."""
    components = [*POSITIONING, *STRAIGHTNESS, *ANGLES]
    listed = made(machine_with(*components), tmp_path / "all", "heidenhain").left
    assert set(listed) == {one.name for one in components}
    for one in components:
        alone = made(machine_with(one), tmp_path / one.name, "heidenhain")
        before, after = listed[one.name]
        assert before == pytest.approx(alone.before.rms_mm, rel=1e-6)
        assert after == pytest.approx(alone.after.rms_mm, abs=2e-6)


def test_a_machine_without_errors_gives_tables_of_zeros(tmp_path):
    machine = machine_with()
    for one in make_tables(task(machine), tmp_path):
        assert one.before.largest_mm == one.after.largest_mm == 0.0, one.name


def test_number_of_entries_follows_the_tolerance(tmp_path):
    position = np.linspace(-500, 500, 2001)
    wave = 0.01 * np.sin(position / 80.0)
    bent = ComponentError("EXX", position, wave, wave, np.zeros(3))
    machine = machine_with(bent)
    coarse, fine = (
        make_tables(replace(task(machine), tolerance_mm=tolerance), tmp_path / str(tolerance),
                    formats=["linuxcnc"])[0]
        for tolerance in (2e-3, 2e-4)
    )  # fmt: skip
    # a chord of a sine of wave number k is off by amplitude (k step)^2 / 8
    for found, tolerance in ((coarse, 2e-3), (fine, 2e-4)):
        step = 1000.0 / (found.entries[0] - 1)
        assert 0.01 * (step / 80.0) ** 2 / 8.0 <= 1.01 * tolerance
        assert found.after.largest_mm <= 1.01 * tolerance
    assert coarse.entries[0] < fine.entries[0] <= 256
