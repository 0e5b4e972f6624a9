"""Every key that a file may hold stands in the pages that describe the file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import typer

from gcode import dialect_called, dialect_names
from vmach.cli import app
from vmach.errors import InputError
from vmach.files.toml_file import FileSection
from vmach.instruments import catalogue
from vmach.job.schema import JobSchema
from vmach.machine.files.machine_schema import MachineSchema
from vmach.program_text import target_control
from vmach.schemas import SCHEMAS

DOCS = Path(__file__).parents[2] / "docs"


def sections(annotation):
    if isinstance(annotation, type) and issubclass(annotation, FileSection):
        yield annotation
    for part in getattr(annotation, "__args__", ()):
        yield from sections(part)


def keys(schema):
    for name, field in schema.model_fields.items():
        yield field.alias or name
        for section in sections(field.annotation):
            yield from keys(section)


@pytest.mark.parametrize(
    ("schema", "pages"),
    [
        (JobSchema, ["files.md", "effects.md"]),
        (MachineSchema, ["files.md", "machine-file.md"]),
        *((kind, ["how-to/diagnose.md"]) for kind in catalogue().values()),
    ],
)
def test_every_key_is_described(schema, pages):
    text = "".join((DOCS / page).read_text(encoding="utf-8") for page in pages)
    assert [key for key in keys(schema) if not re.search(rf"\b{key}\b", text)] == []


def test_every_schema_is_named():
    page = (DOCS / "files.md").read_text(encoding="utf-8")
    (sentence,) = re.findall(r"`vmach schema NAME` prints(.*?): every key", page, re.DOTALL)
    assert re.findall("`([a-z0-9]+)`", sentence) == list(SCHEMAS)


def test_every_command_that_prints_json_has_a_row_of_its_keys():
    page = (DOCS / "files.md").read_text(encoding="utf-8")
    table = page.split("| command | keys |")[1].split("\n\n")[0]
    rows = {name for first in re.findall(r"^\| ([^|]+) \|", table, re.MULTILINE)
            for name in re.findall("`([a-z0-9]+)`", first)}  # fmt: skip
    printing = {
        name
        for name, command in typer.main.get_command(app).commands.items()
        if any("--json" in parameter.opts for parameter in command.params)
    }
    assert rows == printing | {"schema"}


def test_every_control_is_named_where_it_can_be_chosen():
    written = {name for name in dialect_names() if dialect_called(name).is_written}
    files, commands, texts = (
        (DOCS / name).read_text(encoding="utf-8")
        for name in ("files.md", "commands.md", "compensated-text.md")
    )
    (read,) = re.findall(r"`\[control\]`: `name` is (.*?) or `auto`", files)
    assert re.findall("`([a-z]+)`", read) == sorted(dialect_names())
    (row,) = re.findall(r"\| `--dialect` \| ([^|]+) \|", commands)
    assert re.findall("`([a-z]+)`", row) == sorted(written)
    table = texts.split("| `--dialect` |")[1].split("\n\n")[0]
    rows = re.findall(r"^\| (`[^|]+) \|", table, re.MULTILINE)
    assert {name for row in rows for name in re.findall("`([a-z]+)`", row)} == written
    with pytest.raises(InputError) as refused:
        target_control("fanuc", "nosuch", file=Path("part.nc"))
    assert refused.value.accepted.split(", ") == sorted(written)
