"""Measured files as they come from a workshop: the diagnosis says what is wrong, and survives."""

import json
import re
import shutil

import numpy as np
import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.spoil import spoil, spoil_instrument
from tests.hidden_effects.verdict import judge
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """An experiment with lost motion, nothing spoilt."""
    folder = tmp_path_factory.mktemp("sound")
    make_experiment(folder, effects=["backlash"], seed=61)
    return folder


@pytest.fixture
def folder(sound, tmp_path):
    """A copy to spoil."""
    return shutil.copytree(sound, tmp_path / "experiment")


@pytest.mark.parametrize(
    ("how", "share", "word"),
    [
        ("chips", 0.03, "count for little"),
        ("repeated", 0.02, "repeat"),
        ("never_cut", 0.02, "no move cut"),
    ],
)
def test_some_bad_rows_are_said_and_the_verdict_survives(folder, how, share, word):
    count = spoil(folder, how, seed=5, share=share)
    report, _ = program_runs.diagnose(folder)
    notes = " ".join(report["notes"])
    assert word in notes
    if how != "chips":  # the smallest chips lie within the noise
        assert f"{count} " in notes
    found = judge(report, json.loads((folder / "truth.json").read_text()))
    assert found.outcome == "right", found.said
    (_, value, low, high, true) = found.parameters[0]
    assert abs(value - true) < 1.5 * (high - low) / 2


@pytest.mark.parametrize(
    ("how", "word"),
    [
        ("metres", "metres"),
        ("inches", "inches"),
        ("measured_in_metres", "metres"),
        ("uncertainty_in_mm", "u_um"),
        ("uncertainty_in_metres", "u_um"),
    ],
)
def test_a_wrong_unit_is_refused_by_its_name(folder, how, word):
    spoil(folder, how)
    with pytest.raises(RuntimeError, match=r"exit 1\n.*part_measured\.csv") as error:
        program_runs.diagnose(folder)
    assert word in str(error.value)


def test_the_measurement_of_another_part_is_refused(folder):
    shutil.copy(folder / "check_measured.csv", folder / "part_measured.csv")
    with pytest.raises(RuntimeError, match=r"is this the measurement of this part|part.s program"):
        program_runs.diagnose(folder)


@pytest.mark.parametrize(("size_mm", "word"), [(0.012, "count for little"), (0.3, "left out")])
def test_of_several_chips_each_is_found_and_no_good_point_with_them(folder, size_mm, word):
    """Large ones are left out on reading; small ones lose their weight in the fit."""
    path = folder / "part_measured.csv"
    header, *rows = path.read_text().splitlines()
    spoilt = [37, 151, 288, 412, 500]
    for k, row in enumerate(spoilt):
        cells = rows[row].split(",")
        normal, measured = np.array(cells[5:8], float), np.array(cells[8:11], float)
        cells[8:11] = [f"{v:.6f}" for v in measured + size_mm * (1.0 + 0.3 * k) * normal]
        rows[row] = ",".join(cells)
    path.write_text("\n".join([header, *rows]) + "\n")
    report, _ = program_runs.diagnose(folder)
    (note,) = (note for note in report["notes"] if word in note)
    assert f"({len(spoilt)} of {len(rows)})" in note
    found = re.findall(r"\d+", note.partition("): ")[2].replace("part_measured.csv", ""))
    assert sorted(map(int, found)) == [row + 1 for row in spoilt]


def test_one_bad_reading_of_a_test_takes_no_good_one_with_it(tested, tmp_path):
    folder = shutil.copytree(tested, tmp_path / "experiment")
    head, *sections = (folder / "job.toml").read_text().split("[[measurements]]")
    laser = [section for section in sections if "laser_X" in section]
    text = "[[measurements]]".join([head.replace("measured =", "#"), *laser])
    (folder / "job.toml").write_text(text)
    path = folder / "laser_X.csv"
    header, *rows = path.read_text().splitlines()
    cells = rows[40].split(",")
    at = header.split(",").index("deviation_um")
    cells[at] = f"{float(cells[at]) + 60.0:.6f}"
    rows[40] = ",".join(cells)
    path.write_text("\n".join([header, *rows]) + "\n")
    report, _ = program_runs.diagnose(folder)
    assert report["verdict"] == "nothing"
    (note,) = (note for note in report["notes"] if "count for little" in note)
    assert note.endswith(f"(1 of {len(rows)}): laser_X.csv 41")


TESTS = ("ballbar_xy", "laser_X", "diagonal_0", "drift", "tip")


@pytest.fixture(scope="module")
def tested(tmp_path_factory):
    """A machine in good health with a test of every kind."""
    folder = tmp_path_factory.mktemp("tested")
    make_experiment(folder, effects=[], seed=62, instruments=TESTS)
    return folder


@pytest.mark.parametrize("name", TESTS)
@pytest.mark.parametrize(
    ("factor", "said"),
    [(1e-3, "are they in mm?"), (1e-6, "are they in m?"), (1e3, "in nm?")],
)
def test_a_test_in_another_unit_is_refused_by_its_name(tested, tmp_path, name, factor, said):
    folder = shutil.copytree(tested, tmp_path / "experiment")
    spoil_instrument(folder, name, factor)
    message = rf"{name}\.csv(:\d+)?: .* um\b.*accepted: .*{re.escape(said)}"
    with pytest.raises(InputError, match=message):
        read_instruments(read_job(folder / "job.toml"))


def test_an_uncertainty_in_mm_is_refused(tested, tmp_path):
    folder = shutil.copytree(tested, tmp_path / "experiment")
    job = folder / "job.toml"
    job.write_text(job.read_text().replace("u_um = 0.3", "u_um = 0.0003"))
    with pytest.raises(InputError, match=r"this test is 0\.0003 um; accepted: 0\.005 to 100 um"):
        read_instruments(read_job(job))


def test_a_large_error_is_no_wrong_unit(tested, tmp_path):
    """Lost motion of 100 um, and a spindle that grows by 150 um, are real on a worn machine."""
    folder = shutil.copytree(tested, tmp_path / "experiment")
    spoil_instrument(folder, "laser_X", 1.0, add_um=lambda c: 50.0 * c["approach"].astype(float))
    spoil_instrument(
        folder, "drift", 1.0, add_um=lambda c: 150.0 * (c["t_s"].astype(float) / 5400.0)
    )
    assert len(read_instruments(read_job(folder / "job.toml"))) == len(TESTS)


def test_a_machine_compensated_since_its_tables_were_made_is_no_wrong_unit(tested, tmp_path):
    """The readings scatter by their uncertainty alone, far below what the tables say."""
    folder = shutil.copytree(tested, tmp_path / "experiment")
    noise = np.random.default_rng(3)
    spoil_instrument(
        folder, "laser_X", 1.0,
        add_um=lambda c: 0.3 * noise.normal(size=len(c["t_s"])) - c["deviation_um"].astype(float),
    )  # fmt: skip
    assert len(read_instruments(read_job(folder / "job.toml"))) == len(TESTS)
