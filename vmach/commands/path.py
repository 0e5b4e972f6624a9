"""``vmach path``: the error of the tool tip along the program."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.variant import Variant
from vmach.commands.options import HERE, AsJson, Control, JobPath, Model, input_files
from vmach.files.atomic import check_outputs

__all__ = ["path"]


def path(
    job: JobPath = HERE,
    model: Model = Variant.ABBE,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="table to write: .csv, .npz, .parquet")
    ] = None,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Predict the error of the tool tip along the program."""
    from vmach.files.table_file import check_table_file, write_table
    from vmach.job import read_job
    from vmach.prediction.tip_errors import tip_error_columns, tip_errors

    read = read_job(job)
    check_outputs([out], inputs=input_files(read))
    check_table_file(out)
    with progress_bar() as progress:
        progress("path", 0, 1)
        found = tip_errors(read, model)
    if out is not None:
        write_table(out, tip_error_columns(found))
    for note in found.notes:
        print(f"note: {note}", file=sys.stderr)
    figures = found.summary()
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    x, y, z = figures["largest_abs_xyz_um"]
    print(
        f"{figures['nodes']} nodes of the path; largest error in X {x:.2f}, Y {y:.2f}, Z {z:.2f} um"
    )
    worst = figures["largest_error_um"]
    print(f"largest error vector {worst:.2f} um, line {figures['at_line']}")
