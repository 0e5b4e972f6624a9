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


def test_microinches(runs, capsys):
    iso230(runs, unit="uin", as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["unit"] == "um"
    assert table["figures"]["E"] == pytest.approx(4 * 0.0254, abs=1e-4)
    runs.write_text(RUNS.replace("_1,", "_1_uin,").replace("_2", "_2_uin"))
    iso230(runs, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["x"]
    assert table["figures"]["E"] == pytest.approx(4 * 0.0254, abs=1e-4)


def test_a_machine_file_in_microinches(tmp_path, capsys):
    write_job(tmp_path, {"EXX": (lambda x: 0.01 * x, (0, 0, -100))})
    text = (tmp_path / "machine.toml").read_text()
    (tmp_path / "machine.toml").write_text(text.replace('length = "um"', 'length = "uin"'))
    iso230(tmp_path / "machine.toml", as_json=True)
    (table,) = json.loads(capsys.readouterr().out)["tables"].values()
    assert table["figures"]["E"] == pytest.approx(4.0 * 0.0254, abs=1e-4)


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


ROTARY = "run,position_deg,approach,deviation_arcsec\n"


def rotary_runs(random, targets_deg, runs=5):
    """Readings in arcsec by target and direction, one row a run, (runs, K) each."""
    shape = runs, len(targets_deg)
    wave = 3.0 * np.sin(np.radians(targets_deg))
    return wave + random.normal(0, 0.5, shape), wave - 1.2 + random.normal(0, 0.5, shape)


def test_a_rotary_axis_by_the_formulas_written_out_here(tmp_path, capsys):
    """ISO 230-2:2014 covers axes up to 360 degrees; 1 arcsec is pi/648000 rad."""
    targets = np.arange(0.0, 331.0, 30.0)
    forward, backward = rotary_runs(np.random.default_rng(2), targets)
    rows = [
        f"{k + 1},{x},{sign},{readings[k, i]:.6f}"
        for sign, readings in ((1, forward), (-1, backward))
        for k in range(5)
        for i, x in enumerate(targets)
    ]
    path = tmp_path / "ecc.csv"
    path.write_text(ROTARY + "\n".join(rows))
    iso230(path, as_json=True, out=tmp_path / "out")
    table = json.loads(capsys.readouterr().out)["tables"]["ecc"]
    means, s = (np.stack([f(x) for x in (forward, backward)])
                for f in (lambda x: x.mean(axis=0), lambda x: x.std(axis=0, ddof=1)))  # fmt: skip
    reversal = means[0] - means[1]
    urad = 1e6 * np.pi / 648000
    wanted = {
        "A": (means + 2 * s).max() - (means - 2 * s).min(),
        "R": max((2 * s.sum(axis=0) + abs(reversal)).max(), 4 * s.max()),
        "E": np.ptp(means),
        "M": np.ptp(means.mean(axis=0)),
        "B": abs(reversal).max(),
    }
    assert table["unit"] == "urad"
    assert table["length_mm"] is None and table["range_deg"] == pytest.approx(330.0)
    for name, value in wanted.items():
        assert table["figures"][name] == pytest.approx(urad * value, abs=1e-3)
    assert table["notes"] == ["no uncertainty is stated: the budget covers positioning only"]
    assert "330°" in (tmp_path / "out/iso230.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(("range_deg", "least"), [(90, 3), (180, 5), (360, 8)])
def test_targets_of_a_rotary_axis_go_by_its_range(range_deg, least, tmp_path, capsys):
    path = tmp_path / "ecc.csv"
    for count in (least - 1, least):
        rows = [f"{x},1,0.5,2,1" for x in np.linspace(0, range_deg, count)]
        path.write_text(RUNS.partition("\n")[0].replace("_mm", "_deg") + "\n" + "\n".join(rows))
        iso230(path, unit="arcsec", as_json=True)
        notes = json.loads(capsys.readouterr().out)["tables"]["ecc"]["notes"]
        assert any(f"at least {least} over" in note for note in notes) is (count < least)


def test_readings_over_angles_state_their_unit(tmp_path):
    path = tmp_path / "ecc.csv"
    path.write_text("position_deg,forward,backward\n0,1,2\n90,3,4\n")
    with pytest.raises(InputError, match=r"ecc.csv:1: readings over angles, without a unit"):
        iso230(path)


def test_the_unit_of_the_columns_is_that_of_the_readings(tmp_path, capsys):
    path = tmp_path / "ebx.csv"
    path.write_text("position_mm,forward_arcsec,backward_arcsec\n0,1,1\n100,3,4\n")
    iso230(path, as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["ebx"]
    assert table["unit"] == "urad"
    assert table["figures"]["E"] == pytest.approx(3 * 4.8481368, abs=1e-3)


def test_tables_of_rotary_axes_of_a_machine(tmp_path, capsys):
    write_job(tmp_path)
    text = (tmp_path / "machine.toml").read_text().replace("b X' w", "b X' C' w")
    text += "[axes.C]\ntravel_deg = [-360, 360]\ncentre_mm = [0, 0, -200]\n"
    (tmp_path / "machine.toml").write_text(text + '[errors.ECC]\ntable = "ecc.csv"\n')
    (tmp_path / "ecc.csv").write_text(
        RUNS.partition("\n")[0].replace("_mm", "_deg") + "\n0,1,0,3,2\n90,5,4,5,6\n"
    )
    iso230(tmp_path / "machine.toml", as_json=True)
    table = json.loads(capsys.readouterr().out)["tables"]["ECC"]
    assert table["figures"]["E"] == pytest.approx(4.0) and table["range_deg"] == 90.0


def test_runs_of_one_direction_are_told_where_to_go(tmp_path, capsys):
    path = tmp_path / "x.csv"
    path.write_text("run,position_mm,approach,deviation\n1,0,1,1\n2,0,1,3\n1,9,1,5\n2,9,1,5\n")
    with pytest.raises(InputError, match=r"no backward reading; .*error_1, error_2"):
        iso230(path)
    path.write_text("position_mm,error_1,error_2\n0,1,3\n9,5,5\n")
    iso230(path, as_json=True)
    assert json.loads(capsys.readouterr().out)["tables"]["x"]["figures"]["E"] == 3.0
