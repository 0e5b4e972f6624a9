"""Random and mutilated programs: each must give a result or one clear error, and end.

    python tests/benchmarks/fuzz_gcode.py [INPUTS] [SEED] [CONTROL] [FOLDER]

Inputs are the golden programs or a few of their lines, with bytes changed, lines shuffled, words
exchanged, and random words of the language in random order, in all dialects; or those that hold
every word of a control; or all files of a folder, for programs from elsewhere. The compiled lane is
compiled first: what it takes is no program's.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import time
import traceback
from collections import Counter
from pathlib import Path

from gcode import ProgramError, Source, ToolEntry, canon_lines, read_program

GOLDEN = Path(__file__).parents[1] / "golden" / "gcode"
CONTROLS = GOLDEN.with_name("controls")
#: control -> whose programs it is given
LIKE = {
    "haas": "fanuc",
    "mach": "fanuc",
    "centroid": "fanuc",
    "mazak": "fanuc",
}
#: language -> lines before a stretch of a program, so that it begins with a tool, a feed, a place
_HEAD = b"G21 G90 G54 F100\nS500 M3\nG0 X0 Y0 Z50.\n"
HEADS = {
    "fanuc": b"T1 M6\nG43 H1\n" + _HEAD,
    "grbl": _HEAD,
    "okuma": b"T1 M6\nG15 H1\nG56 H1\n" + _HEAD.replace(b" G54", b""),
    "heidenhain": b"TOOL CALL 1 Z S1000 F100\nL X+0 Y+0 Z+50 R0 FMAX M3\n",
    "tnciso": b"%A G71 *\nN1 T1 G17 S1000 F100 *\nN2 G90 G00 G40 X+0 Y+0 Z+50 M3 *\n",
    "sinumerik": b"T1 D1 M6\n" + _HEAD.replace(b"G21", b"G71"),
}
TOOLS = {n: ToolEntry(10.0 * n, 2.0 * n) for n in range(2, 6)} | {
    1: ToolEntry(100, 10, name="MILL_10")
}
DIALECTS = ("auto", "linuxcnc", "linuxcnc", "fanuc", "haas", "heidenhain", "sinumerik", "grbl")
PIECES = [
    *"XYZABCIJKRPQLFSTHDE[]#<>()=*/+-%;:@^$ \t", "G0", "G1", "G2", "G3", "G41", "G42", "G41.1",
    "G40", "G17", "G18", "G81", "G83", "G76", "G33", "G5", "G5.2", "G5.3", "G10", "G92", "G43",
    "G93", "G95", "G54", "M6", "M98", "M99", "M2", "O1", "O<a>", " sub", " endsub", " call",
    " while", " endwhile", " if", " else", " endif", " repeat", " endrepeat", "sqrt", "atan",
    "1", "-2.5", "1e5", "99999999999999999999", ".0001", "#1", "##2", "#<_x>", " EQ ", " MOD ",
    "**", "GOTO 1", "WHILE[1 EQ 1]DO1", "END1", "G65 P1 ", "L X+1 FMAX", "CC X+0", "C X+1 DR+",
    "LBL 1", "CALL LBL 1 REP 2", "TOOL CALL 1 Z S1", "CR=5", "TURN=2", "X=1", "\xff", "\x00",
]  # fmt: skip
SLOW_S = 5.0
CHANGED = 0.9  #: share of the inputs that are changed programs; the others are random words
WHOLE = 0.4  #: share of those that are changed from a whole program
MOST_BYTES = 20_000  #: of a program from elsewhere
_PLAIN = b"G21 G90 G54\nG0 X1\nG1 Y2 F100\nG2 X3 I1 J0\nG81 Z-1 R1\nG80\nM2\n"
#: dialect -> a program that asks for its compiled lane
WARMING = {"linuxcnc": _PLAIN, "fanuc": _PLAIN, "sinumerik": b"G1 X1 F100\nX2\n",
           "heidenhain": b"L X+1 F100\nL X+2\n"}  # fmt: skip


def stretch(text: bytes, rng: random.Random) -> bytes:
    """A few lines of a program that follow each other."""
    lines = text.split(b"\n")
    begin = rng.randrange(len(lines))
    return b"\n".join(lines[begin : begin + rng.randint(1, 12)])


def mutilated(texts: list[bytes], head: bytes, rng: random.Random) -> bytes:
    """A whole program, or a few lines below a sound head, changed at some places."""
    whole, chosen = rng.random() < WHOLE, rng.choice(texts)
    text = bytearray(chosen if whole else stretch(chosen, rng))
    for _ in range(rng.randint(1, 5 if whole else 2)):
        at = rng.randrange(len(text) + 1)
        kind = rng.randrange(5)
        if kind == 0:
            text[at : at + rng.randint(0, 4)] = rng.randbytes(rng.randint(0, 4))
        elif kind == 1:
            text[at:at] = rng.choice(PIECES).encode("latin-1")
        elif kind == 2:
            other = rng.choice(texts)
            begin = rng.randrange(len(other))
            text[at : at + rng.randint(0, 30)] = other[begin : begin + rng.randint(0, 60)]
        elif kind == 3:
            lines = bytes(text).split(b"\n")
            rng.shuffle(lines)
            text = bytearray(b"\n".join(lines))
        else:
            del text[at : at + rng.randint(1, 20)]
    return bytes(text) if whole else head + bytes(text)


def random_program(rng: random.Random) -> bytes:
    lines = ["".join(rng.choices(PIECES, k=rng.randint(0, 8))) for _ in range(rng.randint(1, 15))]
    return "\n".join(lines).encode("latin-1")


def outcome(text: bytes, rng: random.Random, dialect: str) -> str:
    """Read one input; returns what happened, raises for anything that should not happen."""
    try:
        program = read_program(Source(text), tools=TOOLS, max_blocks=2000,
                               dialect=dialect, fast=rng.random() < 0.5)  # fmt: skip
        len(program.moves)
        if rng.random() < 0.1:
            sum(1 for _ in canon_lines(program))
    except ProgramError as error:
        if not re.match(r"<program>:\d+:", str(error)) or "\n" in str(error):
            raise AssertionError(f"unclear message: {error}") from None
        return "refused"
    return "read"


def arguments() -> argparse.Namespace:
    """What is typed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("inputs", nargs="?", type=int, default=100_000)
    parser.add_argument("seed", nargs="?", type=int, default=1)
    parser.add_argument("control", nargs="?", default="", help="all dialects where it is not given")
    parser.add_argument("folder", nargs="?", type=Path, help="of programs to change")
    return parser.parse_args()


def main() -> int:
    asked = arguments()
    count, control, rng = asked.inputs, asked.control, random.Random(asked.seed)
    like = LIKE.get(control, control)
    found = CONTROLS.glob(f"*.{like}.*") if control else GOLDEN.glob("*.ngc")
    head = HEADS.get(like, b"")
    if asked.folder:
        found = (path for path in asked.folder.rglob("*") if path.is_file())
    texts = [path.read_bytes()[:MOST_BYTES] for path in sorted(found)]
    for dialect, program in WARMING.items():
        read_program(Source(program), tools=TOOLS, dialect=dialect, fast=True)
    counts: Counter[str] = Counter()
    slowest = 0.0
    for _ in range(count):
        text = mutilated(texts, head, rng) if rng.random() < CHANGED else random_program(rng)
        start = time.perf_counter()
        try:
            counts[outcome(text, rng, control or rng.choice(DIALECTS))] += 1
        except Exception:
            counts["failed"] += 1
            print(repr(text), traceback.format_exc(), sep="\n")
        took = time.perf_counter() - start
        if took > SLOW_S:
            print(f"{took:.1f} s: {text!r}")
        slowest = max(slowest, took)
    print(f"{count} inputs: {dict(counts)}, slowest {slowest:.2f} s")
    return int(counts["failed"] > 0 or slowest > SLOW_S)


if __name__ == "__main__":
    sys.exit(main())
