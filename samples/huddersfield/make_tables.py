"""Error tables of the machine whose model the paper prints at one position.

Run from anywhere:  python samples/huddersfield/make_tables.py

Every error grows in proportion to the position of its axis, from nothing at home to the printed
value at X 6000, Y 3000, Z 350 mm.
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).resolve().parent
PLACE_MM = {"X": 6000.0, "Y": 3000.0, "Z": 350.0}
END_MM = {"X": 12000.0, "Y": 4000.0, "Z": 2000.0}
#: printed, um, and for angles the printed product over its arm, urad, in the paper's signs
PRINTED = {
    "EXX": 331.98, "EXY": -32.193, "EXZ": 1.303,
    "EYY": 9.2, "EYX": -38.554, "EYZ": -18.188,
    "EZZ": 9.2, "EZX": -39.759, "EZY": 21.126,
    "EBX": 9.975 / 0.350, "EBY": 0.0, "ECX": 61.5 / 3.000,
    "EAX": -2.45 / 0.350, "EAY": 1.51655 / 0.350,
}  # fmt: skip
#: tables are this far apart
STEPS = 20


def rows(name: str) -> str:
    """A table through zero and the printed value, with positions that hit the place."""
    axis = name[2]
    positions = sorted({END_MM[axis] * k / STEPS for k in range(STEPS + 1)} | {0.0, PLACE_MM[axis]})
    lines = ["position_mm,forward,backward"]
    for position in positions:
        value = PRINTED[name] * position / PLACE_MM[axis]
        lines.append(f"{position:g},{value:.9g},{value:.9g}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for error in PRINTED:
        (FOLDER / "errors" / f"{error}.csv").write_text(rows(error))
