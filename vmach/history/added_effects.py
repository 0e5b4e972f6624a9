"""Effects fitted to a job's measurements and written into a new job; the old one stays."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.note import Kind, Note
from vmach.diagnosis.named_fit import NamedEffect, fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import label_of
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.history import rms_um
from vmach.history.fitted_before import (
    Key,
    check_new,
    fitted_before,
    without_effects,
    without_tables,
)
from vmach.history.following_job import history_toml, moved_text
from vmach.history.job_text import with_tables
from vmach.history.new_job_files import check_free, write_new_job
from vmach.job import Job, read_job

__all__ = ["add_effects"]

#: of correlation coefficients that are written; what they round to may not contradict itself
_DECIMALS = 3


def add_effects(
    job_path: str | Path,
    effects: Sequence[str],
    *,
    out: Path | None = None,
    tell: Callable[[Note], object] = lambda note: None,
) -> tuple[Path, tuple[NamedEffect, ...]]:
    """Fit effects to a job's measurements and write a job that holds them.

    Effects that the job has from a fit to the same readings are fitted anew with them: one after
    the other, the first would keep what it took of the others.

    Parameters
    ----------
    job_path : path
    effects : sequence of str
        Names, with the target where it matters: ``backlash:X``; without it the target that fits
        best is taken.
    out : Path, optional
        The job file to write; a new name beside the old one where left out.
    tell : callable, optional
        Told what was noticed of the measurements.

    Returns
    -------
    path of the new job, and the effects with their parameters, those that were there first

    Raises
    ------
    InputError
        Unknown effect or target, an effect that the job has already, a file that is there already.
    """
    job = read_job(job_path)
    twice = [name for name in effects if list(effects).count(name) > 1]
    if twice:
        raise InputError(f"{twice[0]} is named twice", accepted="every effect once")
    check_free(out)
    text = read_text(job.path, what="job file")
    for name in effects:
        check_new(job, text, *_parts(name))
    anew = fitted_before(job)
    bare = survey_job(without_effects(job, anew))
    every = fit_named(bare, [*(label_of(*key) for key in anew), *effects])
    found = every[len(anew) :]
    for effect in found:
        check_new(job, text, effect.effect.name, effect.target)
    before = rms_um(survey_job(job) if anew else bare)
    after = rms_um(bare, sum(effect.explained_mm for effect in every))
    tables = "\n".join(_effect_toml(e) for e in every) + "".join(_fitted_toml(e) for e in every)
    tables += "".join(_correlated_toml(e) for e in every)

    def texts(target: Path) -> dict[Path, str]:
        moved = moved_text(text, job.folder, target.parent, file=job.path)
        moved = without_tables(moved, anew, file=job.path)
        more = tables + history_toml(
            job, target.parent, [effect.label for effect in found],
            figures={"rms_before_um": before, "rms_after_um": after},
            effect_files={e.effect.name: e.effect.file for e in found if e.effect.file},
        )  # fmt: skip
        return {target: with_tables(moved, more, file=job.path)}

    target = write_new_job(job.path, texts, out=out)[0]
    for note in (*bare.notes, *_kept_notes(job, anew)):
        tell(note)
    return target, every


def _kept_notes(job: Job, anew: Collection[Key]) -> list[Note]:
    """What was fitted before and is not now, as the effects beside it may have changed it."""
    labels = [label_of(*key) for key in job.fitted if key not in anew]
    said = "{} stays as it was fitted: to other readings, or the job before cannot be read"
    return [Note.plain(Kind.KEPT, said.format(label), place=label) for label in labels]


def _parts(word: str) -> tuple[str, str]:
    """Name and target of an effect that is told as ``NAME:TARGET``."""
    name, _, target = word.replace(" ", ":").partition(":")
    return name, target


def _effect_toml(effect: NamedEffect) -> str:
    """The table of an effect as it stands in a job file."""
    header = f"effects.{effect.effect.name}" + (f".{effect.target}" if effect.target else "")
    lines = [f"[{header}]", *(f"{k} = {_value(v)}" for k, v in effect.parameters.items())]
    return "\n".join(lines) + "\n"


def _fitted_toml(effect: NamedEffect) -> str:
    """What is not known of an effect's parameters: changes of one standard uncertainty each."""
    target = f'target = "{effect.target}"\n' if effect.target else ""
    changes = [
        ", ".join(f"{name} = {_value(v)}" for name, v in change.items() if np.any(v))
        for change in effect.one_sigma
    ]
    rows = "".join(f"    {{{change}}},\n" for change in changes)
    return f'\n[[fitted]]\neffect = "{effect.effect.name}"\n{target}one_sigma = [\n{rows}]\n'


def _correlated_toml(effect: NamedEffect) -> str:
    """How these changes are correlated with those of effects that were fitted with it."""
    text = ""
    own = _word(effect.label)
    for label, coefficients in effect.correlations.items():
        told = np.round(coefficients, _DECIMALS)
        if told.any():
            rows = "".join(f"    {_value(row)},\n" for row in told.tolist())
            text += f'\n[[correlated]]\neffects = ["{_word(label)}", "{own}"]\n'
            text += f"coefficients = [\n{rows}]\n"
    return text


def _word(label: str) -> str:
    """A label as the command line has it: NAME or NAME:TARGET."""
    return label.replace(" ", ":", 1)


def _value(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return f"{value:.6g}"
