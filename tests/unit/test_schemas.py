"""What the commands write for programs has the keys, types and units that the schemas publish."""

from __future__ import annotations

import json

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from typer.testing import CliRunner

from tests.small_job import write_job_with_nominal
from vmach.cli import app
from vmach.schemas import SCHEMAS, json_schema

ERRORS = {
    "EXX": (lambda x: 6.0 * x / 400.0, (0, 0, -100)),
    "EYX": (lambda x: 6.0 * np.sin(x / 50.0), (0, 0, -100)),
    "EBX": (lambda x: 0.05 * x, None),
}
DRAWN = ("--uncertainty", "monte-carlo", "--draws", "20000")
RUNS = "position_mm,forward_1,backward_1,forward_2,backward_2\n0,1,0,3,2\n100,5,4,5,6\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("schemas")
    write_job_with_nominal(folder, ERRORS)
    (folder / "x.csv").write_text(RUNS)
    (folder / "line.csv").write_text("x,y,z\n-300,-200,-200\n-100,-100,-100\n")
    return folder


def written(folder, *words):
    """What a command prints with ``--json``."""
    words = [str(folder / word[1:]) if word.startswith("@") else word for word in words]
    result = CliRunner().invoke(app, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


COMMANDS: dict[str, list[list[str]]] = {
    "summary": [
        ["run", "@job.toml", "--out", "@out", "--json"],
        ["compare", "@job.toml", "--out", "@compared", "--json"],
    ],
    "predict": [
        ["predict", "@job.toml", "--points", "@points.csv", "--json"],
        ["predict", "@job.toml", "--points", "@points.csv", "--json", *DRAWN],
    ],
    "path": [["path", "@job.toml", "--json"]],
    "compensate": [["compensate", "@job.toml", "-o", "@better.nc", "--json"]],
    "accuracy": [
        ["accuracy", "@machine.toml", "--grid", "4", "--json"],
        ["accuracy", "@machine.toml", "--grid", "4", "--profile", "@line.csv", "--json"],
        ["accuracy", "@machine.toml", "--grid", "4", "--json", *DRAWN],
    ],
    "import": [
        [
            "import",
            "@x.csv",
            "--error",
            "EXX",
            "--set",
            "unit=um",
            "-o",
            "@imported",
            "--squareness",
            "XY 34,1 um/m more",
            "--yes",
            "--json",
        ]
    ],
    "iso230": [["iso230", "@x.csv", "--json"], ["iso230", "@machine.toml", "--json"]],
    "tables": [
        ["tables", "@job.toml", "--out", "@t", "--format", "linuxcnc", "--json"],
        ["tables", "--machine", "@machine.toml", "--out", "@m", "--format", "isg", "--json"],
    ],
}


@pytest.mark.parametrize("name", list(COMMANDS))
def test_output_is_as_its_schema_says(folder, name):
    validator = Draft202012Validator(json_schema(name))
    for words in COMMANDS[name]:
        validator.validate(written(folder, *words))


def test_diagnosis_is_as_its_schema_says(folder):
    out = folder / "diagnosis.json"
    words = ["diagnose", str(folder / "job.toml"), "--json", str(out)]
    result = CliRunner().invoke(app, words, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    found = json.loads(out.read_text())
    validator = Draft202012Validator(json_schema("diagnose"))
    validator.validate(found)
    assert not validator.is_valid(found | {"new": 1})
    assert all(spot["parameter"].endswith(spot["unit"]) for spot in found["blind_spots"])


@pytest.mark.parametrize("name", list(SCHEMAS))
def test_schema_is_one_and_is_printed(name):
    result = CliRunner().invoke(app, ["schema", name])
    schema = json.loads(result.stdout)
    Draft202012Validator.check_schema(schema)
    assert schema == json.loads(json.dumps(json_schema(name)))
    assert name in CliRunner().invoke(app, ["schema"]).stdout


def test_schema_refuses_a_key_that_is_new_lacks_or_has_another_type(folder):
    found = written(folder, *COMMANDS["path"][0])
    validator = Draft202012Validator(json_schema("path"))
    assert validator.is_valid(found)
    assert not validator.is_valid(found | {"new": 1})
    assert not validator.is_valid({key: found[key] for key in found if key != "nodes"})
    assert not validator.is_valid(found | {"largest_error_um": "3 um"})


def test_numbers_have_a_unit_in_their_name_or_their_description():
    """Floats without a unit say what they are; counts are whole numbers."""
    units = ("_um", "_mm", "_mm2", "_mm3", "_s", "_percent", "_urad", "um", "urad", "_rad", "_K")
    for name in SCHEMAS:
        schema = json_schema(name)
        for record in (schema, *schema.get("$defs", {}).values()):
            for key, value in record.get("properties", {}).items():
                kinds = [value, *value.get("anyOf", [])]
                if any(kind.get("type") == "number" for kind in kinds):
                    told = value.get("description") or record.get("description", "")
                    assert key.endswith(units) or told, f"{name}: {key}"


def test_unknown_schema_is_refused_with_what_there_is():
    result = CliRunner().invoke(app, ["schema", "sumary"])
    assert "job, machine, summary, predict, path" in str(result.exception)


def test_the_list_of_schemas_is_plain_text():
    listed = CliRunner().invoke(app, ["schema"]).stdout
    assert "`" not in listed and len(listed.splitlines()) == len(SCHEMAS) + 2
