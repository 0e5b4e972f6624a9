"""Mutated files of every kind that is imported: each is read, or refused with one message.

    python -m tests.benchmarks.fuzz_imports [COUNT] [SEED]

A traceback, a value that is no number, a refusal without its file, or a line that takes longer than
20 s is a fault. The table counts what was read and what was refused, with and without a line.
"""

from __future__ import annotations

import random
import re
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

from tests.import_samples import SAMPLES, Sample, write_plate_job
from vmach.errors import InputError
from vmach.importers import Questions, import_files
from vmach.importers.toml_text import section_text

LONGEST_S = 20.0
_STRANGE = ["", "nan", "inf", "1e400", "-1e9", "1_000", "٣", "\0", "'", '"', ";", ",", "<", "&",
            "é", "--5", "1,2,3", "0x10", "\t", "[", "9" * 50]  # fmt: skip


def mutated(text: str, random_: random.Random) -> str:
    """One to three changes of a text: cells, lines, characters."""
    for _ in range(random_.randint(1, 3)):
        kind = random_.randrange(7)
        lines = text.split("\n")
        at = random_.randrange(len(lines))
        if kind == 0:
            del lines[at]
        elif kind == 1:
            lines.insert(at, lines[random_.randrange(len(lines))])
        elif kind == 2:
            lines = lines[:at]
        elif kind == 3:
            places = [*re.finditer(r"[-+0-9.,]+", lines[at])]
            if places:
                one = random_.choice(places)
                new = random_.choice(_STRANGE)
                lines[at] = lines[at][: one.start()] + new + lines[at][one.end() :]
        elif kind == 4:
            words = lines[at].split()
            random_.shuffle(words)
            lines[at] = " ".join(words)
        else:
            place = random_.randrange(len(lines[at]) + 1)
            put = random_.choice(_STRANGE) if kind == 5 else chr(random_.randrange(32, 300))
            lines[at] = lines[at][:place] + put + lines[at][place + random_.randrange(3) :]
        text = "\n".join(lines)
    return text


def outcome(sample: Sample, text: str, folder: Path, job: Path) -> str:
    """``read``, ``refused with a line``, ``refused`` or what went wrong."""
    path = sample.write(folder, text)
    start = time.perf_counter()
    try:
        (one,) = import_files([path], Questions(sample.answers, job_file=job), kind=sample.kind)
    except InputError as error:
        if error.file is None:
            return f"FAULT: no file in '{error}'"
        if error.line is None:
            return f"refused, {error.what[:30]}"
        return "refused with a line"
    except Exception:
        return "FAULT: " + traceback.format_exc()
    if time.perf_counter() - start > LONGEST_S:
        return f"FAULT: {time.perf_counter() - start:.1f} s"
    written = "".join(one.files.values()) + "".join(map(section_text, one.sections))
    if re.search(r"[,= ](nan|inf)\b", written):  # a run may be called so
        return f"FAULT: writes no number: {written[:200]}"
    return "read"


def main() -> None:
    """Print a row for each sample; exit status 1 where anything went wrong."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    warnings.simplefilter("error")
    faults = 0
    with tempfile.TemporaryDirectory() as room:
        job = write_plate_job(Path(room))
        (Path(room) / "in").mkdir()
        for sample in SAMPLES:
            random_ = random.Random(f"{seed} {sample.kind} {sample.file}")
            texts = (mutated(sample.text, random_) for _ in range(count))
            found = [(text, outcome(sample, text, Path(room) / "in", job)) for text in texts]
            table = Counter(said.split("\n")[0][:60] for _, said in found)
            print(f"{sample.kind:18} {sample.file:12}", dict(table))
            wrong = [(text, said) for text, said in found if said.startswith("FAULT")]
            faults += len(wrong)
            for text, said in wrong[:2]:
                print(said, repr(text[:400]), sep="\n")
    print(f"{faults} faults in {count * len(SAMPLES)} files")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
