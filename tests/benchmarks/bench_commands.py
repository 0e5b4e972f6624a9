"""Whole commands as a user types them: clock, processor, peak memory and growth with the program.

    python tests/benchmarks/bench_commands.py [--lines 1000 10000 100000] [--points 10000]
        [--programs raster cam] [--commands path predict compensate run canon] [--limit-s 600]
        [--control sinumerik]

Every command runs in a process of its own, in a folder of its own. ``raster`` is plain motion, a
ball-nose cutter over a wavy floor; ``cam`` is what a CAM system writes: three tools, roughing by
arcs, F and S words, comments, drilling cycles, then a raster. Peers get the same program in the
same run where they are installed: LinuxCNC's ``rs274`` (it reads and says moves, no more),
FreeCAD's simulator beside ``run`` (a map of heights), and OpenCAMLib beside ``predict`` of the
raster (what a ball leaves, at the same points, without any error). ``growth`` is the exponent of
the processor's time between two sizes, less that of the same command with a few lines, as imports
would hide it. A size that passes the limit ends, and larger ones are left out. Kernels are compiled
before anything is timed.
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from programs_of_controls import CONTROLS, written_for

ROOT = Path(__file__).parents[2]
MACHINE = ROOT / "samples" / "iso10791_7" / "machine.toml"
SAMPLE = ROOT / "samples" / "iso10791_7" / "job.toml"
MEASURED = ROOT / "samples" / "missing_effect" / "job.toml"

JOB = """schema = 1
machine = "{machine}"
program = "part.nc"
[work_offsets_mm]
G54 = [-380, -230, -500]
[stock]
min_mm = [-50, -50, -12]
max_mm = [50, 50, 0]
[tools.1]
shape = "ball"
diameter_mm = 8
length_mm = 100
[tools.2]
shape = "flat"
diameter_mm = 10
length_mm = 90
[tools.3]
shape = "drill"
diameter_mm = 3
length_mm = 110
"""
TOOL_TABLE = "T1 P1 Z100 D8\nT2 P2 Z90 D10\nT3 P3 Z110 D3\n"
#: the raster covers this square, mm, with about so many moves a row for each row
HALF_MM, MOVES_A_ROW = 45.0, 10
HEAD = ["G21 G17 G90 G94 G54"]


def floor_mm(x, y):
    """The wavy floor under the tip of the ball."""
    return -3.0 + 1.5 * np.sin(x / 12.0) * np.cos(y / 15.0)


def raster(lines: int) -> Iterator[str]:
    """Plain motion to and fro."""
    rows = max(round(math.sqrt(lines / MOVES_A_ROW)), 2)
    columns = max(lines // rows - 1, 2)
    yield from ["T1 M6", "S8000 M3", "G43 H1", "G0 X-45. Y-45. Z20.", "G1 Z5. F3000"]
    for row, y in enumerate(np.linspace(-HALF_MM, HALF_MM, rows)):
        x = np.linspace(-HALF_MM, HALF_MM, columns + 1)
        x = x if row % 2 == 0 else x[::-1]
        for a, c in zip(x.tolist(), floor_mm(x, y).tolist(), strict=True):
            yield f"G1 X{a:.4f} Y{y:.4f} Z{c:.4f}"
    yield "G0 Z20."


def roughing(lines: int) -> Iterator[str]:
    """Level rows of short lines and arcs, with F and S on some of them."""
    yield from ["(roughing)", "T2 M6", "S6000 M3", "G43 H2", "G0 X-45. Y-45. Z5.", "M8"]
    rows = max(round(math.sqrt(lines / MOVES_A_ROW)), 2)
    columns = max(lines // rows // 3, 1)
    width = 2.0 * HALF_MM / columns
    for row, y in enumerate(np.linspace(-HALF_MM, HALF_MM, rows).tolist()):
        sense = 1.0 if row % 2 == 0 else -1.0
        yield f"G1 X{-sense * HALF_MM:.4f} Y{y:.4f} Z-1. F{1200 + row % 5 * 100} S{6000 + row % 3}"
        for column in range(columns):
            x, half = sense * (-HALF_MM + column * width), 0.25 * sense * width
            yield f"G1 X{x + half:.4f} Y{y:.4f}"
            yield f"G{2 if row % 2 else 3} X{x + 3 * half:.4f} Y{y:.4f} I{half:.4f} J0. F1000"
            yield f"G1 X{x + 4 * half:.4f} F1500"
    yield from ["G0 Z20.", "M9"]


def drilling(count: int) -> Iterator[str]:
    """A canned cycle with its places."""
    yield from ["(drilling)", "T3 M6", "S3000 M3", "G43 H3", "G0 X0. Y0. Z20.", "M8"]
    side = max(math.ceil(math.sqrt(count)), 1)
    place = np.linspace(-40.0, 40.0, side)
    yield f"G99 G81 X{place[0]:.4f} Y{place[0]:.4f} Z-9. R2. F200"
    for k in range(1, count):
        yield f"X{place[k % side]:.4f} Y{place[k // side % side]:.4f}"
    yield from ["G80", "M9", "G0 Z20."]


def cam(lines: int) -> Iterator[str]:
    """Half roughing, a hundredth drilling, the rest a raster."""
    yield from roughing(lines // 2)
    yield from drilling(max(lines // 100, 1))
    yield from raster(lines - lines // 2 - lines // 100)


PROGRAMS: dict[str, Callable[[int], Iterator[str]]] = {"raster": raster, "cam": cam}


def program_text(program: str, lines: int, control: str) -> str:
    """A program in the language of a control; RS274/NGC where none is said."""
    said = PROGRAMS[program](lines)
    written = written_for(control, said) if control else [*HEAD, *said, "M30"]
    return "\n".join([*written, ""])


def write_job(folder: Path, program: str, lines: int, points: int, control: str = "") -> None:
    """Job, program and points on the floor."""
    dialect = f'dialect = "{control}"\n' if control else ""
    (folder / "job.toml").write_text(
        JOB.format(machine=MACHINE).replace("[work", f"{dialect}[work", 1)
    )
    (folder / "part.nc").write_text(program_text(program, lines, control))
    (folder / "tool.tbl").write_text(TOOL_TABLE)
    side = max(round(math.sqrt(points)), 2)
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(-40.0, 40.0, side)]))
    slope_x = 1.5 / 12.0 * np.cos(x / 12.0) * np.cos(y / 15.0)
    slope_y = -1.5 / 15.0 * np.sin(x / 12.0) * np.sin(y / 15.0)
    normal = np.column_stack([-slope_x, -slope_y, np.ones_like(x)])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    # the ball's centre is 4 mm over its tip, and 4 mm off the surface along the normal
    place = np.column_stack([x, y, floor_mm(x, y) + 4.0]) - 4.0 * normal
    rows = np.column_stack([place, normal]).tolist()
    with (folder / "points.csv").open("w") as file:
        file.write("id,feature,x,y,z,i,j,k\n")
        file.writelines(f"{k},floor," + ",".join(f"{v:.9f}" for v in row) + "\n"
                        for k, row in enumerate(rows))  # fmt: skip


#: what follows ``vmach``; {f} is the folder of the job
COMMANDS: dict[str, str] = {
    "path": "path {f}/job.toml -o {f}/path.csv",
    "path npz": "path {f}/job.toml -o {f}/path.npz",
    "predict": "predict {f}/job.toml --points {f}/points.csv -o {f}/predicted.csv",
    "compensate": "compensate {f}/job.toml -o {f}/moved.nc",
    "run": "run {f}/run.toml --out {f}/result",
    "canon": "canon {f}/part.nc --tools {f}/tool.tbl",
}
#: commands whose work does not grow with a program, on the samples
SAMPLES: dict[str, str] = {
    "run (sample)": f"run {SAMPLE} --out {{f}}/result",
    "compensate (sample)": f"compensate {SAMPLE} -o {{f}}/moved.nc",
    "compare (sample)": f"compare {MEASURED} --out {{f}}/compared",
    "diagnose (sample)": f"diagnose {MEASURED} --out {{f}}/diagnosed",
    "accuracy (sample)": f"accuracy {MACHINE} --json",
    "effects list": "effects list",
}
#: programs of others that read the same file: name and command, by ours
PEERS = {
    "canon": ("rs274", "rs274 -t {f}/tool.tbl -g {f}/part.nc"),
    "run": ("FreeCAD", f"freecadcmd {Path(__file__).parent}/peer_freecad.py {{f}}/part.nc"),
    "predict": ("OpenCAMLib", f"{sys.executable} {Path(__file__).parent}/peer_opencamlib.py {{f}}"),
}
#: seconds of work, at least, that a growth is told from
LEAST_S = 0.1
#: lines that take no time, and lines from which on all compiled code is used
FEW_LINES, COMPILED_LINES = 100, 6_000


@dataclass(frozen=True)
class Cost:
    """Seconds by the clock and of the processor, peak memory in MB, and how it ended."""

    clock_s: float
    processor_s: float
    memory_mb: float
    status: int

    @property
    def text(self) -> str:
        mark = "" if self.status == 0 else f"  ended with {self.status}"
        return f"{self.clock_s:9.1f} {self.processor_s:9.1f} {self.memory_mb:9.0f}{mark}"


def measured(command: Sequence[str], folder: Path, limit_s: float) -> Cost:
    """Run a command to its end, or to the limit."""
    begun = time.perf_counter()
    child = os.fork()
    if child == 0:
        os.setpgid(0, 0)
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        os.chdir(folder)
        os.execvp(command[0], list(command))
    while True:
        done, status, used = os.wait4(child, os.WNOHANG)
        if done:
            break
        if time.perf_counter() - begun > limit_s:
            os.killpg(child, signal.SIGKILL)
            _, status, used = os.wait4(child, 0)
            break
        time.sleep(0.02)
    clock = time.perf_counter() - begun
    code = os.waitstatus_to_exitcode(status)
    return Cost(clock, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0, code)


def vmach(text: str, folder: Path, limit_s: float) -> Cost:
    words = text.format(f=folder).split()
    return measured([sys.executable, "-m", "vmach", *words], folder, limit_s)


def write_all(folder: Path, program: str, lines: int, points: int, control: str = "") -> None:
    """What any command needs."""
    write_job(folder, program, lines, points, control)
    job = (folder / "job.toml").read_text()
    measured = job.replace('"part.nc"', '"part.nc"\nmeasured = "measured.csv"')
    (folder / "run.toml").write_text(measured)
    measured_as_nominal(folder)


def has_peer(name: str, program: str) -> bool:
    """Whether a program of others is there that does the same with such a program."""
    if name not in PEERS or not shutil.which(PEERS[name][1].split()[0]):
        return False
    return name != "predict" or (program == "raster" and find_spec("opencamlib") is not None)


def grown(name: str, program: str, options: argparse.Namespace) -> None:
    """Print one command's row for every size."""
    before: tuple[int, Cost] | None = None
    with tempfile.TemporaryDirectory() as path:
        write_all(Path(path), program, FEW_LINES, options.points, options.control)
        idle_s = vmach(COMMANDS[name], Path(path), options.limit_s).processor_s
    for lines in options.lines:
        with tempfile.TemporaryDirectory() as path:
            folder = Path(path)
            write_all(folder, program, lines, options.points, options.control)
            cost = vmach(COMMANDS[name], folder, options.limit_s)
            peer = ""
            if has_peer(name, program):
                other = measured(PEERS[name][1].format(f=folder).split(), folder, options.limit_s)
                peer = f"  {PEERS[name][0]} {other.processor_s:.1f} s"
        growth = ""
        if before is not None:
            work = [c.processor_s - idle_s for c in (cost, before[1])]
            if min(work) > LEAST_S:
                growth = f"{math.log(work[0] / work[1]) / math.log(lines / before[0]):.2f}"
        print(f"{name:12} {program:7} {lines:9} {cost.text} {growth:>8}{peer}", flush=True)
        before = lines, cost
        if cost.status != 0:
            break


def measured_as_nominal(folder: Path) -> None:
    """Points that were found where they should be, for commands that inspect."""
    rows = (folder / "points.csv").read_text().splitlines()
    with (folder / "measured.csv").open("w") as file:
        file.write(rows[0] + ",mx,my,mz\n")
        file.writelines(row + "," + ",".join(row.split(",")[2:5]) + "\n" for row in rows[1:])


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lines", nargs="+", type=int, default=[1_000, 10_000, 100_000, 1_000_000])
    parser.add_argument("--points", type=int, default=10_000)
    parser.add_argument("--programs", nargs="+", choices=PROGRAMS, default=list(PROGRAMS))
    parser.add_argument("--commands", nargs="*", choices=COMMANDS, default=list(COMMANDS))
    parser.add_argument("--control", choices=CONTROLS, default="", help="whose language")
    parser.add_argument("--samples", action="store_true", help="the commands on samples too")
    parser.add_argument("--limit-s", type=float, default=600.0)
    options = parser.parse_args()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # who types commands has compiled modules
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}, {options.points} points")
    with tempfile.TemporaryDirectory() as path:
        write_all(Path(path), "cam", COMPILED_LINES, 100, options.control)
        for name in options.commands:
            vmach(COMMANDS[name], Path(path), options.limit_s)
    print(f"{'command':12} {'program':7} {'lines':>9} {'clock s':>9} {'proc s':>9} {'MB':>9} "
          f"{'growth':>8}")  # fmt: skip
    for name in options.commands:
        for program in options.programs:
            grown(name, program, options)
    for name, command in SAMPLES.items() if options.samples else ():
        with tempfile.TemporaryDirectory() as path:
            print(f"{name:30} {vmach(command, Path(path), options.limit_s).text}", flush=True)


if __name__ == "__main__":
    main()
