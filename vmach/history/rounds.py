"""Adding in rounds: what a diagnosis shows goes into a new job, until nothing further is shown."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from vmach.diagnosis.diagnose import Diagnosis, diagnose
from vmach.diagnosis.findings import Finding
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import read_effects
from vmach.history.added_effects import add_effects
from vmach.job import read_job

__all__ = ["Round", "Rounds", "add_in_rounds"]

#: rounds at most; each has to find something new
_MOST = 10


@dataclass(frozen=True)
class Round:
    """One job more.

    Attributes
    ----------
    job : Path
    added : tuple of str
    out_of_class : mapping of str to sequence of str
        What was added out of a class, and what it cannot be told from.
    before_um, after_um : float
        Root mean square of measured minus predicted.
    """

    job: Path
    added: tuple[str, ...]
    out_of_class: Mapping[str, Sequence[str]]
    before_um: float
    after_um: float


@dataclass(frozen=True)
class Rounds:
    """All rounds, and where they end.

    Attributes
    ----------
    steps : tuple of Round
    job : Path
        The last one.
    left : Diagnosis
        Of the last job.
    """

    steps: tuple[Round, ...]
    job: Path
    left: Diagnosis


def add_in_rounds(
    job_path: str | Path,
    first: Diagnosis | None = None,
    *,
    tell: Callable[[Round], object] = lambda step: None,
    progress: Callable[[str], object] = lambda stage: None,
) -> Rounds:
    """Add what a diagnosis shows into a new job, diagnose that, and so on.

    Parameters
    ----------
    job_path : path
    first : Diagnosis, optional
        Of that job, where it is known.
    tell : callable, optional
        Told each round as soon as its job is written.
    progress : callable, optional
        Told what begins.

    Raises
    ------
    InputError
        As `survey_job` and `add_effects` do.
    """
    path, steps = Path(job_path), []
    job = read_job(path)
    seen = {effect.label for effect in read_effects(job.effects, file=job.path, job=job)}
    found = first or diagnose(survey_job(path))
    for number in range(1, _MOST + 1):
        new = _new(found, seen)
        if not new:
            break
        progress(f"round {number}, fit")
        path, _ = add_effects(path, [f.label.replace(" ", ":") for f in new])
        seen |= {f.label for f in new}
        steps.append(_round(path, new))
        tell(steps[-1])
        found = diagnose(
            survey_job(path),
            progress=lambda stage, number=number: progress(f"round {number}, {stage}"),
        )
    return Rounds(tuple(steps), path, found)


def _new(found: Diagnosis, seen: Collection[str]) -> Sequence[Finding]:
    """What is shown and not in the job."""
    return [f for f in found.findings if f.effect is not None and f.label not in seen]


def _round(path: Path, new: Sequence[Finding]) -> Round:
    rms = read_job(path).history[-1]
    return Round(
        job=path,
        added=tuple(f.label for f in new),
        out_of_class={f.label: f.indistinct for f in new if f.status == "class"},
        before_um=rms["rms_before_um"],
        after_um=rms["rms_after_um"],
    )
