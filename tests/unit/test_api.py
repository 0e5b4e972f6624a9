"""What ``import vmach`` offers, used as a program of a user's own would."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vmach
from tests.small_job import write_job_with_nominal as write_job

TRAVEL = {"X": (-500.0, 0.0), "Y": (-400.0, 0.0), "Z": (-300.0, 0.0)}


@pytest.mark.parametrize("name", sorted(set(vmach.__all__) - {"__version__"}))
def test_every_public_name_is_there_and_says_what_it_is(name):
    assert getattr(vmach, name).__doc__
    assert getattr(importlib.import_module(vmach._HOMES[name]), name) is getattr(vmach, name)


def test_all_names_have_a_home():
    assert set(vmach.__all__) - {"__version__"} == set(vmach._HOMES)
    assert dir(vmach) == sorted(vmach.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = vmach.nothing


def test_importing_vmach_loads_nothing():
    code = "import sys, vmach; print([m for m in ('numpy', 'scipy', 'numba') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_a_machine_from_arrays_leans_and_stretches_as_it_is_told():
    """Closed form: EXX = 20 um/m and EC0Y = 30 urad over a plane of 500 mm x 400 mm."""
    x = np.linspace(-500.0, 0.0, 11)
    machine = vmach.machine_from_arrays(
        "mill",
        travel_mm=TRAVEL,
        errors={"EXX": (x, 0.02 * x)},
        squareness_urad={"EC0Y": 30.0},
    )
    found = vmach.accuracy(machine, grid=(11, 3, 3))
    assert found.largest_difference_mm == pytest.approx(1e-3 * (0.02 * 500 + 0.03 * 400), rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"errors": {"EQX": ([0, 1], [0, 1])}}, "component error 'EQX'"),
        ({"errors": {"EXX": ([0, 0], [0, 1])}}, "position 0 mm after 0 mm"),
        ({"errors": {"EXX": ([0, 1], [0, np.nan])}}, "not finite"),
        ({"errors": {"EXX": ([0, 1], [0, 1, 2])}}, r"shapes \(2,\), \(3,\)"),
        ({"squareness_urad": {"EC0C": 1.0}}, "squareness 'EC0C'"),
        ({"travel_mm": TRAVEL | {"Y": (0.0, -1.0)}}, r"travel of Y is \(0.0, -1.0\)"),
        ({"measured_at_mm": {"EYX": (0, 0, 0)}}, "measured_at_mm of EYX"),
    ],
)
def test_arrays_that_make_no_machine_are_refused_with_the_value(change, message):
    with pytest.raises(vmach.InputError, match=message):
        vmach.machine_from_arrays(**{"name": "mill", "travel_mm": TRAVEL} | change)


def test_points_are_predicted_and_their_shares_add_up(tmp_path):
    job = write_job(tmp_path)
    read = vmach.read_job(job)
    assert vmach.read_job(read) is read
    by_file = vmach.compare(read, models=["none", "abbe"])
    points = vmach.surface_points(by_file.point_mm, by_file.normal, feature=by_file.feature)
    found = vmach.predict(read, points)
    cut = found.is_cut
    assert cut.any()
    total = sum(found.share_um.values())
    np.testing.assert_allclose(total[cut], found.deviation_um[cut], atol=1e-9)
    np.testing.assert_allclose(found.deviation_um, by_file.deviation_um["abbe"], atol=1e-9)
    assert np.isnan(found.deviation_um[~cut]).all()
    assert list(found.columns())[:5] == ["id", "feature", "x_mm", "y_mm", "z_mm"]


def test_the_error_along_the_path_has_columns(tmp_path):
    found = vmach.path_errors(write_job(tmp_path))
    assert found.error_um.shape == (len(found), 3)
    assert list(found.columns()) == [
        "line", "tool", "time_s", "X_mm", "Y_mm", "Z_mm", "dx_um", "dy_um", "dz_um",
    ]  # fmt: skip


def test_the_errors_along_a_path_say_which_effects_they_lack(tmp_path):
    """Effects of tool and workpiece show on a surface; they left no trace here, and no word."""
    path = write_job(tmp_path)
    effects = "[effects.tool_radius.T1]\nradius_um = 5\n[effects.scale.X]\nscale_ppm = 20\n"
    path.write_text(path.read_text() + effects)
    (note,) = [n for n in vmach.path_errors(path).notes if n.kind == "left out"]
    assert "tool_radius T1" in note.sentence
    assert "scale" not in note.sentence


def test_an_unknown_model_is_refused_with_its_name(tmp_path):
    with pytest.raises(ValueError, match="model = 'hmt'; accepted: none, htm, abbe"):
        vmach.path_errors(write_job(tmp_path), model="hmt")


def test_normals_without_length_are_refused():
    with pytest.raises(ValueError, match="longer than zero"):
        vmach.surface_points([[0, 0, 0]], [0, 0, 0])


@pytest.mark.parametrize(
    ("points", "normals", "shapes"),
    [
        ([[1, 2]], [0, 0, 1], r"\(1, 2\) with normals of shape \(3,\)"),
        ([], [0, 0, 1], r"\(1, 0\)"),
        ([[1, 2, 3]], [[0, 0, 1]] * 2, r"\(2, 3\); accepted: \(P, 3\)"),
        ([[1, 2, 3]], 1.0, r"\(\); accepted"),
    ],
)
def test_points_of_a_wrong_shape_are_told_with_it(points, normals, shapes):
    with pytest.raises(ValueError, match=shapes):
        vmach.surface_points(points, normals)


def test_the_page_names_every_public_name():
    page = (Path(__file__).parents[2] / "docs" / "api.md").read_text()
    results = {"Variant"}  # the page speaks of the models by their names
    assert [name for name in sorted(set(vmach.__all__) - results) if name not in page] == [
        "SurfacePoints", "__version__",
    ]  # fmt: skip


def test_the_reference_has_every_public_name():
    page = (Path(__file__).parents[2] / "docs" / "reference.md").read_text()
    listed = set(re.findall(r"^\.\. auto(?:class|function):: vmach\.(\w+)$", page, re.MULTILINE))
    assert listed == set(vmach.__all__) - {"__version__"}
