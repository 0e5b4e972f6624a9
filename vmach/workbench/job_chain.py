"""The chain of jobs that led to the open one, and on from it, as their files say."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

__all__ = ["ChainStep", "job_chain"]

#: jobs of a chain that are looked at
_MOST = 60


@dataclass(frozen=True)
class ChainStep:
    """One job of a chain.

    Attributes
    ----------
    job : Path
    added : tuple of str
    before_um, after_um : float or None
        RMS of measured minus predicted, before and after what was added.
    effect_files : dict of str to Path
        Where the effects of the user's own are.
    is_later : bool
        Whether it came after the open job, which it goes on from.
    """

    job: Path
    added: tuple[str, ...]
    before_um: float | None
    after_um: float | None
    effect_files: dict[str, Path]
    is_later: bool = False


def job_chain(job: Path) -> list[ChainStep]:
    """The chain, the first job first; the open one is the last that is not later.

    A job that cannot be read ends the chain: whoever opens it is told why.
    """
    earlier: list[ChainStep] = []
    path: Path | None = job.resolve()
    while path is not None and path not in [step.job for step in earlier] and len(earlier) < _MOST:
        step, path = _step(path)
        earlier.append(step)
    return earlier[::-1] + _later(job.resolve(), {step.job for step in earlier})


def _later(job: Path, known: set[Path]) -> list[ChainStep]:
    """The newest chain of jobs beside it that go on from it."""
    following: dict[Path, list[Path]] = {}
    for path in sorted(job.parent.glob("*.toml")):
        _, previous = _step(path)
        if previous is not None and path.resolve() not in known:
            following.setdefault(previous, []).append(path.resolve())
    found: list[ChainStep] = []
    while job in following and len(found) < _MOST:
        job = max(following.pop(job), key=lambda path: path.stat().st_mtime_ns)
        step, _ = _step(job)
        found.append(ChainStep(step.job, step.added, step.before_um, step.after_um,
                               step.effect_files, is_later=True))  # fmt: skip
    return found


def _step(job: Path) -> tuple[ChainStep, Path | None]:
    """What a job's file says of itself, and the job before it."""
    last = _last_of_history(job)
    previous = last.get("previous")
    files = {str(n): job.parent / str(f) for n, f in dict(last.get("effect_files", {})).items()}
    step = ChainStep(job, tuple(map(str, last.get("added", ()))), last.get("rms_before_um"),
                     last.get("rms_after_um"), files)  # fmt: skip
    return step, (job.parent / previous).resolve() if isinstance(previous, str) else None


def _last_of_history(job: Path) -> dict[str, Any]:
    try:
        history = tomllib.loads(job.read_text(encoding="utf-8")).get("history", [])
    except (OSError, ValueError):
        return {}
    return history[-1] if isinstance(history, list) and history else {}
