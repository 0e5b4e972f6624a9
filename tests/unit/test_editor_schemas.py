"""Schemas for editors say what the readers say: the samples are valid, slips are not."""

from __future__ import annotations

import datetime
import json
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft7Validator
from typer.testing import CliRunner

from vmach.cli import app
from vmach.setup.editor_schemas import editor_schema

SAMPLES = Path(__file__).parents[2] / "samples"


def plain(value):
    """A TOML value as JSON has it."""
    if isinstance(value, dict):
        return {key: plain(own) for key, own in value.items()}
    if isinstance(value, list):
        return [plain(own) for own in value]
    return value.isoformat() if isinstance(value, datetime.date) else value


def validator(name):
    schema = editor_schema(name)
    Draft7Validator.check_schema(schema)
    return Draft7Validator(schema)


def kind_of(path):
    return "machine" if "chain" in tomllib.loads(path.read_text()) else "job"


FILES = [p for p in sorted(SAMPLES.rglob("*.toml")) if "study" not in p.name]


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.relative_to(SAMPLES).as_posix())
def test_every_sample_is_valid(path):
    data = plain(tomllib.loads(path.read_text()))
    assert [e.message for e in validator(kind_of(path)).iter_errors(data)] == []


@pytest.mark.parametrize(
    "name, change",
    [
        ("job", lambda d: d.update(machin="machine.toml")),
        ("job", lambda d: d.pop("program")),
        ("job", lambda d: d["tools"]["1"].update(shape="square")),
        ("job", lambda d: d["tools"]["1"].update(diameter_mm="10")),
        ("job", lambda d: d["work_offsets_mm"].update(G54=[1, 2])),
        ("job", lambda d: d.update(probing={"probe_length": 100})),
        ("job", lambda d: d.update(measurements=[{"kind": "laser", "file": "x.csv"}])),
        ("job", lambda d: d.update(measurements=[{"kind": "lasr"}])),
        ("machine", lambda d: d["convention"].update(sign="opposite")),
        ("machine", lambda d: d["errors"]["EXX"].update(reversed=True)),
        ("machine", lambda d: d["motion"].pop("rapid_mm_min")),
    ],
)
def test_a_slip_is_marked(name, change):
    data = plain(tomllib.loads((SAMPLES / "iso10791_7" / f"{name}.toml").read_text()))
    assert validator(name).is_valid(data)
    change(data)
    assert not validator(name).is_valid(data)


def test_a_laser_of_a_job_is_known():
    data = plain(tomllib.loads((SAMPLES / "iso10791_7" / "job.toml").read_text()))
    laser = {"kind": "laser", "file": "x.csv", "tool_length_mm": 150, "u_um": 0.5, "axis": "X",
             "at_mm": [0, 0, 0]}  # fmt: skip
    data["measurements"] = [laser]
    assert validator("job").is_valid(data)


def test_init_names_them_and_writes_them(tmp_path):
    (tmp_path / "part.nc").write_text("%\nG21 G90 G54\nT1 M6\nG43 H1\nG1 X1 F100\nM30\n%\n")
    assert CliRunner().invoke(app, ["init", str(tmp_path), "--yes"]).exit_code == 0
    for name in ("job", "machine"):
        first = (tmp_path / f"{name}.toml").read_text().splitlines()[0]
        schema = json.loads((tmp_path / first.removeprefix("#:schema ")).read_text())
        assert schema == editor_schema(name)
        data = plain(tomllib.loads((tmp_path / f"{name}.toml").read_text()))
        assert Draft7Validator(schema).is_valid(data)
    printed = CliRunner().invoke(app, ["schema", "job"]).output
    assert json.loads(printed) == editor_schema("job")
