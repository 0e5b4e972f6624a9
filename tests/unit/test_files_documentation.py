"""Every key that a file may hold stands in the pages that describe the file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from vmach.files.toml_file import FileSection
from vmach.instruments import catalogue
from vmach.job.schema import JobSchema
from vmach.machine.files.machine_schema import MachineSchema

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
