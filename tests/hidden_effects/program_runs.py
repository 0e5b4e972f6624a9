"""The program from outside: its commands and the files that they write, nothing else."""

from __future__ import annotations

import io
import json
import subprocess
import sys
import time
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np

from vmach.cli import main

from .part import Part
from .shares import alignment_columns

__all__ = [
    "add",
    "aligned_rms_um",
    "diagnose",
    "held_out",
    "left_by_proposal",
    "misfits_um",
    "predicted_um",
    "share_foretold",
]


def _vmach(*words: object) -> str:
    """The command line's own entry, in this process: starting Python costs more than asking."""
    told = io.StringIO()
    argv, sys.argv = sys.argv, ["vmach", *map(str, words)]
    try:
        with redirect_stdout(told), redirect_stderr(told):
            main()
    except SystemExit as end:
        if end.code:
            raise RuntimeError(f"vmach {words[0]}: exit {end.code}\n{told.getvalue()}") from None
    finally:
        sys.argv = argv
    return told.getvalue()


def diagnose(folder: Path) -> tuple[dict, float]:
    """Report, and seconds that it took."""
    start, out = time.perf_counter(), folder / "diagnosis.json"
    _vmach("diagnose", folder / "job.toml", "--json", out)
    return json.loads(out.read_text()), time.perf_counter() - start


def add(folder: Path, report: dict) -> Path:
    """Put what was named into a new job beside the old one."""
    job = folder / "job_added.toml"
    job.unlink(missing_ok=True)
    effects = [
        f"{e['effect']}:{e['target']}" if e["target"] else e["effect"] for e in report["effects"]
    ]
    _vmach("add", folder / "job.toml", *effects, "-o", job)
    return job


def left_by_proposal(folder: Path, share_um: np.ndarray, part: Part) -> float:
    """Share of what a cause does to the check part that the first form proposed does not foretell.

    Free of noise, and of what the calibration does not know. Infinite where the cause does nothing
    there, and the form something.

    share_um : what the cause alone does to the points of the check part
    """
    without, with_it = _with_proposal(folder / "job.toml")
    left = aligned_rms_um(share_um - (with_it - without), part)
    whole = aligned_rms_um(share_um, part)
    if whole == 0.0:
        return 0.0 if left == 0.0 else np.inf
    return left / whole


def misfits_um(job: Path, true_um: np.ndarray, part: Part) -> tuple[float, float]:
    """Misfit of the check part, free of noise, without and with the first form that is proposed."""
    without, with_it = _with_proposal(job)
    return aligned_rms_um(true_um - without, part), aligned_rms_um(true_um - with_it, part)


def _with_proposal(job: Path) -> tuple[np.ndarray, np.ndarray]:
    """What is foretold of the check part, without and with the first form that is proposed, um.

    In a process of its own: an effect that was loaded would be a candidate of the next diagnosis.
    """
    folder = job.parent
    command = [sys.executable, "-c", f"from {__name__} import _propose; _propose()", job]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise RuntimeError(ended.stderr)
    tables = (
        np.genfromtxt(folder / name, delimiter=",", names=True, dtype=None, encoding="utf-8")
        for name in _FORETOLD
    )
    without, with_it = (table["deviation_um"] for table in tables)
    return without, with_it


#: what the check part would be without and with a form that is proposed
_FORETOLD = ("check_without.csv", "check_with.csv")


def _propose() -> None:
    """Add what is proposed for the job of the command line, and foretell the check part."""
    job = Path(sys.argv[-1])
    folder = job.parent
    more, file = folder / "job_proposed.toml", folder / "proposed_form.py"
    _vmach("effects", "propose", job, "-o", file)
    _vmach("add", job, file.stem, "--effect-file", file, "-o", more)
    for one, out in zip((job, more), _FORETOLD, strict=True):
        points, program = folder / "check_measured.csv", folder / "check.nc"
        _vmach("predict", one, "--points", points, "--program", program, "-o", folder / out)


def predicted_um(
    job: Path, points: Path, *, program: Path | None = None, model: str = "abbe"
) -> np.ndarray:
    """Measured minus predicted deviation of every point that the program says it cut, um."""
    return _residual_and_u_um(job, points, program=program, model=model)[0]


def _residual_and_u_um(job: Path, points: Path, *, program: Path | None, model: str = "abbe"):
    """Measured minus predicted, and the standard uncertainty of that difference, um."""
    told = _predicted(job, points, program=program, model=model)
    rows = np.genfromtxt(points, delimiter=",", names=True, dtype=None, encoding="utf-8")
    measured = sum((rows["m" + a] - rows[a]) * rows[b] for a, b in zip("xyz", "ijk", strict=True))
    return measured * 1e3 - told["deviation_um"], np.hypot(rows["u_um"], told["u_um"])


def _predicted(job: Path, points: Path, *, program: Path | None, model: str) -> np.ndarray:
    out = points.with_suffix(f".{job.stem}.{model}.csv")
    extra = ["--program", program] if program else []
    _vmach("predict", job, "--points", points, "--model", model, "-o", out, *extra)
    told = np.genfromtxt(out, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert set(told["status"]) == {"cut"}
    return told


def share_foretold(job: Path, true_um: np.ndarray) -> float:
    """Share of the check part's points whose true deviation lies in the 95 % interval foretold.

    Nothing is aligned: this asks for the whole of the tables' uncertainty.
    """
    points, program = job.with_name("check_measured.csv"), job.with_name("check.nc")
    told = _predicted(job, points, program=program, model="abbe")
    return float(np.mean(np.abs(told["deviation_um"] - true_um) < 1.96 * told["u_um"]))


def held_out(job: Path, part: Part) -> tuple[float, float]:
    """How a job foretells the check part beside it, which was not fitted.

    Returns
    -------
    rms_um : what is left after the part's own alignment
    share : of the points within their 95 % intervals
    """
    points, program = job.with_name("check_measured.csv"), job.with_name("check.nc")
    residual, u = _residual_and_u_um(job, points, program=program)
    left = _aligned(residual, part)
    return float(np.sqrt(np.mean(left**2))), float(np.mean(np.abs(left) < 1.96 * u))


def aligned_rms_um(residual_um: np.ndarray, part: Part) -> float:
    """RMS after the six numbers of the part's alignment."""
    return float(np.sqrt(np.mean(_aligned(residual_um, part) ** 2)))


def _aligned(residual_um: np.ndarray, part: Part) -> np.ndarray:
    columns = alignment_columns(part)
    return residual_um - columns @ np.linalg.lstsq(columns, residual_um, rcond=None)[0]
