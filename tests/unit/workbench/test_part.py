"""The part in the page against predictions that the library makes of job files."""

import gzip
import json
import re
import shutil
from urllib.parse import quote

import numpy as np
import pytest

from tests.measured_job import write_measured_job
from tests.unit.workbench.conftest import Page
from vmach.api.comparison import compare
from vmach.api.points import predict, surface_points
from vmach.effects import catalogue
from vmach.machine import Variant
from vmach.workbench.model.answers import Answers
from vmach.workbench.model.effect_cards import effect_cards
from vmach.workbench.model.part_model import load_part
from vmach.workbench.model.quantities import figures_of
from vmach.workbench.model.what_if import changed_mm, read_changes


@pytest.fixture(scope="module")
def part(measured_folder):
    return load_part(measured_folder / "job.toml")


def with_effect(folder, text):
    """A job beside the measured one, with effects in its file."""
    job = folder / "with-effect.toml"
    job.write_text((folder / "job.toml").read_text() + text)
    return job


CHANGES = {
    "backlash Y": ("backlash", "Y", {"reversal_um": 9.0}),
    "scale X": ("scale", "X", {"scale_ppm": 30.0}),
    "tool radius": ("tool_radius", "T1", {"radius_um": 4.0}),
    "spindle growth": ("spindle_growth", "Z", {"growth_um": 12.0, "time_constant_s": 40.0}),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_slider_does_what_the_job_file_would_do(part, measured_folder, change):
    name, target, parameters = change
    known = {p.name: p.usual for p in catalogue()[name].parameters}
    given = {p: parameters.get(p, usual) for p, usual in known.items()}
    lines = "\n".join(f"{p} = {value}" for p, value in given.items())
    job = with_effect(measured_folder, f"\n[effects.{name}.{target}]\n{lines}\n")
    points = surface_points(part.surface.point_mm, part.surface.normal)
    before, after = predict(measured_folder / "job.toml", points), predict(job, points)
    job.unlink()
    wanted = after.deviation_um - before.deviation_um
    asked = [{"effect": name, "target": target, "parameters": given}]
    found = 1e3 * changed_mm(part.surface, read_changes(asked, part.job, part.effects))
    # to first order: a point stays with the move that makes it
    is_same_move = after.is_cut & (after.line == before.line) & (after.line == lines_of(part))
    assert is_same_move.mean() > 0.8 and np.abs(wanted[is_same_move]).max() > 1.0
    off = np.abs(found - wanted)[is_same_move]
    assert np.quantile(off, 0.9) < 1e-3 * np.abs(wanted[is_same_move]).max() + 0.002


def test_cut_anew_is_what_the_job_file_would_do(part, measured_folder):
    job = with_effect(measured_folder, "\n[effects.scale.X]\nscale_ppm = 30.0\n")
    points = surface_points(part.surface.point_mm, part.surface.normal)
    wanted = predict(job, points)
    job.unlink()
    asked = [{"effect": "scale", "target": "X", "parameters": {"scale_ppm": 30.0}}]
    changes = read_changes(asked, part.job, part.effects)
    found = 1e3 * part.cut_anew([change.now for change in changes])
    assert found[wanted.is_cut] == pytest.approx(wanted.deviation_um[wanted.is_cut], abs=1e-6)


def test_a_difference_of_two_jobs_is_taken_at_the_points_of_both(part, measured_folder):
    first = measured_folder / "job.toml"
    second = with_effect(measured_folder, "\n[effects.scale.X]\nscale_ppm = 30.0\n")
    points = surface_points(part.surface.point_mm, part.surface.normal)
    mine, theirs = (predict(job, points).deviation_um for job in (first, second))
    other = Answers(str(second))
    second.unlink()
    named, values = other.point_values("deviation", "abbe")
    for step in (1, 2):  # all points, and every other one
        some = {"name": "other", "ids": named["ids"][::step]}
        less = some, np.frombuffer(values)[::step].tobytes()
        found, on_mesh = Answers(str(first)).difference(less, tolerance_um=2.0)
        wanted = (mine - theirs)[np.isin(part.surface.id, some["ids"])]
        assert found["count"] == len(wanted)
        assert found["rms_um"] == pytest.approx(np.sqrt(np.mean(wanted**2)), abs=1e-6)
        assert found["outside"] == pytest.approx(np.mean(np.abs(wanted) > 2.0))
        known = np.frombuffer(on_mesh, "<f4")
        known = known[np.isfinite(known)]
        assert len(known) and known.min() > wanted.min() - 1e-3
        assert known.max() < wanted.max() + 1e-3


def test_figures_are_those_of_each_feature_alone(part):
    value = part.surface.predicted_mm
    found = figures_of(part.surface, value, tolerance_mm=1e-3)
    assert {f["name"] for f in found["features"]} == set(part.surface.feature.tolist())
    for one in [found, *found["features"]]:
        mine = value if "name" not in one else value[part.surface.feature == one["name"]]
        um = 1e3 * mine
        assert one["count"] == len(um)
        assert one["rms_um"] == pytest.approx(np.sqrt(np.mean(um**2)), rel=1e-12)
        assert (one["low_um"], one["high_um"]) == pytest.approx((um.min(), um.max()))
        assert one["outside"] == pytest.approx(np.mean(np.abs(um) > 1.0))
    assert abs(found["worst"][0]["um"]) == pytest.approx(np.abs(1e3 * value).max())


def test_everything_that_can_be_shown_is_shown(page):
    for one in page.get("/api/about").json()["quantities"]:
        figures, values = page.framed(page.get(f"/api/values?quantity={one['name']}"))
        assert figures["points"] == one["points"] and np.isfinite(values).any()


def lines_of(part):
    return part.surface.states.line


def test_models_are_those_of_compare(part, measured_folder):
    found = compare(measured_folder / "job.toml")
    for model in ("none", "htm", "abbe"):
        mine = 1e3 * part.measured.under(Variant(model))
        assert mine == pytest.approx(found.deviation_um[model], abs=0.05)


def test_the_residual_is_that_of_compare(page, measured_folder):
    figures, _ = page.framed(page.get("/api/values?quantity=residual"))
    wanted = compare(measured_folder / "job.toml").remainder_rms_um["abbe"]
    assert figures["rms_um"] == pytest.approx(wanted, abs=0.02)
    assert page.get("/api/measured").json()["rms_um"] == pytest.approx(wanted, abs=0.02)


def test_values_lie_on_the_mesh_that_is_sent(page):
    packed = gzip.decompress(page.get("/api/mesh").content)
    header = json.loads(packed[4 : 4 + int.from_bytes(packed[:4], "little")])
    vertices = {name: count for name, _, count in header["columns"]}["vertex_x"]
    figures, values = page.framed(page.get("/api/values"))
    known = values[np.isfinite(values)]
    assert len(values) == vertices and len(known) > 0.1 * vertices
    assert known.min() >= figures["low_um"] - 1e-3 and known.max() <= figures["high_um"] + 1e-3


def test_shares_of_a_point_add_up_to_its_deviation(page):
    place = "points=surface&x=0&y=0&z=-8&i=0&j=0&k=1"
    found = page.get("/api/point?" + place).json()
    total = sum(share["um"] for share in found["shares"])
    assert total == pytest.approx(found["predicted_um"]["abbe"], abs=1e-6)
    assert found["line"] > 0 and np.allclose(found["at_mm"], [0, 0, -8], atol=3)


def test_what_a_line_makes_is_what_its_points_say(page):
    place = "points=surface&x=20&y=0&z=-4&i=-1&j=0&k=0"
    line = page.get("/api/point?" + place).json()["line"]
    figures, places = page.framed(page.get(f"/api/line?line={line}"))
    assert figures["count"] == len(places) // 3 > 0
    assert np.abs(places.reshape(-1, 3)[:, 0]).max() == pytest.approx(20, abs=0.1)


def test_playback_passes_the_programmed_places(page):
    facts, rows = page.framed(page.get("/api/playback"))
    rows = rows.reshape(-1, len(facts["columns"]))
    assert (np.diff(rows[:, 0]) >= 0).all() and rows[-1, 0] <= facts["duration_s"] + 1e-3
    tip = rows[:, 1:4]
    for corner in ([-15, -10, -8], [15, 10, -8], [41, 0, -6]):
        assert np.linalg.norm(tip - corner, axis=1).min() < 1e-3


def test_the_sliders_are_the_same_in_all_tabs_and_leave_the_job_alone(page, measured_folder):
    before = (measured_folder / "job.toml").read_bytes()
    changes = [{"effect": "backlash", "target": "Y", "parameters": {"reversal_um": 6.0}}]
    asked = {"changes": changes, "shown": {"quantity": "residual"}, "tab": "a"}
    figures, _ = page.framed(page.post("/api/what-if", asked))
    assert figures["rms_um"] < 0.7 * page.get("/api/measured").json()["rms_um"]
    assert page.get("/api/state").json()["changes"] == changes
    page.framed(page.post("/api/what-if", {"changes": [], "shown": {}}))
    assert (measured_folder / "job.toml").read_bytes() == before


def test_cards_start_where_the_job_is(tmp_path):
    job = write_measured_job(tmp_path)
    job.write_text(job.read_text() + "\n[effects.backlash.Y]\nreversal_um = 5.5\n")
    card = effect_cards(load_part(job))[0]
    assert (card["effect"], card["target"], card["in_job"]) == ("backlash", "Y", True)
    slider = card["parameters"][0]
    assert slider["value"] == 5.5 and slider["low"] <= 5.5 <= slider["high"]


VIEW = {"azimuth_rad": 0.3, "elevation_rad": 0.5, "zoom": 2, "target_mm": [1, 2, 3],
        "section": [0, 0, 0, 0], "range_um": 5}  # fmt: skip
ON_SCREEN = {"shown": {"quantity": "difference"}, "tolerance_um": 3, "view": VIEW}


def test_the_report_is_of_what_is_on_the_screen(page):
    made = page.post("/api/report", ON_SCREEN)
    assert made.status_code == 200, made.text
    shown = page.get("/show/" + made.json()["page"])
    assert "sandbox" in shown.headers["content-security-policy"]
    data = json.loads(re.search(r'id="page-data"[^>]*>(.*?)</script>', shown.text, re.DOTALL)[1])
    figures, _ = page.framed(page.get("/api/values?quantity=difference&tolerance_um=3"))
    assert data["view"] == VIEW and data["primary"] == "shown"
    column = data["variants"]["shown"]
    assert (column["label"], column["range_um"]) == ("Abbe − HTM", 5)
    assert column["largest_um"] == pytest.approx(figures["largest_um"])
    outside = column["outside"][data["tolerance_index"]] / column["weight"]
    assert outside == pytest.approx(figures["outside"])


@pytest.mark.parametrize("wrong", [
    {"tolerance_um": 0}, {"tolerance_um": None}, {"view": None}, {"picture": "x"},
    {"view": VIEW | {"zoom": "2"}}, {"view": VIEW | {"target_mm": [1, 2]}},
    {"view": VIEW | {"range_um": 1e400}}, {"picture": "data:image/jpeg;base64,!"},
    {"shown": {"quantity": "nothing"}}, {"picture": "data:image/jpeg;base64,/9j/4AAQ"},
], ids=range(10))  # fmt: skip
def test_what_is_no_screen_makes_no_report(page, wrong):
    content = json.dumps(ON_SCREEN | wrong).encode()
    answer = page.client.post("/api/report", content=content, headers=page.headers)
    assert answer.status_code == 400 and answer.json()["error"]


def test_a_result_is_handed_out_under_the_name_of_its_job(page, measured_folder):
    made = measured_folder / "vmach-results" / "Pr\u00fcfling #1" / "compensated.nc"
    made.parent.mkdir(parents=True)
    made.write_text("M30\n")
    answer = page.get(f"/download/vmach-results/{quote(made.parent.name)}/{made.name}")
    said = answer.headers["content-disposition"]
    assert answer.text == "M30\n" and quote(f"{made.parent.name}-compensated.nc") in said
    assert 'filename="part.nc"' in page.get("/download/part.nc").headers["content-disposition"]


def test_the_texts_of_two_programs_are_compared_as_people_wrote_them(measured_folder, tmp_path):
    """Byte 85 of a capital A with a ring in UTF-8 ends a line of Latin-1 to Python."""
    folder = tmp_path / "part"
    shutil.copytree(measured_folder, folder)
    lines = (folder / "part.nc").read_bytes().splitlines()
    lines.insert(1, "(SK\u00c5R F\u00d6R)".encode())
    (folder / "part.nc").write_bytes(b"\n".join(lines))
    (folder / "moved.nc").write_bytes(b"\n".join([*lines[:-1], b"M30", b"(one more)"]))
    page = Page(folder / "job.toml")
    with page.client:
        shown = page.get("/api/program?first=1&count=3").json()["lines"]
        found = page.get("/api/difference?file=moved.nc").json()
    assert shown[1] == "(SK\u00c5R F\u00d6R)"
    assert (found["before"], found["after"]) == (len(lines), len(lines) + 1)
    assert found["added"] - found["removed"] == 1
    assert not any("SK" in text and mark != " " for h in found["hunks"] for mark, text in h["rows"])


@pytest.mark.parametrize("has_blank", [True, False])
def test_a_job_with_neither_cad_nor_points_has_its_blank_or_a_floor(tmp_path, has_blank):
    write_measured_job(tmp_path)
    text = re.sub(r"(?m)^(nominal|measured).*$", "", (tmp_path / "job.toml").read_text())
    if not has_blank:
        text = re.sub(r"(?s)\[stock\].*?(?=\n\[)", "", text)
    (tmp_path / "bare.toml").write_text(text)
    found = Answers(str(tmp_path / "bare.toml"))
    about, _ = found.about()
    assert "neither nominal CAD nor measured points" in about["missing"]
    _, values = found.values()
    assert np.isnan(np.frombuffer(values, "<f4")).all()
    part = load_part(tmp_path / "bare.toml")
    low, high = part.mesh.vertices_mm.min(axis=0), part.mesh.vertices_mm.max(axis=0)
    if has_blank:
        assert (low.tolist(), high.tolist()) == ([-30, -25, -20], [60, 25, 0])
        assert solid_volume_mm3(part.mesh) == pytest.approx(90 * 50 * 20)
    facts, rows = found.playback()
    place = np.frombuffer(rows, "<f4").reshape(facts["count"], -1)[:, 1:4]
    assert (place[:, :2] > low[:2] - 20).all() and place[:, 2].max() > low[2]


def solid_volume_mm3(mesh):
    """By the divergence theorem; positive where its triangles look outward."""
    return np.linalg.det(mesh.vertices_mm[mesh.triangles]).sum() / 6.0
