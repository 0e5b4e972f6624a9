"""Outliers and runs of ISO 230-2 data against a published example and sums by hand."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest
from typer.testing import CliRunner

from vmach.cli import app
from vmach.commands.iso230 import iso230
from vmach.errors import InputError
from vmach.iso230.by_run import outliers, run_figures
from vmach.machine.tables.error_table import MM_PER, read_error_table
from vmach.machine.tables.runs import Runs

#: Rosner (1983), as in the NIST/SEMATECH e-Handbook of statistical methods, 1.3.5.17.3
ROSNER = [-0.25, 0.68, 0.94, 1.15, 1.20, 1.26, 1.26, 1.34, 1.38, 1.43, 1.49, 1.49, 1.55, 1.56,
          1.58, 1.65, 1.69, 1.70, 1.76, 1.77, 1.81, 1.91, 1.94, 1.96, 1.99, 2.06, 2.09, 2.10, 2.14,
          2.15, 2.23, 2.24, 2.26, 2.35, 2.37, 2.40, 2.47, 2.54, 2.62, 2.64, 2.90, 2.92, 2.92, 2.93,
          3.21, 3.26, 3.30, 3.59, 3.68, 4.30, 4.64, 5.34, 5.42, 6.01]  # fmt: skip
#: R_i printed there for the readings taken away first, second and third
PRINTED = (3.118, 2.942, 3.179)


def one_target(values) -> Runs:
    column = np.array(values, float)[:, None]
    return Runs(np.array([0.0]), column, column)


def test_three_outliers_of_the_example_of_rosner():
    """5 % and ten candidates, as there: R_1 and R_2 stay below their bounds, R_3 does not."""
    found = outliers(one_target(ROSNER), level=0.05, most=10)
    assert [own.deviation for own in found] == [6.01, 5.42, 5.34]
    assert {own.direction for own in found} == {"both"}
    for i, (own, printed) in enumerate(zip(found, PRINTED, strict=True)):
        n, t = len(ROSNER) - i, own.studentised
        extreme = (n - 1) * t / math.sqrt(n * (n - 2 + t * t))  # R of an externally studentised t
        assert extreme == pytest.approx(printed, abs=2e-3)


@pytest.mark.parametrize(("extreme", "is_told"), [(1.755, False), (1.773, True)])
def test_bound_is_that_of_the_table_of_grubbs(extreme, is_told):
    """ISO 5725-2, table of Grubbs' test: 1.764 for five readings, one outlier, at 1 %."""
    # four readings +-1, +-a and one at x, moved until its G is `extreme`
    low, high = 1.0, 1e3
    for _ in range(80):
        x = 0.5 * (low + high)
        values = np.array([-1.0, -0.37, 0.41, 1.0, x])
        grubbs = (x - values.mean()) / values.std(ddof=1)
        low, high = (x, high) if grubbs < extreme else (low, x)
    assert bool(outliers(one_target(values), level=0.01)) is is_told


def test_clean_runs_have_an_outlier_no_more_often_than_the_level():
    random = np.random.default_rng(5)
    told = 0
    for _ in range(300):
        forward, backward = random.normal(0, 1.0, (2, 5, 11))
        told += bool(outliers(Runs(np.arange(11.0), forward, backward), level=0.05))
    assert told <= 27  # 15 expected, three standard deviations more


def test_runs_by_hand():
    """Targets 0 and 10; runs 4, 7, 9: means 2 and 5, the last run 1 and 4 above."""
    side = np.array([[1.0, 3.0], [2.0, 3.0], [3.0, 9.0]])
    runs = Runs(np.array([0.0, 10.0]), side, -side, np.array([4, 7, 9]), np.array([4, 7, 9]))
    found = {(own.run, own.direction): own for own in run_figures(runs)}
    assert (found[9, "forward"].mean, found[9, "forward"].largest) == (2.5, 4.0)
    assert (found[4, "backward"].mean, found[4, "backward"].position) == (1.5, 10.0)
    assert found[7, "forward"].readings == 2


def numbered(path, runs, *, odd=None, order=None, way_by_way=False):
    """Readings of +1 forward and -1 backward and a little scatter, in um; `odd` is a reading."""
    random = np.random.default_rng(1)
    rows = []
    for k, run in enumerate(runs):
        for sign in (1, -1):
            for x in (0, 100, 200, 300, 400)[::sign]:
                number = 2 * k + (1 if sign > 0 else 2) if way_by_way else run
                value = sign + random.normal(0, 0.1)
                if odd == (run, sign, x):
                    value += 6.0
                rows.append(f"{number},{x},{sign},{value:.3f}")
    rows = rows if order is None else [rows[i] for i in order(len(rows))]
    path.write_text("\n".join(["run,position_mm,approach,deviation_um", *rows]) + "\n")
    return path


def report(path, capsys):
    iso230(path, as_json=True)
    (table,) = json.loads(capsys.readouterr().out)["tables"].values()
    return table


@pytest.mark.parametrize("shuffled", [False, True])
def test_an_outlier_is_told_with_its_run(shuffled, tmp_path, capsys):
    order = np.random.default_rng(3).permutation if shuffled else None
    path = numbered(tmp_path / "x.csv", (1, 2, 3, 4, 5), odd=(4, -1, 300), order=order)
    table = report(path, capsys)
    (odd,) = table["outliers"]
    assert (odd["run"], odd["direction"], odd["at"]) == (4, "backward", 300.0)
    assert odd["from_others"] == pytest.approx(6.0, abs=0.5)
    (note,) = (n for n in table["note_records"] if n["kind"] == "outlier")
    assert note["level"] == "question" and "run 4 backward reads" in note["sentence"]
    assert [(own["run"], own["direction"]) for own in table["by_run"]][:3] == [
        (1, "forward"), (1, "backward"), (2, "forward"),
    ]  # fmt: skip
    iso230(path)
    assert "4 │ backward" in capsys.readouterr().out


def test_an_outlier_among_runs_that_agree_exactly(tmp_path, capsys):
    path = tmp_path / "x.csv"
    rows = [f"{x},1.5,0.5,1.5,0.5,{1.5 + 10 * (x == 100)},0.5" for x in (0, 100, 200)]
    path.write_text(
        "position_mm,forward_2,backward_2,forward_3,backward_3,forward_4,backward_4\n"
        + "\n".join(rows)
    )
    table = report(path, capsys)
    assert [(own["run"], own["at"], own["from_others"]) for own in table["outliers"]] == [
        (4, 100.0, 10.0)
    ]
    assert "x.csv:1: the runs are numbered 2, 3, 4, not from 1" in " ".join(table["notes"])


def test_numbers_that_do_not_begin_at_1_and_have_a_gap(tmp_path, capsys):
    notes = report(numbered(tmp_path / "x.csv", (3, 4, 6, 7, 8)), capsys)["notes"]
    assert any("the runs are numbered 3, 4, 6, 7, 8, not from 1" in note for note in notes)
    assert any("run 5 is missing between run 3 and run 8" in note for note in notes)


def test_numbers_in_order_are_not_asked_about(tmp_path, capsys):
    for way_by_way in (False, True):
        table = report(numbered(tmp_path / "x.csv", range(1, 6), way_by_way=way_by_way), capsys)
        assert table["notes"] == [] and table["runs"] == 5
    assert {own["run"] for own in table["by_run"] if own["direction"] == "backward"} == {
        2, 4, 6, 8, 10,
    }  # fmt: skip


def test_a_run_that_holds_a_target_twice(tmp_path, capsys):
    path = numbered(tmp_path / "x.csv", range(1, 6))
    clean = report(path, capsys)["figures"]
    lines = path.read_text().splitlines()
    (k,) = (k for k, line in enumerate(lines) if line.startswith("3,200,1,"))
    lines[k] = "2" + lines[k][1:]
    path.write_text("\n".join(lines))
    table = report(path, capsys)
    first = 1 + next(k for k, line in enumerate(lines) if line.startswith("2,200,1,"))
    (note,) = (n for n in table["note_records"] if n["kind"] == "repeat")
    assert note["text"].startswith(
        f"x.csv:{k + 1}: run 2, approach 1, has been at 200 mm already in line {first}"
    )
    assert table["figures"] == clean  # a wrong number changes no figure
    # a whole run under the number of another: its own number is missing
    path.write_text("\n".join("2" + line[1:] if line[:2] == "3," else line for line in lines))
    text = " ".join(report(path, capsys)["notes"])
    assert "and so 4 readings more" in text and "run 3 is missing between" in text


@pytest.mark.parametrize("run", ["1000000", "2000000000", "1e300", "99999999999999999999"])
def test_a_number_that_no_run_has_is_refused(run, tmp_path):
    path = tmp_path / "x.csv"
    path.write_text(f"run,position_mm,approach,deviation_um\n1,0,1,1\n{run},100,1,2\n")
    with pytest.raises(InputError, match=re.escape(f"run '{run}'")) as told:
        read_error_table(path, MM_PER, "um")
    assert told.value.line == 3
    if run.isdigit():
        path.write_text(f"position_mm,forward_{run},backward_{run}\n0,1,2\n100,3,4\n")
        with pytest.raises(InputError, match=f"run {run}") as told:
            read_error_table(path, MM_PER, "um")
        assert told.value.line == 1


def test_an_empty_table_is_told_with_the_columns_of_its_axis(tmp_path):
    (tmp_path / "x.csv").write_text("")
    with pytest.raises(InputError) as told:
        read_error_table(tmp_path / "x.csv", MM_PER, "um")
    assert "position_mm, forward" in str(told.value) and "{" not in str(told.value)


def test_many_readings_have_a_hundred_outliers_at_most():
    random = np.random.default_rng(7)
    values = random.normal(0.0, 1e-3, 4000)
    values[:150] += 1.0  # 150 of 4000 are below 5 %
    assert len(outliers(one_target(values))) == 100


def test_a_run_of_one_direction(tmp_path, capsys):
    path = numbered(tmp_path / "x.csv", range(1, 6))
    kept = [line for line in path.read_text().splitlines() if not line.startswith("2,") or ",-1,"
            not in line]  # fmt: skip
    path.write_text("\n".join(kept))
    notes = report(path, capsys)["notes"]
    assert any("run 2 was measured forward only: where is the other way?" in n for n in notes)


@pytest.mark.parametrize("wrong", ["1.5", "", "-1"])
def test_a_number_that_is_none(wrong, tmp_path):
    path = tmp_path / "x.csv"
    path.write_text(f"run,position_mm,approach,deviation\n1,0,1,1\n{wrong},0,-1,1\n")
    with pytest.raises(InputError, match=rf"x.csv:3: run '{wrong}'; accepted: the number"):
        read_error_table(path, MM_PER, "um")


def test_numbers_go_with_a_table_that_counts_against_the_axis(tmp_path):
    """Forward along the laser is backward of the axis: so are the numbers."""
    from vmach.machine.counted_positions import in_machine_coordinates

    path = numbered(tmp_path / "x.csv", (1, 2), way_by_way=True)
    table = read_error_table(path, MM_PER, "um")
    turned = in_machine_coordinates(table, 400.0, reverse=True, swap=True, negate=True).runs
    assert turned.forward_number.tolist() == [2, 4]
    assert turned.backward[0] == pytest.approx(-table.runs.forward[0, ::-1])


LASER = """Maschine;Beispiel;;
Position (mm);Abweichung (µm);Richtung;Lauf
0,0;1,0;+;4
100,0;2,0;+;4
100,0;1,0;-;4
0,0;0,0;-;4
0,0;1,4;+;7
100,0;2,4;+;7
100,0;1,4;-;7
0,0;0,4;-;7
"""


def table_of(tmp_path, text):
    """What `vmach import` makes of a laser file."""
    (tmp_path / "x.csv").write_text(text, encoding="utf-8")
    words = ["import", str(tmp_path / "x.csv"), "--error", "EXX", "-o", str(tmp_path), "--yes"]
    made = CliRunner().invoke(app, words, catch_exceptions=False)
    assert made.exit_code == 0, made.output
    return read_error_table(tmp_path / "errors" / "EXX.csv", MM_PER, "um").runs, made.output


def test_the_import_keeps_the_numbers_of_a_laser_file(tmp_path):
    runs, told = table_of(tmp_path, LASER)
    assert runs.forward_number.tolist() == runs.backward_number.tolist() == [4, 7]
    assert 1e3 * runs.forward == pytest.approx(np.array([[1.0, 2.0], [1.4, 2.4]]))
    assert 1e3 * runs.backward == pytest.approx(np.array([[0.0, 1.0], [0.4, 1.4]]))
    assert "counted anew" not in told


@pytest.mark.parametrize(
    ("numbers", "said"), [("4", "run 4 has the position of line 7"), ("A", "no whole numbers")]
)
def test_numbers_that_tell_no_runs_are_counted_anew(numbers, said, tmp_path):
    runs, told = table_of(tmp_path, LASER.replace(";7", f";{numbers}"))
    assert runs.forward_number.tolist() == [1, 2]
    assert 1e3 * runs.forward == pytest.approx(np.array([[1.0, 2.0], [1.4, 2.4]]))
    assert said in told and "counted anew" in told


def test_the_import_keeps_the_numbers_of_headings(tmp_path):
    text = "Position (mm),Run 3 + (um),Run 3 - (um),Run 5 + (um),Run 5 - (um)\n"
    runs, _ = table_of(tmp_path, text + "0,1,0,2,1\n100,3,2,4,3\n")
    assert runs.forward_number.tolist() == [3, 5]
    assert 1e3 * runs.backward == pytest.approx(np.array([[0.0, 2.0], [1.0, 3.0]]))
