"""Processor time, volume and faces of STEP files, beside OCP where it can be had.

    python tests/benchmarks/bench_step.py [--spacing MM] [--ocp PYTHON] [FILE ...]

Without files: the samples and the small solids of the tests. `vmach` reads a file, with triangles
and volume; then it makes surface points with normals at the spacing. `OCP` (PyPI ``cadquery-ocp``,
in the environment of PYTHON) reads it and triangulates it with the same chord, without volume and
points: its time stands beside that of the reading alone, file by file. Of each the best of some
passes counts, after a first one: imports and compilation are left out.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

from vmach.errors import VmachError
from vmach.nominal import read_nominal
from vmach.nominal.step.solids import CHORD_MM

ROOT = Path(__file__).parents[2]
FILES = [*(ROOT / "samples").rglob("*.step"), *(ROOT / "tests/golden/cad").glob("*.step")]

#: of each work the best of so many passes counts
PASSES = 3

#: run by the other environment: for each file its processor time in s, faces and volume in mm3
OCP_PROGRAM = """
import json, sys, time
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer

def inside(shape, kind):
    found, explorer = [], TopExp_Explorer(shape, kind)
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found

def read(path):
    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is not None and not shape.IsNull():
        BRepMesh_IncrementalMesh(shape, float(sys.argv[1]), False, 0.5, False)
    return shape

read(sys.argv[3])
for path in sys.argv[3:]:
    passes = []
    for _ in range(int(sys.argv[2])):
        began = time.process_time()
        shape = read(path)
        passes.append(time.process_time() - began)
    seconds, volume, faces = min(passes), 0.0, 0
    for solid in [] if shape is None or shape.IsNull() else inside(shape, TopAbs_SOLID):
        sums = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, sums, 1e-7)
        volume += sums.Mass()
        faces += len(inside(solid, TopAbs_FACE))
    print("RESULT" + json.dumps([path, seconds, faces, volume]), flush=True)
"""


def by_ocp(python: str, path: Path) -> list | None:
    """Processor time, s, faces and volume, mm3, of the other kernel; None where it has no solid."""
    command = [python, "-c", OCP_PROGRAM, str(CHORD_MM), str(PASSES), str(path)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")
    found = [json.loads(line.split("RESULT")[1])[1:] for line in lines if "RESULT" in line]
    return found[0] if found and found[0][1] else None


def best_s(work: Callable[[], object]) -> float:
    """Least processor time of some passes, s."""
    seconds = []
    for _ in range(PASSES):
        began = time.process_time()
        work()
        seconds.append(time.process_time() - began)
    return min(seconds)


def row(path: Path, spacing_mm: float, python: str | None) -> str:
    try:
        part = read_nominal(path)
        points = part.sample(spacing_mm)
    except VmachError as error:
        return f"| {path.name} | {str(error)[:100]} |"
    read_s, sample_s = best_s(lambda: read_nominal(path)), best_s(lambda: part.sample(spacing_mm))
    cells = [path.name, len(part.faces), len(part.mesh.triangles), f"{part.volume_mm3:.6g}"]
    cells += [f"{read_s:.2f}", len(points), f"{sample_s:.2f}"]
    if python and (other := by_ocp(python, path)):
        ocp_s, faces, truth = other
        off = part.volume_mm3 / truth - 1.0
        cells += [faces, f"{off:.1e}", f"{ocp_s:.2f}", f"{read_s / ocp_s:.2f}"]
    return f"| {' | '.join(map(str, cells))} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--spacing", type=float, default=1.0)
    parser.add_argument("--ocp", help="a Python interpreter that can import OCP")
    parser.add_argument("files", nargs="*", type=Path)
    arguments = parser.parse_args()
    paths = sorted(arguments.files or FILES)
    heads = ["file", "faces", "triangles", "volume, mm3", "reads, s", "points", "points, s"]
    if arguments.ocp:
        heads += ["faces by OCP", "volume off", "OCP, s", "reads / OCP"]
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    for path in paths:
        print(row(path, arguments.spacing, arguments.ocp), flush=True)


if __name__ == "__main__":
    main()
