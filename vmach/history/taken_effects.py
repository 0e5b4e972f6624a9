"""Effects that were found on one part, in the job of another part of the same machine."""

from __future__ import annotations

import tomllib
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from gcode import WORK_OFFSETS
from vmach.effects import EffectInstance, read_effects
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.history.fitted_before import Key, check_new, take_effects
from vmach.history.following_job import history_toml, moved_path, moved_text
from vmach.history.job_text import take_fits, with_tables
from vmach.history.new_job_files import write_new_job
from vmach.job import Job, JobTool, read_job
from vmach.job.path_keys import change_paths

__all__ = ["LeftOut", "take_effects_of"]

#: tables of a job that say what effects it has
_OF_EFFECTS = ("effects", "fitted", "correlated")


@dataclass(frozen=True)
class LeftOut:
    """An effect that belongs to the part that was measured, and why."""

    label: str
    why: str


def take_effects_of(
    other_path: str | Path, job_path: str | Path, *, out: Path | None = None
) -> tuple[Path, tuple[str, ...], tuple[LeftOut, ...]]:
    """Write a job with the effects of another one, and how well they are known.

    What belongs to the other part stays there: what began at one moment, errors of tools and work
    offsets that are others here.

    Parameters
    ----------
    other_path : path
        The job of the part that was measured.
    job_path : path
        The job of another part.
    out : Path, optional
        The job file to write; a new name beside the old one where left out.

    Returns
    -------
    path of the new job, names and targets of the effects it has, and those that were left out

    Raises
    ------
    InputError
        The other job has no effects, or none for this part; the machine is another one; the job
        has one of them already; a file that is there already.
    """
    other, job = read_job(other_path), read_job(job_path)
    _check_machine(other, job)
    every = read_effects(other.effects, file=other.path, job=other)
    if not every:
        raise InputError(
            "the job has no effects", file=other.path, accepted="a job that 'vmach add' wrote"
        )
    reasons = {(one.effect.name, one.target): _why_not(one, other, job) for one in every}
    left = [LeftOut(one.label, why) for one in every if (why := reasons[_key(one)])]
    taken = [one for one in every if not reasons[_key(one)]]
    if not taken:
        said = "; ".join(f"{one.label}: {one.why}" for one in left)
        raise InputError(f"none of its effects acts on {job.path}: {said}", file=other.path)
    text = read_text(job.path, what="job file")
    for one in taken:
        check_new(job, text, *_key(one))
    own = {one.effect.name: one.effect.file for one in taken if one.effect.file}

    def texts(target: Path) -> dict[Path, str]:
        moved = moved_text(text, job.folder, target.parent, file=job.path)
        more = _tables(other, [key for key, why in reasons.items() if why], target.parent)
        more += history_toml(job, target.parent, [one.label for one in taken], effect_files=own)
        return {target: with_tables(moved, more, file=job.path)}

    written = write_new_job(job.path, texts, out=out)[0]
    return written, tuple(one.label for one in taken), tuple(left)


def _key(one: EffectInstance) -> Key:
    return one.effect.name, one.target


def _check_machine(other: Job, job: Job) -> None:
    """Complain where the effects are those of another machine."""
    files = [one.machine_path.resolve() for one in (other, job)]
    if files[0] != files[1] and files[0].read_bytes() != files[1].read_bytes():
        raise InputError(
            f"the machine of {other.path} is another file, {other.machine_path}",
            file=job.path,
            line=line_of_key(read_text(job.path, what="job file"), ["machine"]),
            accepted="jobs of one machine",
        )


def _why_not(one: EffectInstance, other: Job, job: Job) -> str | None:
    """Why an effect of another part does not act on this one; None where it does."""
    effect, target = one.effect, one.target
    if effect.is_sudden:
        return "it began at one moment of that part"
    if target not in effect.possible_targets(job):
        return f"this job has no {target}" if target else "this job has nothing that it acts on"
    number = int(target[1:]) if target[:1] == "T" and target[1:].isdigit() else None
    if number is not None and _size(other.tools[number]) != _size(job.tools[number]):
        return f"{target} is another tool here"
    if target in WORK_OFFSETS and not _is_same_offset(target, other, job):
        return f"{target} was set anew"
    return None


def _size(tool: JobTool) -> tuple[float, float, int | None]:
    """What tells one tool from another of its number."""
    return tool.diameter_mm, tool.length_mm, tool.flutes


def _is_same_offset(name: str, other: Job, job: Job) -> bool:
    return tuple(other.work_offsets_mm[name]) == tuple(job.work_offsets_mm[name])


def _tables(other: Job, left: Collection[Key], folder: Path) -> str:
    """Effects of a job, and how well they are known, as another folder names their files."""
    said = tomllib.loads(read_text(other.path, what="job file"))
    data: dict[str, Any] = {key: said[key] for key in _OF_EFFECTS if key in said}
    take_effects(data["effects"], left)
    take_fits(data, left)
    change_paths(data, lambda name: moved_path(name, other.folder, folder))
    return tomlkit.dumps(data)
