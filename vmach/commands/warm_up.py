"""``vmach warm-up``: the compiler's work, done before somebody waits for a result."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from vmach.base.kernel_cache import is_cold

__all__ = ["tell_if_cold", "warm_up"]

#: commands that look for edges, which takes longest to compile
_COMPILING = {"run", "compare", "predict", "diagnose", "add", "history", "compensate"}

#: a pocket and what was measured on it: small, and every kernel of a run is asked for
_FILES = {
    "job.toml": """\
schema = 1
machine = "machine.toml"
program = "part.nc"
measured = "points.csv"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [-30, -30, -20]
max_mm = [30, 30, 0]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
""",
    "machine.toml": """\
schema = 1
name = "warm-up"
chain = "t (C) Z Y b X' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 12000
tool_change_s = 5
[errors.EXX]
table = "EXX.csv"
[axes.X]
travel_mm = [-400, 0]
[axes.Y]
travel_mm = [-300, 0]
[axes.Z]
travel_mm = [-300, 0]
""",
    "EXX.csv": "position_mm,forward_um,backward_um\n-400,0,1\n-200,2,3\n0,4,5\n",
    "part.nc": """\
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X0 Y0 Z5
G1 Z-8 F300
G1 X-15 Y-10 F900
G1 X15
G2 X15 Y10 I0 J10
G1 X-15
G1 Y-10
G0 Z5
M30
""",
    "points.csv": "id,feature,x,y,z,i,j,k,mx,my,mz\n"
    + "".join(
        f"{k},floor,{k - 8},-10,-8,0,0,1,{k - 8},-10,{-8 + 1e-3 * (k * 7 % 5):.3f}\n"
        for k in range(16)
    ),
}


def warm_up() -> None:
    """Compile everything that vmach compiles: once after an installation or an update."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in _FILES.items():
            (folder / file).write_text(text, encoding="utf-8")
        for what, work in (("a machined part", _machine), ("a diagnosis", _diagnose)):
            print(f"compiling what {what} needs ...", flush=True)
            work(folder)
    print(f"ready after {time.monotonic() - start:.0f} s")


def _machine(folder: Path) -> None:
    from vmach.run.pipeline import machine_part
    from vmach.run.results import write_results

    write_results(machine_part(folder), folder / "out", command="vmach warm-up")


def _diagnose(folder: Path) -> None:
    from vmach.diagnosis.diagnose import diagnose
    from vmach.diagnosis.residuals.job_survey import survey_job

    diagnose(survey_job(folder))


def tell_if_cold(command: str | None) -> None:
    """Say on a terminal why the first command takes longer than the next.

    Where standard error is no terminal nobody waits, and a message of an error stands alone.
    """
    if not sys.stderr.isatty():
        return
    if command in _COMPILING and not {"-h", "--help"} & set(sys.argv) and is_cold():
        print(
            "vmach: compiling first, once after an installation or an update, up to a minute; "
            "vmach warm-up does it beforehand",
            file=sys.stderr,
        )
