"""Points files: what is read, what is said, what is refused."""

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.nominal.points import read_points_csv

HEAD = "id,feature,x,y,z,i,j,k,mx,my,mz,u_um\n"
ROW = "1,top,10,20,-5,0,0,1,10,20,-4.998,0.8\n"


def written(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_text(text)
    return path


def test_a_measured_point(tmp_path):
    points = read_points_csv(written(tmp_path, HEAD + ROW))
    assert points.measured_deviation_mm == pytest.approx([0.002], abs=1e-12)
    assert points.u_mm == pytest.approx([0.8e-3])
    assert points.id.tolist() == ["1"] and points.feature.tolist() == ["top"]
    assert points.notes == ()


def test_nominal_points_need_no_measurement(tmp_path):
    text = "z,y,x,k,j,i,id\n# comment\n\n1,2,3,0,0,1.0005,a\n"
    points = read_points_csv(written(tmp_path, text))
    assert points.point_mm.tolist() == [[3, 2, 1]] and points.normal.tolist() == [[1, 0, 0]]
    with pytest.raises(InputError, match="not measured"):
        _ = points.measured_deviation_mm


def test_repeated_points_are_kept_and_said(tmp_path):
    points = read_points_csv(written(tmp_path, HEAD + ROW + ROW))
    assert len(points) == 2
    assert any("repeat" in str(note) for note in points.notes)
    assert any("more than once" in str(note) for note in points.notes)


@pytest.mark.parametrize(
    ("ids", "said"),
    [
        ("1 2 1", "points.csv:4: id '1' occurs more than once"),
        ("1 1 2 2 3 3", "points.csv:3: id '1' occurs more than once, and so 2 more"),
    ],
)
def test_ids_that_stand_twice_are_said(ids, said, tmp_path):
    rows = (f"{name},top,{k},20,-5,0,0,1\n" for k, name in enumerate(ids.split()))
    points = read_points_csv(written(tmp_path, "id,feature,x,y,z,i,j,k\n" + "".join(rows)))
    assert [str(note) for note in points.notes] == [said]


def test_measured_points_in_metres_are_said(tmp_path):
    rows = [f"{n},f,{n * 10},0,0,0,0,1,{n / 100},0,0,1\n" for n in range(5)]
    points = read_points_csv(written(tmp_path, HEAD + "".join(rows)))
    assert any("metres" in str(note) for note in points.notes)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (HEAD, None, "no points"),
        (HEAD + ROW.replace(".", ","), 2, "decimal comma"),
        (
            HEAD.replace("u_um", "measured_s") + ROW.replace("0.8", "10:05:00"),
            2,
            "seconds of its clock, no time of day",
        ),
        (HEAD.replace(",z,", ",") + ROW, 1, "column z is missing"),
        (HEAD.replace("mz,", "") + ROW, 1, "column mz is missing"),
        (HEAD + ROW + ROW.replace("20", "twenty"), 3, "y is 'twenty'"),
        (HEAD + ROW.replace("20", "nan"), 2, "y is 'nan'"),
        (HEAD + ROW.replace("0,0,1", "0,0,1.01"), 2, "length 1.01"),
        (HEAD + ROW.replace("0.8", "0"), 2, "u_um is 0"),
        (HEAD + ROW.replace("0.8", "1e-300"), 2, "u_um is 1e-300; accepted: 1e-06 um or more"),
        (HEAD + ROW.replace(",0.8", ""), 2, "11 values"),
        (HEAD.replace(",", ";") + ROW, 1, "separate the columns by commas"),
    ],
)
def test_bad_files_are_refused_with_their_line(tmp_path, text, line, words):
    with pytest.raises(InputError, match=words) as error:
        read_points_csv(written(tmp_path, text))
    assert error.value.line == line


def test_arrays_are_read_only(tmp_path):
    points = read_points_csv(written(tmp_path, HEAD + ROW))
    with pytest.raises(ValueError, match="read-only"):
        points.point_mm[0] = np.zeros(3)


@pytest.mark.parametrize("cell", ["1_000", "\u0661\u0662", "\uff11"])
def test_digits_that_only_python_takes_for_a_number_are_refused(tmp_path, cell):
    file = tmp_path / "points.csv"
    file.write_text(f"id,feature,x,y,z,i,j,k\n1,top,{cell},0,0,0,0,1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"points\.csv:2: x is .*; accepted: a finite number"):
        read_points_csv(file)
