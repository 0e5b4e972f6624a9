"""``vmach iso230``: what it prints and writes, and its complaints."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.report_page import Page, assert_asks_for_nothing
from tests.small_job import write_job
from vmach.commands.accuracy import accuracy
from vmach.commands.iso230 import iso230
from vmach.errors import InputError
from vmach.iso230.evaluation import evaluate
from vmach.machine.tables.runs import Runs

RUNS = "position_mm,forward_1,backward_1,forward_2,backward_2\n0,1,0,3,2\n100,5,4,5,6\n"


@pytest.fixture
def runs(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text(RUNS)
    return path


def test_json_has_figures_and_uncertainty(runs, capsys):
    iso230(runs, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["unit"] == "um"
    assert table["figures"]["E"] == pytest.approx(4.0)
    assert table["U_k2"]["A"] > table["U_k2"]["R"] > 0
    assert table["notes"] == [
        "2 runs; the standard asks for five",
        "2 targets; the standard asks for at least five, and five a metre",
    ]


@pytest.mark.parametrize(("targets", "length_mm", "said"), [(4, 300, True), (5, 300, False),
                                                           (6, 1500, True), (8, 1600, False),
                                                           (5, 2500, False)])  # fmt: skip
def test_targets_are_five_at_least_and_five_a_metre(targets, length_mm, said, tmp_path, capsys):
    """ISO 230-2:2014, 5.3.2; public software has max(5, ceil(5 L)) up to 2 m as well."""
    path = tmp_path / "x.csv"
    rows = [f"{x},1,0.5,2,1" for x in np.linspace(0, length_mm, targets)]
    path.write_text("\n".join([RUNS.partition("\n")[0], *rows]))
    iso230(path, as_json=True)
    notes = json.loads(capsys.readouterr().out)["tables"]["x"]["notes"]
    assert any("at least five" in note for note in notes) is said


def test_runs_of_one_direction_say_nothing_of_reversal(tmp_path, capsys):
    """As the import writes them: both columns hold the same readings."""
    path = tmp_path / "x.csv"
    path.write_text("position_mm,forward_1,backward_1,forward_2,backward_2\n0,1,1,2,2\n9,3,3,4,4\n")
    iso230(path, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["figures"]["B"] == 0.0 and table["figures"]["A"] is not None
    assert any("the same values for both directions" in note for note in table["notes"])


def test_angles_have_no_budget(runs, capsys):
    iso230(runs, unit="arcsec", as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["unit"] == "urad"
    assert table["figures"]["E"] == pytest.approx(4 * 4.8481368, abs=1e-3)
    assert "U_k2" not in table


def test_diagram_and_json_are_written(runs, tmp_path, capsys):
    iso230(runs, out=tmp_path / "out")
    assert (tmp_path / "out/x.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads((tmp_path / "out/iso230.json").read_text())["standard"] == "ISO 230-2:2014"
    assert "expanded uncertainty" in capsys.readouterr().out


def test_the_sheet_has_figures_uncertainty_and_a_line_to_sign(runs, tmp_path):
    iso230(runs, out=tmp_path / "out", serial="4711-B", date="2026-05-04")
    entry = json.loads((tmp_path / "out/iso230.json").read_text())["tables"]["x"]
    page = Page((tmp_path / "out/iso230.html").read_text())
    assert_asks_for_nothing(page)
    for words in ("4711-B", "2026-05-04", "Signature", "2 runs; the standard asks for five"):
        assert words in page.text
    assert f"{entry['U_k2']['A']:.1f}" in page.text
    marks = [a for t, a in page.elements if t == "path" and a.get("class") == "dots forward"]
    assert [a["d"].count("M") for a in marks] == [2, 2]  # two runs of two targets
    lines = [a.get("class", "") for t, a in page.elements if t == "path"]
    assert lines.count("line range-E") == lines.count("line range-A") == 2
    assert "range A" in page.text and "range E" in page.text


def test_the_ends_that_are_drawn_are_those_of_the_figures():
    runs = Runs(np.array([0.0, 100.0]), np.array([[1.0, 5], [3, 5]]), np.array([[0.0, 4], [2, 6]]))
    result = evaluate(runs)
    ends = result.ends()
    assert ends["E"] == (1.0, 5.0)
    assert ends["A"] == pytest.approx((1 - 2 * np.sqrt(2), 5 + 2 * np.sqrt(2)))
    for name, (low, high) in ends.items():
        assert high - low == pytest.approx(getattr(result, name))
    assert set(evaluate(Runs(runs.position_mm, runs.forward[:1], runs.backward[:1])).ends()) == {
        "E"
    }


def test_budget_file_changes_the_uncertainty(runs, tmp_path, capsys):
    budget = tmp_path / "budget.toml"
    budget.write_text("eve_um = 0\nmisalignment_mrad = 0\nabbe_offset_mm = 0\nair_um = 0.5\n")
    iso230(runs, budget=budget, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["U_k2"]["R"] == 0
    assert table["U_k2"]["E"] == pytest.approx(2 * 0.5036, abs=0.01)


@pytest.mark.parametrize("text", ["", "# to be filled in\n"])
def test_a_budget_file_that_says_nothing_is_refused(runs, tmp_path, text):
    """It would be told as the source of figures that are all assumed."""
    (tmp_path / "budget.toml").write_text(text)
    with pytest.raises(InputError, match=r"names no contributor; accepted: wavelength_um, .*hint"):
        iso230(runs, budget=tmp_path / "budget.toml")


def test_complaints(runs, tmp_path):
    with pytest.raises(InputError, match="--unit parsec"):
        iso230(runs, unit="parsec")
    budget = tmp_path / "budget.toml"
    budget.write_text("eve = 1\n")
    with pytest.raises(InputError, match="unknown key 'eve'"):
        iso230(runs, budget=budget)
    with pytest.raises(InputError, match="not found"):
        iso230(tmp_path / "none.csv")


def test_tables_of_means_have_the_figures_that_means_have(tmp_path, capsys):
    write_job(tmp_path, {"EXX": (lambda x: 0.01 * x, (0, 0, -100))})
    iso230(tmp_path / "machine.toml", as_json=True)
    (figures,) = (t["figures"] for t in json.loads(capsys.readouterr().out)["tables"].values())
    assert figures["E"] == pytest.approx(4.0)  # 0.01 um/mm over 400 mm


def test_machine_without_tables(tmp_path):
    path = tmp_path / "machine.toml"
    travel = "".join(f"[axes.{axis}]\ntravel_mm = [-1, 0]\n" for axis in "XYZ")
    path.write_text(
        "schema = 1\nname = 'bare'\nchain = 't Z Y X b w'\n[convention]\nsign = 'relative'\n"
        "length = 'um'\nangle = 'urad'\n[motion]\nrapid_mm_min = 1\n" + travel
    )
    with pytest.raises(InputError, match="no error tables"):
        iso230(path)
    accuracy(path, grid="3", as_json=True)  # nothing wrong with it, nothing to find


def test_the_target_with_the_fewest_readings_tells_the_runs(runs, capsys):
    """U of a mean of n readings has the n of that target (budget of one drift, eve)."""
    runs.write_text(RUNS.replace("backward_2", "backward_2,forward_3,backward_3")
                    .replace("3,2\n", "3,2,3,\n").replace("5,6\n", "5,6,5,6\n"))  # fmt: skip
    iso230(runs, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["runs"] == 2
    eve = 1.5 / 3**0.5
    assert table["U_k2"]["B"] == pytest.approx(2 * eve * (2 / 2) ** 0.5, abs=0.01)


@pytest.mark.parametrize("slope", [0.0, 0.02])
def test_a_straightness_is_told_without_its_slope(slope, tmp_path, capsys):
    """A bow of 4 um on a line of 20 um/m: E is the line's, the rest by numpy's own fit."""
    bow = lambda x: 4.0 * ((x + 200.0) / 200.0) ** 2  # noqa: E731
    write_job(tmp_path, {"EYX": (lambda x: bow(x) + slope * x, (0, 0, -100))})
    iso230(tmp_path / "machine.toml", as_json=True)
    (table,) = json.loads(capsys.readouterr().out)["tables"].values()
    notes = [note for note in table["note_records"] if note["kind"] == "slope"]
    assert len(notes) == (slope > 0)
    if slope:
        assert notes[0]["size"] == pytest.approx(20.0)
        assert "the means vary by 4.00 um" in notes[0]["sentence"]
        assert table["figures"]["E"] > 4.0
