"""``vmach schema``: the keys, types and units of an output for programs."""

from __future__ import annotations

import json
from typing import Annotated

import typer

__all__ = ["schema"]


def schema(
    name: Annotated[
        str | None, typer.Argument(help="summary, predict, path ...; all names where left out")
    ] = None,
) -> None:
    """Print the JSON schema of an output."""
    from vmach.schemas import SCHEMAS, json_schema

    if name is None:
        for known, record in SCHEMAS.items():
            print(f"{known:11} {(record.__doc__ or '').splitlines()[0]}")
        return
    print(json.dumps(json_schema(name), indent=1))
