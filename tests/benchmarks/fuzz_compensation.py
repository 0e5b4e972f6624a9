"""Programs in other people's habits, compensated and judged by LinuxCNC.

    python tests/benchmarks/fuzz_compensation.py FOLDER [--rounds 50] [--seed 0] [--machine FILE]

Takes programs of FOLDER that LinuxCNC accepts, changes case, blanks, signs, zeros, block numbers,
slashes, comments, line endings and modal words at random, without changing the path, and
compares LinuxCNC's path of the compensated text with the intended one.
"""

import argparse
import random
import re
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.oracle.compensation_corpus import corpus_programs, judged

WORD = re.compile(
    r"(?<![\w#\[<])([XYZIJKRF])\s*([+-]?)\s*(\d*)(\.?)(\d*)(?![\d.\[#])", re.IGNORECASE
)
COMMENT = re.compile(r"\([^)\n]*\)|;.*")


def on_code(text, change):
    """Change what is no comment."""
    pieces, position = [], 0
    for comment in COMMENT.finditer(text):
        pieces += [change(text[position : comment.start()]), comment.group()]
        position = comment.end()
    return "".join([*pieces, change(text[position:])])


def words(chance, rng, change):
    def replace(match):
        return change(*match.groups()) if rng.random() < chance else match.group()

    return lambda code: WORD.sub(replace, code)


def with_sign(letter, sign, whole, point, rest):
    return f"{letter}{sign or '+'}{whole}{point}{rest}" if whole or rest else letter + sign


def without_zero(letter, sign, whole, point, rest):
    return f"{letter}{sign}{whole.lstrip('0') if rest else whole}{point}{rest}"


def with_zeros(letter, sign, whole, point, rest):
    return f"{letter}{sign}00{whole or '0'}{point or '.'}{rest}0"


def with_blanks(letter, sign, whole, point, rest):
    return f"{letter} {sign} {whole}{point}{rest} "


def is_plain(text):
    """No O-words or percent sign, so that lines may get numbers and slashes."""
    return re.search(r"(?im)^\s*(/|n?\d*\s*o|%)|M\s*98|M\s*99", text) is None


def mutated(text, rng):
    """One program in other habits."""
    for change in (with_sign, without_zero, with_zeros, with_blanks):
        if rng.random() < 0.4:
            text = on_code(text, words(rng.choice((0.1, 1.0)), rng, change))
    if rng.random() < 0.3:
        text = on_code(text, str.lower if rng.random() < 0.5 else str.upper)
    if rng.random() < 0.3 and "<" not in text:
        text = on_code(text, lambda code: re.sub(r"[ \t]+(?=[A-Za-z\d.+-])", "", code))
    lines = text.splitlines()
    if is_plain(text):
        if rng.random() < 0.4 and not any(re.match(r"(?i)\s*n", line) for line in lines):
            step = rng.choice((1, 5, 10))
            lines = [f"N{step * k} {line}" if COMMENT.sub("", line).strip() else line
                     for k, line in enumerate(lines, 1)]  # fmt: skip
        if rng.random() < 0.3:
            lines = ["/" + line if rng.random() < 0.1 else line for line in lines]
    if rng.random() < 0.3:
        lines = [line + rng.choice((" (note X1 Y2)", " ; note", "\t", "")) for line in lines]
    text = rng.choice(("\n", "\r\n")).join(lines)
    return text if rng.random() < 0.3 else text + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--machine", type=Path, help="machine file with measured errors")
    parser.add_argument("--largest-kb", type=float, default=4.0)
    arguments = parser.parse_args()
    rng = random.Random(arguments.seed)
    programs = [p for p in corpus_programs(arguments.folder)
                if p.stat().st_size <= 1024 * arguments.largest_kb]  # fmt: skip
    faults = refused = 0
    for number in range(arguments.rounds):
        source = rng.choice(programs)
        text = mutated(source.read_text(encoding="latin-1"), rng)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / source.name
            path.write_bytes(text.encode("latin-1"))
            for table in (source.name + ".tbl", "tool.tbl"):
                if source.with_name(table).exists():
                    (Path(folder) / table).write_bytes(source.with_name(table).read_bytes())
            outcome = judged(Path(folder) / "job", path, machine=arguments.machine)
        if outcome.refusal is not None:
            refused += 1
            print(f"{number} refused: {outcome.refusal.rsplit('/', 1)[-1][:150]}")
        wrong = outcome.linuxcnc or (outcome.wrong and outcome.wrong[0])
        if wrong and "original refused" not in wrong:
            faults += 1
            kept = Path(tempfile.gettempdir()) / f"fault_{arguments.seed}_{number}_{source.name}"
            kept.write_bytes(text.encode("latin-1"))
            print(f"{number} {source.name}: {wrong[:200]}; program in {kept}")
    print(f"{arguments.rounds} programs, {refused} refused, {faults} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
