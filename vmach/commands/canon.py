"""``vmach canon``: what a program says to the machine."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from vmach.base.progress import progress_bar
from vmach.commands.options import AsJson
from vmach.files.text_file import check_is_file

__all__ = ["canon"]


def canon(
    program: Annotated[Path, typer.Argument(metavar="PROGRAM", help="the NC program")],
    tools: Annotated[
        Path | None, typer.Option(help="tool table, as LinuxCNC's tool.tbl; for G43 and G41")
    ] = None,
    machine_unit: Annotated[
        Literal["mm", "inch"], typer.Option(help="unit of the tool table and of stored offsets")
    ] = "mm",
    control: Annotated[
        str, typer.Option(help="control that the program is written for; auto recognises it")
    ] = "auto",
    as_json: AsJson = False,
) -> None:
    """Print what a program says, one canonical call a line."""
    from gcode import (
        UnknownToolError,
        canon_calls,
        canon_text,
        dialect_name,
        read_program,
        read_tool_table,
    )

    check_is_file(program, what="NC program")
    unit_mm = {"mm": 1.0, "inch": 25.4}[machine_unit]
    table = read_tool_table(tools, unit_mm=unit_mm) if tools is not None else {}
    with progress_bar() as progress:
        progress("read", 0, 1)
        try:
            read = read_program(
                program,
                tools=table,
                machine_unit_mm=unit_mm,
                dialect=dialect_name(control),
                preview=True,
            )
        except UnknownToolError as error:
            error.hint = f"add it to {tools}" if tools else "give the tool table with --tools"
            raise
    print(f"note: {program.name} is {read.assumed}", file=sys.stderr)
    for note in read.notes:
        if note.is_of_reading:
            print(f"note: {program.name}:{note.line}: {note.meaning}", file=sys.stderr)
    if as_json:
        calls = [{"line": n, "call": name, "arguments": a} for n, name, a in canon_calls(read)]
        print(json.dumps(calls, indent=1))
    else:
        sys.stdout.writelines(canon_text(read))
