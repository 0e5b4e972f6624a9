"""Exercise 3: error of the tool point from errors measured at another point of the slide.

python samples/exercises/exercise3.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.machine import Variant, displacement, read_machine

#: tool point B from point A, where the errors were measured
OFFSET_MM = np.array([300.0, 400.0, 500.0])
#: Table 2 of the paper: error in Y at B, um
PRINTED = (0, 8, 60, 81, 76, 17, -18, -47, -54)


def errors_at_b_um() -> np.ndarray:
    """Error of the tool point B at y = 0 ... 8 mm, (9, 3) um."""
    machine = read_machine(Path(__file__).with_name("machine.toml"))
    nose = np.zeros((9, 3))
    nose[:, 1] = np.arange(9)
    return 1e3 * displacement(machine, nose, OFFSET_MM, Variant.ABBE).shift_mm


def main() -> None:
    """Print the exercise with the paper\'s figures beside it."""
    print(" y, mm   dx, um    dy, um    dz, um    dy printed (Table 2)")
    for y, (error, printed) in enumerate(zip(errors_at_b_um(), PRINTED, strict=True)):
        dx, dy, dz = error
        print(f"{y:5d} {dx:9.3f} {dy:9.3f} {dz:9.3f} {printed:9d}")


if __name__ == "__main__":
    main()
