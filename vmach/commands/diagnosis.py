"""Commands: diagnose, add, set, history."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.base.note import Kind, Note, note_records
from vmach.base.progress import progress_bar
from vmach.base.terminal import console
from vmach.commands.options import (
    HERE,
    AsJson,
    Control,
    JobPath,
    OutDir,
    OwnEffects,
    command_line,
    input_files,
    tell_doubts,
    typed,
)
from vmach.errors import InputError
from vmach.files.atomic import atomic_file, check_folder, check_outputs
from vmach.files.ending import check_ending
from vmach.files.together import together

if TYPE_CHECKING:
    from vmach.diagnosis.diagnose import Diagnosis
    from vmach.diagnosis.named_fit import NamedEffect
    from vmach.history.rounds import Round
    from vmach.job import Job
    from vmach.nominal import Mesh

__all__ = ["add", "diagnose", "history", "set_job_values"]

#: in the folder of results: the diagnosis of the last job that adding in rounds made
_LEFT = "left"


def diagnose(
    job: JobPath = HERE,
    out: OutDir = None,
    json_file: Annotated[Path | None, typer.Option("--json", help="JSON file to write")] = None,
    next_file: Annotated[
        Path | None, typer.Option("--next", help="where to write the next measurement's program")
    ] = None,
    effect_file: OwnEffects = None,
    add_all: Annotated[
        bool, typer.Option("--add-all", help="add what is shown, and go on until nothing is left")
    ] = False,
    rules: Annotated[
        bool, typer.Option("--rules", help="print the numbers that decide a verdict")
    ] = False,
    control: Control = None,
) -> None:
    """Say what the model lacks, from measurements."""
    if rules:
        from vmach.diagnosis.inference.rules import rules_text

        print(rules_text())
        return
    from vmach.diagnosis.diagnose import diagnose as diagnose_survey
    from vmach.diagnosis.report import as_text
    from vmach.diagnosis.residuals.job_survey import survey_job
    from vmach.diagnosis.results import FOLDER_FILES, read_nominal_mesh, write_diagnosis
    from vmach.job import read_job

    _load(effect_file)
    read = read_job(job)
    next_path = next_file or (json_file.with_name("next.nc") if json_file else None)
    inputs = input_files(read)
    check_outputs([json_file, next_path], inputs=inputs)
    if out is not None:
        check_folder(out, FOLDER_FILES, inputs=inputs)
    if out is not None and add_all:
        check_folder(out / _LEFT, FOLDER_FILES, inputs=inputs)
    tell_doubts(read)
    with progress_bar() as progress:
        progress("read", 0, 1)
        survey = survey_job(read)
        nominal = None if out is None else read_nominal_mesh(survey.job)
        found = diagnose_survey(survey, progress=lambda stage: progress(stage, 0, 1))
        with together():
            program = _write_files(found, json_file, next_path, is_named=next_file is not None)
            if out is not None:
                progress("draw", 0, 1)
                written = write_diagnosis(
                    out, found, nominal=nominal, command=command_line(), job=typed(job)
                )
                if found.next_program is not None:
                    program = program or str(out / written[-1])
    print(as_text(found, program=program))
    if add_all:
        _add_all(job, found, out=None if out is None else out / _LEFT, nominal=nominal)
    else:
        _tell_how_to_go_on(job, found)
    if found.next_program is not None and program is None:
        print("--next FILE writes the program of the measurement to do next")
    if next_path is not None:
        _tell_of_program(next_path, found, is_named=next_file is not None)
    if out is None:
        print("--out DIR writes a page with pictures")
    else:
        _tell(out, written, FOLDER_FILES)


def _write_files(
    found: Diagnosis, json_file: Path | None, next_path: Path | None, *, is_named: bool
) -> str | None:
    """Write the single files; returns the name of the next measurement's program.

    It is the path where the user named the file, else the file's name beside the JSON.
    """
    from vmach.diagnosis.report import write_figures

    program = None
    if found.next_program is not None and next_path is not None:
        program = str(next_path) if is_named else next_path.name
        with atomic_file(next_path) as temporary:
            temporary.write_text(found.next_program, encoding="utf-8")
    if json_file is not None:
        write_figures(json_file, found, program=program)
    return program


def _add_all(job: Path, found: Diagnosis, *, out: Path | None, nominal: Mesh | None) -> None:
    """Add what is shown, round by round, each in a job of its own, and say what is left.

    The diagnosis of the last job goes to `out`.
    """
    from vmach.diagnosis.results import FOLDER_FILES, write_diagnosis
    from vmach.history.rounds import add_in_rounds

    made: list[Round] = []
    try:
        with progress_bar() as progress:
            rounds = add_in_rounds(
                job, found, tell=made.append, progress=lambda stage: progress(stage, 0, 1)
            )
    finally:  # whoever stops the rounds has the jobs that are written
        _tell_rounds(made)
    left = rounds.left
    if left.verdict in ("partly", "unknown"):
        print(
            f"nothing further is shown, but {left.remains_um:.2f} um RMS of something else remain "
            "beside noise"
        )
        if left.proposals:
            print(
                f"vmach effects propose {typed(rounds.job)} -o my_effect.py  writes the first form"
            )
    else:
        print("nothing further is shown")
    if not rounds.steps:
        return
    print(f"go on from {rounds.job}, or from any job before it")
    if out is not None:
        written = write_diagnosis(
            out, left, nominal=nominal, command=command_line(), job=typed(rounds.job)
        )
        _tell(out, written, FOLDER_FILES)


def _tell_rounds(steps: Sequence[Round]) -> None:
    for step in steps:
        print(
            f"{step.job}: {', '.join(step.added)}; {step.before_um:.2f} -> {step.after_um:.2f} um"
        )
        for label, others in step.out_of_class.items():
            print(f"  {label} was chosen out of a class: it may as well be {', '.join(others)}")


def _tell_how_to_go_on(job: Path, found: Diagnosis) -> None:
    """The commands that add what is shown, and write a form for what is not."""
    from vmach.diagnosis.report import words_of_add

    if effects := words_of_add(found):
        print(f"to add this to the model: vmach add {typed(job)} {effects}")
    if found.proposals:
        print(f"to write form 1 as an effect: vmach effects propose {typed(job)} -o my_effect.py")


def _tell_of_program(path: Path, found: Diagnosis, *, is_named: bool) -> None:
    """Say that a file for the next measurement's program is not of this diagnosis."""
    if found.next_program is not None:
        return
    if path.exists():
        print(f"{path} is from an earlier diagnosis; this one calls for no such program")
    elif is_named:
        print(f"no program of a next measurement is called for; {path} was not written")


def _tell(out: Path, written: Sequence[str], possible: Sequence[str]) -> None:
    """Say what lies in the folder now, also what an earlier diagnosis left there."""
    print(f"results in {out}: {', '.join(written)}")
    for name in possible:
        if name not in written and (out / name).exists():
            print(f"{out / name} is from an earlier diagnosis; this one calls for no measurement")


def add(
    job: JobPath,
    effects: Annotated[list[str], typer.Argument(metavar="EFFECT...", help="NAME or NAME:TARGET")],
    out: Annotated[Path | None, typer.Option("-o", "--out", help="job file to write")] = None,
    effect_file: OwnEffects = None,
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Fit effects and write a new job that has them."""
    from vmach.diagnosis.gates.impossible_sizes import impossible_size_notes
    from vmach.history.added_effects import add_effects
    from vmach.job import read_job

    _load(effect_file)
    check_outputs([out])
    check_ending(out, [".toml"], what="a job")
    with progress_bar() as progress:
        progress("fit", 0, 1)
        notes: list[Note] = []
        path, found = add_effects(job, effects, out=out, tell=notes.append)
    rms = read_job(path).history[-1]
    for effect in found:
        if not effect.is_called_for:
            place = effect.label
            said = f"these measurements do not call for {place}: noise alone would give it as much"
            notes.append(Note.plain(Kind.NOT_CALLED_FOR, said, place=place))
    notes += impossible_size_notes(found)
    if as_json:
        rows = [
            {
                "effect": e.effect.name,
                "target": e.target or None,
                "parameters": e.parameters,
                "u": e.u,
                "fitted_anew": e.label not in rms["added"],
            }
            for e in found
        ]
        fall = {"before": rms["rms_before_um"], "after": rms["rms_after_um"]}
        told = {"job": str(path), "effects": rows, "rms_um": fall}
        told |= {"notes": [str(note) for note in notes], "note_records": note_records(notes)}
        print(json.dumps(told, indent=1))
        return
    for effect in found:
        anew = " (fitted anew with it)" * (effect.label not in rms["added"])
        print(f"{effect.label}{anew}: {_values(effect)}")
    print(
        f"RMS of measured minus predicted: {rms['rms_before_um']:.2f} um before, "
        f"{rms['rms_after_um']:.2f} um after"
    )
    for note in notes:
        print(f"note: {note}")
    print(f"{path} holds the added effects; {job} is unchanged")


def _values(effect: NamedEffect) -> str:
    """Fitted numbers with their standard uncertainties; of a curve, where it is not zero."""
    from vmach.diagnosis.words import where_component

    if any(isinstance(value, list) for value in effect.parameters.values()):
        where = where_component(effect.parameters, effect.u, effect.target)
        return f"a correction curve, {where}"
    return ", ".join(
        f"{name} = {value:.4g} (u = {effect.u[name]:.2g})"
        for name, value in effect.parameters.items()
    )


def set_job_values(
    job: JobPath,
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME=VALUE...",
            help="backlash:Y.reversal_um=5, EXX=TABLE.csv or EXX.measured_at_mm=X,Y,Z",
        ),
    ] = None,
    effects_of: Annotated[
        Path | None, typer.Option(help="job of another part, whose effects JOB is to have")
    ] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="job file to write")] = None,
    effect_file: OwnEffects = None,
    as_json: AsJson = False,
) -> None:
    """Write a job with other sizes of effects, or other tables of its machine."""
    from vmach.history.set_values import set_values

    _load(effect_file)
    check_outputs([out])
    check_ending(out, [".toml"], what="a job")
    if effects_of is not None:
        _take_effects(effects_of, job, values, out=out, as_json=as_json)
        return
    written, machine = set_values(job, values or [], out=out)
    if as_json:
        told = {"job": str(written), "machine": machine and str(machine)}
        print(json.dumps(told))
        return
    print(f"{written} has the new values; {job} is unchanged")
    if machine is not None:
        print(f"its machine is {machine}")


def _take_effects(
    other: Path, job: Path, values: list[str] | None, *, out: Path | None, as_json: bool
) -> None:
    """Write a job with the effects of another part's, and tell which these are."""
    from vmach.history.taken_effects import take_effects_of

    if values:
        raise InputError(
            f"--effects-of, and {values[0]}",
            accepted="either of them",
            hint="set the values of the job that has the effects",
        )
    written, taken, left = take_effects_of(other, job, out=out)
    if as_json:
        left_out = [{"effect": one.label, "why": one.why} for one in left]
        print(json.dumps({"job": str(written), "effects": list(taken), "left_out": left_out}))
        return
    print(f"{written} has {', '.join(taken)}, as {other}; {job} is unchanged")
    for one in left:
        print(f"left out: {one.label}: {one.why}")


def history(
    job: JobPath = HERE,
    check_job: Annotated[
        Path | None, typer.Option(help="job of another part, measured; nothing is fitted to it")
    ] = None,
    check_program: Annotated[
        Path | None, typer.Option(help="or its program, where all else is as in JOB")
    ] = None,
    check_points: Annotated[Path | None, typer.Option(help="and its measured points")] = None,
    picture: Annotated[Path | None, typer.Option(help="PNG file to draw")] = None,
    as_json: AsJson = False,
    effect_file: OwnEffects = None,
    control: Control = None,
) -> None:
    """Show how the error fell from job to job."""
    from vmach.history import draw_history, history_of
    from vmach.history.printing import history_table
    from vmach.job import read_job

    _load(effect_file)
    read = read_job(job)
    check = _other_part(read, check_job, check_program, check_points)
    picture = picture or (job if job.is_dir() else job.parent) / "history.png"
    check_outputs([picture], inputs=input_files(read))
    check_ending(picture, [".png"], what="the picture")
    with progress_bar() as progress:
        progress("evaluate", 0, 1)
        steps = history_of(read, check=check)
    draw_history(steps, picture)
    if as_json:
        rows = [
            {
                "job": s.job.name,
                "added": list(s.added),
                "rms_um": s.rms_um,
                "check_rms_um": s.check_rms_um,
                "held_out_um": s.held_out_um,
                "notes": [str(note) for note in s.notes],
                "note_records": note_records(s.notes),
            }
            for s in steps
        ]
        print(json.dumps(rows, indent=1))
        return
    console().print(history_table(steps, is_checked=check is not None))
    for note in steps[-1].notes:
        print(f"note: {note}")
    print(f"drawn in {picture}")


def _other_part(
    job: Job, other: Path | None, program: Path | None, points: Path | None
) -> Job | None:
    """The job of the part to check on, from its own file or as another program of `job`."""
    from vmach.job import read_job

    if other is not None and (program is not None or points is not None):
        raise typer.BadParameter("--check-job brings its own program and points")
    if (program is None) != (points is None):
        raise typer.BadParameter("--check-program and --check-points go together")
    if other is not None:
        return read_job(other)
    if program is None:
        return None
    return replace(job, program=program, measured=points)


def _load(files: list[Path] | None) -> None:
    from vmach.effects import load_effect_file

    for file in files or []:
        load_effect_file(file)
