"""Mutated STL files: each must give a part or one clear error, soon, and no wrong solid in silence.

    python tests/benchmarks/fuzz_meshes.py [COUNT] [SEED]

Inputs are the STL files of all samples and meshes of their STEP files, binary and ASCII, with one
change each. Some changes are harmless, some may be either, and some give a wrong solid or a wrong
unit for certain: those must be refused, or said (a mesh inside out is turned with a note). Prints
a table of changes and outcomes, and processor times; exit status 1 where anything went wrong.
"""

from __future__ import annotations

import argparse
import random
import signal
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.job import read_job
from vmach.nominal import read_nominal
from vmach.run.inspection import surface_points

SAMPLES = Path(__file__).parents[2] / "samples"
JOBS = (
    "freecad_pocket/job.toml",
    "iso10791_7/job.toml",
    "mazak_ajv25/toolpath1.toml",
    "mazak_ajv25/toolpath2.toml",
    "spline_slot/corner.toml",
)
#: more processor time than this is a fault
LIMIT_S = 20
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def binary(corners: np.ndarray) -> bytes:
    records = np.zeros(len(corners), _RECORD)
    records["corners"] = corners
    return b"fuzz".ljust(80) + np.uint32(len(corners)).tobytes() + records.tobytes()


def ascii_text(corners: np.ndarray) -> bytes:
    lines = ["solid fuzz"]
    for triangle in corners.astype(np.float32):
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(repr(float(x)) for x in corner) for corner in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid fuzz"]).encode()


def some(rng: random.Random, corners: np.ndarray) -> int:
    return rng.randrange(len(corners))


def with_row(corners: np.ndarray, row: int, value: object) -> np.ndarray:
    corners = corners.copy()
    corners[row] = value
    return corners


def moved(corners: np.ndarray, rng: random.Random) -> np.ndarray:
    """One corner, wherever it occurs, somewhere else: the mesh stays closed."""
    vertex = corners[some(rng, corners), rng.randrange(3)]
    here = (corners == vertex).all(axis=2)
    corners = corners.copy()
    corners[here] += rng.choice([1e-3, 0.1, 5.0, 1e3, 1e9, 1e30])
    return corners


def halved(corners: np.ndarray) -> np.ndarray:
    """The same surface with every triangle cut in four."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def buried(corners: np.ndarray) -> np.ndarray:
    """A small copy of the part, some tenths of a millimetre below its largest triangle."""
    a, b, c = np.moveaxis(corners, 1, 0)
    across = np.cross(b - a, c - a)
    largest = np.linalg.norm(across, axis=1).argmax()
    normal = across[largest] / np.linalg.norm(across[largest])
    size = np.ptp(corners, axis=(0, 1)).max()
    return (
        corners[largest].mean(axis=0) - 0.004 * size * normal + 0.002 * (corners - a.mean(axis=0))
    )


def scaled(factor: float):
    return lambda corners, rng: corners * factor


#: changes that leave no solid, or one of another size: never accepted without a word
WRONG = {
    "metres": scaled(1e-3),
    "inches": scaled(1 / 25.4),
    "a 25th": scaled(1 / 25),
    "times 25": scaled(25.0),
    "times 25.4": scaled(25.4),
    "times 1000": scaled(1e3),
    "every triangle twice": lambda c, rng: np.concatenate([c, c]),
    "a surface and its reverse": lambda c, rng: np.concatenate([c, c[:, ::-1]]),
    "twice, other triangles": lambda c, rng: np.concatenate([c, halved(c)]),
    "reverse, other triangles": lambda c, rng: np.concatenate([c, halved(c)[:, ::-1]]),
    "inside out": lambda c, rng: c[:, ::-1],
    "flattened": lambda c, rng: c * [1.0, 1.0, 0.0],
    "in itself, same sense": lambda c, rng: np.concatenate([c, buried(c)]),
    "one triangle away": lambda c, rng: np.delete(c, some(rng, c), axis=0),
    "one triangle twice": lambda c, rng: np.concatenate([c, c[[some(rng, c)]]]),
    "all in one point": lambda c, rng: np.zeros_like(c),
    "not a number": lambda c, rng: with_row(c, some(rng, c), np.nan),
    "vertex at 1e9": lambda c, rng: with_row(c, some(rng, c), 1e9),
}
#: changes after which the mesh may still be a solid of about the same size
EITHER = {
    "as it is": lambda c, rng: c,
    "four triangles for one": lambda c, rng: halved(c),
    "shuffled": lambda c, rng: c[rng.sample(range(len(c)), len(c))],
    "a corner moved": moved,
    "a triangle turned": lambda c, rng: with_row(c, k := some(rng, c), c[k, ::-1]),
    "a triangle without area": lambda c, rng: with_row(c, k := some(rng, c), c[k, [0, 0, 1]]),
    "noise": lambda c, rng: c + np.random.default_rng(rng.randrange(99)).normal(0, 1e-4, c.shape),
    "shifted": lambda c, rng: c + rng.choice([0.01, 1.0, 100.0]),
}


def damaged(data: bytes, rng: random.Random) -> bytes:
    """Bytes changed, cut away or put in."""
    data = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(data))
        kind = rng.randrange(4)
        if kind == 0:
            data[at] = rng.randrange(256)
        elif kind == 1:
            del data[at : at + rng.randint(1, 60)]
        elif kind == 2:
            data[at:at] = rng.randbytes(rng.randint(1, 60))
        else:
            del data[at:]
        data = data or bytearray(b" ")
    return bytes(data)


class TooSlow(Exception):
    """The clock rang."""


def ring(*_: object) -> None:
    raise TooSlow


def outcome(job: object, path: Path) -> str:
    """What came of one file: refused, said (with a note that it was turned) or read."""
    try:
        part = read_nominal(path)
        surface_points(_with_nominal(job, path), part)
    except InputError as error:
        assert path.name in str(error), f"the message does not name the file: {error}"
        assert "\n" not in str(error), f"more than one line: {error}"
        return "refused"
    return "said" if any("turned" in str(note) for note in part.notes) else "read"


def _with_nominal(job: object, path: Path) -> object:
    from dataclasses import replace

    return replace(job, nominal=path)


def sources() -> list[tuple[str, object, np.ndarray]]:
    """Name, job and triangles (T, 3, 3) of every sample's STL and STEP."""
    found = []
    for name in JOBS:
        job = read_job(SAMPLES / name)
        for path in sorted({job.nominal, job.nominal.with_suffix(".stl")}):
            if path.is_file():
                found.append((path.name, job, np.asarray(read_nominal(path).mesh.corners_mm)))
    return found


def main(count: int, seed: int) -> int:
    rng = random.Random(seed)
    parts, table, faults, slowest = sources(), Counter(), [], 0.0
    changes = [*WRONG, *EITHER, "bytes", "bytes"]
    signal.signal(signal.SIGPROF, ring)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mutated.stl"
        for number in range(count):
            change = changes[number % len(changes)]
            name, job, corners = rng.choice(parts)
            write = rng.choice([binary, ascii_text])
            with np.errstate(all="ignore"):
                if change == "bytes":
                    data = damaged(write(corners), rng)
                else:
                    data = write((WRONG | EITHER)[change](corners, rng))
            path.write_bytes(data)
            begin = time.process_time()
            signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
            try:
                result = outcome(job, path)
            except TooSlow:
                result = "TOO SLOW"
            except Exception:
                result = "CRASHED"
                traceback.print_exc()
            signal.setitimer(signal.ITIMER_PROF, 0)
            slowest = max(slowest, time.process_time() - begin)
            if change in WRONG and result == "read":
                result = "IN SILENCE"
            table[change, result] += 1
            if result.isupper():
                faults.append(f"{number}: {change} of {name} ({write.__name__}): {result}")
    for (change, result), times in sorted(table.items()):
        print(f"{change:28}{result:12}{times:5}")
    print(f"{count} files, {len(faults)} faults, the slowest took {slowest:.1f} s")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=300, help="files")
    parser.add_argument("seed", type=int, nargs="?", default=1)
    raise SystemExit(main(**vars(parser.parse_args())))
