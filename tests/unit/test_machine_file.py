"""What a machine file says, and what is answered where it is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.machine import Variant, displacement, read_machine
from vmach.machine.component_errors import SetUp

FILE = """schema = 1
name = "test"
chain = "t (C) Z Y b X' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 20000
[axes.X]
travel_mm = [-500, 0]
[axes.Y]
travel_mm = [-400, 0]
[axes.Z]
travel_mm = [-300, 0]
[errors.EXX]
table = "EXX.csv"
measured_at_mm = [-250, -200, -350]
[errors.ECX]
table = "ECX.csv"
[squareness]
EC0Y = 14.5
"""
TABLE = "position_mm, forward, backward\n-500, 1, 3\n0, 5, 7\n"


@pytest.fixture
def write(tmp_path):
    """Writes the machine file with one text replaced, and its tables; returns its path."""

    def write(old: str = "", new: str = "", **tables: str):
        assert old in FILE
        for name in ("EXX", "ECX"):
            (tmp_path / f"{name}.csv").write_text(tables.get(name, TABLE))
        (tmp_path / "machine.toml").write_text(FILE.replace(old, new, 1))
        return tmp_path / "machine.toml"

    return write


def test_file_is_read_in_mm_and_rad(write):
    machine = read_machine(write())
    assert machine.components["EXX"].forward.tolist() == [0.001, 0.005]
    assert machine.components["EXX"].mean.tolist() == [0.002, 0.006]
    assert machine.components["ECX"].backward == pytest.approx([3e-6, 7e-6])
    assert machine.squareness_rad[1, 2] == pytest.approx(14.5e-6)
    assert machine.travel_mm.tolist() == [[-500, -400, -300], [0, 0, 0]]
    assert [path.name for path in machine.files] == ["machine.toml", "EXX.csv", "ECX.csv"]


@pytest.mark.parametrize(
    ("old", "new", "line", "parts"),
    [
        ("measured_at_mm =", "measured_at =", 18, ["errors.EXX.measured_at", "measured_at_mm"]),
        ("[squareness]", "[squarenes]", 21, ["key 'squarenes'", "did you mean 'squareness'?"]),
        ("t (C) Z Y b X' w", "t (C) Z Y X' w", 3, ["from t over b to w"]),
        ("t (C) Z Y b X' w", "t (C) Z' Y b X' w", 3, ["Z'", "tool side"]),
        ("t (C) Z Y b X' w", "t (C) Z Y b Y' w", 3, ["X, Y and Z, each once"]),
        ("t (C) Z Y b X' w", "t (C) Z Y b U' w", 3, ["'U' is no axis"]),
        ("[-500, 0]", "[0, -500]", 11, ["travel 0.0 .. -500.0 mm"]),
        ("[-500, 0]", "[0, nan]", 11, ["finite"]),
        ("[axes.Z]\ntravel_mm = [-300, 0]\n", "", 10, ["axis Z has no travel"]),
        ("[errors.ECX]", "[errors.EQX]", 19, ["component error 'EQX'", "EXX, EYX"]),
        ('[errors.ECX]\ntable = "ECX.csv"', "[errors.ECX]", 19, ["ECX has no table"]),
        (
            '"ECX.csv"', '"ECX.csv"\nmeasured_at_mm = [0, 0, 0]', 21,
            ["ECX is an angle, which is the same at every point"],
        ),
        ("EC0Y", "EC0C", 22, ["squareness 'EC0C'", "EC0Y"]),
        ("EC0Y", "EB0Y", 22, ["squareness 'EB0Y'"]),
        ('"relative"', '"laser"', 5, ["accepted: 'relative'"]),
        ('"urad"', '"grad"', 7, ["arcsec"]),
        ('"ECX.csv"', '"ECX.csv"\nunit = "um"', 21, ["unit 'um' of ECX", "arcsec"]),
        ('"ECX.csv"', '"ECX.csv"\ninterpolation = "fourier"', 21, ["without an order"]),
        ('"ECX.csv"', '"ECX.csv"\ninterpolation = "legendre"\norder = 5', 21, ["needs 6 points"]),
        ("[-250, -200, -350]", "[-250, -200, -350]\nstick_out_mm = 5", 16, ["in one form"]),
        ("20000", "-1", 9, ["greater than 0"]),
        ('"ECX.csv"', '"ECX.csv"\nperiod_mm = 9', 21, ["period_mm", "'linear'", "'fourier'"]),
        (
            '"ECX.csv"', '"ECX.csv"\ninterpolation = "cross-validation"\norder = 2', 21,
            ["'cross-validation' with order 2"],
        ),
        ("[-500, 0]", "[-500, 0]\ntravel_deg = [0, 90]", 12, ["travel_deg", "linear axis X"]),
        ("[squareness]", "[axes.A]\ntravel_deg = [0, 9]\n[squareness]", 21, ["no axis A"]),
        ('"EXX.csv"', '"EXY.csv"', 17, ["table = 'EXY.csv': no such file"]),
        ("EC0Y = 14.5", "EC0Y = true", 22, ["True; accepted: a number, or a table"]),
        ("EC0Y = 14.5", 'EC0Y = {um_per_m = "x"}', 22, ["EC0Y.um_per_m' = 'x'", "a number"]),
        (
            '"ECX.csv"', '"ECX.csv"\ninterpolation = "spline"', 21,
            ["'linear', 'pchip'", "or 'cross-validation'"],
        ),
        ("schema = 1", "schema = 2", 1, ["schema"]),
    ],
)  # fmt: skip
def test_complaints_name_file_line_and_what_is_accepted(write, old, new, line, parts):
    path = write(old, new)
    with pytest.raises(InputError) as caught:
        read_machine(path)
    assert caught.value.file == path
    assert caught.value.line == line
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize(
    ("table", "line", "parts"),
    [
        ("position,forward,backward\n0,1,2\n1,2,3\n", 1, ["position, forward", "position_mm"]),
        ("position_mm,forward,backward\n0,1,2\n1,2,x\n", 3, ["1, 2, x", "3 finite numbers"]),
        ("position_mm,forward,backward\n0,1,2\n1,2\n", 3, ["1, 2"]),
        ("position_mm,forward,backward\n0,1,2\n1,2,nan\n", 3, ["1, 2, nan"]),
        ("position_mm,forward,backward\n0,1,2\n,2,5\n", 3, ["no position"]),
        ("position_mm,forward,backward\n0,1,2\n0,2,2\n5,6,6\n", 3, ["0 occurs twice"]),
        ("position_mm,forward,backward\n0,1,2\n", 2, ["1 position", "two or more"]),
        ("position_mm,forward,backward\n0,1,2\n1,,2\n", 3, ["no forward reading at 1 mm"]),
        ("position_mm,forward_grad,backward\n0,1,2\n1,1,2\n", 1, ["unit 'grad'", "um"]),
        ("position_mm,forward,forward,backward\n0,1,1,2\n", 1, ["header"]),
        ("position_mm,forward\n0,1\n1,2\n", 1, ["header"]),
        ("run,position_mm,approach,deviation\n1,0,0,1\n", 2, ["approach 0", "1 or -1"]),
        ("run,position_mm,approach,deviation\n1,0,1,1\n1,9,2,1\n", 3, ["approach 2", "1 or -1"]),
        ("run,position_mm,approach,deviation\n1,0,-0.5,1\n", 2, ["approach -0.5", "1 or -1"]),
        ("", None, ["empty"]),
        ("position_mm,forward,backward\n", 1, ["no rows"]),
    ],
)
def test_complaints_about_tables(write, table, line, parts):
    path = write(EXX=table)
    with pytest.raises(InputError) as caught:
        read_machine(path)
    assert caught.value.file == path.parent / "EXX.csv"
    assert caught.value.line == line
    for part in parts:
        assert part in str(caught.value)


def test_a_missing_machine_file_is_named(tmp_path):
    with pytest.raises(InputError, match="machine file not found"):
        read_machine(tmp_path / "no.toml")


def test_beyond_a_table_is_refused_unless_the_file_says_how_to_go_on(write):
    table = "position_mm, forward, backward\n-400, 2, 2\n-100, 5, 5\n"
    nose, tool = np.array([[-50.0, 0.0, 0.0]]), np.array([0.0, 0.0, -100.0])
    with pytest.raises(InputError) as caught:
        displacement(read_machine(write(EXX=table)), nose, tool, Variant.HTM)
    for part in ("EXX", "X = -50.000 mm", "-400 .. -100 mm", 'extrapolation = "hold"'):
        assert part in str(caught.value)
    # 1 um per 100 mm: half a micrometre more where the tangent goes on
    ecx = "position_mm, forward, backward\n-500, 0, 0\n0, 0, 0\n"
    for setting, expected_um in (("hold", 5.0), ("linear", 5.5)):
        path = write("[-250, -200, -350]", f'[0, 0, 0]\nextrapolation = "{setting}"',
                     EXX=table, ECX=ecx)  # fmt: skip
        moved = displacement(read_machine(path), nose, tool, Variant.HTM)
        assert moved.shift_mm[0, 0] == pytest.approx(expected_um * 1e-3)


def test_forward_and_backward_act_by_the_direction_of_motion_only_where_the_file_says_so(write):
    nose = np.tile([0.0, 0.0, 0.0], (3, 1))
    direction = np.array([[1, 0, 0], [-1, 1, -1], [0, 1, 1]])
    tool = np.zeros(3)
    ecx = "position_mm, forward, backward\n-500, 0, 0\n0, 0, 0\n"
    together = read_machine(write(EXX=TABLE, ECX=ecx))
    apart = read_machine(write("[errors.EXX]", '[tables]\ndirections = "separate"\n[errors.EXX]',
                               EXX=TABLE, ECX=ecx))  # fmt: skip
    for machine, expected_um in ((together, [6, 6, 6]), (apart, [5, 7, 6])):
        moved = displacement(machine, nose, tool, Variant.HTM, direction=direction)
        assert moved.shift_mm[:, 0] * 1e3 == pytest.approx(expected_um)
        assert displacement(machine, nose, tool, Variant.HTM).shift_mm[:, 0] == pytest.approx(6e-3)


def test_measuring_point_from_the_state_of_the_machine_at_the_reading(write):
    # work-side X: nose position and stick-out give the point of the table under the optics
    state = 'nose_at_mm = [-800, -256, -280]\nstick_out_mm = 198\nset_up = "indicator"'
    path = write("measured_at_mm = [-250, -200, -350]", state)
    component = read_machine(path).components["EXX"]
    assert component.measured_at_mm.tolist() == [-800.0, -256.0, -478.0]
    assert component.set_up is SetUp.INDICATOR


SQUARE = "EC0Y = 14.5"


def test_squareness_printed_in_two_units_that_agree(write):
    path = write(SQUARE, "[squareness.EC0Y]\num_per_m = 14.569\narcsec = 3")
    assert read_machine(path).squareness_rad[1, 2] == pytest.approx(14.569e-6)


def test_squareness_with_its_two_numbers_swapped_is_caught(write):
    # as printed in the thesis on the AJV 25/405: 13.757 um/m (66.697 arcsec)
    swapped = "[squareness.EA0Z]\num_per_m = 13.757\narcsec = 66.697"
    with pytest.raises(InputError) as caught:
        read_machine(write(SQUARE, swapped))
    for part in ("13.757 um/m is 2.838 arcsec, but 66.697 arcsec", "probably exchanged", "use ="):
        assert part in str(caught.value)
    path = write(SQUARE, swapped + '\nuse = "arcsec"')
    assert read_machine(path).squareness_rad[2, 0] == pytest.approx(323.357e-6, rel=1e-5)


ISG = "X EXX ECX\n-500 0.001 0.000002\n0 0.003 0.000004\n#\nC0Y\n0.00003\n"
VOLUMETRIC = """[volumetric]
file = "vc.csv"
format = "isg-csv"
measured_at_mm = [0, 0, 0]
"""


def test_all_errors_in_one_volumetric_file(write, tmp_path):
    path = write()
    (tmp_path / "vc.csv").write_text(ISG)
    own = FILE[FILE.index("[errors.EXX]") : FILE.index("[squareness]")]
    path.write_text(FILE.replace(own, VOLUMETRIC).replace(SQUARE, ""))
    machine = read_machine(path)
    assert machine.components["EXX"].mean.tolist() == [0.001, 0.003]
    assert machine.components["EXX"].measured_at_mm.tolist() == [0, 0, 0]
    assert machine.components["ECX"].measured_at_mm is None
    assert machine.squareness_rad[1, 2] == 3e-5
    assert [file.name for file in machine.files] == ["machine.toml", "vc.csv"]


def test_an_error_in_both_files_is_refused(write, tmp_path):
    path = write("[errors.EXX]", VOLUMETRIC + "[errors.EXX]")
    (tmp_path / "vc.csv").write_text(ISG)
    with pytest.raises(InputError, match=r"EXX is in 'EXX.csv' and in 'vc.csv'"):
        read_machine(path)


def test_an_error_of_the_volumetric_file_is_left_out(write, tmp_path):
    without = VOLUMETRIC + 'without = ["EXX"]\n[errors.EXX]'
    path = write("[errors.EXX]", without)
    (tmp_path / "vc.csv").write_text("X EXX EBX\n-500 0.001 2e-6\n0 0.003 4e-6\n")
    machine = read_machine(path)
    assert machine.components["EBX"].mean.tolist() == [2e-6, 4e-6]
    assert machine.components["EXX"].source.endswith("EXX.csv")
    path = write("[errors.EXX]", without.replace('["EXX"]', '["EYZ"]'))
    with pytest.raises(InputError, match=r"machine.toml:\d+: without EYZ.*accepted: EXX, EBX"):
        read_machine(path)


def test_interpolation_left_to_cross_validation_keeps_its_evidence(write):
    rows = "".join(f"{x},{x * x / 1e4},{x * x / 1e4}\n" for x in range(-500, 1, 25))
    path = write('"EXX.csv"', '"EXX.csv"\ninterpolation = "cross-validation"',
                 EXX="position_mm,forward,backward\n" + rows)  # fmt: skip
    component = read_machine(path).components["EXX"]
    assert str(component.interpolation) == "legendre(2)"
    assert len(component.evidence) == 12
    assert component.evaluate(np.array([-260.0])) == pytest.approx([6.76e-3])
