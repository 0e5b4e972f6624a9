"""``vmach schema``: keys, types and units of outputs for programs, and of files for editors."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from vmach.errors import InputError

__all__ = ["schema"]


def schema(
    name: Annotated[
        str | None, typer.Argument(help="job, machine, summary ...; all names where left out")
    ] = None,
) -> None:
    """Print the JSON schema of an output, or of a file that you write."""
    from vmach.schemas import SCHEMAS, json_schema
    from vmach.setup.editor_schemas import EDITED_FILES, editor_schema

    if name is not None and name in EDITED_FILES:
        print(json.dumps(editor_schema(name), indent=1))
        return
    if name is None:
        for known in EDITED_FILES:
            print(f"{known:11} {known}.toml, for editors")
        for known, record in SCHEMAS.items():
            said = (record.__doc__ or "").splitlines()[0]
            print(f"{known:11} {said.replace('``', '')}")
        return
    if name not in SCHEMAS:
        known = ", ".join([*EDITED_FILES, *SCHEMAS])
        raise InputError(f"there is no schema {name!r}", accepted=known)
    print(json.dumps(json_schema(name), indent=1))
