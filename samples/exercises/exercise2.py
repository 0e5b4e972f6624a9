"""Exercise 2: the homogeneous matrix of a vertical slide on a horizontal one.

    python samples/exercises/exercise2.py

Frame 2 sits on the vertical Z slide, frame 1 on the horizontal Y slide; at home frame 2 is at
(0, a, b) in frame 1. All errors are functions of z alone: only Z moves between the two frames.
"""

from __future__ import annotations

import numpy as np

SYMBOLS = (
    ("1", "-ECZ(z)", "EBZ(z)", "EXZ(z)"),
    ("ECZ(z)", "1", "-EAZ(z)", "a + EYZ(z)"),
    ("-EBZ(z)", "EAZ(z)", "1", "b + EZZ(z)"),
    ("0", "0", "0", "1"),
)


def matrix(errors: dict[str, float], a_mm: float, b_mm: float) -> np.ndarray:
    """Frame 2 to frame 1 for given errors, mm and rad (eq. 29)."""
    names = {f"{name}(z)": value for name, value in errors.items()} | {"a": a_mm, "b": b_mm}

    def number(text: str) -> float:
        if " + " in text:
            return sum(map(number, text.split(" + ")))
        if text.startswith("-"):
            return -number(text[1:])
        return names[text] if text in names else float(text)

    return np.array([[number(cell) for cell in row] for row in SYMBOLS])


def main() -> None:
    """Print the exercise with the paper\'s figures beside it."""
    print("frame 2 to frame 1, errors by their ISO 230-1 symbols (eq. 29):")
    for row in SYMBOLS:
        print("   " + "".join(f"{cell:>13}" for cell in row))
    errors = {"EXZ": 4e-3, "EYZ": -2e-3, "EZZ": 5e-3, "EAZ": 2e-5, "EBZ": -1e-5, "ECZ": 3e-5}
    point = np.array([120.0, -80.0, 200.0, 1.0])
    moved = matrix(errors, 300.0, 150.0) @ point - point - [0.0, 300.0, 150.0, 0.0]
    print(f"error of a point at {point[:3]} mm of frame 2: {np.round(1e3 * moved[:3], 3)} um")


if __name__ == "__main__":
    main()
