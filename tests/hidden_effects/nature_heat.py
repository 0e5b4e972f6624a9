"""Effects of heat and time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .machine_maker import TrueMachine
from .state import Hidden, State

__all__ = ["HEAT"]

UM = 1e-3
#: height of the blank below the workpiece zero
BLANK_MM = 60.0
#: mean speed of an axis at which a screw stretches by what was drawn
USUAL_SPEED_MM_S = 1.5


def spindle_growth(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Bearings warm quickly, the housing slowly; both cool slower than they warm."""
    size, tau, power = rng.uniform(15, 35), rng.uniform(500, 1800), rng.uniform(0.6, 1.0)

    def move(state: State) -> np.ndarray:
        past = state.history
        drive = (past.rpm / 8000.0) ** power
        quick = past.response(drive, tau, 1.3 * tau)
        slow = past.response(drive, 2.2 * tau, 2.8 * tau)
        e = np.zeros_like(state.nose_mm)
        e[:, 2] = -size * UM * past.at(0.8 * quick + 0.2 * slow, state.time_s)
        return e

    return Hidden(
        "spindle_growth", ("spindle_growth",), {"size_um": size, "tau_s": tau, "power": power}, move
    )


def axis_expansion(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A screw that warms where its nut works; the heat spreads along it and is lost to the air."""
    axis, ppm = int(rng.integers(2)), rng.uniform(40, 80)
    tau, fixed_at_home = rng.uniform(900, 2400), bool(rng.random() < 0.5)
    at_nut, spreading = rng.uniform(0.15, 0.5), rng.uniform(0.005, 0.03)
    low, high = machine.travel_mm["XYZ"[axis]]

    def move(state: State) -> np.ndarray:
        past, zones = state.history, 24
        nut = past.nose_mm[:, axis]
        passed = np.linspace(np.append(nut[0], nut[:-1]), nut, 8, axis=1)  # within each second
        passed = np.clip((passed - low) / (high - low) * zones, 0, zones - 1).astype(int)
        warm, strain = np.zeros(zones), np.empty((len(nut), zones))
        for k, speed in enumerate(past.speed_mm_s[:, axis] / USUAL_SPEED_MM_S):
            padded = np.pad(warm, 1, mode="edge")
            spread = padded[2:] - 2 * warm + padded[:-2]
            warm = warm + spreading * spread + ((1 - at_nut) * speed - warm) / tau
            np.add.at(warm, passed[k], at_nut * speed * zones / tau / 8)
            strain[k] = warm
        strain *= ppm * 1e-6
        edges = np.linspace(low, high, zones + 1)
        grown = np.concatenate(
            [np.zeros((len(strain), 1)), np.cumsum(strain, axis=1) * (high - low) / zones], axis=1
        )
        if fixed_at_home:
            grown = grown - grown[:, -1:]
        e = np.zeros_like(state.nose_mm)
        when = np.clip(state.time_s, 0, len(grown) - 1.001)
        for q, t, moved in zip(state.nose_mm[:, axis], when, e, strict=True):
            row, since = int(t), t % 1
            now = (1 - since) * grown[row] + since * grown[row + 1]
            moved[axis] = np.interp(q, edges, now)
        return e

    return Hidden(
        "axis_expansion",
        ("axis_expansion",),
        {"axis": "XYZ"[axis], "ppm": ppm, "tau_s": tau},
        move,
        target="XYZ"[axis],
    )


def head_tilt(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The column bends backwards while the spindle warms it."""
    urad, tau = rng.choice([-1, 1]) * rng.uniform(70, 120), rng.uniform(1200, 3600)

    def move(state: State) -> np.ndarray:
        past = state.history
        tilt = (
            urad
            * 1e-6
            * past.at(past.response((past.rpm / 8000) ** 0.8, tau, 1.4 * tau), state.time_s)
        )
        e = np.zeros_like(state.nose_mm)
        e[:, 1], e[:, 2] = -tilt * state.contact_mm[:, 2], tilt * state.contact_mm[:, 1]
        return e

    # with nearly equal tools a slow motion in Y
    return Hidden("head_tilt", ("head_tilt", "ambient_drift"), {"urad": urad, "tau_s": tau}, move)


def leaning_column(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A head that grows away from its guide as its spindle warms, and hardly turns."""
    axis, size = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(12, 22)
    tau = rng.uniform(1000, 3600)

    def move(state: State) -> np.ndarray:
        past = state.history
        warm = past.at(past.response((past.rpm / 8000.0) ** 0.8, tau, 1.5 * tau), state.time_s)
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = size * UM * warm
        return e

    told = {"axis": "XY"[axis], "size_um": size, "tau_s": tau}
    accept = ("head_tilt", f"ambient_drift {'XY'[axis]}", "ambient_drift XYZ")
    return Hidden("head_tilt", accept, told, move, target="BA"[axis])


def ambient_drift(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The hall's temperature: a slow wave and a quicker weak one, each axis its own."""
    size = rng.choice([-1, 1], 3) * rng.uniform(5, 12, 3)
    period, phase = rng.uniform(4000, 9000), rng.uniform(0, 2 * np.pi, 2)
    other_phase = np.random.default_rng(int(1e6 * phase[0])).uniform(0, 2 * np.pi, 2)

    def moved(state: State, phase: np.ndarray) -> np.ndarray:
        turn = 2 * np.pi * state.time_s / period
        wave = np.sin(turn + phase[0]) + 0.25 * np.sin(2.3 * turn + phase[1])
        return UM * wave[:, None] * size

    return Hidden(
        "ambient_drift",
        ("ambient_drift",),
        {"size_um": size.tolist(), "period_s": period},
        lambda state: moved(state, phase),
        another_day=lambda state: moved(state, other_phase),
    )


def workpiece_temperature(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Cut warm, measured at 20 degrees: the part is smaller about its datum."""
    ppm, datum = rng.choice([-1, 1]) * rng.uniform(12, 35), rng.uniform(0, 300, 3) * [1, 1, 0]

    def move(state: State) -> np.ndarray:
        return -ppm * 1e-6 * (state.place_mm - datum)

    return Hidden(
        "workpiece_temperature",
        ("workpiece_temperature",),
        {"ppm": ppm},
        move,
        {"expansion_ppm": ppm},
        on_part_only=True,
        twins=("workpiece_temperature", "scale"),
    )


def workpiece_warming(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The cut heats the part little by little; in pauses it cools a little."""
    ppm, tau = rng.uniform(25, 50), rng.uniform(1000, 3000)
    clamp = np.array([rng.uniform(0, 500), rng.uniform(0, 350), -BLANK_MM])

    def cuts(state: State) -> np.ndarray:
        return np.where(state.history.speed_mm_s.sum(axis=1) > 0.5, 1.0, 0.85)

    def move(state: State) -> np.ndarray:
        past = state.history
        warm = past.at(past.response(cuts(state), tau, tau), state.time_s)
        return -ppm * 1e-6 * warm[:, None] * (state.place_mm - clamp)

    def told_as(state: State) -> tuple[Hidden, ...]:
        """The stretch that the part tends to with the pauses of its program."""
        return (replace(hidden, comparable={"expansion_ppm": ppm * float(cuts(state).mean())}),)

    hidden = Hidden(
        "workpiece_warming",
        ("workpiece_warming",),
        {"ppm": ppm, "tau_s": tau},
        move,
        on_part_only=True,
        told_as=told_as,
    )
    return hidden


def thermal_bow(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Chips warm the bed's top: it arches over its supports, a little flatter in the middle."""
    axis, size, tau = int(rng.integers(2)), rng.uniform(10, 20), rng.uniform(900, 3600)
    low, high = machine.travel_mm["XYZ"[axis]]

    def move(state: State) -> np.ndarray:
        along = 2.0 * (state.nose_mm[:, axis] - low) / (high - low) - 1.0
        arch = 1.0 - 0.9 * along**2 - 0.1 * along**4
        warm = 0.9 * (1.0 - np.exp(-state.time_s / tau)) + 0.1 * (
            1.0 - np.exp(-state.time_s / 3.0 / tau)
        )
        return -size * UM * (arch * warm)[:, None] * np.array([0.0, 0.0, 1.0])

    name = "XYZ"[axis]
    told = {"axis": name, "size_um": size, "tau_s": tau}
    return Hidden("thermal_bow", ("thermal_bow",), told, move, {"bow_um": size}, target=name)


def tool_growth(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Every tool lengthens in its first minutes in the spindle: its cut warms it."""
    size, time = rng.uniform(9, 16), rng.uniform(60, 400)

    def move(state: State) -> np.ndarray:
        past = state.history
        seconds = np.arange(len(past.rpm))
        changed = np.append(True, np.diff(past.rpm) != 0.0)
        since = seconds - np.maximum.accumulate(np.where(changed, seconds, 0))
        warm = 1.0 - np.exp(-past.at(since.astype(float), state.time_s) / time)
        return -size * UM * warm[:, None] * np.array([0.0, 0.0, 1.0])

    told = {"size_um": size, "time_s": time}
    return Hidden("tool_growth", ("tool_growth",), told, move, on_part_only=True)


HEAT = (
    spindle_growth,
    axis_expansion,
    head_tilt,
    leaning_column,
    ambient_drift,
    workpiece_temperature,
    workpiece_warming,
    thermal_bow,
    tool_growth,
)
