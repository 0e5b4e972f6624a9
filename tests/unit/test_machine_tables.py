"""Forms in which error tables come: order, gaps, units, single runs, files of others."""

from __future__ import annotations

import math

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.machine.files.volumetric_file import read_volumetric_file
from vmach.machine.tables.error_table import MM_PER, RAD_PER, read_error_table


def read(tmp_path, text, units=MM_PER, unit="um"):
    path = tmp_path / "table.csv"
    path.write_text(text)
    return read_error_table(path, units, unit)


def test_rows_in_any_order_and_comments(tmp_path):
    table = read(tmp_path, "# laser, 2 runs\nposition_mm, backward, forward\n0,4,3\n-50,2,1\n")
    assert table.position.tolist() == [-50, 0]
    assert table.forward.tolist() == [0.001, 0.003]
    assert table.backward.tolist() == [0.002, 0.004]
    assert tuple(map(str, table.notes)) == ("rows sorted by position",)
    assert table.runs is None


def test_gap_lies_on_the_line_between_its_neighbours_and_is_noted(tmp_path):
    table = read(tmp_path, "position_mm,forward,backward\n0,0,0\n10,,7\n40,8,0\n")
    assert table.forward == pytest.approx([0, 0.002, 0.008])
    assert table.backward == pytest.approx([0, 0.007, 0])
    assert [*map(str, table.notes)] == ["no forward reading at 10 mm: taken from the neighbours"]


def test_unit_in_a_column_goes_before_that_of_the_machine_file(tmp_path):
    text = "position_inch,forward_arcsec,backward\n0,1,1\n2,1,2\n"
    table = read(tmp_path, text, RAD_PER, "um/m")
    assert table.position.tolist() == [0, 50.8]
    assert table.forward == pytest.approx(np.full(2, math.pi / 180 / 3600))
    assert table.backward.tolist() == [1e-6, 2e-6]


def test_microinches(tmp_path):
    """An inch is 25.4 mm by definition: 100 uin are 2.54 um."""
    text = "position_inch,forward_uin,backward\n0,100,50\n10,-20,400\n"
    table = read(tmp_path, text, MM_PER, "uin")
    assert table.position.tolist() == [0, 254]
    assert table.forward == pytest.approx([2.54e-3, -0.508e-3])
    assert table.backward == pytest.approx([1.27e-3, 10.16e-3])
    with pytest.raises(InputError, match=r"column 'forward_uin': unit 'uin'; accepted: urad"):
        read(tmp_path, text, RAD_PER, "urad")


def test_single_runs_side_by_side(tmp_path):
    text = "position_mm,forward_1,backward_1,forward_2,backward_2\n0,1,3,2,4\n10,5,,7,8\n"
    table = read(tmp_path, text)
    assert table.forward == pytest.approx([0.0015, 0.006])
    assert table.backward == pytest.approx([0.0035, 0.008])
    assert table.runs.forward == pytest.approx(np.array([[0.001, 0.005], [0.002, 0.007]]))
    assert np.isnan(table.runs.backward[0, 1])


def test_a_wrong_header_is_told_every_header_that_is_read(tmp_path):
    rows = {3: "0,1,1\n10,1,1\n", 2: "0,1\n10,1\n", 4: "1,0,1,5\n1,0,-1,5\n1,9,1,5\n1,9,-1,5\n"}
    for wrong in ("position_mm,mean_um", "position_mm,forward_um"):
        with pytest.raises(InputError) as caught:
            read(tmp_path, f"{wrong}\n{rows[2]}")
        assert caught.value.line == 1
        for header in caught.value.accepted.split(" | "):
            names = header.removesuffix(", forward_2, ...").split(", ")
            assert read(tmp_path, f"{','.join(names)}\n{rows[len(names)]}").position[0] == 0
    assert "position_mm, error |" in caught.value.accepted
    assert "go into a column error" in caught.value.hint


def test_single_readings_below_each_other(tmp_path):
    rows = ["run,position_mm,approach,deviation_um"]
    for run in (1, 2):
        rows += [f"{run},{x},1,{x / 10 + run}" for x in (0, 10, 20)]
        rows += [f"{run},{x},-1,{x / 10 - run}" for x in (20, 10, 0)]
    table = read(tmp_path, "\n".join(rows))
    assert table.position == pytest.approx([0, 10, 20])
    assert table.runs.forward * 1e3 == pytest.approx(np.array([[1, 2, 3], [2, 3, 4]]))
    assert table.runs.backward * 1e3 == pytest.approx(np.array([[-1, 0, 1], [-2, -1, 0]]))


ISG = """// component errors of the X axis, as in the manual of the control
X      EXX    EYX    EZX    EAX    EBX    ECX
0.0    0.02   0.01   0.07   0.00   0.0042 0.003
10.0   0.00   -0.1   0.01   0.00   0.0011 0.002
#
C0Y B0X // squareness
0.00001 -0.00002
"""
ETALON = """// exchange format
[C0Y]
VALUE = 0.000022355737
[EXY]
Gridpoints = {
    -270.0 -0.000240680764
    -280.0 -0.001358635132  // not in order
    -260.0 0.000877273605
}  // end of EXY
"""


def test_isg_csv(tmp_path):
    (tmp_path / "vc.csv").write_text(ISG)
    found = read_volumetric_file(tmp_path / "vc.csv", "isg-csv")
    assert sorted(found.tables) == ["EAX", "EBX", "ECX", "EXX", "EYX", "EZX"]
    assert [column.tolist() for column in found.tables["EYX"]] == [[0, 10], [0.01, -0.1]]
    assert found.squareness_rad == {"EC0Y": 1e-5, "EB0X": -2e-5}


def test_etalon_text(tmp_path):
    (tmp_path / "vc.txt").write_text(ETALON)
    found = read_volumetric_file(tmp_path / "vc.txt", "etalon")
    position, value = found.tables["EXY"]
    assert position.tolist() == [-280, -270, -260]
    assert value.tolist() == [-0.001358635132, -0.000240680764, 0.000877273605]
    assert found.squareness_rad == {"EC0Y": 0.000022355737}


@pytest.mark.parametrize(
    ("format_name", "text", "line", "part"),
    [
        ("isg-csv", "Z X EXX\n0 0 1\n", 1, "depend on Z and X at once"),
        ("isg-csv", "X EXY\n0 1\n1 2\n", 1, "EXY over X"),
        ("isg-csv", "X EXX\n0 1\n1\n", 3, "2 finite numbers"),
        ("isg-csv", "X EXX\n0 1\n", 1, "1 rows"),
        ("isg-csv", "X EXX\n0 1\n0 2\n", 1, "a position twice"),
        ("isg-csv", "Y0A\n0.1\n", 1, "'Y0A' is no error of a linear axis"),
        ("isg-csv", "// nothing\n", None, "no error found"),
        ("etalon", "[EXX]\nGridpoints = {\n0 1\n1 2\n", 1, "no closing brace"),
        ("etalon", "[EXX]\nPoints = 4\n", 2, "Gridpoints"),
        ("etalon", "[EXX]\nGridpoints = {\n0 1\n1 2 3\n}\n", 4, "2 finite numbers"),
    ],
)
def test_complaints_about_volumetric_files(tmp_path, format_name, text, line, part):
    path = tmp_path / "vc"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_volumetric_file(path, format_name)
    assert (caught.value.file, caught.value.line) == (path, line)
    assert part in str(caught.value)


def test_positions_in_messages_are_in_the_unit_of_the_file(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("position_deg,forward,backward\n0,1,1\n90,,2\n180,3,3\n")
    rad_per = {"deg": math.pi / 180.0}
    table = read_error_table(path, MM_PER, "um", positions=rad_per)
    assert [*map(str, table.notes)] == ["no forward reading at 90 deg: taken from the neighbours"]
    path.write_text("position_deg,forward,backward\n0,1,1\n90,,2\n")
    with pytest.raises(InputError, match="no forward reading at 90 deg, the end"):
        read_error_table(path, MM_PER, "um", positions=rad_per)
