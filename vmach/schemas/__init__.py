"""JSON schemas of what the commands write: keys, types, units.

A test holds what the commands write against these records: a key that one side lacks fails.
"""

from __future__ import annotations

from typing import Any

from vmach.errors import InputError
from vmach.schemas.base import Output
from vmach.schemas.checkup import CheckOutput
from vmach.schemas.correction import CompensationFigures, DiagnosisFigures
from vmach.schemas.importing import ImportOutput
from vmach.schemas.machine import Accuracy, Iso230, Tables
from vmach.schemas.part import PathErrors, PointPrediction, Summary
from vmach.schemas.study import Batch

__all__ = ["SCHEMAS", "CheckOutput", "json_schema"]

#: by the name of the file or of the command that writes it
SCHEMAS: dict[str, type[Output]] = {
    "summary": Summary,
    "predict": PointPrediction,
    "path": PathErrors,
    "batch": Batch,
    "diagnose": DiagnosisFigures,
    "compensate": CompensationFigures,
    "accuracy": Accuracy,
    "iso230": Iso230,
    "tables": Tables,
    "check": CheckOutput,
    "import": ImportOutput,
}


def json_schema(name: str) -> dict[str, Any]:
    """The schema of one output (JSON Schema, draft 2020-12).

    Raises
    ------
    InputError
        There is no such schema.
    """
    if name not in SCHEMAS:
        raise InputError(f"there is no schema {name!r}", accepted=", ".join(SCHEMAS))
    schema = SCHEMAS[name].model_json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | schema
