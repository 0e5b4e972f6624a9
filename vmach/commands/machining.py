"""``vmach run`` and ``vmach compare``: the part machined virtually."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import nullcontext
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
    OutDir,
    Seed,
    Uncertainty,
    command_line,
    draw_plan,
    input_files,
    tell_doubts,
)
from vmach.errors import InputError
from vmach.files.atomic import check_folder, check_outputs
from vmach.files.ending import check_ending
from vmach.files.together import together

if TYPE_CHECKING:
    from vmach.run.pipeline import MachinedPart
    from vmach.uncertainty.monte_carlo import Plan

__all__ = ["compare", "run"]


def run(
    job: JobPath = HERE,
    model: Model = Variant.ABBE,
    out: OutDir = None,
    part: Annotated[
        Path | None, typer.Option(help="also write the coloured part: .glb, .3mf or .stl")
    ] = None,
    solid: Annotated[
        bool | None,
        typer.Option(
            "--solid/--no-solid",
            help="cut the virtual part as a solid; by default for programs of up to 100,000 moves",
        ),
    ] = None,
    uncertainty: Uncertainty = UncertaintyMethod.FIRST_ORDER,
    digits: Digits = 1,
    draws: Draws = 1_000_000,
    seed: Seed = 1,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Machine the part virtually and compare it with its CAD."""
    from stock.solid.cut_aside import cutter_at_hand
    from stock.solid.export import PART_FORMATS

    check_ending(part, PART_FORMATS, what="the coloured part", is_needed=True)
    variants = (Variant.NONE,) if model is Variant.NONE else (Variant.NONE, model)
    if part is not None:
        if solid is False:
            what = f"--part {part} without the solid"
            raise InputError(what, accepted="one of --part and --no-solid")
        solid = True
    plan = draw_plan(uncertainty, digits, draws, seed)
    with nullcontext() if solid is False else cutter_at_hand():
        _machine(
            job, model, variants, out=out, part_file=part, as_json=as_json, solid=solid, plan=plan
        )


def compare(
    job: JobPath = HERE,
    out: OutDir = None,
    solid: Annotated[
        bool, typer.Option("--solid", help="also cut the virtual part as a solid")
    ] = False,
    uncertainty: Uncertainty = UncertaintyMethod.FIRST_ORDER,
    digits: Digits = 1,
    draws: Draws = 1_000_000,
    seed: Seed = 1,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Compare error models with each other and the measured part."""
    _machine(
        job,
        Variant.ABBE,
        (Variant.NONE, Variant.HTM, Variant.ABBE),
        prefer_measured=True,
        out=out,
        as_json=as_json,
        solid=solid,
        plan=draw_plan(uncertainty, digits, draws, seed),
    )


def _machine(
    job: Path,
    model: Variant,
    variants: tuple[Variant, ...],
    *,
    out: Path | None,
    as_json: bool,
    part_file: Path | None = None,
    prefer_measured: bool = False,
    solid: bool | None = None,
    plan: Plan | None = None,
) -> None:
    from vmach.job import read_job
    from vmach.run.part_pictures import PartPictures
    from vmach.run.pipeline import machine_part
    from vmach.run.results import (
        ALL_FILES,
        default_folder,
        write_coloured_part,
        write_results,
    )

    out = out or default_folder(job)
    read = read_job(job)
    inputs = input_files(read)
    check_folder(out, ALL_FILES, inputs=inputs)
    results = [out / name for name in ALL_FILES] if out.is_dir() else []
    check_outputs([part_file, *results], inputs=inputs)
    tell_doubts(read)
    pictures = PartPictures()
    with progress_bar() as progress:
        made = machine_part(
            read, model=model, variants=variants, prefer_measured=prefer_measured, solid=solid,
            plan=plan, meanwhile=pictures.draw, progress=progress,
        )  # fmt: skip
        with together():
            if part_file is not None:
                write_coloured_part(made, part_file)
            figures = write_results(
                made, out, command=command_line(), pictures=pictures, progress=progress
            )
    if as_json:
        print(json.dumps(figures, indent=1))
    else:
        _print_results(made, out, figures["run"]["warnings"])


def _print_results(made: MachinedPart, out: Path, warnings: Sequence[str]) -> None:
    """Tables and notes of a part, and which files lie in its folder."""
    from vmach.report import (
        arms_text,
        circular_table,
        columns_table,
        differences_text,
        features_table,
    )
    from vmach.run.results import (
        FEATURES_FILE,
        REMAINDER_FILE,
        RESULT_FILES,
        SOLID_FILE,
        run_record,
    )

    screen = console()
    record = run_record(made, command_line())
    screen.print(columns_table(made.points, record))
    if (drawing := features_table(record)) is not None:
        screen.print(drawing)
    if (circles := circular_table(record)) is not None:
        screen.print(circles)
    for line in (*arms_text(made.points, record), *differences_text(record)):
        screen.print(line, highlight=False, markup=False)
    for note in warnings:
        screen.print(f"note: {note}", highlight=False, markup=False)
    files = [name for name in RESULT_FILES if made.part is not None or name != SOLID_FILE]
    files += [REMAINDER_FILE] if made.points.remainders else []
    files += [FEATURES_FILE] if made.features else []
    screen.print(f"results in {out}: {', '.join(files)}", highlight=False, markup=False)
