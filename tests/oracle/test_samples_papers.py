"""Samples of two papers: the Huddersfield worksheet, and the slots that a CMM looked at."""

from __future__ import annotations

import importlib.util
import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vmach.commands.machining import compare
from vmach.machine import Variant, displacement, read_machine
from vmach.prediction.tip_errors import tip_errors
from vmach.run.pipeline import predict_points

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
SLOT, WORKSHEET = SAMPLES / "spline_slot", SAMPLES / "huddersfield"

#: figure 2: table or squareness, axis that it acts on, printed value in um
TERMS = [
    ("EXX", 0, 331.98), ("EXY", 0, -32.193), ("EXZ", 0, 1.303), ("EBX", 0, 9.975), ("EBY", 0, 0.0),
    ("ECX", 0, 61.5), ("EB0Z", 0, 63.35), ("EC0Y", 0, -231.0),
    ("EYY", 1, 9.2), ("EYX", 1, -38.554), ("EYZ", 1, -18.188), ("EAX", 1, -2.45),
    ("EAY", 1, 1.51655), ("EA0Z", 1, 8.05),
    ("EZZ", 2, 9.2), ("EZX", 2, -39.759), ("EZY", 2, 21.126), ("EAX", 2, 21.0),
]  # fmt: skip
SUMS = [204.915, -40.42545, 11.567]


def test_terms_of_the_paper_add_up_to_its_sums():
    for axis, total in enumerate(SUMS):
        assert sum(v for _, k, v in TERMS if k == axis) == pytest.approx(total, abs=1e-9)


def test_the_worksheet_comes_out_at_the_end_of_the_path():
    """The paper rounds the sum in Y to 40.4255."""
    found = tip_errors(WORKSHEET, Variant.ABBE)
    assert found.states.nose_mm[-1] == pytest.approx([6000.0, 3000.0, 350.0])
    assert 1e3 * found.error_mm[-1] == pytest.approx(SUMS, abs=1e-6)
    assert found.summary()["largest_abs_xyz_um"] == pytest.approx(np.abs(SUMS), abs=1e-6)


@pytest.mark.parametrize(("name", "axis", "printed_um"), TERMS)
def test_every_term_of_the_worksheet(name, axis, printed_um):
    machine = read_machine(WORKSHEET / "machine.toml")
    squareness = np.zeros((3, 3))
    if "0" in name:
        one, other = {"EB0Z": (2, 1), "EC0Y": (1, 2), "EA0Z": (2, 0)}[name]
        squareness[one, other] = machine.squareness_rad[one, other]
    components = {  # the others stay as measured at their reflectors, and read nothing
        key: c if key == name else replace(c, forward=0.0 * c.forward, backward=0.0 * c.backward)
        for key, c in machine.components.items()
    }
    machine = replace(machine, components=components, squareness_rad=squareness)
    moved = displacement(
        machine, np.array([[6000.0, 3000.0, 350.0]]), np.array([0.0, 0.0, -100.0]), Variant.ABBE
    )
    assert 1e3 * moved.shift_mm[0, axis] == pytest.approx(printed_um, abs=1e-6)


@pytest.fixture(scope="module")
def truth():
    """The script that cuts the slots with exact matrices and knows nothing of vmach."""
    text = (SLOT / "make_measurements.py").read_text()
    assert "import vmach" not in text and "from vmach" not in text
    spec = importlib.util.spec_from_file_location("slot_truth", SLOT / "make_measurements.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("place", ["centre", "corner"])
def test_exact_matrices_cut_the_slot_as_reflectors_say(truth, place):
    """With the tables alone the walls are where Abbe-consistent arms put them, and HTM does not."""
    job = tomllib.loads((SLOT / f"{place}.toml").read_text())
    _, points, normals = truth.wall_points()
    walls = truth.cut_walls(job, points, normals, bare=True)
    found = {
        v: predict_points(SLOT / f"{place}.toml", SLOT / "wall_points.csv", variant=v)[1]
        for v in (Variant.ABBE, Variant.HTM)
    }
    apart = {v: np.abs(p.deviation_mm[::3] - walls).max() for v, p in found.items()}
    assert apart[Variant.ABBE] < 5e-5
    assert apart[Variant.HTM] > 4e-3


def test_the_measured_files_are_what_the_script_writes(truth):
    for seed, place in enumerate(("centre", "corner"), 5):
        job = tomllib.loads((SLOT / f"{place}.toml").read_text())
        names, points, normals = truth.wall_points()
        rows = truth.measured_rows(names, points, normals, truth.cut_walls(job, points, normals),
                                   np.random.default_rng(seed))  # fmt: skip
        written = np.loadtxt((SLOT / f"measured_{place}.csv").read_text().splitlines()[1:],
                             delimiter=",", usecols=(8, 9, 10))  # fmt: skip
        again = np.loadtxt(rows.splitlines()[1:], delimiter=",", usecols=(8, 9, 10))
        assert written == pytest.approx(again, abs=1e-6)


@pytest.mark.parametrize(("place", "nearer"), [("centre", "cannot be told"), ("corner", "abbe")])
def test_one_command_says_which_is_nearer(tmp_path, capsys, place, nearer):
    """Far from the reflectors the arms matter; in the middle other errors hide them."""
    compare(SLOT / f"{place}.toml", out=tmp_path / "out", as_json=True)
    told = json.loads(capsys.readouterr().out)["htm_against_abbe"]
    assert told["nearer"] == nearer
    low, high = told["gain_interval_um"]
    assert low < told["gain_um"] < high
    assert (low > 0.0) == (nearer == "abbe")
