"""Jobs, machines and tables of every sample, broken at random: refused, asked about, or right?

    python tests/benchmarks/fuzz_configurations.py [--rounds 2000] [--seed 0] [--list]

A round changes one thing in a copy of a sample and calls a command in this process. Three things
are counted: faults of the program itself (exit 70), rounds above 20 s of processor time, and wrong
tables, tools, units, places and right angles (25 or 1000 times, shifted, mirrored) that are
accepted without a doubt.

A number that is wrong and moves the prediction nowhere in the machine's volume by more than 1 um
is listed as harmless: nobody can tell it from a right one, and nobody needs to. A reading of laser
or straightedge is itself uncertain by that much. Places where no angle acts on the component are of
this kind.

Programs are the samples' own, with the first lines of every tool only: what is wrong with a
configuration does not depend on how long the program goes on.
"""

import argparse
import random
import re
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
from typer.testing import CliRunner

from gcode import ProgramError
from stock import StockError
from vmach.cli import app
from vmach.errors import VmachError
from vmach.machine import Variant, displacement, read_machine
from vmach.machine.tables.interpolation import Extrapolation

ROOT = Path(__file__).parents[2]
JOBS = {
    "freecad_pocket/job.toml": "iso10791_7",
    "iso10791_7/job.toml": "iso10791_7",
    "mazak_ajv25/toolpath1.toml": "mazak_ajv25",
    "mazak_ajv25/toolpath2.toml": "mazak_ajv25",
    "missing_effect/job.toml": "iso10791_7",
    "spline_slot/centre.toml": "spline_slot",
    "spline_slot/corner.toml": "spline_slot",
}
FACTORS = (1e3, 1e-3, 25.4, 1 / 25.4)
#: a wrong number that moves no point of the volume by more is harmless, um
HARMLESS_UM = 1.0
#: lines of the program that every tool gets, and points that have to be cut with them
LINES_A_TOOL, LEAST_POINTS = 40, 40
#: more processor time than this is a fault
LIMIT_S = 20
#: of the rounds that look at the path, so many ask a slow command instead
SLOW_SHARE = 0.4
NUMBER = re.compile(r"(?<![\w.\"'-])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])")
ODD_VALUES = (
    "1e308", "-1e308", "1e-308", "0", "-1", "nan", "inf", "true", '"10"', "[]", "[1, 2]", "{}",
    "9" * 400, "1e9", "-0.0", "2026-01-01", '""', '"\\u0000"', "[[[[1]]]]",
)  # fmt: skip


@dataclass(frozen=True)
class Change:
    """What was done, to which file, and whether it certainly makes a right file wrong."""

    kind: str
    told: str
    is_wrong: bool = False


class Slow(Exception):
    """A round that takes too long."""


def assigned(text, pattern):
    """Matches of ``key = number`` outside comments whose key fits the pattern."""
    return list(re.finditer(rf"(?m)^({pattern})(\s*=\s*)(-?[\d.]+)", text))


def replaced(text, match, value):
    return text[: match.start(3)] + f"{value:.9g}" + text[match.end(3) :]


def tool(folder, job, rng):
    text = job.read_text()
    match = rng.choice(assigned(text, "diameter_mm|length_mm"))
    factor = rng.choice(FACTORS)
    job.write_text(replaced(text, match, float(match[3]) * factor))
    return Change("tool", f"{match[1]} = {match[3]} x {factor:.4g}", True)


def table_of(folder, rng):
    return rng.choice(sorted(machine_of(folder).parent.glob("errors/*.csv")))


def machine_of(folder):
    return folder / "machine.toml"


def rows_changed(path, change):
    header, *rows = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    cells = [[float(cell) for cell in row.split(",")] for row in rows if row.strip()]
    cells = change(header.split(","), cells)
    path.write_text("\n".join([header, *(",".join(f"{x:.12g}" for x in row) for row in cells)]))


def positions(folder, job, rng):
    path, factor = table_of(folder, rng), rng.choice(FACTORS)
    rows_changed(path, lambda _, rows: [[row[0] * factor, *row[1:]] for row in rows])
    return Change("positions", f"{path.name} x {factor:.4g}", True)


def values(folder, job, rng):
    path, factor = table_of(folder, rng), rng.choice(FACTORS)
    rows_changed(path, lambda _, rows: [[row[0], *(x * factor for x in row[1:])] for row in rows])
    return Change("values", f"{path.name} x {factor:.4g}", True)


def shifted(folder, job, rng):
    path, way = table_of(folder, rng), rng.choice((-1, 1))

    def shift(_, rows):
        length = max(row[0] for row in rows) - min(row[0] for row in rows)
        return [[row[0] + way * length, *row[1:]] for row in rows]

    rows_changed(path, shift)
    return Change("shifted", f"{path.name} {way:+d} length", True)


def mirrored(folder, job, rng):
    path = table_of(folder, rng)
    rows_changed(path, lambda _, rows: [[-row[0], *row[1:]] for row in rows])
    return Change("mirrored", path.name, True)


def one_row(folder, job, rng):
    path = table_of(folder, rng)

    def far(_, rows):
        rows[rng.randrange(len(rows))][0] = rng.choice((-1e9, 1e9, 1e5))
        return rows

    rows_changed(path, far)
    return Change("one row far out", path.name, True)


def unit(folder, job, rng):
    path = machine_of(folder)
    key, others = rng.choice((("length", ("mm", "m", "inch")), ("angle", ("rad", "mrad", "deg"))))
    other = rng.choice(others)
    text = path.read_text()
    path.write_text(re.sub(rf'(?m)^{key} = "\w+"', f'{key} = "{other}"', text, count=1))
    return Change("unit", f'{key} = "{other}"', True)


def all_values(folder, job, rng):
    factor = rng.choice(FACTORS)
    for path in sorted(machine_of(folder).parent.glob("errors/*.csv")):
        rows_changed(path, lambda _, rows: [[r[0], *(x * factor for x in r[1:])] for r in rows])
    return Change("all values", f"x {factor:.4g}", True)


def squareness(folder, job, rng):
    path, factor = machine_of(folder), rng.choice(FACTORS)
    text = path.read_text()
    found = list(re.finditer(r"(?m)^(E[ABC]0[XYZ])( = (?:\{ um_per_m = )?)(-?[\d.]+)", text))
    match = rng.choice(found)
    path.write_text(replaced(text, match, float(match[3]) * factor))
    return Change("squareness", f"{match[1]} = {match[3]} x {factor:.4g}", True)


def place(folder, job, rng):
    path, factor = machine_of(folder), rng.choice(FACTORS)
    text = path.read_text()
    found = list(re.finditer(r"(?m)^(?:measured_at|nose_at|stick_out)_mm = \[?([-\d., ]*\d)", text))
    if not found:
        return Change("nothing", "no place")
    match = rng.choice(found)
    numbers = ", ".join(f"{float(x) * factor:.9g}" for x in match[1].split(","))
    path.write_text(text[: match.start(1)] + numbers + text[match.end(1) :])
    return Change("place", f"[{match[1]}] x {factor:.4g}", True)


def some_file(folder, job, rng):
    return rng.choice((job, job, machine_of(folder), machine_of(folder), table_of(folder, rng)))


def odd_value(folder, job, rng):
    path = rng.choice((job, machine_of(folder)))
    lines = path.read_text().splitlines()
    rows = [k for k, line in enumerate(lines) if re.match(r"\s*\w+\s*=", line)]
    k, value = rng.choice(rows), rng.choice(ODD_VALUES)
    told = lines[k]
    lines[k] = lines[k].split("=")[0] + "= " + value
    path.write_text("\n".join(lines))
    return Change("odd value", f"{path.name}: {told} -> {value[:20]}")


def odd_number(folder, job, rng):
    path = some_file(folder, job, rng)
    text = path.read_text()
    match = rng.choice(list(NUMBER.finditer(text)))
    number = rng.choice(("1e308", "-1e9", "nan", "1e-300", "0", "--3", "1_000", "0x10", "1e400"))
    path.write_text(text[: match.start()] + number + text[match.end() :])
    return Change("odd number", f"{path.name}: {match[0]} -> {number}")


def missing_line(folder, job, rng):
    path = some_file(folder, job, rng)
    lines = path.read_text().splitlines()
    told = lines.pop(rng.randrange(len(lines)))
    path.write_text("\n".join(lines))
    return Change("missing line", f"{path.name}: {told}")


def swapped_lines(folder, job, rng):
    path = some_file(folder, job, rng)
    lines = path.read_text().splitlines()
    a, b = rng.randrange(len(lines)), rng.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]
    path.write_text("\n".join(lines))
    return Change("swapped lines", f"{path.name}: {a + 1}, {b + 1}")


def unknown_key(folder, job, rng):
    path = rng.choice((job, machine_of(folder)))
    lines = path.read_text().splitlines()
    key = rng.choice(("extra = 1", "[extra]", "[tools.x]", '"" = 2', "[[history]]", "[errors.EQQ]"))
    lines.insert(rng.randrange(len(lines)), key)
    path.write_text("\n".join(lines))
    return Change("unknown key", f"{path.name}: {key}")


def bytes_changed(folder, job, rng):
    path = some_file(folder, job, rng)
    data = bytearray(path.read_bytes())
    for _ in range(rng.randint(1, 4)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    path.write_bytes(bytes(data))
    return Change("bytes", path.name)


def no_file(folder, job, rng):
    path = rng.choice((table_of(folder, rng), machine_of(folder)))
    path.unlink()
    if rng.random() < 0.5:
        path.mkdir()
    return Change("file missing", path.name)


CHANGES = (
    tool, positions, values, shifted, mirrored, one_row, unit, all_values, squareness, place,
    odd_value, odd_number, missing_line, swapped_lines, unknown_key, bytes_changed, no_file,
)  # fmt: skip


def beginnings(text, lines):
    """The first lines of a program and of every tool in it, and its end."""
    kept, since = [], 0
    for line in text.splitlines():
        since = 0 if re.search(r"\bM0?6\b", line) else since + 1
        if since < lines or re.search(r"\bM(0?2|30)\b|^%|^O\d", line):
            kept.append(line)
    return "\n".join(kept) + "\n"


def sample(name, machine, where, lines=None):
    """A folder with the job, its machine and tables; without CAD, which nothing here reads."""
    lines = lines or lines_needed(name)
    source = ROOT / "samples" / Path(name).parent
    folder = shutil.copytree(
        ROOT / "samples" / machine, where / "job", ignore=shutil.ignore_patterns("*.st*", "*.py")
    )
    text = (ROOT / "samples" / name).read_text()
    program = re.search(r'(?m)^program = "(.*)"', text)[1]
    (folder / "program.nc").write_text(beginnings((source / program).read_text(), lines))
    text = re.sub(r'(?m)^program = ".*"', 'program = "program.nc"', text)
    text = re.sub(r'(?m)^machine = ".*"', 'machine = "machine.toml"', text)
    text = re.sub(r'(?m)^(nominal|measured) = ".*"\n', "", text)
    job = folder / "the_job.toml"
    job.write_text(text)
    points = "id,feature,x,y,z,i,j,k\n1,top,0,0,0,0,0,1\n2,top,20,0,0,0,0,1\n"
    (folder / "points.csv").write_text(points)
    (folder / "measured.csv").write_text(points_on_cut(name, lines))
    return folder, job


@cache
def lines_needed(name):
    """So many lines of every tool that some points are cut."""
    lines = LINES_A_TOOL
    while lines < 10_000 and points_on_cut(name, lines).count("\n") <= LEAST_POINTS:
        lines *= 3
    return lines


@cache
def points_on_cut(name, lines):
    """Some points that the job's program cuts, measured where they should be but for noise."""
    from vmach.job import read_job
    from vmach.nominal import read_nominal
    from vmach.path.preparation import prepare
    from vmach.prediction import predict
    from vmach.run.inspection import surface_points

    job = read_job(ROOT / "samples" / name)
    points = surface_points(job, read_nominal(job.nominal, job.nominal_unit))
    with tempfile.TemporaryDirectory() as place_:
        program = Path(place_) / "program.nc"
        program.write_text(beginnings(job.program.read_text(), lines))
        try:
            prepared = prepare(job, program_path=program)
        except ProgramError:  # cut off in the middle of a subprogram
            return ""
    found = predict(prepared, points.point_mm, points.normal, variant=Variant.ABBE)
    rows = np.flatnonzero(found.is_cut)
    rows = rows[:: max(len(rows) // 150, 1)]
    noise = np.random.default_rng(0).normal(0.0, 5e-4, len(rows))
    place, normal = points.point_mm[rows], points.normal[rows]
    at = place + (found.deviation_mm[rows] + noise)[:, None] * normal
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for k, row in enumerate(np.hstack([place, normal, at]).tolist()):
        lines.append(f"{k},f," + ",".join(f"{x:.9f}" for x in row) + ",0.7")
    return "\n".join(lines) + "\n"


def command(folder, job, kind, rng):
    """A call that the changed file matters to: every command, the slow ones at a small rate."""
    out, machine = str(folder / "out"), str(machine_of(folder))
    if kind is not tool and rng.random() < 0.3:
        if rng.random() < 0.1:
            return ["tables", "--machine", machine, "-o", out, "--format", "linuxcnc"]
        return ["accuracy", machine, "--grid", "2", "--json"]
    if rng.random() < 0.2:
        return ["predict", str(job), "--points", str(folder / "points.csv")]
    if rng.random() < SLOW_SHARE:
        return rng.choice((
            ["compensate", str(job), "-o", str(folder / "moved.nc")],
            ["tables", str(job), "-o", out, "--format", "linuxcnc"],
            ["run", measured(folder, job), "--no-solid", "--json", "--out", out],
            ["compare", measured(folder, job), "--json", "--out", out],
            ["diagnose", measured(folder, job), "--json", str(folder / "found.json")],
            ["add", measured(folder, job), "backlash:X"],
            ["history", measured(folder, job), "--json"],
        ))  # fmt: skip
    return ["path", str(job)]


def measured(folder, job):
    """The job with points that were measured in place, for commands that need some."""
    if "measured =" not in job.read_text(errors="replace"):
        job.write_bytes(b'measured = "measured.csv"\n' + job.read_bytes())
    return str(job)


def outcome(call):
    """What became of it: fault, refused, asked or silent; and the words."""
    result = CliRunner().invoke(app, call)
    error = result.exception
    if isinstance(error, Slow):
        return "slow", ""
    if error is None or (isinstance(error, SystemExit) and not error.code):
        said = result.output + result.stderr
        return ("asked" if "doubt: " in said or "contradiction: " in said else "silent"), said
    if isinstance(error, (VmachError, ProgramError, StockError, OSError, SystemExit)):
        return "refused", str(error)
    return "fault", f"{type(error).__name__}: {error}"


@cache
def displaced_um(machine_path, stamp):
    """Error of the tip over the machine's volume, (N, 3), um; tables hold beyond their ends."""
    machine = read_machine(machine_path)
    held = {name: replace(component, extrapolation=Extrapolation.HOLD)
            for name, component in machine.components.items()}  # fmt: skip
    axes = (np.linspace(*ends, 5) for ends in machine.travel_mm.T)
    nose = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    tool = np.array([0.0, 0.0, -120.0])
    moved = displacement(replace(machine, components=held), nose, tool, Variant.ABBE)
    return 1e3 * moved.shift_mm


def moved_um(folder, name):
    """How far a changed machine is from the sample's own, at most; a shift of all is none."""
    right = ROOT / "samples" / JOBS[name] / "machine.toml"
    change = displaced_um(machine_of(folder), object()) - displaced_um(right, None)
    return float(np.abs(change - change.mean(axis=0)).max())


def stop(*_):
    raise Slow


def fuzz(rounds, seed, show):
    rng = random.Random(seed)
    counts, examples = defaultdict(Counter), defaultdict(list)
    asked = Counter()
    signal.signal(signal.SIGPROF, stop)
    for number in range(rounds):
        name = rng.choice(sorted(JOBS))
        kind = CHANGES[number % len(CHANGES)]
        with tempfile.TemporaryDirectory() as place_:
            folder, job = sample(name, JOBS[name], Path(place_))
            change = kind(folder, job, rng)
            call = command(folder, job, kind, rng)
            asked[call[0]] += 1
            signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
            found, said = outcome(call)
            signal.setitimer(signal.ITIMER_PROF, 0)
            if change.kind in ("squareness", "place") and found == "silent":
                moved = moved_um(folder, name)
                found = "silent" if moved > HARMLESS_UM else "harmless"
                change = replace(change, told=f"{change.told}, {moved:.2f} um")
        counts[change.kind][found] += 1
        bad = found in ("fault", "slow") or (change.is_wrong and found == "silent")
        if bad or (show and found in ("silent", "harmless")):
            examples[found].append(f"{number}: {name}: {call[0]}: {change.told}: {said[:90]!r}")
        if bad:
            counts["BAD"]["silent and wrong" if found == "silent" else found] += 1
    return counts, examples, asked


def unchanged():
    """Every sample as it is: accepted without a doubt."""
    for name, machine in JOBS.items():
        with tempfile.TemporaryDirectory() as place_:
            folder, job = sample(name, machine, Path(place_))
            for call in (["path", str(job)], ["accuracy", str(machine_of(folder)), "--json"]):
                found, said = outcome([*call, *(["--grid", "2"] if call[0] == "accuracy" else [])])
                print(f"{name:28} {call[0]:9} {found}" + ("" if found == "silent" else said[:300]))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--list", action="store_true", help="also what was accepted in silence")
    options = parser.parse_args()
    unchanged()
    start = time.process_time()
    counts, examples, asked = fuzz(options.rounds, options.seed, options.list)
    bad = counts.pop("BAD", Counter())
    names = ("refused", "asked", "silent", "harmless", "slow", "fault")
    print(f"{'changed':22}" + "".join(f"{name:>9}" for name in names))
    for kind, row in counts.items():
        print(f"{kind:22}" + "".join(f"{row[name]:9}" for name in names))
    for found, lines in examples.items():
        print(f"\n{found}:", *lines[:40], sep="\n  ")
    print(f"\n{options.rounds} rounds, {time.process_time() - start:.0f} s of processor time")
    print("commands: " + ", ".join(f"{name} {count}" for name, count in asked.most_common()))
    print(f"exit 70: {bad['fault']}; above {LIMIT_S} s: {bad['slow']}; "
          f"wrong and silent: {bad['silent and wrong']}")  # fmt: skip


if __name__ == "__main__":
    main()
