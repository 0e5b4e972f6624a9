"""Adding effects to a job, and how the error fell with each of them; nothing is overwritten."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.atomic import atomic_file
from vmach.diagnosis.job_survey import survey_job, survey_part
from vmach.diagnosis.named_fit import NamedEffect, fit_named
from vmach.errors import InputError
from vmach.fit.survey import Survey
from vmach.job import Job, read_job
from vmach.text_file import read_text
from vmach.units import um_from_mm

__all__ = ["Step", "add_effects", "draw_history", "history_of"]

_PATHS = re.compile(
    r"""^(?P<key>\s*(?:machine|program|nominal|measured|file)\s*=\s*)"""
    r"""(?P<quote>["'])(?P<path>(?:(?!(?P=quote)).)+)(?P=quote)""",
    re.MULTILINE,
)


@dataclass(frozen=True)
class Step:
    """One model in the history of a job.

    Attributes
    ----------
    job : Path
    added : tuple of str
        What this model has and the one before had not.
    rms_um : float
        Of measured minus predicted, alignment taken off, on the points that were fitted.
    check_rms_um : float or None
        On a part that nothing was fitted to.
    """

    job: Path
    added: tuple[str, ...]
    rms_um: float
    check_rms_um: float | None


def add_effects(
    job_path: str | Path, effects: Sequence[str], *, out: Path | None = None
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
    for effect in found:
        if _is_there(job.effects, effect):
            raise InputError(
                f"the job has the effect {effect.label} already",
                file=job.path,
                hint="take it out of the job first, or add another one",
            )
    target = out or _free_name(job.path)
    if target.exists():
        raise InputError("file is there already", file=target, hint="choose another name with -o")
    text = _moved(read_text(job.path, what="job file"), job.folder, target.parent)
    before = rms_um(survey)
    after = rms_um(survey, sum(effect.explained_mm for effect in found))
    text = text.rstrip() + "\n\n" + "\n".join(effect_toml(e) for e in found)
    text += "".join(_fitted_toml(e) for e in found)
    text += _history_toml(job.path, target.parent, found, before=before, after=after)
    with atomic_file(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return target, found


def history_of(job_path: str | Path, *, check: Job | None = None) -> list[Step]:
    """The models that led to a job, the first one first, each evaluated anew.

    Parameters
    ----------
    job_path : path
    check : Job, optional
        Another part of the same machine, with its measured points; its own effects do not count.

    Raises
    ------
    InputError
        A job of the history is missing, or goes round in a circle.
    """
    steps: list[Step] = []
    job = read_job(job_path)
    seen: set[Path] = set()
    while True:
        if job.path.resolve() in seen:
            raise InputError("the history goes round in a circle", file=job.path)
        seen.add(job.path.resolve())
        last = job.history[-1] if job.history else {}
        on_other = None if check is None else rms_um(survey_part(check, job))
        steps.append(
            Step(job.path, tuple(last.get("added", ())), rms_um(survey_job(job.path)), on_other)
        )
        if "previous" not in last:
            return steps[::-1]
        job = read_job(job.folder / last["previous"])


def rms_um(survey: Survey, explained_mm: np.ndarray | float = 0.0) -> float:
    """RMS of measured minus predicted minus explained, what the instruments leave free fitted."""
    weight = 1.0 / survey.u_mm
    residual = survey.residual_mm - explained_mm
    solution = np.linalg.lstsq(survey.nuisance * weight[:, None], residual * weight, rcond=None)[0]
    return float(um_from_mm(np.sqrt(np.mean((residual - survey.nuisance @ solution) ** 2))))


def draw_history(steps: Sequence[Step], path: Path) -> None:
    """Draw the fall of the error, model by model, into a PNG file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(5.0, 1.6 + 1.7 * len(steps)), 4.0), layout="constrained")
    axes = figure.add_subplot()
    place = np.arange(len(steps))
    rows = {"points that were fitted": [s.rms_um for s in steps]}
    if all(s.check_rms_um is not None for s in steps):
        rows["another part"] = [s.check_rms_um for s in steps]
    wide = 0.8 / len(rows)
    for k, (label, values) in enumerate(rows.items()):
        bars = axes.bar(
            place + (k - 0.5 * (len(rows) - 1)) * wide, values, 0.92 * wide, label=label
        )
        axes.bar_label(bars, fmt="%.2f", fontsize=8)
    names = ["+ " + "\n+ ".join(s.added) if s.added else s.job.name for s in steps]
    axes.set_xticks(place, names)
    axes.set_axisbelow(True)
    axes.set_ylabel("RMS of measured minus predicted, µm")
    axes.legend()
    axes.grid(alpha=0.3, axis="y")
    with atomic_file(path) as temporary:
        figure.savefig(temporary, format="png", dpi=130)


def effect_toml(effect: NamedEffect) -> str:
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
    rows = "".join(f"    {{{change}}},\n" for change in changes if change)
    return f'\n[[fitted]]\neffect = "{effect.effect.name}"\n{target}one_sigma = [\n{rows}]\n'


def _value(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return f"{value:.6g}"


def _history_toml(
    old: Path, folder: Path, found: Sequence[NamedEffect], *, before: float, after: float
) -> str:
    previous = os.path.relpath(old.resolve(), folder.resolve())
    return (
        "\n[[history]]\n"
        f"previous = {json.dumps(previous)}\n"
        f"added = {json.dumps([effect.label for effect in found])}\n"
        f"rms_before_um = {before:.4g}\n"
        f"rms_after_um = {after:.4g}\n"
    )


def _is_there(effects: Any, new: NamedEffect) -> bool:
    table = effects.get(new.effect.name)
    if table is None:
        return False
    return new.target in table or table.get("target", "") == new.target


def _free_name(path: Path) -> Path:
    number = 2
    stem = re.sub(r"-\d+$", "", path.stem)
    while (candidate := path.with_name(f"{stem}-{number}.toml")).exists():
        number += 1
    return candidate


def _moved(text: str, old: Path, new: Path) -> str:
    """The job's text with its relative paths seen from another folder."""
    if old.resolve() == new.resolve():
        return text

    def rebased(match: re.Match) -> str:
        path = Path(match["path"])
        if not path.is_absolute():
            path = Path(os.path.relpath((old / path).resolve(), new.resolve()))
        return f"{match['key']}{match['quote']}{path.as_posix()}{match['quote']}"

    return _PATHS.sub(rebased, text)
