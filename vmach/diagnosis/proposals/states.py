"""States that something unknown may depend on, each as a line of code of an effect file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from vmach.effects import Displaced
from vmach.machine import LINEAR_AXES, RigidDisplacement
from vmach.path.circumstances import Circumstances

__all__ = [
    "ALL_AXES",
    "CONSTANT",
    "CUT",
    "DIRECTIONS",
    "HALF_TURNS",
    "MOTION",
    "SWELLING",
    "TILTS",
    "TURNS",
    "Direction",
    "State",
    "bend_about",
    "curve_in",
    "states_of",
]

#: way over which what follows a reversal fades, mm: spikes of friction, joints, and creep
_FADES_MM = (1.0, 10.0, 40.0)
#: speed over which the friction of a guide falls as its oil carries, m/min; chosen (the Stribeck
#: curve, B. Armstrong-Hélouvry et al., Automatica 30 (1994) 1083)
_SLOW_M_MIN = 0.2
#: time constants of what warms or settles, s; a factor of four apart, the best is never far
_SETTLES_S = (75.0, 300.0, 1200.0, 4800.0)
#: factor by which a way or a time of what leads is made shorter and longer: a third, in powers, of
#: that between two on the list
_FINER = 4.0 ** (1.0 / 3.0)
#: half turns at most of a smooth curve along an axis
HALF_TURNS = 4


@dataclass(frozen=True)
class State:
    """One number of each of P states, or a few that go together, made to be of the order of one.

    Attributes
    ----------
    kind : str
        Of which several states are the same in another power or axis.
    words : str
        For people.
    code : str
        Python for its value from `path`, a `Circumstances`: (P,), or (P, C).
    looked_at : float
        How many like it were tried before this one was put on the list.
    each : tuple of str
        Of several numbers, what each is, in words.
    turns : bool
        Whether its sign turns where the path is cut in the opposite direction.
    axis : str
        The one whose motion it is, of states of motion.
    near : tuple of State
        The same with another way or time, which are fitted where it leads.
    """

    kind: str
    words: str
    code: str
    looked_at: float = 1.0
    each: tuple[str, ...] = ("",)
    turns: bool = False
    axis: str = ""
    near: tuple[State, ...] = ()

    def __hash__(self) -> int:
        return hash(self.code)  # asked for thousands of times

    @property
    def needs_surface(self) -> bool:
        """Whether only a machined surface has it."""
        return "normal" in self.code or "radial" in self.code

    def held(self, values: np.ndarray) -> State:
        """The same, but what goes beyond values (n, 1) that were seen stays at their ends."""
        low, high = float(values.min()), float(values.max())
        return replace(self, code=f"np.clip({self.code}, {low!r}, {high!r})")

    def at(self, path: Circumstances) -> np.ndarray:
        """Its values, (P, C); zero where they are not known."""
        value = np.asarray(eval(self.code, {"np": np, "path": path}), dtype=np.float64)
        return np.nan_to_num(value.reshape(len(path), -1))


@dataclass(frozen=True)
class Direction:
    """Where to a displacement goes from `path`; or several, each with an amount of its own.

    Or about what the tool turns: then it is the rotation by 1 mm over a metre, in rad.

    Attributes
    ----------
    words : str
        For people.
    code : str
        Python for it from `path`, a `Circumstances`: (P, 3), or (P, 3, D).
    needs_surface : bool
        Whether only a machined surface has it.
    lever : tuple of str
        Places that its length depends on, in words.
    each : tuple of str
        Of several, what each is, in words.
    turns_tool : bool
        Whether it is a tilt.
    """

    words: str
    code: str
    needs_surface: bool
    lever: tuple[str, ...] = ()
    each: tuple[str, ...] = ("",)
    turns_tool: bool = False

    def __hash__(self) -> int:
        return hash(self.code)  # asked for thousands of times

    def at(self, path: Circumstances) -> np.ndarray:
        """Directions, (P, 3, D)."""
        value = np.asarray(eval(self.code, {"np": np, "path": path}), dtype=np.float64)
        value = value.reshape(*value.shape[:2], -1)
        return np.broadcast_to(value, (len(path), 3, value.shape[2]))

    def of_tool(self, moved: np.ndarray) -> Displaced:
        """What the tool does, moved by so much at P states, (P, 3) mm, or tilted by rad."""
        return RigidDisplacement(np.zeros_like(moved), moved) if self.turns_tool else moved


#: kinds of states that say how the axes move
MOTION = frozenset({
    "direction", "travel since reversal", "ringing", "speed", "low speed", "acceleration",
})  # fmt: skip
#: kinds of states that nothing has without cutting
CUT = frozenset({
    "cutting length", "wave in cutting length", "feed per tooth", "depth", "height above the tip",
    "chip load", "side of the wall", "direction of the wall",
})  # fmt: skip
CONSTANT = State("constant", "", "np.ones(len(path))")

DIRECTIONS = (
    *(
        Direction(f"along {axis}", f"np.eye(3)[{k}] * np.ones((len(path), 1))", False)
        for k, axis in enumerate(LINEAR_AXES)
    ),
    Direction("out of the walls", "path.side_normal", True),
    Direction("out of the floors", "path.normal * np.array([0.0, 0.0, 1.0])", True),
    Direction("out of all surfaces", "path.normal", True),
)

#: about the tip: what reads tilts tells nothing of where the tool turns about
TILTS = tuple(
    Direction(
        f"as a tilt about {axis} over a metre",
        f"1e-3 * np.eye(3)[{k}] * np.ones((len(path), 1))",
        needs_surface=False,
        turns_tool=True,
    )
    for k, axis in enumerate(LINEAR_AXES)
)

#: each with an amount of its own
ALL_AXES = Direction(
    "along X, Y and Z",
    "np.eye(3) * np.ones((len(path), 1, 1))",
    needs_surface=False,
    each=tuple(f"along {axis}" for axis in LINEAR_AXES),
)


def _others(k: int) -> tuple[int, ...]:
    return tuple(i for i in range(3) if i != k)


def _places(*ks: int) -> tuple[str, ...]:
    return tuple(f"{LINEAR_AXES[k]} in 100 mm" for k in ks)


def _listed(function: str, columns: Iterable[str], how: str) -> str:
    """A call with a list, each column in a line of its own, as in the method of an effect."""
    lines = "".join(f"            {column},\n" for column in columns)
    return f"{function}([\n{lines}        ], {how})"


def _turn(k: int) -> Direction:
    """A turn about an axis: arms along the two others, and shifts where they start elsewhere.

    Which arm follows the axes depends on the machine, so each has an amount of its own.
    """
    i, j = _others(k)
    arms = ((i, j), (j, i))
    moved = [
        *(f"np.outer(0.01 * path.nose_mm[:, {a}], np.eye(3)[{b}])" for a, b in arms),
        *(f"np.outer(np.ones(len(path)), np.eye(3)[{a}])" for a in (i, j)),
    ]
    code = _listed("np.stack", moved, "axis=2")
    each = [f"along {LINEAR_AXES[b]} per 100 mm in {LINEAR_AXES[a]}" for a, b in arms]
    each += [f"along {LINEAR_AXES[a]}" for a in (i, j)]
    words = f"as a turn about {LINEAR_AXES[k]}"
    return Direction(words, code, False, lever=_places(i, j), each=tuple(each))


TURNS = tuple(_turn(k) for k in range(3))


def _swelling() -> Direction:
    """Away from the part's zero in proportion to the distance, and shifts where it is held.

    Source: a body of one temperature that expands freely.
    """
    moved = ["0.01 * path.on_part_mm"]
    moved += [f"np.eye(3)[{k}] * np.ones((len(path), 1))" for k in range(3)]
    each = ("per 100 mm from the part's zero", *(f"along {axis}" for axis in LINEAR_AXES))
    code, lever = _listed("np.stack", moved, "axis=2"), _places(0, 1, 2)
    return Direction("as the part swells", code, True, lever=lever, each=each)


SWELLING = _swelling()


def bend_about(middle_mm: np.ndarray) -> Direction:
    """Curvature along X and Y, and twist, of a part about its middle (3,) mm.

    As a plate whose normals stay normal: what is at height z turns with the slope of the
    deflection w, and so moves by (-z dw/dx, -z dw/dy, w).

    Source: closed form derived here from Kirchhoff's assumption.
    """
    x, y, z = (f"0.01 * (path.on_part_mm[:, {k}] - {v:.0f})" for k, v in enumerate(middle_mm))
    none = "np.zeros(len(path))"
    moved = (
        f"[-2.0 * {z} * {x}, {none}, ({x}) ** 2]",
        f"[{none}, -2.0 * {z} * {y}, ({y}) ** 2]",
        f"[-{z} * {y}, -{z} * {x}, {x} * {y}]",
    )
    code = _listed("np.transpose", moved, "(2, 1, 0)")
    each = ("bend along X", "bend along Y", "twist")
    return Direction("as a plate bends and twists", code, True, lever=_places(0, 1), each=each)


def curve_in(k: int, low_mm: float, high_mm: float) -> State:
    """A smooth curve along an axis, as cosines of half a turn to two turns, and a constant."""
    share = f"np.clip((path.nose_mm[:, {k}] - {low_mm:.0f}) / {high_mm - low_mm:.0f}, 0.0, 1.0)"
    code = f"np.cos(np.pi * np.outer({share}, np.arange({HALF_TURNS + 1})))"
    waves = (f"{0.5 * waves:g} waves in {LINEAR_AXES[k]}" for waves in range(1, HALF_TURNS + 1))
    return State(
        "position", f"a curve in {LINEAR_AXES[k]} in 100 mm", code, each=("everywhere", *waves)
    )


def states_of(path: Circumstances) -> Iterator[State]:
    """All states that a job's readings may be asked for."""
    for k, axis in enumerate(LINEAR_AXES):
        yield from _of_axis(k, axis)
    yield State("speed", "speed in m/min", "0.06 * np.linalg.norm(path.velocity_mm_per_s, axis=1)")
    yield from _of_time()
    yield from _of_tool(path)
    if path.states.normal is not None:
        yield from _of_surface()


def _of_axis(k: int, axis: str) -> Iterator[State]:
    moves = partial(State, axis=axis)
    yield moves("direction", f"direction of {axis}", f"path.play_side[:, {k}]", turns=True)
    speed = f"0.06 * path.velocity_mm_per_s[:, {k}]"
    yield moves("speed", f"speed of {axis} in m/min", speed, turns=True)
    # an axis at rest has no friction of motion
    slow = f"np.where(np.abs({speed}) > 1e-4, np.exp(-np.abs({speed}) / {_SLOW_M_MIN}), 0.0)"
    yield moves("low speed", f"low speed of {axis}, fading within {_SLOW_M_MIN:g} m/min", slow)
    pull = f"1e-3 * path.acceleration_mm_per_s2[:, {k}]"
    yield moves("acceleration", f"acceleration of {axis} in m/s²", pull)
    # controls round off short straight moves or do not
    on_arcs = f"{pull} * path.on_arc"
    yield moves("acceleration", f"acceleration of {axis} on arcs in m/s²", on_arcs)
    yield from _with_near(_FADES_MM, partial(_fading, k, axis))
    for power in (1, 2):
        place = f"(0.01 * path.nose_mm[:, {k}]) ** {power}"
        yield State("position", f"{axis}{'²' * (power == 2)} in 100 mm", place)


def _fading(k: int, axis: str, way_mm: float) -> State:
    code = f"path.play_side[:, {k}] * np.exp(-path.travel_since_reversal_mm[:, {k}] / {way_mm})"
    words = f"what fades {way_mm:g} mm after {axis} turned"
    return State("travel since reversal", words, code, turns=True, axis=axis)


def _with_near(scales: Sequence[float], made: Callable[[float], State]) -> Iterator[State]:
    """A state of each scale, with those a little shorter and longer near it."""
    for scale in scales:
        # two digits say as much as readings do
        near = (made(float(f"{scale * f:.2g}")) for f in (1.0 / _FINER, _FINER))
        yield replace(made(scale), near=tuple(replace(one, looked_at=2.0) for one in near))


def _of_time() -> Iterator[State]:
    yield State("time", "time in hours", "path.time_s / 3600.0")
    yield State("order of measuring", "order of measuring", "np.linspace(0.0, 1.0, len(path))")
    for made in (_warm_up, _since_tool_change, _warmth_of_spindle):
        yield from _with_near(_SETTLES_S, made)


def _warm_up(tau_s: float) -> State:
    code = f"-np.expm1(-np.maximum(path.time_s, 0.0) / {tau_s})"
    return State("warm-up", f"warm-up within {tau_s:g} s", code)


def _since_tool_change(tau_s: float) -> State:
    words = f"time since the tool change, settling within {tau_s:g} s"
    code = f"-np.expm1(-path.time_since_tool_change_s / {tau_s})"
    return State("time since tool change", words, code)


def _warmth_of_spindle(tau_s: float) -> State:
    words = f"warmth of the spindle within {tau_s:g} s"
    return State("spindle", words, f"path.warmth_of_spindle({tau_s}, 1.0)")


def _of_tool(path: Circumstances) -> Iterator[State]:
    # what is out of balance pulls with its square
    yield State("spindle speed", "spindle speed in 10000 rpm", "1e-4 * path.spindle_rpm")
    yield State("cutting length", "cutting length in 10 m", "1e-4 * path.cutting_length_mm")
    yield State("feed per tooth", "feed per tooth in 0.1 mm", "10.0 * path.feed_per_tooth_mm")
    for power in (1.0, 1.5, 2.0):
        words = f"depth below the top in 10 mm{'' if power == 1 else f' to the power {power:g}'}"
        deep = f"np.maximum(-0.1 * path.on_part_mm[:, 2], 0.0) ** {power:g}"
        yield State("depth", words, deep)
    tools = np.unique(path.tool)
    for tool in tools if len(tools) > 1 else ():
        yield State("tool", f"tool {tool}", f"path.tool == {tool}")
    # of changes between which nothing was read the last stands for all
    changes = np.unique(path.tool_changes)[1:].tolist()
    for change in changes:
        yield State("tool change", f"after tool change {change}", f"path.tool_changes >= {change}")
    if len(changes) > 1:
        each = f"path.tool_changes[:, None] >= np.array({changes})"
        words = tuple(f"after tool change {change}" for change in changes)
        yield State("tool change", "a step at each tool change", each, each=words)
    yield State("height above the tip", "height above the tip in 10 mm", _HEIGHT)


def _of_surface() -> Iterator[State]:
    yield State("chip load", "radial depth of cut in mm", "path.radial_depth_mm")
    yield State("side of the wall", "walls that look inwards", _INWARDS)
    for words, turns in (("twice", 2), ("three times", 3), ("four times", 4)):
        angle = f"{turns} * np.arctan2(path.normal[:, 1], path.normal[:, 0])"
        code = f"np.stack([np.cos({angle}), np.sin({angle})], axis=1)"
        both = ("cosine", "sine")
        yield State("direction of the wall", f"a wave {words} round the walls", code, each=both)


_HEIGHT = "0.1 * path.contact_mm[:, 2]"
_INWARDS = "np.sum(path.side_normal * (path.on_part_mm - path.middle_of_part_mm), axis=1) < 0.0"
