"""``vmach tables``: jobs and machines, what it writes and prints, and its complaints."""

from __future__ import annotations

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.small_job import write_job
from vmach.cli import app
from vmach.commands.tables import tables
from vmach.controller_tables import FORMATS
from vmach.controller_tables.formats.linuxcnc import read_linuxcnc
from vmach.errors import InputError

ERRORS = {
    "EXX": (lambda x: 20.0 + 0.03 * x, (0, 0, -100)),
    "EZX": (lambda x: 6.0 * np.sin(x / 100.0), (0, 0, -100)),
    "EBX": (lambda x: 0.05 * x, None),
}


def figures(capsys, *args, **options):
    tables(*args, as_json=True, **options)
    return json.loads(capsys.readouterr().out)


def test_a_machine_gets_every_format_and_a_summary(tmp_path, capsys):
    write_job(tmp_path, ERRORS)
    out = tmp_path / "tables"
    found = figures(capsys, None, out=out, machine=tmp_path / "machine.toml", tool_length=100.0)
    assert found == json.loads((out / "tables.json").read_text())
    assert list(found["formats"]) == list(FORMATS)
    assert found["judged"] == "volume"
    readme = (out / "README.md").read_text()
    for name, one in found["formats"].items():
        assert all((out / path).is_file() for path in one["files"])
        assert one["after_um"]["rms"] < one["before_um"]["rms"]
        assert one["holds"] in readme and one["does_not_hold"] in readme
        assert f"| {name} | {one['before_um']['rms']:.2f} |" in readme
    left = found["formats"]["linuxcnc"]["left_by_component_um"]
    assert {"EZX", "EBX"} <= set(left)
    assert "EXX" not in left
    longer = found["formats"]["sinumerik-cec-products"]["tool_100_mm_longer_um"]
    assert longer["after"]["rms"] > 10 * found["formats"]["isg"]["after_um"]["rms"]


def test_a_job_is_judged_along_its_program(tmp_path, capsys):
    job = write_job(tmp_path, ERRORS)
    out = tmp_path / "tables"
    found = figures(capsys, job, out=out, formats="linuxcnc, isg")
    assert found["judged"] == "program"
    assert list(found["formats"]) == ["linuxcnc", "isg"]
    assert found["formats"]["isg"]["after_um"]["largest"] < 0.3
    assert found["formats"]["linuxcnc"]["tool_100_mm_longer_um"] is None
    over_volume = figures(
        capsys, None, out=out, machine=tmp_path / "machine.toml", tool_length=100.0,
        formats="linuxcnc",
    )  # fmt: skip
    # the entries of the volume leave more along this program than its own
    program = found["formats"]["linuxcnc"]["after_um"]["rms"]
    assert program < over_volume["formats"]["linuxcnc"]["after_um"]["rms"]


def test_effects_of_a_job_that_belong_to_an_axis_go_into_its_table(tmp_path, capsys):
    more = "[effects.scale.X]\nscale_ppm = 60\n[effects.backlash.Y]\nreversal_um = 8\n"
    job = write_job(tmp_path, more=more)
    found = figures(capsys, job, out=tmp_path / "t", formats="linuxcnc,sinumerik-enc,components")
    own, mean, model = (found["formats"][name] for name in found["formats"])
    assert own["before_um"]["rms"] > 11.0  # 60 ppm of about 200 mm
    assert own["after_um"]["rms"] < 0.5  # what is left: the take-up at the reversals
    assert model["after_um"]["rms"] < 0.5
    assert mean["after_um"]["rms"] > 2.0  # no place for the reversal
    entries = read_linuxcnc(tmp_path / "t/linuxcnc").joints
    at = np.array([-210.0, -200.0, -190.0])
    trim = np.interp(at, entries[0][:, 0], entries[0][:, 1])
    assert trim == pytest.approx(-60e-6 * at, abs=1e-5)
    place = np.interp(-150.0, entries[1][:, 0], np.arange(len(entries[1])))
    near = entries[1][int(place)]
    assert near[1] - near[2] == pytest.approx(0.008, abs=5e-4)


def test_help_says_what_every_format_holds():
    text = " ".join(CliRunner().invoke(app, ["tables", "--help"]).output.split())
    for name, one in FORMATS.items():
        assert f"{name}:" in text
        assert one.lacks.split(",")[0].split("(")[0].strip() in text


def test_comp_type_1_and_error_signs_are_read_as_they_were_written(tmp_path, capsys):
    write_job(tmp_path, ERRORS)
    common = {"machine": tmp_path / "machine.toml", "formats": "linuxcnc,sinumerik-cec"}
    plain = figures(capsys, None, out=tmp_path / "a", **common)
    other = figures(capsys, None, out=tmp_path / "b", comp_type=1, cec_entries="error", **common)
    for name in plain["formats"]:
        after, again = (one["formats"][name]["after_um"]["rms"] for one in (plain, other))
        assert after == pytest.approx(again, abs=1e-6)
    texts = [(tmp_path / d / "sinumerik-cec/NC_CEC.INI").read_text() for d in "ab"]
    assert texts[0] != texts[1]
    assert "error, subtracted" in texts[1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "for a job or for a machine"),
        (
            {"machine": "machine.toml", "formats": "fanuc"},
            "--format fanuc; accepted: all, linuxcnc",
        ),
        ({"machine": "machine.toml", "tolerance_um": 0.0}, "--tolerance-um 0"),
        ({"machine": "machine.toml", "model": "none"}, "no error to compensate"),
        ({"job": "job.toml", "tool_length": 5.0}, "--tool-length 5 goes with --machine"),
        ({"machine": "absent.toml"}, "not found"),
    ],
)
def test_complaints_leave_nothing_behind(tmp_path, options, message):
    write_job(tmp_path, ERRORS)
    arguments = ["tables", "-o", str(tmp_path / "out")]
    for name, value in options.items():
        value = tmp_path / value if name in ("job", "machine") else value
        option = {"formats": "--format"}.get(name, f"--{name.replace('_', '-')}")
        arguments += [str(value)] if name == "job" else [option, str(value)]
    result = CliRunner().invoke(app, arguments)
    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)
    assert not (tmp_path / "out").exists()


def test_rotary_axes_are_refused(tmp_path):
    write_job(tmp_path)
    text = (tmp_path / "machine.toml").read_text().replace("X' w", "X' C' w")
    text += "[axes.C]\ntravel_deg = [0, 360]\ncentre_mm = [0, 0, -200]\n"
    (tmp_path / "machine.toml").write_text(text)
    with pytest.raises(InputError, match="rotary axes C"):
        tables(None, out=tmp_path / "out", machine=tmp_path / "machine.toml")
