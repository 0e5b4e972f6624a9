"""``vmach predict``: deviations at points of the surface."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.variant import Variant
from vmach.commands.options import AsJson, Control, JobPath, Model, input_files
from vmach.files.atomic import check_outputs

__all__ = ["predict"]


def predict(
    job: JobPath,
    points: Annotated[Path, typer.Option(help="surface points: id,feature,x,y,z,i,j,k")],
    program: Annotated[Path | None, typer.Option(help="another NC program")] = None,
    model: Model = Variant.ABBE,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="table to write: .csv, .npz, .parquet")
    ] = None,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Predict the deviation at given points of the surface."""
    from vmach.files.table_file import check_table_file, write_table
    from vmach.job import read_job
    from vmach.run.pipeline import predict_points
    from vmach.run.results import prediction_columns, prediction_summary, write_prediction

    read = read_job(job)
    inputs = [*input_files(read), points, *([program] if program else [])]
    check_outputs([out], inputs=inputs)
    check_table_file(out)
    with progress_bar() as progress:
        found, prediction = predict_points(
            read, points, program_path=program, variant=model, progress=progress
        )
    for note in (*prediction.preparation.notes, *found.notes):
        print(f"note: {note}", file=sys.stderr)
    if out is not None:
        write_table(out, prediction_columns(found, prediction))
    if as_json:
        print(json.dumps(prediction_summary(found, prediction), indent=1))
    elif out is None:
        write_prediction(sys.stdout, found, prediction)
    else:
        figures = prediction_summary(found, prediction)
        states = ", ".join(f"{count} {state}" for state, count in figures["status"].items())
        print(f"{out}: {states}")
