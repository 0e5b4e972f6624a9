"""Exercise 1: lateral and Abbe error of a probe on a cantilever beam.

    python samples/exercises/exercise1.py

The beam sags under the weight of the probe, wherever the probe stands on it. Sag and slope are the
straightness and the pitch error of the probe's axis; the probe's length is the arm.
"""

from __future__ import annotations

import numpy as np

from vmach.machine import Axis, Chain, ComponentError, Machine, Motion, Variant, displacement

LENGTH_MM, WIDTH_MM, DEPTH_MM = 250.0, 25.0, 50.0
WEIGHT_N, MODULUS_N_PER_MM2 = 100.0, 210e3
PROBE_MM = 100.0


def sag_and_slope(x_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sag, mm, and slope, rad, of the beam under a load at x (eq. 26)."""
    inertia_mm4 = WIDTH_MM * DEPTH_MM**3 / 12.0
    stiffness = MODULUS_N_PER_MM2 * inertia_mm4
    return WEIGHT_N * x_mm**3 / (3.0 * stiffness), WEIGHT_N * x_mm**2 / (2.0 * stiffness)


def beam_machine() -> Machine:
    """An X axis along the beam that carries the probe; X from the wall, Z up."""
    x = np.linspace(0.0, LENGTH_MM, 26)
    sag, slope = sag_and_slope(x)
    origin = np.zeros(3)
    return Machine(
        name="beam",
        chain=Chain.parse("t X Y Z b w"),
        axes={axis: Axis(0.0, LENGTH_MM) for axis in "XYZ"},
        motion=Motion(rapid_mm_per_min=1000.0),
        components={
            "EZX": ComponentError("EZX", x, -sag, -sag, origin),
            "EBX": ComponentError("EBX", x, slope, slope),
        },
        squareness_rad=np.zeros((3, 3)),
    )


def tip_error_um() -> np.ndarray:
    """Error of the probe's tip at the end of the beam, um."""
    end = np.array([[LENGTH_MM, 0.0, 0.0]])
    tip = np.array([0.0, 0.0, -PROBE_MM])
    return 1e3 * displacement(beam_machine(), end, tip, Variant.ABBE).shift_mm[0]


def main() -> None:
    """Print the exercise with the paper\'s figures beside it."""
    sag, slope = sag_and_slope(np.array(LENGTH_MM))
    x, _, z = tip_error_um()
    print("                              here     printed in the paper")
    print(f"second moment of area, m4     {WIDTH_MM * DEPTH_MM**3 / 12e12:.4e}")
    print(f"lateral error (sag), um       {1e3 * sag:.3f}    9.54, about 10")
    print(f"slope, urad                   {1e6 * slope:.2f}    57")
    print(f"slope, arcsec                 {np.degrees(slope) * 3600:.2f}    12")
    print(f"Abbe error, um                {1e3 * slope * PROBE_MM:.3f}    5.7, about 6")
    print(f"tip by the machine model, um  X {x:.3f}, Z {z:.3f}")


if __name__ == "__main__":
    main()
