"""``vmach diagnose JOB --out DIR``: the files, the page that needs no network, what is refused."""

import json
import re

import numpy as np
import pytest

from tests.golden.test_bad_input import replace, run_vmach
from tests.measured_job import write_measured_job, write_odd_job
from tests.report_case import HOSTILE
from tests.report_page import Page, assert_asks_for_nothing
from tests.small_job import pocket_points, write_job_with_nominal, write_points
from tests.unit.test_diagnosis_verdicts import nothing, stretched_and_loose, tip_job
from tests.unit.test_report_html import unpack
from vmach.files.atomic import atomic_folder
from vmach.files.written_files import files_in

ERRORS = {"EXX": (lambda x: 3.0 * np.sin(x / 40.0), (0, 0, -100))}


@pytest.fixture
def job(tmp_path):
    """A pocket that no effect explains: its short walls stand 4 um too far in."""
    folder = tmp_path / "job"
    folder.mkdir()
    path = write_job_with_nominal(folder, ERRORS)
    names, points, normals = pocket_points()
    short = np.isin(names, ["wall +X", "wall -X"])
    away_um = 0.5 * np.random.default_rng(3).standard_normal(len(points)) + 4.0 * short
    write_points(folder / "points.csv", points + 1e-3 * away_um[:, None] * normals)
    return path


def diagnosed(job, out, monkeypatch, capsys, *options):
    status, text, beside = run_vmach(monkeypatch, capsys, "diagnose", job, "--out", out, *options)
    assert status == 0, beside
    return text


def test_folder_holds_figures_page_and_program(job, tmp_path, monkeypatch, capsys):
    out, beside = tmp_path / "deep" / "out", tmp_path / "same.json"
    text = diagnosed(job, out, monkeypatch, capsys, "--json", beside)
    figures = json.loads((out / "diagnosis.json").read_text())
    assert figures == json.loads(beside.read_text())
    names = {path.name for path in files_in(out)}
    assert names == {"diagnosis.json", "diagnosis.html"} | (
        {"next.nc"} if figures["next_measurement"] else set()
    )
    assert f"results in {out}: " in text
    if figures["next_measurement"]:
        assert figures["next_measurement"]["program"] == "next.nc"
        assert "G1" in (out / "next.nc").read_text()
    page = Page((out / "diagnosis.html").read_text(encoding="utf-8"))
    for value in figures["rms_um"].values():
        assert f"{value:.2f} µm" in page.text
    assert "Measured minus predicted on the part" in page.text
    assert "wall +X" in page.text
    for candidate in figures["candidates"]:
        assert candidate["effect"] in page.text
    assert not re.search(r"\bum\b|\burad\b", page.text.split("What was compared")[0])


def test_page_asks_the_network_for_nothing_and_is_small(job, tmp_path, monkeypatch, capsys):
    diagnosed(job, tmp_path / "out", monkeypatch, capsys)
    path = tmp_path / "out" / "diagnosis.html"
    assert path.stat().st_size < 2e6
    page = Page(path.read_text(encoding="utf-8"))
    assert_asks_for_nothing(page)


def test_names_cannot_break_out_of_the_page(job, tmp_path, monkeypatch, capsys):
    points = job.parent / "points.csv"
    quoted = '"' + HOSTILE.replace('"', '""') + '"'
    points.write_text(points.read_text().replace("wall +X", quoted))
    diagnosed(job, tmp_path / "out", monkeypatch, capsys)
    page = Page((tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8"))
    assert not any("onerror" in attributes for _, attributes in page.elements)
    assert [tag for tag, _ in page.elements].count("script") == 6
    assert HOSTILE in page.text


def test_named_effects_have_their_card(tmp_path, monkeypatch, capsys):
    job = tip_job(tmp_path, stretched_and_loose)
    diagnosed(job, tmp_path / "out", monkeypatch, capsys)
    figures = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    page = Page((tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8"))
    assert len(figures["effects"]) == 2
    for effect in figures["effects"]:
        for words in (effect["usual_size"], effect["confirm"], effect["cure"]):
            assert words.replace(" um", " µm").replace(" urad", " µrad") in page.text
        for name in effect["interval_95"].keys() - effect["weakly_identified"]:
            low, high = effect["interval_95"][name]
            shown = re.search(rf"{name}\s+95 % between (\S+) and (\S+)", page.text)
            ends = [float(end.replace("−", "-")) for end in shown.groups()]
            assert ends == pytest.approx([low, high], abs=0.03 * (high - low))
    assert "on the part" not in page.text.split("What these measurements")[0]
    assert "component Z" in page.text  # the picture of the tip's readings


def test_commands_to_go_on_can_be_typed(tmp_path, monkeypatch, capsys):
    """The page named the job's file without its folder; a blank parted it in two words."""
    folder = tmp_path / "a job"
    folder.mkdir()
    job = write_measured_job(folder)
    text = diagnosed(job, tmp_path / "out", monkeypatch, capsys)
    command = f"vmach add '{job}' backlash:Y"
    assert f"to add this to the model: {command}" in text
    page = Page((tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8"))
    assert command in page.text


def test_text_of_the_program_stands_at_its_line(tmp_path, monkeypatch, capsys):
    """UTF-8 of a capital A with a ring ends a line of Latin-1 to Python."""
    job = write_measured_job(tmp_path)
    program = tmp_path / "part.nc"
    lines = program.read_text().splitlines()
    lines.insert(1, "(SK\u00c5R)")
    lines[2:] = [f"{line} (\u00c5)" if line.startswith("G1") else line for line in lines[2:]]
    program.write_text("\n".join(lines) + "\n", encoding="utf-8")
    out, report = tmp_path / "out", tmp_path / "report.html"
    diagnosed(job, out, monkeypatch, capsys)
    words = ["compensate", job, "-o", tmp_path / "out.nc", "--report", report]
    assert run_vmach(monkeypatch, capsys, *words)[0] == 0
    for path in (out / "diagnosis.html", report):
        header, _ = unpack(Page(path.read_text(encoding="utf-8")).scripts[1])
        assert header["nc"]
        assert all(text == lines[int(line) - 1] for line, text in header["nc"].items())


def test_forms_for_what_nobody_foresaw_are_on_the_page(tmp_path, monkeypatch, capsys):
    write_measured_job(tmp_path)
    write_odd_job(tmp_path)
    diagnosed(tmp_path / "odd.toml", tmp_path / "out", monkeypatch, capsys)
    figures = json.loads((tmp_path / "out" / "diagnosis.json").read_text())
    page = Page((tmp_path / "out" / "diagnosis.html").read_text(encoding="utf-8"))
    told = page.text.split("What it may depend on")[1].split("Measured minus predicted on")[0]
    assert figures["proposals"]
    said = [float(number) for number in re.findall(r"\d+\.\d\d", told)]
    for proposal in figures["proposals"]:
        assert proposal["formula"] in told
        # both are rounded, to two decimals and to three
        assert min(abs(n - proposal["held_out_um"]["with"]) for n in said) < 0.006


def test_a_sound_machine_has_a_page_too(tmp_path, monkeypatch, capsys):
    out = tmp_path / "out"
    out.mkdir()
    with atomic_folder(out) as earlier:
        (earlier / "next.nc").write_text("of yesterday")
    text = diagnosed(tip_job(tmp_path, nothing), out, monkeypatch, capsys)
    page = Page((out / "diagnosis.html").read_text(encoding="utf-8"))
    assert "The measurements agree with the model" in page.text
    assert "with the effects found" not in page.text
    # a program of an earlier diagnosis stays, and that is said
    assert (out / "next.nc").read_text() == "of yesterday"
    assert f"{out / 'next.nc'} is from an earlier diagnosis" in text


@pytest.mark.parametrize("target", ["file", "input", "nowhere"])
def test_a_folder_that_cannot_be_filled_is_refused_at_once(
    job, tmp_path, target, monkeypatch, capsys
):
    monkeypatch.setattr(
        "vmach.diagnosis.residuals.job_survey.survey_job", lambda job: pytest.fail("late")
    )
    (tmp_path / "file").write_text("mine")
    replace(job, "part.nc", "next.nc")
    (job.parent / "part.nc").rename(job.parent / "next.nc")
    out = {"file": tmp_path / "file", "input": job.parent, "nowhere": "/proc/none"}[target]
    status, text, message = run_vmach(monkeypatch, capsys, "diagnose", job, "--out", out)
    assert status == 1 and text == ""
    said = {"file": "is a file", "input": "is read by this command", "nowhere": "cannot be written"}
    assert said[target] in message
    assert (tmp_path / "file").read_text() == "mine"


def test_without_a_folder_pictures_are_offered(tmp_path, monkeypatch, capsys):
    status, text, _ = run_vmach(monkeypatch, capsys, "diagnose", tip_job(tmp_path, nothing))
    assert status == 0
    assert text.splitlines()[-1] == "--out DIR writes a page with pictures"


def test_interrupted_page_leaves_nothing(job, tmp_path, monkeypatch, capsys):
    def fail(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("vmach.diagnosis.page.write_diagnosis_page", fail)
    with pytest.raises((KeyboardInterrupt, SystemExit)):
        run_vmach(monkeypatch, capsys, "diagnose", job, "--out", tmp_path / "out")
        raise SystemExit
    assert not (tmp_path / "out").exists()
