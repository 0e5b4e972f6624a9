"""``vmach view``: a result in a window."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["view"]


def view(directory: Annotated[Path, typer.Argument(metavar="DIR", help="a result")]) -> None:
    """Show a result in a window."""
    from vmach.report import open_viewer

    open_viewer(directory)
