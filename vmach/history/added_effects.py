"""Effects fitted to a job's measurements and written into a new job; the old one stays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.note import Note
from vmach.diagnosis.named_fit import NamedEffect, fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.history import rms_um
from vmach.history.following_job import history_toml, moved_text
from vmach.history.job_text import with_tables
from vmach.history.new_job_files import write_and_read
from vmach.job import free_job_name, read_job

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
    path of the new job, and the effects with their parameters

    Raises
    ------
    InputError
        Unknown effect or target, an effect that the job has already, a file that is there already.
    """
    job = read_job(job_path)
    twice = [name for name in effects if list(effects).count(name) > 1]
    if twice:
        raise InputError(f"{twice[0]} is named twice", accepted="every effect once")
    survey = survey_job(job.path)
    found = fit_named(survey, effects)
    text = read_text(job.path, what="job file")
    for effect in found:
        if _is_there(job.effects, effect):
            raise InputError(
                f"the job has the effect {effect.label} already",
                file=job.path,
                line=line_of_key(text, ["effects", effect.effect.name, effect.target]),
                hint="take it out of the job first, or go on from the job before it",
            )
    target = out or free_job_name(job.path)
    if target.exists():
        raise InputError("file is there already", file=target, hint="choose another name with -o")
    text = moved_text(text, job.folder, target.parent, file=job.path)
    before = rms_um(survey)
    after = rms_um(survey, sum(effect.explained_mm for effect in found))
    more = "\n".join(_effect_toml(e) for e in found) + "".join(_fitted_toml(e) for e in found)
    more += "".join(_correlated_toml(e) for e in found)
    more += history_toml(
        job, target.parent, [effect.label for effect in found],
        figures={"rms_before_um": before, "rms_after_um": after},
        effect_files={e.effect.name: e.effect.file for e in found if e.effect.file},
    )  # fmt: skip
    text = with_tables(text, more, file=job.path)
    write_and_read({target: text}, target, old=job.path)
    for note in survey.notes:
        tell(note)
    return target, found


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


def _is_there(effects: Mapping[str, Any], new: NamedEffect) -> bool:
    table = effects.get(new.effect.name)
    if table is None:
        return False
    return new.target in table or table.get("target", "") == new.target
