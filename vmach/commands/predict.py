"""``vmach predict``: deviations at points of the surface."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.uncertainty_method import UncertaintyMethod
from vmach.base.variant import Variant
from vmach.commands.options import (
    HERE,
    AsJson,
    Control,
    Digits,
    Draws,
    JobPath,
    Model,
    Seed,
    Uncertainty,
    input_files,
)
from vmach.files.atomic import check_outputs

__all__ = ["predict"]


def predict(
    *,
    job: JobPath = HERE,
    points: Annotated[Path, typer.Option(help="surface points: id,feature,x,y,z,i,j,k")],
    program: Annotated[Path | None, typer.Option(help="another NC program")] = None,
    model: Model = Variant.ABBE,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="table to write: .csv, .npz, .parquet")
    ] = None,
    uncertainty: Uncertainty = UncertaintyMethod.FIRST_ORDER,
    digits: Digits = 1,
    draws: Draws = 1_000_000,
    seed: Seed = 1,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Predict the deviation at given points of the surface."""
    from vmach.files.table_file import check_table_file, write_table
    from vmach.job import read_job
    from vmach.run.pipeline import predict_points
    from vmach.run.results import prediction_columns, prediction_summary, write_columns

    read = read_job(job)
    inputs = [*input_files(read), points, *([program] if program else [])]
    check_outputs([out], inputs=inputs)
    check_table_file(out)
    drawn_too = uncertainty is UncertaintyMethod.MONTE_CARLO
    with progress_bar() as progress:
        found, prediction = predict_points(
            read, points, program_path=program, variant=model, progress=progress
        )
        columns = prediction_columns(found, prediction)
        figures = prediction_summary(found, prediction)
        notes = [*prediction.preparation.notes, *found.notes]
        said = ""
        if drawn_too:
            from vmach.uncertainty.monte_carlo import Plan
            from vmach.uncertainty.point_figures import point_uncertainty

            plan = Plan(digits=digits, most_draws=draws, seed=seed)
            more = point_uncertainty(found, prediction, plan, progress=progress)
            columns |= more.columns
            figures["uncertainty"] = more.figures
            notes += more.notes
            said = f"; {more.sentence}"
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    if out is not None:
        write_table(out, columns)
    if as_json:
        print(json.dumps(figures, indent=1))
    elif out is None:
        write_columns(sys.stdout, columns)
    else:
        states = ", ".join(f"{count} {state}" for state, count in figures["status"].items())
        print(f"{out}: {states}{said}")
