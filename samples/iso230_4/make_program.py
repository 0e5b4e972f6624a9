"""The program of the circular test: circles both ways round in three planes.

Run from anywhere:  python samples/iso230_4/make_program.py

The first pair is cut, as a ring groove; the pairs in ZX and YZ are made above the part. Half a
circle leads into every circle, so that both axes have reversed before the full turn begins.
"""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).resolve().parent
GROOVE_RADIUS_MM, AIR_RADIUS_MM, AIR_HEIGHT_MM = 100.0, 50.0, 80.0
FEED_MM_MIN = 1000
HEADER = """\
%
O2304 (CIRCULAR TEST: RADIUS 100 IN XY AS A GROOVE, RADIUS 50 IN ZX AND YZ ABOVE THE PART)
(PLATE 240 X 240 X 20, ZERO AT THE CENTRE OF THE TOP FACE)
(T1 END MILL D10 Z3, CUTS OVER ITS CENTRE)
G21 G17 G90 G94 G40 G49 G80
G54
T1 M6
S5000 M3
G4 P2
G0 X-100. Y0.
G43 H1 Z50. M8
Z2.
G1 Z-1. F150
"""

#: plane, words of both axes and of their centres; in the order that counter-clockwise goes
PLANES = {"G17": ("X", "Y", "I", "J"), "G18": ("Z", "X", "K", "I"), "G19": ("Y", "Z", "J", "K")}


def pair(plane: str, radius_mm: float, middle: tuple[float, float]) -> list[str]:
    """Counter-clockwise, then clockwise, from the far side of the first axis."""
    first, _, to_first, to_second = PLANES[plane]
    blocks = [plane]
    for word in ("G3", "G2"):
        blocks += [
            f"{word} {first}{middle[0] + radius_mm:.4f} {to_first}{radius_mm:.4f} {to_second}0. "
            f"F{FEED_MM_MIN}",
            f"{word} {to_first}{-radius_mm:.4f} {to_second}0.",
            f"{word} {first}{middle[0] - radius_mm:.4f} {to_first}{-radius_mm:.4f} {to_second}0.",
        ]
    return blocks


def program() -> str:
    """The whole program."""
    blocks = ["(--- XY)", *pair("G17", GROOVE_RADIUS_MM, (0.0, 0.0))]
    low = AIR_HEIGHT_MM - AIR_RADIUS_MM
    blocks += ["G0 Z50. M9", "(--- ZX)", "X0. Y0.", f"Z{low:.4f}"]
    blocks += pair("G18", AIR_RADIUS_MM, (AIR_HEIGHT_MM, 0.0))
    blocks += ["(--- YZ)", f"G0 Z{AIR_HEIGHT_MM:.4f}", f"Y{-AIR_RADIUS_MM:.4f}"]
    blocks += pair("G19", AIR_RADIUS_MM, (0.0, AIR_HEIGHT_MM))
    blocks += ["G17", "G0 Z150.", "M5", "M30", "%"]
    return HEADER + "\n".join(blocks) + "\n"


if __name__ == "__main__":
    (FOLDER / "part.nc").write_text(program())
