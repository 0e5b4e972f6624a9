"""Commands: effects list, show, new, check, propose."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.commands.options import HERE, Control, JobPath

if TYPE_CHECKING:
    from vmach.effects import Effect, Parameter

__all__ = ["effects_app"]

effects_app = typer.Typer(
    help="List, show, write, check and propose physical effects.", no_args_is_help=True
)

#: effects that are told as looking alike, at most
_MOST_TOLD = 8
#: a usual size that moves the tool by less (mm) is hardly meant
_VERY_LITTLE_MM = 1e-6
#: what a user should be told of every effect
_WORDS = ("law", "shows_as", "usual_size", "confirm", "cure", "source")


@effects_app.command("list")
def list_effects() -> None:
    """List all effects with their targets and parameters."""
    from vmach.effects import catalogue

    for effect in catalogue().values():
        targets = " ".join(filter(None, effect.targets))
        print(f"{effect.name}  {targets}".rstrip())
        print(f"    {effect.title}; usual: {effect.usual_size}")
        print(f"    {', '.join(p.name for p in effect.parameters)}")


@effects_app.command()
def show(
    name: Annotated[str, typer.Argument(metavar="NAME", help="as 'effects list' has it")],
) -> None:
    """Show the law of an effect, its parameters, how to confirm it and what cures it."""
    from vmach.effects import catalogue
    from vmach.effects.catalogue import unknown_effect_hint
    from vmach.errors import InputError

    if name not in catalogue():
        raise InputError(
            f"unknown effect '{name}'",
            accepted=", ".join(catalogue()),
            hint=unknown_effect_hint(name),
        )
    effect = catalogue()[name]
    print(f"{effect.name}: {effect.title}")
    for word in _WORDS:
        if said := getattr(effect, word):
            print(f"    {word.replace('_', ' ')}: {said}")
    for parameter in effect.parameters:
        print(f"    {_told(parameter)}")


@effects_app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="lower_case_name")],
    folder: Annotated[Path, typer.Option(help="where to write it")] = Path("."),
) -> None:
    """Write a file to start an effect of your own from."""
    from vmach.effects.skeleton import write_skeleton

    path = write_skeleton(name, folder)
    print(f"{path}: edit it, then  vmach diagnose JOB --effect-file {shlex.quote(str(path))}")


@effects_app.command()
def check(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Python file with an effect")],
    job: Annotated[
        Path | None,
        typer.Option(help="measured job: what its readings cannot tell the effect from"),
    ] = None,
    control: Control = None,
) -> None:
    """Check the file of an effect of your own."""
    from vmach.base.units import um_from_mm
    from vmach.diagnosis.residuals.job_survey import survey_job
    from vmach.effects import load_effect_file
    from vmach.effects.law_check import largest_displacement_mm
    from vmach.effects.trial_path import trial_path
    from vmach.fit.alike import alike_effects, trial_survey

    with progress_bar() as progress:
        progress("check", 0, 1)
        effect = load_effect_file(file)
        largest_mm = largest_displacement_mm(effect, trial_path())
        survey = trial_survey() if job is None else survey_job(job)
        found = alike_effects(survey, effect)
    print(f"{effect.name}: {effect.title}")
    for parameter in effect.parameters:
        print(f"    {_told(parameter)}")
    where = f"{len(trial_path())} states of the trial part"
    print(f"law: finite, (P, 3) mm, in proportion to its amplitudes, zero without them ({where})")
    print(f"size: up to {um_from_mm(largest_mm):.3g} um there at the usual size")
    rows = "the readings of the job" if job else "surfaces and tool tip of the trial part"
    if not found:
        print(f"looks like no other effect ({rows})")
    for one in found[:_MOST_TOLD]:
        target = f" {one.target}" if one.target else ""
        print(
            f"hard to tell from {one.label}, which leaves {100 * one.share_left:.0f} % of "
            f"{effect.name}{target} ({rows})"
        )
    for note in _notes(effect, largest_mm):
        print(f"note: {note}")


@effects_app.command()
def propose(
    *,
    job: JobPath = HERE,
    out: Annotated[Path, typer.Option("-o", "--out", help="Python file to write")],
    number: Annotated[int, typer.Option(min=1, help="which of the proposals")] = 1,
    control: Control = None,
) -> None:
    """Write a form for what no effect explains, as a file."""
    import re

    from vmach.diagnosis.diagnose import diagnose
    from vmach.diagnosis.proposals.effect_text import effect_text
    from vmach.diagnosis.residuals.job_survey import survey_job
    from vmach.errors import InputError
    from vmach.files.atomic import atomic_file, check_outputs

    check_outputs([out])
    name = out.stem
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name) or out.suffix != ".py":
        raise InputError(
            f"'{out.name}' cannot be the file of an effect",
            accepted="lower-case words joined by underscores, and .py",
        )
    if out.exists():
        raise InputError("file is there already", file=out, hint="choose another name with -o")
    with progress_bar() as progress:
        progress("diagnose", 0, 1)
        found = diagnose(survey_job(job))
    for k, one in enumerate(found.proposals, 1):
        print(f"{k}: {one.words} (log odds {one.odds:.0f})")
    if len(found.proposals) < number:
        raise InputError(
            f"there are {len(found.proposals)} proposals for this job",
            file=job,
            hint="forms are proposed where the verdict is unknown or partly",
        )
    with atomic_file(out, is_new=True) as temporary:
        temporary.write_text(effect_text(found.proposals[number - 1], name=name), encoding="utf-8")
    command = f"vmach add {shlex.quote(str(job))} {name} --effect-file {shlex.quote(str(out))}"
    print(f"{out}: proposal {number}; look at it, then  {command}")


def _told(parameter: Parameter) -> str:
    kind = "amplitude" if parameter.is_linear else "inner"
    return (
        f"{parameter.name}: {parameter.meaning}; {kind}, usual {parameter.usual:g}, "
        f"accepted {parameter.low:g} .. {parameter.high:g}"
    )


def _notes(effect: Effect, largest_mm: float) -> list[str]:
    """What is no mistake, but might have been meant otherwise."""
    from vmach.effects.declaration import has_unit

    notes = [f"{p.name} ends in no unit" for p in effect.parameters if not has_unit(p.name)]
    notes += [f"'{word}' is empty" for word in _WORDS if not getattr(effect, word)]
    if largest_mm < _VERY_LITTLE_MM:
        notes.append("it moves nothing on the trial part: is a factor missing? 1 um is 1e-3 mm")
    return notes
