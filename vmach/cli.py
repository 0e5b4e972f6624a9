"""The command line: ``vmach COMMAND``."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer
from rich.console import Console

from gcode import ProgramError, canon_calls, canon_lines, read_program, read_tool_table
from stock import StockError
from vmach import __version__
from vmach.accuracy.command import accuracy
from vmach.atomic import atomic_file, check_outputs
from vmach.compensation.command import compensate
from vmach.controller_tables.command import tables
from vmach.diagnosis.command import add, diagnose, effects_app, history
from vmach.errors import InputError, VmachError
from vmach.iso230.command import iso230
from vmach.job import read_job
from vmach.kernel_cache import compile_without_collection, forget_stale_kernels
from vmach.machine import Variant
from vmach.progress import progress_bar

__all__ = ["app", "main"]

app = typer.Typer(
    name="vmach",
    help="Predict the part that a real machine makes from an NC program.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

JobPath = Annotated[Path, typer.Argument(metavar="JOB", help="job.toml, or the folder it is in")]
AsJson = Annotated[bool, typer.Option("--json", help="print the figures as JSON")]
OutDir = Annotated[Path | None, typer.Option("--out", help="folder for the results")]
Model = Annotated[Variant, typer.Option(help="arms of the machine's angular errors")]


@app.callback(invoke_without_command=True)
def _before_any_command(
    version: Annotated[bool, typer.Option("--version", help="print the version")] = False,
    effect_file: Annotated[
        list[Path] | None,
        typer.Option(help="Python file with an effect of your own, for any command; repeatable"),
    ] = None,
) -> None:
    if version:
        print(__version__)
        raise typer.Exit
    for file in effect_file or []:
        from vmach.effects import load_effect_file

        load_effect_file(file)


@app.command()
def run(
    job: JobPath,
    model: Model = Variant.ABBE,
    out: OutDir = None,
    part: Annotated[
        Path | None, typer.Option(help="also write the coloured part: .glb, .3mf or .stl")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Machine the part virtually and compare it with its nominal CAD."""
    variants = (Variant.NONE,) if model is Variant.NONE else (Variant.NONE, model)
    _machine(job, model, variants, out=out, part_file=part, as_json=as_json)


@app.command()
def compare(job: JobPath, out: OutDir = None, as_json: AsJson = False) -> None:
    """Error-model variants side by side, and against the measured points of the job."""
    _machine(
        job,
        Variant.ABBE,
        (Variant.NONE, Variant.HTM, Variant.ABBE),
        prefer_measured=True,
        out=out,
        as_json=as_json,
    )


@app.command()
def predict(
    job: JobPath,
    points: Annotated[Path, typer.Option(help="surface points: id,feature,x,y,z,i,j,k")],
    program: Annotated[Path | None, typer.Option(help="another NC program")] = None,
    model: Model = Variant.ABBE,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="CSV to write")] = None,
    as_json: AsJson = False,
) -> None:
    """Predicted deviation at given surface points, with the NC line that made each."""
    from vmach.pipeline import predict_points
    from vmach.results import prediction_summary, write_prediction, write_prediction_csv

    inputs = [file for _, file in read_job(job).files()]
    check_outputs([out], inputs=[*inputs, points, *([program] if program else [])])
    with progress_bar() as progress:
        found, prediction = predict_points(
            job, points, program_path=program, variant=model, progress=progress
        )
    for note in (*prediction.preparation.notes, *found.notes):
        print(f"note: {note}", file=sys.stderr)
    if out is not None:
        write_prediction_csv(out, found, prediction)
    if as_json:
        print(json.dumps(prediction_summary(found, prediction), indent=1))
    elif out is None:
        write_prediction(sys.stdout, found, prediction)
    else:
        figures = prediction_summary(found, prediction)
        states = ", ".join(f"{count} {state}" for state, count in figures["status"].items())
        print(f"{out}: {states}")


@app.command()
def path(
    job: JobPath,
    model: Model = Variant.ABBE,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="CSV to write")] = None,
    as_json: AsJson = False,
) -> None:
    """Error of the tool tip along the program, whatever it cuts."""
    from vmach.tip_errors import tip_errors, write_tip_errors_csv

    check_outputs([out], inputs=[file for _, file in read_job(job).files()])
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


for _command in (diagnose, add, history):
    app.command()(_command)
app.add_typer(effects_app, name="effects")
app.command()(compensate)
app.command()(tables)
app.command()(accuracy)
app.command()(iso230)


@app.command()
def canon(
    program: Annotated[Path, typer.Argument(metavar="PROGRAM", help="the NC program")],
    tools: Annotated[
        Path | None, typer.Option(help="tool table, as LinuxCNC's tool.tbl; for G43 and G41")
    ] = None,
    machine_unit: Annotated[
        Literal["mm", "inch"], typer.Option(help="unit of the tool table and of stored offsets")
    ] = "mm",
    as_json: AsJson = False,
) -> None:
    """What the program says to the machine: one resolved move a line."""
    if not program.is_file():
        raise InputError("NC program not found", file=program)
    unit_mm = {"mm": 1.0, "inch": 25.4}[machine_unit]
    table = read_tool_table(tools, unit_mm=unit_mm) if tools is not None else {}
    with progress_bar() as progress:
        progress("read", 0, 1)
        read = read_program(program, tools=table, machine_unit_mm=unit_mm)
    if as_json:
        calls = [{"line": n, "call": name, "arguments": a} for n, name, a in canon_calls(read)]
        print(json.dumps(calls, indent=1))
    else:
        sys.stdout.writelines(f"{line}\n" for line in canon_lines(read))


@app.command()
def view(directory: Annotated[Path, typer.Argument(metavar="DIR", help="a result")]) -> None:
    """Show a result in a window."""
    from vmach.report import open_viewer

    open_viewer(directory)


def _machine(
    job: Path,
    model: Variant,
    variants: tuple[Variant, ...],
    *,
    out: Path | None,
    as_json: bool,
    part_file: Path | None = None,
    prefer_measured: bool = False,
) -> None:
    from vmach.pipeline import machine_part
    from vmach.report import variants_table
    from vmach.results import (
        RESULT_FILES,
        default_folder,
        run_record,
        write_coloured_part,
        write_results,
    )

    out = out or default_folder(job)
    inputs = [file for _, file in read_job(job).files()]
    check_outputs([part_file], inputs=inputs)
    if out.is_dir():
        check_outputs([part_file, *(out / name for name in RESULT_FILES)], inputs=inputs)
    with progress_bar() as progress:
        made = machine_part(
            job, model=model, variants=variants, prefer_measured=prefer_measured, progress=progress
        )
        if part_file is not None:
            write_coloured_part(made, part_file)
        figures = write_results(made, out, command=_command_line(), progress=progress)
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    console = Console()
    console.print(variants_table(made.points, run_record(made, _command_line())))
    for note in figures["run"]["warnings"]:
        console.print(f"note: {note}", highlight=False, markup=False)
    console.print(f"results in {out}: {', '.join(RESULT_FILES)}", highlight=False, markup=False)


def _command_line() -> str:
    return shlex.join(["vmach", *sys.argv[1:]])


def main() -> None:
    """Run the command line; user errors become one message and exit status 1."""
    forget_stale_kernels()
    compile_without_collection()
    try:
        app()
    except BrokenPipeError:  # the reader of a pipe has seen enough
        sys.stderr.close()
        sys.exit(0)
    except (VmachError, ProgramError, StockError) as error:
        print(f"vmach: {error}", file=sys.stderr)
        sys.exit(1)
    except OSError as error:
        print(f"vmach: {error.filename or 'file'}: {error.strerror}", file=sys.stderr)
        sys.exit(1)
