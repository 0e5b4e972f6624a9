"""Adding in rounds: what a diagnosis shows goes into a new job, until nothing further is shown."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.history.added_effects import add_effects
from vmach.job import read_job

__all__ = ["Round", "rounds"]

#: rounds at most; each has to find something new
_MOST = 10


@dataclass(frozen=True)
class Round:
    """One job more.

    Attributes
    ----------
    job : Path
    added : tuple of str
    before_um, after_um : float
        Root mean square of measured minus predicted.
    """

    job: Path
    added: tuple[str, ...]
    before_um: float
    after_um: float


def rounds(job_path: str | Path) -> Iterator[Round]:
    """Diagnose, add what is shown into a new job, and go on from there.

    Raises
    ------
    InputError
        As `survey_job` and `add_effects` do.
    """
    path = Path(job_path)
    seen: set[str] = {label for label in _of_job(path)}
    for _ in range(_MOST):
        found = diagnose(survey_job(path))
        new = [f for f in found.findings if f.effect is not None and f.label not in seen]
        if not new:
            return
        path, _ = add_effects(path, [f.label.replace(" ", ":") for f in new])
        seen |= {f.label for f in new}
        last = read_job(path).history[-1]
        labels = tuple(f.label for f in new)
        yield Round(path, labels, last["rms_before_um"], last["rms_after_um"])


def _of_job(path: Path) -> Iterator[str]:
    """Labels of the effects that a job has already."""
    from vmach.effects import read_effects

    job = read_job(path)
    for effect in read_effects(job.effects, file=job.path, job=job):
        yield effect.label
