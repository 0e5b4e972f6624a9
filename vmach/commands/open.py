"""What is looked at: ``vmach open [JOB]``, the workbench, and ``vmach view DIR``, a result."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from vmach.commands.options import Control
from vmach.errors import InputError

__all__ = ["open_workbench", "view"]


def open_workbench(
    job: Annotated[
        Path | None, typer.Argument(metavar="[JOB]", help="job.toml, or the folder it is in")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0: any that is free")] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="open the browser on it")
    ] = True,
    control: Control = None,
) -> None:
    """Look, ask, add and watch the error fall, in a page of this machine's browser."""
    missing = [name for name in ("starlette", "uvicorn") if find_spec(name) is None]
    if missing:
        raise InputError(
            f"the workbench needs {' and '.join(missing)}",
            hint="pip install 'vmach[workbench]'",
        )
    from vmach.workbench.launch import launch

    launch(job, port=port, with_browser=browser, control=control)


def view(directory: Annotated[Path, typer.Argument(metavar="DIR", help="a result")]) -> None:
    """Show a result in a window."""
    from vmach.report import open_viewer

    open_viewer(directory)
