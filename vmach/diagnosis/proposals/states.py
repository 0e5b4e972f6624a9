"""States that something unknown may depend on, each as a line of code of an effect file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmach.job import Job
from vmach.machine import LINEAR_AXES
from vmach.path.circumstances import Circumstances

__all__ = ["CONSTANT", "DIRECTIONS", "Direction", "State", "states_of"]

#: way over which what follows a reversal fades, mm
_FADES_MM = (1.0, 10.0)
#: time constants of what warms or settles, s
_SETTLES_S = (300.0, 1200.0, 4800.0)


@dataclass(frozen=True)
class State:
    """One number of each of P states, made to be of the order of one.

    Attributes
    ----------
    kind : str
        Of which several states are the same in another power or axis.
    words : str
        For people.
    code : str
        Python for its value from `path`, a `Circumstances`.
    """

    kind: str
    words: str
    code: str

    @property
    def needs_surface(self) -> bool:
        """Whether only a machined surface has it."""
        return "normal" in self.code or "radial" in self.code

    def at(self, path: Circumstances) -> np.ndarray:
        """Its values, (P,); zero where they are not known."""
        value = eval(self.code, {"np": np, "path": path})
        return np.nan_to_num(np.broadcast_to(np.asarray(value, dtype=np.float64), (len(path),)))


@dataclass(frozen=True)
class Direction:
    """Where to a displacement goes, (P, 3) from `path`."""

    words: str
    code: str
    needs_surface: bool

    def at(self, path: Circumstances) -> np.ndarray:
        """Directions, (P, 3)."""
        value = eval(self.code, {"np": np, "path": path})
        return np.broadcast_to(np.asarray(value, dtype=np.float64), (len(path), 3))


CONSTANT = State("constant", "", "np.ones(len(path))")

DIRECTIONS = (
    *(
        Direction(f"along {axis}", f"np.eye(3)[{k}] * np.ones((len(path), 1))", False)
        for k, axis in enumerate(LINEAR_AXES)
    ),
    Direction("out of the walls", "path.side_normal", True),
    Direction("out of the floors", "path.normal * np.array([0.0, 0.0, 1.0])", True),
)


def states_of(job: Job, path: Circumstances) -> Iterator[State]:
    """All states that a job's readings may be asked for."""
    for k, axis in enumerate(LINEAR_AXES):
        yield State("direction", f"direction of {axis}", f"path.play_side[:, {k}]")
        speed = f"0.06 * path.velocity_mm_per_s[:, {k}]"
        yield State("speed", f"speed of {axis} in m/min", speed)
        pull = f"1e-3 * path.acceleration_mm_per_s2[:, {k}]"
        yield State("acceleration", f"acceleration of {axis} in m/s²", pull)
        for fade in _FADES_MM:
            code = (
                f"path.play_side[:, {k}] * np.exp(-path.travel_since_reversal_mm[:, {k}] / {fade})"
            )
            yield State(
                "travel since reversal", f"what fades {fade:g} mm after {axis} turned", code
            )
        for power in (1, 2):
            place = f"(0.01 * path.nose_mm[:, {k}]) ** {power}"
            yield State("position", f"{axis}{'²' * (power == 2)} in 100 mm", place)
    yield State("speed", "speed in m/min", "0.06 * np.linalg.norm(path.velocity_mm_per_s, axis=1)")
    yield State("time", "time in hours", "path.time_s / 3600.0")
    for tau in _SETTLES_S:
        yield State("warm-up", f"warm-up within {tau:g} s", f"-np.expm1(-path.time_s / {tau})")
        yield State(
            "time since tool change",
            f"time since the tool change, settling within {tau:g} s",
            f"-np.expm1(-path.time_since_tool_change_s / {tau})",
        )
        yield State(
            "spindle", f"warmth of the spindle within {tau:g} s",
            f"path.warmth_of_spindle({tau}, 1.0)",
        )  # fmt: skip
    yield State("cutting length", "cutting length in 10 m", "1e-4 * path.cutting_length_mm")
    yield State("feed per tooth", "feed per tooth in 0.1 mm", "10.0 * path.feed_per_tooth_mm")
    for power in (1.0, 1.5, 2.0):
        words = f"depth below the top in 10 mm{'' if power == 1 else f' to the power {power:g}'}"
        deep = f"np.maximum(-0.1 * path.on_part_mm[:, 2], 0.0) ** {power:g}"
        yield State("depth", words, deep)
    tools = np.unique(path.tool)
    for tool in tools if len(tools) > 1 else ():
        yield State("tool", f"tool {tool}", f"path.tool == {tool}")
    for change in range(1, int(path.tool_changes.max(initial=0)) + 1):
        yield State("tool change", f"after tool change {change}", f"path.tool_changes >= {change}")
    if path.states.normal is not None:
        yield State("chip load", "radial depth of cut in mm", "path.radial_depth_mm")
        for words, turns in (("twice", 2), ("three times", 3), ("four times", 4)):
            angle = "np.arctan2(path.normal[:, 1], path.normal[:, 0])"
            for name in ("cos", "sin"):
                code = f"np.{name}({turns} * {angle})"
                yield State("direction of the wall", f"{name} {words} round the walls", code)
