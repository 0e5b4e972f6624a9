"""Ten thousand small cases in four ways: clock, processor, and whether all bits are the same.

    python tests/benchmarks/bench_batch.py [--cases 10000]

One process, two, 64 shards, and two dask workers of which one is killed on the way.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.unit.test_study import cluster

MODULE = """
def small(case, random):
    return {"sum": float(random.standard_normal(50).sum()), "list": random.random(3)}
"""


def run(folder: Path, name: str, *words: str) -> None:
    """One command of the study."""
    command = [sys.executable, "-m", "vmach", "batch", "study.toml", "--out", name, *words]
    env = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    subprocess.run(command, cwd=folder, env=env, check=True, stdout=subprocess.DEVNULL)


def digest(folder: Path, name: str) -> str:
    """Of the names and bytes of all results."""
    found = hashlib.sha256()
    for path in sorted((folder / name / "cases").iterdir()):
        found.update(path.name.encode() + path.read_bytes())
    return found.hexdigest()[:12]


def on_cluster(folder: Path, cases: int) -> None:
    """Two workers; one is killed when a tenth of the cases is there."""
    with cluster(folder, 2) as (address, workers):
        env = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
        words = ["batch", "study.toml", "--out", "dask", "--scheduler", address]
        command = subprocess.Popen(
            [sys.executable, "-m", "vmach", *words], cwd=folder, env=env,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        done = folder / "dask" / "cases"
        while command.poll() is None and sum(1 for _ in done.glob("*.json")) < cases // 10:
            time.sleep(0.1)
        workers[0].kill()
        assert command.wait() == 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--ways", nargs="+", default=["one", "two", "shards", "dask"])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "small_cases.py").write_text(MODULE)
        (folder / "study.toml").write_text(
            f'schema = 1\nfunction = "small_cases:small"\ndraws = {options.cases}\n'
        )
        ways = {
            "one": lambda: run(folder, "one", "--processes", "1"),
            "two": lambda: run(folder, "two", "--processes", "2"),
            "shards": lambda: [
                run(folder, "shards", "--processes", "1", "--shard", f"{k}/64")
                for k in range(64, 0, -1)
            ],
            "dask": lambda: on_cluster(folder, options.cases),
        }
        for way in options.ways:
            start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
            ways[way]()
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            clock = time.perf_counter() - start
            print(f"{way:8}{clock:8.1f} s clock {cpu:8.1f} s processor  {digest(folder, way)}",
                  flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
