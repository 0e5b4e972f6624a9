"""More things that no catalogue holds, made up after the diagnosis: nothing was tuned on them."""

from __future__ import annotations

import numpy as np

from .machine_maker import TrueMachine
from .state import Hidden, State

__all__ = ["UNFORESEEN"]

UM = 1e-3


def lobed_probe(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The CMM's stylus is worn to a square: its error goes round four times on every wall."""
    size, turn = rng.uniform(3.5, 6.0), rng.uniform(0.0, np.pi / 2)

    def move(state: State) -> np.ndarray:
        round_ = np.arctan2(state.normal[:, 1], state.normal[:, 0])
        across = np.hypot(*state.normal[:, :2].T)
        return size * UM * (np.cos(4.0 * (round_ - turn)) * across)[:, None] * state.normal

    return Hidden("lobed_probe", ("unknown",), {"size_um": size}, move, on_part_only=True)


def burrs(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """Near both ends of every feature a burr stands under the probe."""
    size, share = rng.uniform(7.0, 13.0), rng.uniform(0.08, 0.15)

    def move(state: State) -> np.ndarray:
        height = np.zeros(len(state.time_s))
        for feature in np.unique(state.feature):
            own = np.flatnonzero(state.feature == feature)
            from_end = 1.0 - np.abs(np.linspace(-1.0, 1.0, len(own)))
            height[own] = np.exp(-from_end / share)
        return size * UM * height[:, None] * state.normal

    return Hidden("burrs", ("unknown",), {"size_um": size}, move, on_part_only=True)


def press_next_door(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A press works in a few stretches of time and pushes the machine off its place meanwhile."""
    size = rng.choice([-1, 1], 2) * rng.uniform(7.0, 13.0, 2)
    start = rng.uniform(0.0, 0.9, 4)

    def works(state: State) -> np.ndarray:
        share = state.time_s / max(float(state.time_s.max()), 1.0)
        return ((share[:, None] > start) & (share[:, None] < start + 0.08)).any(axis=1)

    def move(state: State) -> np.ndarray:
        return UM * works(state)[:, None] * np.array([size[0], size[1], 0.0])

    def shows_as(state: State) -> tuple[str, ...]:
        """Where it began or ended once between the walls, no more than a shift is to be seen."""
        walls = np.flatnonzero(np.abs(state.normal[:, 2]) < 0.5)
        in_turn = walls[np.argsort(state.time_s[walls])]
        turns = np.count_nonzero(np.diff(works(state)[in_turn]))
        return ("datum_shift",) if turns == 1 else ()

    told = {"size_um": size.tolist()}
    return Hidden("press_next_door", ("unknown",), told, move, shows_as=shows_as)


def yaw_play(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The saddle skews in its gib whenever X turns: a reversal that differs along Y."""
    skew, lever = rng.choice([-1, 1]) * rng.uniform(18, 35), rng.uniform(-150, 150)
    middle = 0.5 * machine.travel_mm["Y"][0] + 0.5 * machine.travel_mm["Y"][1]

    def move(state: State) -> np.ndarray:
        turn = 1e-6 * skew * state.sign[:, 0]
        away = state.nose_mm[:, 1] - middle
        return np.stack([-turn * away, turn * lever, 0.0 * turn], axis=1)

    return Hidden("yaw_play", ("unknown",), {"skew_urad": skew, "lever_mm": lever}, move)


def ringing(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """An axis swings for a few periods wherever it has turned."""
    axis, size = int(rng.integers(2)), rng.uniform(9, 16)
    hertz, fades = rng.uniform(4, 9), rng.uniform(0.3, 0.6)

    def move(state: State) -> np.ndarray:
        since = state.time_s - state.reversed_s[:, axis]
        swing = np.exp(-since / fades) * np.sin(2 * np.pi * hertz * since)
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = size * UM * state.sign[:, axis] * swing
        return e

    return Hidden("ringing", ("unknown",), {"axis": "XY"[axis], "hertz": hertz}, move)


def divided_wrongly(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """An encoder's interpolation errs within each of its lines, which are hundredths of a mm."""
    axis, size = int(rng.integers(2)), rng.uniform(4, 7)
    line = float(rng.choice([0.02, 0.04]))

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = size * UM * np.sin(2 * np.pi * state.nose_mm[:, axis] / line)
        return e

    return Hidden("divided_wrongly", ("unknown",), {"axis": "XY"[axis], "line_mm": line}, move)


def tapered_tool(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """One tool was ground slightly conical: its walls lean."""
    tool, lean = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(0.6, 1.2)

    def move(state: State) -> np.ndarray:
        height = state.place_mm[:, 2] - state.tip_mm[:, 2]
        left = lean * UM * height * (state.tool == tool)
        return left[:, None] * state.normal * [1, 1, 0]

    told = {"tool": tool + 1, "um_per_mm": lean}
    return Hidden("tapered_tool", ("unknown",), told, move, on_part_only=True)


def worn_screw(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A nut has play where the screw is worn."""
    axis, play, width = int(rng.integers(2)), rng.uniform(8, 15), rng.uniform(60, 150)
    low, high = machine.travel_mm["XY"[axis]]
    worst = low + rng.uniform(0.2, 0.8) * (high - low)

    def move(state: State) -> np.ndarray:
        place = state.nose_mm[:, axis]
        here = play * np.exp(-0.5 * ((place - worst) / width) ** 2)
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = -0.5 * UM * here * state.sign[:, axis]
        return e

    return Hidden("worn_screw", ("unknown",), {"axis": "XY"[axis], "play_um": play}, move)


def loosening_nut(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The warm nut loses its preload: play that grows from nothing."""
    axis, play, time = int(rng.integers(2)), rng.uniform(8, 15), rng.uniform(1200, 3600)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        now = play * (1.0 - np.exp(-state.time_s / time))
        e[:, axis] = -0.5 * UM * now * state.sign[:, axis]
        return e

    return Hidden("loosening_nut", ("unknown",), {"axis": "XY"[axis], "play_um": play}, move)


def stick_slip(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The slower an axis goes, the larger the jumps in which it follows."""
    axis, size = int(rng.integers(2)), rng.uniform(9, 16)

    def move(state: State) -> np.ndarray:
        speed = np.abs(state.velocity_mm_s[:, axis])
        jump = np.where(speed > 0.01, np.exp(-speed / 3.0), 0.0)
        saw = (state.since_reversal_mm[:, axis] / 2.3) % 1.0
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = -size * UM * jump * saw * state.sign[:, axis]
        return e

    return Hidden("stick_slip", ("unknown",), {"axis": "XY"[axis], "size_um": size}, move)


def swinging_head(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The head's weight is off its slide: it swings aside when the other axis accelerates."""
    axis, hertz = int(rng.integers(2)), rng.uniform(9, 14)

    def move(state: State) -> np.ndarray:
        e = np.zeros_like(state.nose_mm)
        e[:, 1 - axis] = state.acceleration_mm_s2[:, axis] / (2 * np.pi * hertz) ** 2
        return e

    return Hidden("swinging_head", ("unknown",), {"axis": "XY"[axis], "hertz": hertz}, move)


def nodding_column(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The column nods with the speed of Y, and what is high up goes further."""
    urad = rng.choice([-1, 1]) * rng.uniform(20, 40)
    middle = 0.5 * np.array([sum(machine.travel_mm[a]) for a in "XYZ"])

    def move(state: State) -> np.ndarray:
        turn = 1e-6 * urad * state.velocity_mm_s[:, 1] / 10.0
        away = state.nose_mm - middle
        return np.stack([0.0 * turn, -turn * (away[:, 2] + 300.0), turn * away[:, 1]], axis=1)

    return Hidden("nodding_column", ("unknown",), {"urad": urad}, move)


def loose_gib(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """A gib is worn towards one end of Y: the table jumps aside when Y turns, more there."""
    low, high = machine.travel_mm["Y"]
    size, end = rng.uniform(15, 30), float(rng.choice([low, high]))

    def move(state: State) -> np.ndarray:
        near = 1.0 - np.abs(state.nose_mm[:, 1] - end) / (high - low)
        e = np.zeros_like(state.nose_mm)
        e[:, 0] = 0.5 * size * UM * near * state.sign[:, 1]
        return e

    return Hidden("loose_gib", ("unknown",), {"size_um": size}, move)


def swelling_walls(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The later a wall was cut, the warmer the part below its top, and the more it is left."""
    size, time = rng.uniform(4, 8), rng.uniform(1000, 3000)

    def move(state: State) -> np.ndarray:
        deep = np.maximum(-state.place_mm[:, 2], 0.0) / 10.0
        late = 1.0 - np.exp(-state.time_s / time)
        return size * UM * (deep * late)[:, None] * state.normal * [1, 1, 0]

    return Hidden("swelling_walls", ("unknown",), {"size_um": size}, move, on_part_only=True)


def pulsing_oil(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """The oil of the guides is cooled in pulses: all goes to and fro along X and Y."""
    period, turn, size = rng.uniform(90, 220), rng.uniform(0, 6.28), rng.uniform(4, 7)
    along = size * UM * np.array([np.cos(turn), np.sin(turn), 0.0])

    def move(state: State) -> np.ndarray:
        return np.sin(2 * np.pi * state.time_s / period)[:, None] * along

    return Hidden("pulsing_oil", ("unknown",), {"period_s": period}, move)


def creeping_axis(rng: np.random.Generator, machine: TrueMachine) -> Hidden:
    """After a reversal an axis stands behind, and creeps to its place over centimetres."""
    axis, size, way = int(rng.integers(2)), rng.uniform(10, 18), rng.uniform(15, 60)

    def move(state: State) -> np.ndarray:
        behind = size * UM * np.exp(-state.since_reversal_mm[:, axis] / way)
        e = np.zeros_like(state.nose_mm)
        e[:, axis] = -behind * state.sign[:, axis]
        return e

    return Hidden("creeping_axis", ("unknown",), {"axis": "XY"[axis], "way_mm": way}, move)


#: made up when the forms were what they are; nothing was tuned on them
LATER = (swinging_head, nodding_column, loose_gib, swelling_walls, pulsing_oil)

UNFORESEEN = (
    lobed_probe,
    burrs,
    press_next_door,
    yaw_play,
    ringing,
    divided_wrongly,
    tapered_tool,
    worn_screw,
    loosening_nut,
    stick_slip,
    *LATER,
)

#: for single tests; counts do not draw them, so that their seeds go on to mean the same machines
TRIED_ALONE = (creeping_axis,)
