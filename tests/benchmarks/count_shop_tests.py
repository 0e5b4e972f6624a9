"""How often what is plain is shown of plates, axes, circles and levels without any table.

    python tests/benchmarks/count_shop_tests.py --seed SEED [--count 100] [--rows counts.csv]

Each case is drawn by `tests/hidden_effects/shop_tests.py` and diagnosed through the command line.
Printed is a table with limits of 95 % (Clopper and Pearson).
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.benchmarks.bench_hidden_effects import binomial, write_rows
from tests.hidden_effects import program_runs
from tests.hidden_effects.shop_tests import make_axis, make_ballbar, make_level, make_plate
from vmach.effects import label_of

#: what is left of an axis at most, um
LEFT_UM = 4.0
#: maps of an axis: what bends over a plate is one of them, or is left
_KINDS = {"plate": make_plate, "axis": make_axis, "ballbar": make_ballbar, "level": make_level}
_MAPS = ("component", "scale", "squareness", "workpiece_temperature")


def judged(folder: Path, kind: str) -> dict[str, object]:
    """A row: what of the truth was shown, what was said besides, what is left."""
    truth = json.loads((folder / "truth.json").read_text())
    report, seconds = program_runs.diagnose(folder)
    said = [entry for entry in report["effects"] if entry["effect"] != "unknown"]
    classes = [{_label(entry), *entry["rivals"]} for entry in said]
    shown = [any(c & {*names} for c in classes) for names in truth["hidden"]]
    led = [any(_label(entry) in names for entry in said) for names in truth["hidden"]]
    true = {name for names in truth["hidden"] for name in names}
    false = [
        _label(entry)
        for entry, its in zip(said, classes, strict=True)
        if not its & true and not (kind in ("plate", "axis") and entry["effect"] in _MAPS)
    ]
    row = {"kind": kind, "verdict": report["verdict"], "all": all(shown), "clean": not shown}
    if kind in ("plate", "axis"):
        row |= {"first": shown[0], "second": shown[1], "led_first": led[0], "led_second": led[1]}
    of = dict(zip((names[0] for names in truth["hidden"]), shown, strict=True))
    pitch = [hit for name, hit in of.items() if name.startswith("cyclic_pitch")]
    row |= {"pitch": sum(pitch) if pitch else "", "size": of.get("tool_radius T1", "")}
    row |= {"false": " ".join(false)}
    row |= {"left_um": report["remains_um"], "seconds": round(seconds, 2), "inside": ""}
    row["is_left_ok"] = report["remains_um"] <= max(LEFT_UM, truth.get("rest_um", LEFT_UM))
    for entry in said:
        if entry["effect"] == "backlash" and kind == "axis":
            low, high = entry["interval_95"]["reversal_um"]
            row["inside"] = int(low <= truth["reversal_um"] <= high)
    return row


def _label(entry: dict) -> str:
    return label_of(entry["effect"], entry["target"] or "")


def print_table(rows: list[dict]) -> None:
    """Counts as Markdown."""
    print("| of | count | share | 95 % limits |\n|---|---|---|---|")
    plates, axes, circles, levels = ([r for r in rows if r["kind"] == kind] for kind in _KINDS)
    pitch = [r["pitch"] for r in plates if r["pitch"] != ""]
    inside = [r["inside"] for r in axes if r["inside"] != ""]
    sizes = [r["size"] for r in plates if r["size"] != ""]
    clean, pitched = ([r for r in levels if r["clean"] == wanted] for wanted in (True, False))
    for name, hits, count in (
        ("plates: scale or temperature shown", sum(r["first"] for r in plates), len(plates)),
        ("plates: the same, first of its class", sum(r["led_first"] for r in plates), len(plates)),
        ("plates: squareness shown", sum(r["second"] for r in plates), len(plates)),
        ("plates: the same, first of its class", sum(r["led_second"] for r in plates), len(plates)),
        ("plates: pitch errors of 1 to 3 um shown", sum(pitch), 2 * len(pitch)),
        ("plates: size of the drill shown", sum(sizes), len(sizes)),
        ("plates: a false name", sum(bool(r["false"]) for r in plates), len(plates)),
        ("axes: lost motion shown", sum(r["first"] for r in axes), len(axes)),
        ("axes: 95 % intervals of it that hold its mean", sum(inside), len(inside)),
        ("axes: a map shown", sum(r["second"] for r in axes), len(axes)),
        (f"axes: {LEFT_UM:g} um left at most, or what is true", sum(r["is_left_ok"] for r in axes),
         len(axes)),
        ("axes: a false name", sum(bool(r["false"]) for r in axes), len(axes)),
        ("ballbars: all effects shown", sum(r["all"] for r in circles), len(circles)),
        ("ballbars: a false name", sum(bool(r["false"]) for r in circles), len(circles)),
        ("levels: pitch shown", sum(r["all"] for r in pitched), len(pitched)),
        ("levels: nothing, where nothing is", sum(r["verdict"] == "nothing" for r in clean),
         len(clean)),
    ):  # fmt: skip
        if count:
            low, high = binomial(hits, count)
            shares = f"{hits / count:.0%} | {low:.0%} to {high:.0%}"
            print(f"| {name} | {hits} of {count} | {shares} |")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=100, help="of each kind")
    parser.add_argument("--rows", type=Path, help="a file that gets a row of each case")
    args = parser.parse_args()
    rows: list[dict] = []
    for seed in range(args.seed, args.seed + args.count):
        for kind, make in _KINDS.items():
            with tempfile.TemporaryDirectory() as name:
                folder = Path(name) / kind
                make(folder, seed)
                rows.append({"seed": seed} | judged(folder, kind))
    if args.rows:
        write_rows(args.rows, rows)
    print_table(rows)


if __name__ == "__main__":
    main()
