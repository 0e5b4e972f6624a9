"""Mutilated STEP files: each must give a part or one clear error, and end.

    python tests/benchmarks/fuzz_step.py [COUNT] [SEED]

Inputs are all STEP files of the samples and the tests with bytes and tokens changed, lines moved,
and apostrophes, comments, escapes, brackets and numbers put in. Every file is read in a process of
its own, as the command line reads it, with a clock of processor time. Ends with 1 if a file made
the program fail.
"""

from __future__ import annotations

import argparse
import multiprocessing
import random
import re
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from vmach.errors import VmachError
from vmach.nominal import read_nominal

ROOT = Path(__file__).parents[2]
FILES = sorted([*(ROOT / "samples").rglob("*.step"), *(ROOT / "tests/golden/cad").glob("*.step")])
WARM_UP = FILES[0]
PIECES = [
    "'", "''", "'''", "\\", "\\S\\'", "\\X2\\00E9\\X0\\", "\\X4\\", "/*", "*/", "/**/", "/*'*/",
    "(", ")", "((((((((", ",", ",,", "$", "*", ";", "#", "#1", "#999999999", "#-1", "=", "!", '"',
    ".T.", ".F.", ".UNKNOWN.", "1e999", "-1e308", "0.", "-1", "1.E-400", "9" * 5000, "nan",
    "CLOSED_SHELL", "OPEN_SHELL", "B_SPLINE_SURFACE", "ENDSEC;", "DATA;", "\x00", "\xff", "\r",
    "(" * 20_000, "'" * 20_001, "#1=" * 5_000, " " * 50_000, "/*" * 20_000,
]  # fmt: skip
VALUES = [
    "0",
    "0.",
    "-1.",
    "1e30",
    "1e-30",
    "$",
    "*",
    "()",
    "(#1)",
    "''",
    ".F.",
    "3",
    "1000000",
    "-7",
]
ARGUMENT = re.compile(r"(?<=[(,])(#\d+|[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?|\.\w+\.|'[^']*'|\$)(?=[,)])")

#: a file takes more processor time than this: a hang
HANG_S = 20.0

#: it uses none and does not answer either: a hang too, however busy the computer is
DEAD_S = 900.0


def mutilated(text: str, rng: random.Random) -> str:
    for _ in range(rng.randint(1, 4)):
        kind = rng.randrange(7)
        at = rng.randrange(len(text) + 1)
        if kind == 0:
            text = text[:at] + rng.choice(PIECES) + text[at:]
        elif kind == 1:
            text = text[:at] + text[at + rng.randint(1, 20) :]
        elif kind == 2:
            end = at + rng.randint(0, 3)
            text = text[:at] + "".join(chr(rng.randrange(256)) for _ in range(3)) + text[end:]
        elif kind == 3:
            lines = text.split("\n")
            one, other = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[one], lines[other] = lines[other], lines[one]
            text = "\n".join(lines)
        else:  # an argument becomes another value, or one of another instance
            found = [match.span() for match in ARGUMENT.finditer(text)]
            if not found:
                continue
            start, end = rng.choice(found)
            other = slice(*rng.choice(found))
            value = rng.choice(VALUES) if kind == 4 else text[other]
            text = text[:start] + value + text[end:]
    return text


def outcome(path: Path) -> str:
    """What a user of the file meets."""
    try:
        part = read_nominal(path)
        part.sample(5.0)
    except VmachError as error:
        return (
            "message" if str(path) in str(error) or "accepted" in str(error) else f"vague: {error}"
        )
    except BaseException as error:  # that is what is looked for
        return f"exit 70: {type(error).__name__}: {error}"
    return "part"


def serve(pipe) -> None:
    """Answer for each path with the outcome and its processor time, s.

    The system ends the process when the time is up, whatever code it is in.
    """
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    while path := pipe.recv():
        signal.setitimer(signal.ITIMER_PROF, HANG_S if path != WARM_UP else 0.0)
        began = time.process_time()
        pipe.send((outcome(path), time.process_time() - began))
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def begin() -> tuple[multiprocessing.Process, object]:
    here, there = multiprocessing.Pipe()
    process = multiprocessing.Process(target=serve, args=(there,), daemon=True)
    process.start()
    here.send(WARM_UP)  # imports and compilation are not timed
    here.recv()
    return process, here


def answer(process: multiprocessing.Process, pipe: object, path: Path) -> tuple[str, float]:
    """What the process says of a file, and its processor time, s."""
    pipe.send(path)
    try:
        return pipe.recv() if pipe.poll(DEAD_S) else ("hang", DEAD_S)
    except EOFError:
        process.join()
    if process.exitcode == -signal.SIGPROF:
        return "hang", HANG_S
    return f"exit 70: the process died with {process.exitcode}", 0.0


def main(count: int, seed: int) -> int:
    rng = random.Random(seed)
    texts = [path.read_text(encoding="latin-1") for path in FILES]
    counts, longest, failures = Counter(), 0.0, 0
    process, pipe = begin()
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            path = Path(folder) / f"part{number}.step"
            base = rng.randrange(len(FILES))
            path.write_text(mutilated(texts[base], rng), encoding="latin-1", newline="")
            result, seconds = answer(process, pipe, path)
            longest = max(longest, seconds)
            kind = result.split(":")[0]
            counts[kind] += 1
            if kind not in ("part", "message"):
                failures += 1
                kept = Path(tempfile.gettempdir()) / f"fuzz_step_{seed}_{number}.step"
                kept.write_bytes(path.read_bytes())
                print(f"{FILES[base].name} -> {kept}: {result}")
            if kind == "hang" or not process.is_alive():
                process.kill()
                process, pipe = begin()
            path.unlink()
    print(f"| files | part | message | exit 70 | hang above {HANG_S:g} s | longest, s |")
    print("| --- | --- | --- | --- | --- | --- |")
    print(
        f"| {count} | {counts['part']} | {counts['message']} | {counts['exit 70']} | "
        f"{counts['hang']} | {longest:.1f} |"
    )
    return 1 if failures else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=300, help="files")
    parser.add_argument("seed", type=int, nargs="?", default=1)
    sys.exit(main(**vars(parser.parse_args())))
