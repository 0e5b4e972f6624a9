"""``vmach features``: what the drawing asks for, in the formats of other programs."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.terminal import console
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
    command_line,
    draw_plan,
    input_files,
)
from vmach.errors import InputError
from vmach.files.atomic import check_outputs
from vmach.files.together import together

if TYPE_CHECKING:
    from vmach.job import Job
    from vmach.report import RunRecord
    from vmach.run.pipeline import MachinedPart

__all__ = ["features"]


def features(
    job: JobPath = HERE,
    out: Annotated[
        list[Path] | None,
        typer.Option("-o", "--out", help="file to write: .qif, .dmo, .dfq, .csv, .pdf; repeatable"),
    ] = None,
    model: Model = Variant.ABBE,
    faces: Annotated[
        bool, typer.Option("--faces", help="list the faces of the CAD, which features are made of")
    ] = False,
    as_json: AsJson = False,
    control: Control = None,
    uncertainty: Uncertainty = UncertaintyMethod.FIRST_ORDER,
    digits: Digits = 1,
    draws: Draws = 1_000_000,
    seed: Seed = 1,
) -> None:
    """Evaluate what the drawing asks for: values, verdicts, files for other programs."""
    from vmach.job import read_job
    from vmach.report import check_ending
    from vmach.report.figures.features import features_summary, features_table
    from vmach.run.pipeline import machine_part
    from vmach.run.results import run_record

    read = read_job(job)
    if faces:
        _list_faces(read, as_json)
        return
    for path in out or []:
        check_ending(path)
    check_outputs(out or [], inputs=input_files(read))
    with progress_bar() as progress:
        made = machine_part(
            read, model=model, variants=(model,), prefer_measured=True, solid=False,
            plan=draw_plan(uncertainty, digits, draws, seed), progress=progress,
        )  # fmt: skip
    if not made.features:
        raise InputError(
            "the job asks for no feature", file=read.path,
            accepted='[tolerances], as bore = "35 H7", or tolerances in the STEP file',
            hint="--faces lists what can be named",
        )  # fmt: skip
    record = run_record(made, command_line())
    _write_files(out or [], made, record)
    if as_json:
        print(json.dumps(features_summary(record), indent=1))
        return
    screen = console()
    screen.print(features_table(record))
    for path in out or []:
        screen.print(f"written: {path}", highlight=False, markup=False)


def _write_files(files: list[Path], made: MachinedPart, record: RunRecord) -> None:
    """All files or none; the printed report gets a picture."""
    from vmach.report import write_features_file
    from vmach.run.results import write_picture

    with tempfile.TemporaryDirectory() as folder:
        picture = None
        if any(path.suffix.lower() == ".pdf" for path in files):
            picture = Path(folder) / "heatmap.png"
            write_picture(picture, made, record)
        with together():
            for path in files:
                write_features_file(path, record, picture=picture, logo=made.job.drawing.logo)


def _list_faces(job: Job, as_json: bool) -> None:
    """Names, kinds and areas of the faces of the CAD."""
    from vmach.nominal import read_nominal

    if job.nominal is None:
        raise InputError("the job has no CAD", file=job.path, accepted='nominal = "part.step"')
    part = read_nominal(job.nominal, job.nominal_unit)
    rows = [
        {"name": f.name, "title": getattr(f, "title", ""), "kind": f.kind, "area_mm2": f.area_mm2}
        for f in part.faces
    ]
    if as_json:
        print(json.dumps(rows, indent=1))
        return
    screen = console()
    for row in rows:
        title = f"  '{row['title']}'" if row["title"] else ""
        screen.print(f"{row['name']}{title}  {row['area_mm2']:.4g} mm2", highlight=False,
                     markup=False)  # fmt: skip
