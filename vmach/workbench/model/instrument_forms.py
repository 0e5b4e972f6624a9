"""What the page has to ask for when readings come in: one form an instrument."""

from __future__ import annotations

from typing import Any

from vmach.instruments import catalogue
from vmach.measurements.instrument import Instrument

__all__ = ["instrument_forms"]

#: keys that the page knows itself
_KNOWN = ("kind", "file")


def instrument_forms() -> list[dict[str, Any]]:
    """Kind, title, columns of the file, and the further keys of its section, of all instruments.

    Points of the part have no further key: a job names their file alone.
    """
    forms = []
    for kind in catalogue().values():
        schema = kind.model_json_schema() if kind.is_section_of_job else {}
        required = schema.get("required", [])
        fields = [
            {"name": name, "is_required": name in required, **_entry(told)}
            for name, told in schema.get("properties", {}).items()
            if name not in _KNOWN
        ]
        columns = _columns(kind)
        forms.append({"kind": kind.name, "title": kind.title, "columns": columns, "fields": fields})
    return sorted(forms, key=lambda form: form["kind"] != "part")


def _columns(kind: type[Instrument]) -> list[str]:
    if not kind.is_section_of_job:
        return ["id", "feature", "x", "y", "z", "i", "j", "k", "mx", "my", "mz", "u_um"]
    return list(getattr(kind, "columns", ()))


def _entry(told: dict[str, Any]) -> dict[str, Any]:
    """How a key is asked for: a number, three numbers, or a choice."""
    if "enum" in told:
        return {"is": "choice", "choices": told["enum"], "value": told.get("default")}
    if told.get("type") == "array":
        return {"is": "three", "value": told.get("default")}
    return {"is": "number", "value": told.get("default")}
