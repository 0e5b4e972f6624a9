"""The commands on a small job: what they write and print."""

import csv
import json

import numpy as np
import pytest
import trimesh

from tests.golden.test_bad_input import replace, run_vmach
from tests.small_job import pocket_points, write_job_with_nominal
from vmach.files.written_files import files_in

ERRORS = {"EXX": (lambda x: 6.0 * x / 400.0, (0, 0, -100)), "ECX": (lambda x: 20.0, None)}


@pytest.fixture
def job(tmp_path):
    folder = tmp_path / "job"
    folder.mkdir()
    return write_job_with_nominal(folder, ERRORS)


def test_run_writes_all_files(job, tmp_path, monkeypatch, capsys):
    out = tmp_path / "out"
    status, text, _ = run_vmach(monkeypatch, capsys, "run", job, "--out", out)
    assert status == 0
    assert "Abbe-consistent" in text
    expected = [
        "budget.csv",
        "deviations.csv",
        "heatmap.png",
        "part.stl",
        "report.html",
        "summary.json",
    ]
    assert sorted(p.name for p in files_in(out)) == expected
    summary = json.loads((out / "summary.json").read_text())
    assert summary["model"] == "abbe"
    assert list(summary["variants"]) == ["none", "abbe"]
    rows = list(csv.DictReader((out / "deviations.csv").read_text().splitlines()))
    assert summary["points"] == len(rows)
    # where the round tool can get to, a perfect machine makes the nominal part
    inner = [r for r in rows if abs(float(r["x"])) < 14.9 or abs(float(r["y"])) < 9.9]
    program_only = [float(r["none_deviation_um"]) for r in inner if r["none_status"] == "cut"]
    assert len(program_only) > 300
    assert max(map(abs, program_only)) < 1e-6
    roles = {file["path"] for file in summary["run"]["files"]}
    assert {"job.toml", "part.nc", "machine.toml", "part.stl", "errors/EXX.csv"} <= roles


def test_results_are_the_same_every_time(job, tmp_path, monkeypatch, capsys):
    for name in ("one", "two"):
        run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / name)
    for name in ("deviations.csv", "part.stl"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_a_run_without_the_solid_has_the_same_deviations(job, tmp_path, monkeypatch, capsys):
    import vmach.run.pipeline as pipeline

    with_solid = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "with")
    without = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "no", "--no-solid")
    monkeypatch.setattr(pipeline, "SOLID_MOVES", 5)
    monkeypatch.setattr(pipeline, "CutAside", None)  # it would be an error to call it
    large = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "large")
    assert (with_solid[0], without[0], large[0]) == (0, 0, 0)
    assert "no solid was cut" in large[1]
    assert "no solid was cut" not in without[1]
    for name in ("no", "large"):
        assert not (tmp_path / name / "part.stl").exists()
        for file in ("deviations.csv", "budget.csv"):
            assert (tmp_path / name / file).read_bytes() == (tmp_path / "with" / file).read_bytes()
    status, _, error = run_vmach(
        monkeypatch, capsys, "run", job, "--no-solid", "--part", tmp_path / "part.glb"
    )
    assert status != 0
    assert "--part " in error and " without the solid" in error


def test_compare_sets_variants_and_measurement_side_by_side(job, tmp_path, monkeypatch, capsys):
    status, text, _ = run_vmach(
        monkeypatch, capsys, "compare", job, "--out", tmp_path / "out", "--json"
    )
    assert status == 0
    summary = json.loads(text)
    assert (tmp_path / "out" / "remainder.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "out" / "report.html").read_text().count("data:image/jpeg") == 2
    assert list(summary["variants"]) == ["none", "htm", "abbe", "measured"]
    assert summary["points"] == len(pocket_points()[0])
    # the part was "measured" exactly nominal
    assert summary["variants"]["none"]["remainder_rms_um"] < 1e-6
    assert summary["variants"]["abbe"]["remainder_rms_um"] > 0.1


def test_compare_needs_neither_solid_nor_blank(job, tmp_path, monkeypatch, capsys):
    with_solid = run_vmach(monkeypatch, capsys, "compare", job, "--out", tmp_path / "w", "--solid")
    replace(job, "[stock]\nmin_mm = [-30, -25, -20]\nmax_mm = [60, 25, 0]\n", "")
    without = run_vmach(monkeypatch, capsys, "compare", job, "--out", tmp_path / "o")
    assert (with_solid[0], without[0]) == (0, 0)
    assert [(tmp_path / n / "part.stl").exists() for n in "wo"] == [True, False]
    assert "part.stl" not in without[1]
    one, other = ((tmp_path / n / "deviations.csv").read_bytes() for n in "wo")
    assert one == other


def test_predict_writes_a_row_for_every_point(job, tmp_path, monkeypatch, capsys):
    out = tmp_path / "out.csv"
    points = job.parent / "points.csv"
    status, _, _ = run_vmach(monkeypatch, capsys, "predict", job, "--points", points, "-o", out)
    assert status == 0
    rows = list(csv.DictReader(out.read_text().splitlines()))
    assert list(rows[0]) == ["id", "deviation_um", "u_um", "line", "tool", "time_s", "status"]
    assert [row["id"] for row in rows] == [str(k + 1) for k in range(len(rows))]
    assert {row["status"] for row in rows} == {"cut"}


def test_uncut_and_gouged_away_are_states_without_a_number(job, tmp_path, monkeypatch, capsys):
    points = tmp_path / "points.csv"
    points.write_text(
        "id,feature,x,y,z,i,j,k\n"
        "cut,floor,0,0,-8,0,0,1\n"
        "stock,side,60,0,-10,1,0,0\n"
        "buried,core,0,0,-15,0,0,1\n"
        "air,ghost,0,0,-4,0,0,1\n"
    )
    out = tmp_path / "out.csv"
    run_vmach(monkeypatch, capsys, "predict", job, "--points", points, "-o", out)
    rows = {row["id"]: row for row in csv.DictReader(out.read_text().splitlines())}
    status = {name: row["status"] for name, row in rows.items()}
    assert status == {"cut": "cut", "stock": "uncut", "buried": "uncut", "air": "gouged away"}
    assert all((row["deviation_um"] == "") == (row["status"] != "cut") for row in rows.values())


def test_no_model_means_the_program_alone(job, tmp_path, monkeypatch, capsys):
    status, text, _ = run_vmach(
        monkeypatch, capsys, "run", job, "--model", "none", "--out", tmp_path / "o", "--json"
    )
    assert status == 0
    assert list(json.loads(text)["variants"]) == ["none"]


def test_budget_adds_up_to_the_deviation(job, tmp_path, monkeypatch, capsys):
    out = tmp_path / "out"
    run_vmach(monkeypatch, capsys, "compare", job, "--out", out)
    budget = {r["id"]: r for r in csv.DictReader((out / "budget.csv").read_text().splitlines())}
    rows = csv.DictReader((out / "deviations.csv").read_text().splitlines())
    for row in rows:
        made = budget[row["id"]]
        assert made["line"] == row["line"]
        shares = {k: float(v) for k, v in made.items() if k.endswith("_um")}
        assert set(shares) == {"program_um", "EXX_um", "ECX_um"}
        assert sum(shares.values()) == pytest.approx(float(row["abbe_deviation_um"]), abs=2e-4)
        assert abs(shares["program_um"]) < 0.02


def test_collisions_are_named_by_line(job, tmp_path, monkeypatch, capsys):
    replace(job.parent / "part.nc", "G0 Z5\nG0 X40 Y0", "G0 X25 Y9\nG0 Z5\nG0 X40 Y0")
    _, text, _ = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "o", "--json")
    (note,) = [n for n in json.loads(text)["run"]["warnings"] if "collision" in n]
    assert note.startswith("part.nc:18: collision: rapid in material, T1, 8 mm deep")


def test_collisions_are_known_before_anything_is_machined(job, monkeypatch, capsys):
    status, text, _ = run_vmach(monkeypatch, capsys, "check", job, "--collisions", "--json")
    assert status == 0 and json.loads(text)["collisions"] == []
    replace(job.parent / "part.nc", "G0 Z5\nG0 X40 Y0", "G0 X25 Y9\nG0 Z5\nG0 X40 Y0")
    _, text, _ = run_vmach(monkeypatch, capsys, "check", job, "--collisions", "--json")
    (hit,) = json.loads(text)["collisions"]
    assert (hit["kind"], hit["line"], hit["tool"]) == ("rapid in material", 18, 1)
    assert hit["depth_mm"] == pytest.approx(8.0, abs=0.05) and hit["time_s"] > 0
    assert 19 < hit["place_mm"][0] < 31 and hit["place_mm"][2] == pytest.approx(-8, abs=0.05)
    _, text, _ = run_vmach(monkeypatch, capsys, "check", job, "--json")
    assert json.loads(text)["collisions"] is None


def test_blank_from_a_solid(job, tmp_path, monkeypatch, capsys):
    block = trimesh.creation.box(bounds=[(-30, -25, -20), (60, 25, 0)])
    block.export(job.parent / "blank.stl")
    box = "min_mm = [-30, -25, -20]\nmax_mm = [60, 25, 0]"
    run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "box", "--json")
    replace(job, box, 'file = "blank.stl"')
    run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "solid", "--json")
    one, other = ((tmp_path / n / "deviations.csv").read_bytes() for n in ("box", "solid"))
    assert one == other
    volumes = [trimesh.load(tmp_path / n / "part.stl").volume for n in ("box", "solid")]
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-6)


def test_coloured_part(job, tmp_path, monkeypatch, capsys):
    path = tmp_path / "part.glb"
    run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "o", "--part", path)
    (mesh,) = trimesh.load(path).geometry.values()
    assert mesh.is_watertight
    assert len(np.unique(mesh.visual.vertex_colors, axis=0)) > 20
    status, _, message = run_vmach(
        monkeypatch, capsys, "run", job, "--out", tmp_path / "p", "--part", tmp_path / "part.xyz"
    )
    assert (status, (tmp_path / "p").exists()) == (1, False)
    assert "part.xyz" in message and ".glb" in message


def test_path_gives_the_error_of_the_tip_along_the_program(job, tmp_path, monkeypatch, capsys):
    out = tmp_path / "path.csv"
    status, text, _ = run_vmach(monkeypatch, capsys, "path", job, "-o", out, "--json")
    assert status == 0
    rows = list(csv.DictReader(out.read_text().splitlines()))
    for row in rows:
        x, y = float(row["X_mm"]), float(row["Y_mm"])
        # EXX = 6 um over 400 mm; ECX = 20 urad on the arm from the reflector at the origin
        expected_dx = 6.0 * x / 400.0 - 20e-3 * y
        assert float(row["dx_um"]) == pytest.approx(expected_dx, abs=1e-3)
    largest = max(abs(float(row["dx_um"])) for row in rows)
    assert json.loads(text)["largest_abs_xyz_um"][0] == pytest.approx(largest, abs=1e-3)


def test_what_the_machine_file_leaves_open_is_said(job, tmp_path, monkeypatch, capsys):
    _, text, _ = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "o", "--json")
    (note,) = [n for n in json.loads(text)["run"]["warnings"] if "taken as zero" in n]
    assert note.startswith("machine.toml: EYX EZX EAX EBX EXY")


def test_points_on_the_terminal_have_their_heading_and_notes_beside_them(job, monkeypatch, capsys):
    replace(job, "length_mm = 100", "length_mm = 99")
    replace(job.parent / "part.nc", "G43 H1", "G43.1 Z100")
    points = job.parent / "points.csv"
    status, text, beside = run_vmach(monkeypatch, capsys, "predict", job, "--points", points)
    assert status == 0
    rows = text.splitlines()
    assert rows[0] == "id,deviation_um,u_um,line,tool,time_s,status"
    assert len(rows) == 1 + len(pocket_points()[0])
    assert "note: part.nc:7: tool 1 is 99 mm long but cuts with a length offset" in beside


def test_compensate_tells_what_the_program_leaves_open(job, tmp_path, monkeypatch, capsys):
    replace(job, "length_mm = 100", "length_mm = 99")
    replace(job.parent / "part.nc", "G43 H1", "G43.1 Z100")
    replace(job.parent / "part.nc", "G1 X-15 Y-10 F900", "#1 = -15\nG1 X#1 Y-10 F900")
    out = tmp_path / "out.nc"
    status, text, _ = run_vmach(monkeypatch, capsys, "compensate", job, "-o", out)
    assert status == 0
    assert "written out" in text
    assert "note: part.nc:7: tool 1 is 99 mm long but cuts with a length offset" in text
    status, text, _ = run_vmach(monkeypatch, capsys, "compensate", job, "-o", out, "--json")
    assert status == 0
    assert any(
        note.startswith("part.nc:7: tool 1 is 99 mm long but cuts with a length offset")
        for note in json.loads(text)["notes"]
    )
