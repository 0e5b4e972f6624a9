"""The program of the circle-diamond-square test piece.

Run from anywhere:  python samples/nas979/make_program.py

One down-milled contour finishes each step, the tool beside it. Corners are sharp.
"""

from __future__ import annotations

import math
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
SQUARE_MM, DIAMOND_MM, CIRCLE_MM, BORE_MM = 127.0, 88.0, 86.0, 25.4
TOOL_RADIUS_MM, BORE_TOOL_RADIUS_MM = 10.0, 6.0
#: lower end of circle, diamond, square
CIRCLE_Z_MM, DIAMOND_Z_MM, SQUARE_Z_MM = -6.35, -12.7, -25.4
FEED_MM_MIN = 500
HEADER = """\
%
O0979 (CIRCLE 86, DIAMOND 88 ACROSS FLATS, SQUARE 127, BORE 25.4)
(BLANK 130 X 130 X 38.1, ZERO AT THE CENTRE OF THE TOP FACE)
(T1 END MILL D20 Z4, FINISHING; T2 END MILL D12 Z3, CUTS OVER ITS CENTRE)
G21 G17 G90 G94 G40 G49 G80
G54
"""


def corners(across_mm: float, turn_deg: float) -> list[tuple[float, float]]:
    """Corners of the tool path round a square, clockwise from the upper left."""
    reach = math.sqrt(2.0) * (across_mm / 2 + TOOL_RADIUS_MM)
    angles = (math.radians(turn_deg + a) for a in (135.0, 45.0, -45.0, -135.0))
    return [(reach * math.cos(a), reach * math.sin(a)) for a in angles]


def square(across_mm: float, turn_deg: float, bottom_mm: float) -> list[str]:
    """Once round a square, clockwise, which is down-milling outside."""
    path = corners(across_mm, turn_deg)
    (x0, y0), (x1, y1) = path[0], path[1]
    # from one tool radius before the first corner, along the first side
    length = math.hypot(x1 - x0, y1 - y0)
    before = (x0 - 25.0 * (x1 - x0) / length, y0 - 25.0 * (y1 - y0) / length)
    blocks = [f"G0 X{before[0]:.4f} Y{before[1]:.4f}", "Z2.", f"G1 Z{bottom_mm:.4f} F1000"]
    blocks.append(f"X{x1:.4f} Y{y1:.4f} F{FEED_MM_MIN}")
    blocks += [f"X{x:.4f} Y{y:.4f}" for x, y in (*path[2:], path[0])]
    return [*blocks, "G0 Z50."]


def circle() -> list[str]:
    """Once round the circle, clockwise, with quarter circles to it and away."""
    radius = CIRCLE_MM / 2 + TOOL_RADIUS_MM
    return [
        f"G0 X{-radius - 20:.4f} Y-20.",
        "Z2.",
        f"G1 Z{CIRCLE_Z_MM:.4f} F1000",
        f"G3 X{-radius:.4f} Y0. I0. J20. F{FEED_MM_MIN}",
        f"G2 I{radius:.4f} J0.",
        f"G3 X{-radius - 20:.4f} Y20. I-20. J0.",
        "G0 Z50.",
    ]


def bore() -> list[str]:
    """The bore, counter-clockwise, through the part."""
    radius = BORE_MM / 2 - BORE_TOOL_RADIUS_MM
    return [
        "G0 X0. Y0.",
        "Z2.",
        "G1 Z-38.6 F150",
        f"X{radius:.4f} F{FEED_MM_MIN}",
        f"G3 I{-radius:.4f} J0.",
        "G1 X0.",
        "G0 Z50.",
    ]


def program() -> str:
    """The whole program."""
    blocks = ["T1 M6", "S2500 M3", "G4 P2", "G0 X-110. Y0.", "G43 H1 Z50. M8"]
    blocks += ["(--- SQUARE)", *square(SQUARE_MM, 0.0, SQUARE_Z_MM)]
    blocks += ["(--- DIAMOND, TWO PASSES FURTHER OUT FIRST)"]
    for across_mm in (DIAMOND_MM + 72.0, DIAMOND_MM + 36.0, DIAMOND_MM):
        blocks += square(across_mm, 45.0, DIAMOND_Z_MM)
    blocks += ["(--- CIRCLE)", *circle(), "M9", "M5"]
    blocks += ["(--- BORE)", "T2 M6", "S4000 M3", "G4 P2", "G0 X0. Y0.", "G43 H2 Z50. M8", *bore()]
    return HEADER + "\n".join([*blocks, "M9", "M5", "M30", "%"]) + "\n"


if __name__ == "__main__":
    (FOLDER / "part.nc").write_text(program())
