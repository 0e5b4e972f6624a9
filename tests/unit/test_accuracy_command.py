"""``vmach accuracy``: what it prints and writes, and its complaints."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from tests.report_page import Page, assert_asks_for_nothing
from vmach.commands.accuracy import accuracy
from vmach.errors import InputError
from vmach.files.written_files import files_in
from vmach.machine import Variant, read_machine
from vmach.volumetric import error_field, measured_volume
from vmach.volumetric.cones import SIDES, cone_mesh, cone_step_mm, cone_volume
from vmach.volumetric.profile import Profile, read_profile

MACHINE = Path(__file__).parents[2] / "samples/mazak_ajv25/machine.toml"


def test_json_holds_all_figures(capsys):
    accuracy(MACHINE, tool_length=200.0, grid="7,5,4", as_json=True)
    report = json.loads(capsys.readouterr().out)
    assert report["volume"]["grid"] == [7, 5, 4]
    assert report["volumetric"]["pairs"] == 140 * 139 // 2
    assert sum(report["contributions_percent"].values()) == pytest.approx(100.0, abs=0.2)
    assert [row["kind"] for row in report["diagonals"]] == ["body"] * 4 + ["face"] * 6
    assert len(report["grouping"]) == 3
    assert report["variants"]["mean_htm_um"] > 0
    assert any("taken as zero" in finding for finding in report["findings"])


def test_a_reduced_volume_is_more_accurate_and_conventional_arms_say_otherwise(capsys):
    figures = []
    for volume, model in (
        (None, Variant.ABBE), ("-600,-400,-300,-200,-300,-200", Variant.ABBE), (None, Variant.HTM),
    ):  # fmt: skip
        accuracy(MACHINE, grid="5", volume=volume, model=model, as_json=True)
        report = json.loads(capsys.readouterr().out)
        figures.append(report["volumetric"]["largest_difference_um"])
    assert figures[1] < 0.5 * figures[0]
    assert figures[2] != figures[0]


def test_pictures_and_profile(tmp_path, capsys):
    profile = tmp_path / "profile.csv"
    profile.write_text("x,y,z\n-700,-50,-200\n-300,-50,-200\n\n-300,-400,-200\n")
    accuracy(MACHINE, grid="5", profile=profile, out=tmp_path / "out")
    names = {path.name for path in files_in(tmp_path / "out")}
    assert names == {
        "accuracy.html", "accuracy.json",
        "cones.png", "histogram.png", "htm_abbe.png", "profile.png",
    }  # fmt: skip
    report = json.loads((tmp_path / "out/accuracy.json").read_text())
    assert report["profile"]["points"] == 1 + 80 + 70
    assert report["profile"]["length_mm"] == 750
    text = capsys.readouterr().out
    assert "volumetric accuracy" in text
    ranges = [f"{v:.1f}" for v in report["volumetric"]["range_xyz_um"]]
    assert "range of the error: X {}  Y {}  Z {} um".format(*ranges) in text
    words = " ".join(text.split())
    assert "may cancel" in words and "difference of unit vectors, no unit" in words
    assert "below 0.05" in words and "range of reading" in words
    assert "% smaller" in text


def test_the_page_says_what_the_json_says_and_asks_for_nothing(tmp_path):
    accuracy(MACHINE, tool_length=200.0, grid="5", out=tmp_path / "out")
    report = json.loads((tmp_path / "out/accuracy.json").read_text())
    page = Page((tmp_path / "out/accuracy.html").read_text())
    assert_asks_for_nothing(page)
    for name in ("largest_difference_um", "mean_error_um", "p95_error_um"):
        assert f"{report['volumetric'][name]:.1f} " in page.text
    assert all(name in page.text for name in list(report["contributions_percent"])[:5])
    assert all(row["diagonal"] in page.text for row in report["diagonals"])
    assert "Range of angle × arm in it" in page.text and "may cancel" in page.text


def test_cones_stand_on_the_grid_and_point_along_the_errors():
    machine = read_machine(MACHINE)
    volume = cone_volume(measured_volume(machine, (3, 3, 3)))
    field = error_field(machine, volume, np.array([0.0, 0.0, -200.0]), Variant.ABBE)
    vertices, triangles = cone_mesh(field)
    cones = vertices.reshape(-1, SIDES + 2, 3)
    assert cones[:, 1] == pytest.approx(field.nose_mm(np.arange(len(cones))))
    way = cones[:, 0] - cones[:, 1]
    length = np.linalg.norm(way, axis=1)
    assert length.max() == pytest.approx(0.9 * cone_step_mm(volume))
    assert length == pytest.approx(length.max() * field.magnitude_mm / field.magnitude_mm.max())
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent
    # a pyramid on a regular polygon: a third of base times height, and outside is outside
    base = SIDES / 2 * np.sin(2 * np.pi / SIDES) * (0.25 * length) ** 2
    assert mesh.volume == pytest.approx((base * length / 3).sum(), rel=1e-6)


def test_profile_is_divided_and_remembers_directions():
    profile = Profile(np.array([[0.0, 0, 0], [10.0, 0, 0], [10.0, -3.0, 0]])).divided(4.0)
    assert profile.nose_mm[:, 0].tolist() == pytest.approx([0, 10 / 3, 20 / 3, 10, 10])
    assert profile.nose_mm[-1].tolist() == [10, -3, 0]


@pytest.mark.parametrize(
    ("options", "part"),
    [
        ({"grid": "0"}, "--grid 0"),
        ({"grid": "3,4"}, "three: 21,11,11"),
        ({"volume": "1,2,3"}, "six numbers"),
        ({"volume": "-2000,0,-500,0,-460,0"}, "-990 .. 0, -500 .. 0"),
        ({"volume": "0,-990,-500,0,-460,0"}, "low < high"),
    ],
)
def test_complaints(options, part):
    with pytest.raises(InputError, match=part):
        accuracy(MACHINE, **options)


@pytest.mark.parametrize(
    ("text", "part"),
    [("a,b,c\n1,2,3\n", "accepted: x, y, z"), ("x,y,z\n1,2\n", ":2: row '1,2'"),
     ("x,y,z\n1,2,inf\n", "finite"), ("x,y,z\n", "no points")],
)  # fmt: skip
def test_complaints_about_profiles(tmp_path, text, part):
    path = tmp_path / "profile.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=part):
        read_profile(path)
