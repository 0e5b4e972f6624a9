"""JSON schemas of the files that people write, for editors: completion, and a mark under a slip.

They are made from the models that read the files, so that both say the same.
"""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from vmach.errors import InputError
from vmach.instruments import catalogue
from vmach.job.schema import JobSchema
from vmach.machine.files.machine_schema import MachineSchema

__all__ = ["EDITED_FILES", "editor_schema"]

#: what a person writes, by the name of the schema
EDITED_FILES: dict[str, type[BaseModel]] = {"job": JobSchema, "machine": MachineSchema}
_DRAFT = "http://json-schema.org/draft-07/schema#"  #: what editors of TOML know


def editor_schema(name: str) -> dict[str, Any]:
    """The schema of ``job.toml`` or ``machine.toml`` (JSON Schema, draft 7).

    Raises
    ------
    InputError
        Another name.
    """
    if name not in EDITED_FILES:
        raise InputError(f"there is no schema {name!r}", accepted=", ".join(EDITED_FILES))
    schema = EDITED_FILES[name].model_json_schema(by_alias=True)
    if name == "job":
        schema["properties"]["measurements"]["items"] = _measurements(schema["$defs"])
    return {"$schema": _DRAFT} | _in_draft_7(schema)


def _measurements(definitions: dict[str, Any]) -> dict[str, Any]:
    """One of the instruments, each with its own keys."""
    kinds = []
    for kind, instrument in catalogue().items():
        if not instrument.is_section_of_job:
            continue
        own = instrument.model_json_schema(by_alias=True)
        definitions |= own.pop("$defs", {})
        own["properties"]["kind"] = {"const": kind}
        kinds.append(own)
    return {"oneOf": kinds}


def _in_draft_7(part: Any) -> Any:
    """Tuples as draft 7 has them."""
    if isinstance(part, list):
        return [_in_draft_7(one) for one in part]
    if not isinstance(part, dict):
        return part
    found = {key: _in_draft_7(value) for key, value in part.items()}
    if "prefixItems" in found:
        found["items"] = found.pop("prefixItems")
        found["additionalItems"] = False
    return found
