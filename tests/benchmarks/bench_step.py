"""Processor time, volume and faces of STEP files, beside OCP where it can be had.

    python tests/benchmarks/bench_step.py [--spacing MM] [--ocp PYTHON] [FILE ...]

Without files: the samples and the small solids of the tests. `vmach` reads a file and makes surface
points with normals at the spacing; `OCP` (PyPI ``cadquery-ocp``, in the environment of PYTHON)
reads it and triangulates it with the same chord, without any points. Each is timed in a second
pass, so imports and compilation are left out. Volumes of vmach are those of its surfaces.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import time
from pathlib import Path

from vmach.errors import VmachError
from vmach.nominal import read_nominal
from vmach.nominal.step.solids import CHORD_MM

ROOT = Path(__file__).parents[2]
FILES = [*(ROOT / "samples").rglob("*.step"), *(ROOT / "tests/golden/cad").glob("*.step")]

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

for path in sys.argv[2:]:
    read(path)
    began = time.process_time()
    shape = read(path)
    seconds, volume, faces = time.process_time() - began, 0.0, 0
    for solid in [] if shape is None or shape.IsNull() else inside(shape, TopAbs_SOLID):
        sums = GProp_GProps()
        BRepGProp.VolumeProperties_s(solid, sums, 1e-7)
        volume += sums.Mass()
        faces += len(inside(solid, TopAbs_FACE))
    print("RESULT" + json.dumps([path, seconds, faces, volume]), flush=True)
"""


def by_ocp(python: str, paths: list[Path]) -> dict[str, list]:
    command = [python, "-c", OCP_PROGRAM, str(CHORD_MM), *map(str, paths)]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")
    found = [json.loads(line.split("RESULT")[1]) for line in lines if "RESULT" in line]
    return {path: figures for path, *figures in found}


def row(path: Path, spacing_mm: float, other: list | None) -> str:
    try:
        read_nominal(path).sample(spacing_mm)
        began = time.process_time()
        part = read_nominal(path)
        points = part.sample(spacing_mm)
        seconds = time.process_time() - began
    except VmachError as error:
        return f"| {path.name} | {str(error)[:100]} |"
    volume = part.volume_mm3
    cells = [path.name, len(part.faces), len(points.id), f"{volume:.6g}", f"{seconds:.2f}"]
    if other:
        ocp_s, faces, truth = other
        cells += [faces, f"{volume / truth - 1.0:.1e}", f"{ocp_s:.2f}", f"{seconds / ocp_s:.1f}"]
    return f"| {' | '.join(map(str, cells))} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--spacing", type=float, default=1.0)
    parser.add_argument("--ocp", help="a Python interpreter that can import OCP")
    parser.add_argument("files", nargs="*", type=Path)
    arguments = parser.parse_args()
    paths = sorted(arguments.files or FILES)
    others = by_ocp(arguments.ocp, paths) if arguments.ocp else {}
    heads = ["file", "faces", "points", "volume, mm3", "vmach, s"]
    if others:
        heads += ["faces by OCP", "volume off", "OCP, s", "vmach / OCP"]
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    for path in paths:
        print(row(path, arguments.spacing, others.get(str(path))), flush=True)


if __name__ == "__main__":
    main()
