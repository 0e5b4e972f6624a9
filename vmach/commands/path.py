"""``vmach path``: the error of the tool tip along the program."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.variant import Variant
from vmach.commands.options import AsJson, Control, JobPath, Model, input_files
from vmach.files.atomic import atomic_file, check_outputs

__all__ = ["path"]


def path(
    job: JobPath,
    model: Model = Variant.ABBE,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="CSV to write")] = None,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Error of the tool tip along the program, whatever it cuts."""
    from vmach.prediction.tip_errors import tip_errors, write_tip_errors_csv

    check_outputs([out], inputs=input_files(job))
    with progress_bar() as progress:
        progress("path", 0, 1)
        found = tip_errors(job, model)
    if out is not None:
        with atomic_file(out) as temporary:
            write_tip_errors_csv(temporary, found)
    for note in found.notes:
        print(f"note: {note}", file=sys.stderr)
    figures = found.summary()
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    x, y, z = figures["largest_abs_xyz_um"]
    print(f"{figures['nodes']} nodes; largest error in X {x:.2f}, Y {y:.2f}, Z {z:.2f} um")
    worst = figures["largest_error_um"]
    print(f"largest error vector {worst:.2f} um, line {figures['at_line']}")
