"""Speed of the G-code reader beside its peers, in one run, by the clock and by processor time.

    python tests/benchmarks/bench_gcode.py [LINES]

``plain`` is G1 with X Y Z; ``cam`` has arcs, F and S words, three tools and drilling cycles. Peers:
LinuxCNC's ``rs274`` where it is installed, and pygcode (on a share of the lines). Every reader gets
the same file; the best of several runs counts.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_commands import HEAD, TOOL_TABLE, cam

from gcode import read_program, read_tool_table

PYGCODE_LINES = 5000
PLAIN_LINES = 100_000


def write_program(path: Path, lines: int) -> None:
    points = np.cumsum(np.random.default_rng(1).uniform(-2.0, 2.0, (lines, 3)), axis=0)
    rows = "".join(f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f}\n" for x, y, z in points.tolist())
    path.write_text("G21 G90 F1000\n" + rows + "M2\n")


def best(action: Callable[[], object], runs: int) -> tuple[float, float]:
    """Least seconds by the clock, and of the processor (children too), of several runs."""
    clock, processor = [], []
    for _ in range(runs):
        start, before = time.perf_counter(), os.times()
        action()
        after = os.times()
        clock.append(time.perf_counter() - start)
        processor.append(sum(after[:4]) - sum(before[:4]))
    return min(clock), min(processor)


def rs274_seconds(path: Path, folder: str) -> tuple[float, float]:
    parameters, tools = Path(folder) / "rs274.var", Path(folder) / "tool.tbl"
    tools.write_text(TOOL_TABLE)

    def run() -> None:
        parameters.write_text("5220\t1.0\n")
        command = ["rs274", "-t", str(tools), "-v", str(parameters), "-n", "2", "-g", str(path)]
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)

    return best(run, 2)


def pygcode_seconds(path: Path) -> tuple[float, float]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from pygcode import Line, Machine

    def run() -> None:
        machine = Machine()
        with path.open() as file:
            for text in file:
                machine.process_block(Line(text).block)

    return best(run, 1)


def main() -> None:
    lines = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
    print(f"{'':44}{'clock':^30}{'processor':^30}")
    head = "".join(f"{title:>10}" for title in ("s", "M lines/s", "x rs274"))
    print(f"{'reader':34}{'lines':>10}{head}{head}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.ngc"
        write_program(path, lines)
        compare("plain", path, folder)
        path.write_text("\n".join([*HEAD, *cam(lines), "M30", ""]))
        compare("cam", path, folder)


def compare(kind: str, path: Path, folder: str) -> None:
    """Print the rows of one program."""
    text = path.read_text().splitlines(keepends=True)
    some, few = Path(folder) / "some.ngc", Path(folder) / "few.ngc"
    some.write_text("".join(text[:PLAIN_LINES]))
    few.write_text("".join(text[:PYGCODE_LINES]))
    table = Path(folder) / "tool.tbl"
    table.write_text(TOOL_TABLE)
    tools, count = read_tool_table(table), len(text)
    read_program(few, tools=tools, fast=True)  # compile before the clock runs
    rows = [
        ("compiled, text to path", count,
         best(lambda: read_program(path, tools=tools, fast=True), 5)),
        ("compiled, text to moves", count,
         best(lambda: read_program(path, tools=tools, fast=True).moves, 3)),
        ("interpreter, text to path", min(count, PLAIN_LINES),
         best(lambda: read_program(some, tools=tools, fast=False), 1)),
    ]  # fmt: skip
    if shutil.which("rs274"):
        rows.append(("rs274 -g (LinuxCNC)", count, rs274_seconds(path, folder)))
    if kind == "plain":
        rows.append(("pygcode Machine", min(count, PYGCODE_LINES), pygcode_seconds(few)))
    peers = [seconds for name, _, seconds in rows if name.startswith("rs274")]
    for name, of, measured in rows:
        line = f"{kind + ': ' + name:34}{of:10d}"
        for index, seconds in enumerate(measured):
            speed = of / max(seconds, 0.005)  # processor time comes in hundredths
            ratio = f"{speed * peers[0][index] / count:10.1f}" if peers else f"{'-':>10}"
            line += f"{seconds:10.3f}{speed / 1e6:10.3f}{ratio}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
