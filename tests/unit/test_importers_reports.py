"""Files of makers' own programs that have no public specification: what is in them."""

from __future__ import annotations

import pytest

from tests.import_samples import PCDMIS, RTL, write_plate_job
from vmach.errors import InputError
from vmach.importers import Questions, import_files


def imported(folder, name, text, job=None, **given):
    (folder / name).write_text(text, encoding="utf-8")
    (one,) = import_files([folder / name], Questions(given, job_file=job))
    return one


def rows(one, file):
    return [line.split(",") for line in one.files[file].splitlines()]


def test_runs_of_an_rtl_stand_side_by_side(tmp_path):
    """Runs 1 and 3 go up, 2 and 4 come back; the axis is that of the file."""
    one = imported(tmp_path, "any.rtl", RTL)
    assert rows(one, "errors/EXX.csv") == [
        ["position_mm", "forward_1_um", "forward_2_um", "backward_1_um", "backward_2_um"],
        ["0", "0.1", "0.2", "-1.1", "-0.9"],
        ["100", "1.5", "1.6", "0.4", "0.6"],
        ["200", "3.2", "3.3", "2.2", "2.4"],
    ]


def test_an_rtl_numbers_its_targets_from_nought_or_from_one(tmp_path):
    head, tail = RTL.split("DEVIATIONS::")
    lines = []
    for line in tail.splitlines():
        words = line.split()
        if len(words) == 3 and words[0].isdigit():
            words[1] = str(int(words[1]) - 1)
        lines.append(" ".join(words))
    other = imported(tmp_path, "b.rtl", head + "DEVIATIONS::" + "\n".join(lines))
    assert other.files == imported(tmp_path, "a.rtl", RTL).files


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("Target-count: 3", "Target-count: 4", "7: Target-count: 4, and 3 positions"),
        ("Run-count: 4", "Run-count: 5", "Run-count: 5, and 4 runs"),
        ("1 3 3.2000", "1 3 inf", "26: '1 3 inf'"),
        ("1 3 3.2000", "1 5 3.2000", "deviations of the targets 1 to 5, 3 positions"),
        ("100.0000\n", "100.0000 x\n", "10: '0.0000 100.0000 x'"),
    ],
)
def test_a_bad_rtl_is_refused_with_its_line(old, new, said, tmp_path):
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "x.rtl", RTL.replace(old, new))


def test_linear_runs_are_no_rotation_and_angular_ones_no_displacement(tmp_path):
    angular = RTL.replace(": rtl", ": rta").replace(": Linear", ": Angular")
    with pytest.raises(InputError, match="EBX, and the runs are linear; accepted: a displacement"):
        imported(tmp_path, "x.rtl", RTL, error="EBX")
    with pytest.raises(InputError, match="EXX, and the runs are angular; accepted: a rotation"):
        imported(tmp_path, "x.rta", angular, error="EXX")
    with pytest.raises(InputError, match=r"which error does x[.]rta hold"):
        imported(tmp_path, "x.rta", angular)  # axis X alone does not say which of its rotations
    with pytest.raises(InputError, match=r"which error does x[.]rts hold"):
        imported(tmp_path, "x.rts", RTL.replace(": rtl", ": rts"))


@pytest.mark.parametrize("name", ["x.rta", "pitch.txt"])
def test_angular_runs_are_in_mrad(name, tmp_path):
    """As two public readers have it, which multiply by 206.264 to get arcseconds."""
    angular = RTL.replace(": rtl", ": rta").replace("3.2000", "0.0320")
    one = imported(tmp_path, name, angular, error="EBX")
    assert one.sections[0].table == "errors.EBX"
    last = rows(one, "errors/EBX.csv")[3]
    arcsec = float(last[1]) * 1e-6 * 648000 / 3.14159265358979
    assert arcsec == pytest.approx(0.032 * 206.264, rel=1e-5)


def test_runs_filled_with_zeros_were_not_measured(tmp_path):
    """Files of runs in one direction have such runs, as a public program writes them."""
    lines = [
        f"{line.rsplit(' ', 1)[0]} 0" if line[:2] in ("2 ", "4 ") else line
        for line in RTL.splitlines()
    ]
    one = imported(tmp_path, "x.rtl", "\n".join(lines))
    assert "all 6 readings backward are 0: taken as not measured" in one.told
    table = rows(one, "errors/EXX.csv")
    assert [row[1:] for row in table[1:]] == [
        ["0.1", "0.2", "0.1", "0.2"], ["1.5", "1.6", "1.5", "1.6"], ["3.2", "3.3", "3.2", "3.3"],
    ]  # fmt: skip


def test_locations_of_a_report_are_holes_and_points(tmp_path):
    """Columns in two orders, rows with empty cells, a form that has no place."""
    one = imported(tmp_path, "plate.txt", PCDMIS, write_plate_job(tmp_path))
    assert rows(one, "plate_holes.csv") == [
        ["id", "x", "y", "mx", "my", "d", "md"],
        ["CIR1", "10", "20", "10.011", "19.995", "8", "8.012"],
        ["CIR2", "-28.6", "9.1", "-28.623", "9.125", "4.2", "4.254"],
    ]
    assert rows(one, "plate_points.csv")[1] == [
        "PNT1", "PNT1", "5", "3", "0", "0", "0", "1", "5", "3.001", "-0.012",
    ]  # fmt: skip


def test_a_report_in_inches(tmp_path):
    text = PCDMIS[: PCDMIS.index("DIM LOC3")].replace("UNITS=MM", "UNITS=IN")
    one = imported(tmp_path, "plate.txt", text)
    assert rows(one, "plate_holes.csv")[1] == [
        "CIR1", "254", "508", "254.2794", "507.873", "203.2", "203.5048",
    ]  # fmt: skip


def test_a_report_that_does_not_say_its_unit_is_asked(tmp_path):
    text = PCDMIS[: PCDMIS.index("DIM LOC3")].replace("UNITS=MM", "")
    with pytest.raises(InputError, match="the file does not say: unit of the coordinates"):
        imported(tmp_path, "plate.txt", text)
    assert imported(tmp_path, "plate.txt", text, unit="mm").files


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        # the heading of another format above the same numbers
        ("NOMINAL       +TOL       -TOL       MEAS", "MEAS          +TOL       -TOL    NOMINAL",
         "MEAS minus NOMINAL is -0.011, DEV is 0.011"),
        ("10.011      0.011", "10.111      0.011", "6: MEAS minus NOMINAL is 0.111, DEV is 0.011"),
        ("10.011      0.011", "10.x11      0.011", "6: 'X      10.000"),
        ("CIR1  UNITS=MM", "CIR1  UNITS=IN", "UNITS=IN, MM"),
    ],
)  # fmt: skip
def test_a_bad_report_is_refused_with_its_line(old, new, said, tmp_path):
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "plate.txt", PCDMIS.replace(old, new, 1), write_plate_job(tmp_path))


def test_holes_of_a_table_may_have_places_alone(tmp_path):
    text = "hole;x;y;mx;my\nA;10;20;10.003;19.998\nB;30;20;30.001;20\n"
    one = imported(tmp_path, "plate.csv", text)
    assert rows(one, "plate_holes.csv")[:2] == [
        ["id", "x", "y", "mx", "my"], ["A", "10", "20", "10.003", "19.998"]]  # fmt: skip
    assert "no diameter was measured: the holes have places alone" in one.told


def test_holes_of_a_table_without_their_diameter_are_left_out_among_others(tmp_path):
    text = "hole;x;y;mx;my;d;md\nA;10;20;10.003;19.998;8;8.01\nB;30;20;30.001;20;8;\n"
    one = imported(tmp_path, "plate.csv", text)
    assert [row[0] for row in rows(one, "plate_holes.csv")] == ["id", "A"]
    assert "1 holes without a measured diameter are left out" in one.told


def test_locations_of_a_report_without_diameters_are_holes_by_their_places(tmp_path):
    text = "\n".join(
        line for line in PCDMIS[: PCDMIS.index("DIM LOC3")].splitlines()
        if not line.startswith("D")  or line.startswith("DIM")
    )  # fmt: skip
    one = imported(tmp_path, "plate.txt", text)
    assert rows(one, "plate_holes.csv") == [
        ["id", "x", "y", "mx", "my"], ["CIR1", "10", "20", "10.011", "19.995"],
        ["CIR2", "-28.6", "9.1", "-28.623", "9.125"]]  # fmt: skip
