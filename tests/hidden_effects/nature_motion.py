"""Effects of the axes: direction, position, drives. Each draws itself and says what it does."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .state import Hidden, State

__all__ = ["MOTION"]

UM = 1e-3


def backlash(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The table lags by half the play; the flank is taken up over a few hundredths of a mm."""
    axis, play = int(rng.integers(2)), rng.uniform(5, 12)
    take_up = rng.uniform(0.005, 0.02)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        ease = 1 - 2 * np.exp(-state.since_reversal_mm[:, axis] / take_up)
        e[:, axis] = -0.5 * play * UM * state.sign[:, axis] * ease
        return e

    return Hidden(
        "backlash",
        ("backlash",),
        {"axis": "XYZ"[axis], "play_um": play, "take_up_mm": take_up},
        move,
        {"reversal_um": play},
        target="XYZ"[axis],
    )


def scale(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A scale that grew since the calibration."""
    axis, ppm = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(12, 35)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = ppm * 1e-6 * state.nose_mm[:, axis]
        return e

    # a straight ramp in the position table is the same thing
    return Hidden(
        "scale",
        ("scale", f"component E{'XYZ'[axis]}{'XYZ'[axis]}"),
        {"axis": "XYZ"[axis], "ppm": ppm},
        move,
        {"scale_ppm": ppm},
        target="XYZ"[axis],
    )


def squareness(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A guide that turned, by a collision say."""
    name = str(rng.choice(["C0Y", "B0X", "A0Y"]))
    urad = rng.choice([-1, 1]) * rng.uniform(15, 45)
    straight = {"C0Y": "EXY", "B0X": "EZX", "A0Y": "EZY"}[name]  # its slope is the same thing

    def move(state: State) -> np.ndarray:
        x, y, _ = state.nose_mm.T * urad * 1e-6
        e = np.zeros_like(state.nose_mm)
        out, value = {"C0Y": (0, -y), "B0X": (2, -x), "A0Y": (2, y)}[name]
        e[:, out] = value
        return e

    return Hidden(
        "squareness",
        ("squareness", f"component {straight}"),
        {"which": name, "urad": urad},
        move,
        {"squareness_urad": urad},
        target=name,
    )


def cyclic_pitch(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Once per turn of the screw, with a weak second harmonic."""
    axis, size = int(rng.integers(2)), rng.uniform(3, 6)
    pitch, phase = float(rng.choice([5, 8, 10, 12, 16, 20])), rng.uniform(0, 2 * np.pi, 2)

    def move(state: State) -> np.ndarray:
        turn = 2 * np.pi * state.nose_mm[:, axis] / pitch
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = size * UM * (np.sin(turn + phase[0]) + 0.1 * np.sin(2 * turn + phase[1]))
        return e

    return Hidden(
        "cyclic_pitch",
        ("cyclic_pitch",),
        {"axis": "XYZ"[axis], "size_um": size, "pitch_mm": pitch},
        move,
        {"amplitude_um": size, "pitch_mm": pitch},
        target="XYZ"[axis],
    )


def hysteresis(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The guide winds up over centimetres after each reversal."""
    axis, size, way = int(rng.integers(2)), rng.uniform(8, 16), rng.uniform(12, 40)

    def move(state: State) -> np.ndarray:
        wound = 1 - 2 * np.exp(-state.since_reversal_mm[:, axis] / way)
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = -0.5 * size * UM * state.sign[:, axis] * wound
        return e

    return Hidden(
        "hysteresis",
        ("hysteresis",),
        {"axis": "XYZ"[axis], "size_um": size, "travel_mm": way},
        move,
        target="XYZ"[axis],
    )


def lateral_play(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A carriage that leans sideways with its direction."""
    axis, size = int(rng.integers(2)), rng.uniform(6, 12)
    aside = int(rng.choice([k for k in range(3) if k != axis]))

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        ease = 1 - 2 * np.exp(-state.since_reversal_mm[:, axis] / 0.05)
        e[:, aside] = 0.5 * size * UM * state.sign[:, axis] * ease
        return e

    return Hidden(
        "lateral_play",
        ("lateral_play",),
        {"axis": "XYZ"[axis], "aside": "XYZ"[aside], "size_um": size},
        move,
        {"play_um": size},
    )


def servo_mismatch(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Two position loops with different gain."""
    slow_ms = rng.choice([-1, 1]) * rng.uniform(0.25, 0.6)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        e[:, 0] = -0.5e-3 * slow_ms * state.velocity_mm_s[:, 0]
        e[:, 1] = +0.5e-3 * slow_ms * state.velocity_mm_s[:, 1]
        return e

    return Hidden(
        "servo_mismatch",
        ("servo_mismatch",),
        {"slow_ms": slow_ms},
        move,
        {"mismatch_ms": slow_ms},
        target="XY",
    )


def servo_lag(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Position loops of equal gain without feed-forward: circles shrink."""
    gain = rng.uniform(25, 55)

    def move(state: State) -> np.ndarray:
        return state.acceleration_mm_s2 / (2 * gain**2)

    return Hidden("servo_lag", ("servo_lag",), {"gain_per_s": gain}, move)


def inertia(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A slide on its springs: it runs wide on curves; the rest of the machine gives a little."""
    axis, hertz = int(rng.integers(2)), rng.uniform(16, 26)
    softness_s2 = 1 / (2 * np.pi * hertz) ** 2

    def move(state: State) -> np.ndarray:
        share = np.full(3, 0.03)
        share[axis] = 1.0
        # near its resonance the structure gives more than by its weight alone
        turning_per_s = np.linalg.norm(state.acceleration_mm_s2, axis=1) / np.maximum(
            np.linalg.norm(state.velocity_mm_s, axis=1), 1e-9
        )
        raised = 1 / (1 - softness_s2 * np.minimum(turning_per_s, 20) ** 2)
        return -softness_s2 * share * state.acceleration_mm_s2 * raised[:, None]

    return Hidden(
        "inertia",
        ("inertia",),
        {"axis": "XYZ"[axis], "hertz": hertz},
        move,
        {"sway_ms2": 1e6 * softness_s2},
        target="XYZ"[axis],
    )


def quadrant_glitch(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Friction after a reversal: a spike that the loop pulls back within a little way."""
    axis, size, way = int(rng.integers(2)), rng.uniform(9, 16), rng.uniform(0.4, 1.2)

    def move(state: State) -> np.ndarray:
        since = state.since_reversal_mm[:, axis] / way
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = -size * UM * state.sign[:, axis] * np.exp(-since)
        return e

    return Hidden(
        "quadrant_glitch",
        ("quadrant_glitch",),
        {"axis": "XYZ"[axis], "size_um": size, "travel_mm": way},
        move,
        target="XYZ"[axis],
    )


def corner_rounding(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Every change of velocity is followed late: position loop, and a quick loop inside it."""
    late_ms, slow_s = rng.uniform(0.3, 1.2), rng.uniform(0.015, 0.05)
    quick_s = slow_s * rng.uniform(0.05, 0.12)

    def move(state: State) -> np.ndarray:
        velocity = state.path.velocity_mm_s
        jump = np.diff(velocity, axis=0, append=np.zeros((1, 3)))
        speed = np.linalg.norm(velocity, axis=1)
        turned = np.linalg.norm(jump, axis=1) > 0.3 * np.minimum(speed, np.roll(speed, -1))
        when, jump = state.path.time_s[turned], jump[turned]
        e = np.zeros_like(state.nose_mm)
        last = np.searchsorted(when, state.time_s, side="right") - 1
        for back in range(4):  # what is older has faded
            k = np.maximum(last - back, 0)
            since = np.maximum(state.time_s - when[k], 0.0)
            fade = slow_s * np.exp(-since / slow_s) - quick_s * np.exp(-since / quick_s)
            fade *= (last >= back) / (slow_s - quick_s)
            e += late_ms * UM * fade[:, None] * jump[k]
        return e

    return Hidden(
        "corner_rounding", ("corner_rounding",), {"late_ms": late_ms, "slow_s": slow_s}, move
    )


MOTION = (
    backlash,
    scale,
    squareness,
    cyclic_pitch,
    hysteresis,
    lateral_play,
    servo_mismatch,
    servo_lag,
    inertia,
    quadrant_glitch,
    corner_rounding,
)
