"""How fast the workbench answers, how much it sends, and what memory it takes.

    python tests/benchmarks/bench_workbench.py [--diagnoses 10] [--spacing 0.72]

Opens a copy of the sample missing_effect and asks as a page does. Clock times are of an idle
machine only; the processor times of the two processes stand beside them.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from http.client import HTTPConnection
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: what a page asks for until it shows the part
FIRST = ["/", "/viewer/scene.js", "/viewer/gestures.js", "/api/state", "/api/about", "/api/mesh",
         "/api/values", "/api/program", "/api/effects", "/api/measured", "/api/start"]  # fmt: skip


class Bench:
    """A workbench in a process of its own, asked as its page asks."""

    def __init__(self, job: Path) -> None:
        self.began = time.perf_counter()
        words = [sys.executable, "-m", "vmach", "open", str(job), "--no-browser"]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.search(r":(\d+)/\?token=(\S+)", line)
        assert found is not None, line
        self.port, self.token = int(found[1]), found[2]

    def ask(self, address: str, what: dict | None = None) -> bytes:
        connection = HTTPConnection("127.0.0.1", self.port, timeout=600)
        headers = {"x-vmach-token": self.token, "x-vmach": "1"}
        method, content = ("GET", None) if what is None else ("POST", json.dumps(what))
        connection.request(method, address, body=content, headers=headers)
        answer = connection.getresponse()
        told = answer.read()
        assert answer.status == 200, told
        return told

    def processes(self) -> dict[str, int]:
        """Server and model, by their numbers."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text()
        model = [
            p for p in children.split() if b"spawn_main" in Path(f"/proc/{p}/cmdline").read_bytes()
        ]
        return {"server": self.process.pid, "model": int(model[-1])}

    def memory_mb(self) -> dict[str, float]:
        found = {}
        for name, pid in self.processes().items():
            text = Path(f"/proc/{pid}/status").read_text()
            found[name] = int(re.search(r"VmRSS:\s+(\d+)", text)[1]) / 1024
        return found

    def processor_s(self) -> dict[str, float]:
        ticks = os.sysconf("SC_CLK_TCK")
        found = {}
        for name, pid in self.processes().items():
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            found[name] = (int(fields[11]) + int(fields[12])) / ticks
        return found


def main() -> None:
    given = argparse.ArgumentParser()
    given.add_argument("--diagnoses", type=int, default=10)
    given.add_argument("--spacing", type=float, help="of the inspected points, mm")
    options = given.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["XDG_STATE_HOME"] = folder
        for name in ("missing_effect", "iso10791_7"):
            shutil.copytree(ROOT / "samples" / name, Path(folder) / name)
        job = Path(folder) / "missing_effect" / "job.toml"
        if options.spacing:
            job.write_text(job.read_text() + f"\n[inspection]\nspacing_mm = {options.spacing}\n")
        bench = Bench(job)
        try:
            measure(bench, options.diagnoses)
        finally:
            bench.process.terminate()
            bench.process.wait()


def measure(bench: Bench, diagnoses: int) -> None:
    static = sorted((ROOT / "vmach" / "workbench" / "static").iterdir())
    sent = sum(len(bench.ask(address)) for address in FIRST)
    took, cpu = time.perf_counter() - bench.began, bench.processor_s()
    sent += sum(len(bench.ask(f"/static/{path.name}")) for path in static if path.suffix != ".html")
    print(f"first picture: {took:.1f} s by the clock; processor: {told(cpu)} s")
    print(f"the page: {sent / 1e6:.2f} MB")
    repeat("slider", bench, "model", lambda k: bench.ask("/api/what-if", slider(k)))
    place = "/api/point?points=surface&x=0&y={}&z=0&i=0&j=0&k=1"
    repeat("pick", bench, "model", lambda k: bench.ask(place.format(k)))
    print(f"memory: {told(bench.memory_mb())} MB")
    for number in range(1, diagnoses + 1):
        bench.ask("/api/diagnose", {})
        while True:
            runs = json.loads(bench.ask("/api/state"))["runs"]
            if runs[-1]["state"] not in ("waiting", "running"):
                break
            time.sleep(0.2)
        assert runs[-1]["state"] == "done", runs[-1]["message"]
        print(f"memory after {number} diagnoses: {told(bench.memory_mb())} MB", flush=True)


def slider(k: int) -> dict:
    size = {"reversal_um": 5.0 + 0.1 * k}
    return {"changes": [{"effect": "backlash", "target": "Y", "parameters": size}], "shown": {}}


def repeat(name: str, bench: Bench, process: str, ask, times: int = 50) -> None:
    ask(0)
    cpu, clock = bench.processor_s()[process], []
    for k in range(1, times + 1):
        began = time.perf_counter()
        ask(k)
        clock.append(1e3 * (time.perf_counter() - began))
    spent = 1e3 * (bench.processor_s()[process] - cpu) / times
    print(f"{name}: {sorted(clock)[times // 2]:.0f} ms by the clock, {spent:.0f} ms of processor")


def told(numbers: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.1f}" for name, value in numbers.items())


if __name__ == "__main__":
    main()
