"""What the machine did at every moment at which a measured point was made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .part import TOOLS, Part
from .program_writer import Path3

__all__ = ["Hidden", "History", "State", "state_of", "state_without_cut"]


@dataclass
class Hidden:
    """One effect of nature, drawn and ready.

    Attributes
    ----------
    name : as the program's file format names it, or a foreign name
    accept : names with which the data would be explained just as well
    parameters : what was drawn
    comparable : parameter with its unit -> value that a right diagnosis has to find (sign free)
    displacement_mm : state -> (M, 3) of the tool against the workpiece; None for pure tables
    changed : component -> function of position that came on top since the calibration
    missing : tables that were never measured
    turned_round : tables that the file has with the other sign
    misplaced : reading -> what the record adds to the place of the reflector, mm
    target : axis or component where there is one
    amounts : what one of each of its amounts does, state -> (M, 3); empty where all go together
    shows_as : state of the measured points -> further names that are true of just these points
    told_as : state of the measured points -> what these points show instead; empty: this effect
    twins : names that no measurement of this kind can tell from it: naming one alone is too much
    another_day : the same when another part is made, another day; None: it repeats itself
    once : it happens one time, another part says nothing about it
    on_part_only : it belongs to the cut or to the piece; a test without a cut cannot see it
    """

    name: str
    accept: tuple[str, ...]
    parameters: dict
    displacement_mm: Callable[[State], np.ndarray] | None = None
    comparable: dict[str, float] = field(default_factory=dict)
    changed: dict[str, Callable] = field(default_factory=dict)
    missing: tuple[str, ...] = ()
    turned_round: tuple[str, ...] = ()
    misplaced: dict[str, np.ndarray] = field(default_factory=dict)
    target: str | None = None
    once: bool = False
    on_part_only: bool = False
    twins: tuple[str, ...] = ()
    another_day: Callable[[State], np.ndarray] | None = None
    amounts: tuple[Callable[[State], np.ndarray], ...] = ()
    shows_as: Callable[[State], tuple[str, ...]] = lambda state: ()
    told_as: Callable[[State], tuple[Hidden, ...]] = lambda state: ()


@dataclass(frozen=True)
class History:
    """One row a second since the cold start: spindle speed, axis speeds and nose position."""

    rpm: np.ndarray
    speed_mm_s: np.ndarray
    nose_mm: np.ndarray

    def response(self, drive: np.ndarray, rise_s: float, fall_s: float) -> np.ndarray:
        """First-order lag of a drive, warming and cooling with their own time constants."""
        out, value = np.empty(len(drive)), 0.0
        for k, aim in enumerate(drive):
            value += (aim - value) / (rise_s if aim > value else fall_s)
            out[k] = value
        return out

    def at(self, values: np.ndarray, time_s: np.ndarray) -> np.ndarray:
        """Read a series of this history at given times."""
        return np.interp(time_s, np.arange(len(values)), values)


@dataclass(frozen=True)
class State:
    """M moments; lengths mm, times s."""

    place_mm: np.ndarray
    normal: np.ndarray
    nose_mm: np.ndarray
    contact_mm: np.ndarray  #: from the nose to the point of contact
    tip_mm: np.ndarray
    velocity_mm_s: np.ndarray
    acceleration_mm_s2: np.ndarray
    sign: np.ndarray  #: (M, 3) of the last motion of each axis
    since_reversal_mm: np.ndarray  #: (M, 3)
    reversed_s: np.ndarray  #: (M, 3) when each axis last turned
    time_s: np.ndarray
    tool: np.ndarray
    ae_mm: np.ndarray
    ap_mm: np.ndarray
    cut_mm: np.ndarray  #: way that this tool has cut so far
    feature: np.ndarray
    set_up: np.ndarray  #: 0, or 1 in the second clamping
    history: History
    path: Path3


def state_of(part: Part) -> State:
    """Gather the moments of a part."""
    rows = part.contacts
    tool = rows["tool"]
    length = np.array([t.length_mm for t in TOOLS])[tool]
    down = np.zeros_like(rows["tip_mm"])
    down[:, 2] = length
    place = part.place_mm[rows["point"]]
    sign, travel, turned = _directions(part.path, rows["node"], rows["share"])
    node, share = rows["node"], rows["share"]
    time = part.path.time_s
    return State(
        place_mm=place,
        normal=part.normal[rows["point"]],
        nose_mm=rows["tip_mm"] + part.offsets_mm[0] + down,
        contact_mm=place - rows["tip_mm"] - down,
        tip_mm=rows["tip_mm"],
        velocity_mm_s=rows["velocity_mm_s"],
        acceleration_mm_s2=rows["acceleration_mm_s2"],
        sign=sign,
        since_reversal_mm=travel,
        reversed_s=turned,
        time_s=time[node] + share * (time[node + 1] - time[node]),
        tool=tool,
        ae_mm=rows["ae_mm"],
        ap_mm=rows["ap_mm"],
        cut_mm=_cut_way(part.path, tool, node, share),
        feature=np.unique(part.feature, return_inverse=True)[1][rows["point"]],
        set_up=rows["set_up"],
        history=history_of(part.path),
        path=part.path,
    )


def state_without_cut(
    path: Path3,
    *,
    node: np.ndarray,
    share: np.ndarray,
    tool_length_mm: float,
    zero_mm: np.ndarray,
    nose_mm: np.ndarray | None = None,
    velocity_mm_s: np.ndarray | None = None,
    acceleration_mm_s2: np.ndarray | None = None,
) -> State:
    """Moments of a test, between the nodes `node` and `node + 1` of its path.

    Parameters
    ----------
    zero_mm : where the workpiece zero is, machine coordinates
    nose_mm : exact positions; on the chords where left out
    velocity_mm_s, acceleration_mm_s2 : at rest where left out
    """
    rest, count = np.zeros((len(node), 3)), np.zeros(len(node))
    sign, travel, turned = _directions(path, node, share)
    if nose_mm is None:
        nose_mm = path.nose_mm[node] + share[:, None] * np.diff(path.nose_mm, axis=0)[node]
    down = np.array([0.0, 0.0, -tool_length_mm])
    return State(
        place_mm=nose_mm + down - zero_mm,
        normal=rest,
        nose_mm=nose_mm,
        contact_mm=rest + down,
        tip_mm=nose_mm + down - zero_mm,
        velocity_mm_s=rest if velocity_mm_s is None else velocity_mm_s,
        acceleration_mm_s2=rest if acceleration_mm_s2 is None else acceleration_mm_s2,
        sign=sign,
        since_reversal_mm=travel,
        reversed_s=turned,
        time_s=path.time_s[node] + share * np.diff(path.time_s)[node],
        tool=np.full(len(node), -1),
        ae_mm=count,
        ap_mm=count,
        cut_mm=count,
        feature=np.zeros(len(node), dtype=int),
        set_up=np.zeros(len(node), dtype=int),
        history=history_of(path),
        path=path,
    )


def _directions(path: Path3, node: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, ...]:
    """Sign of the last motion, way since it last turned, and when that was, per axis."""
    step = np.diff(path.nose_mm, axis=0)
    sign = np.zeros((len(step) + 1, 3))
    way = np.zeros((len(step) + 1, 3))
    when = np.zeros((len(step) + 1, 3))
    for k, move in enumerate(step):
        now = np.where(np.abs(move) > 1e-7, np.sign(move), sign[k])
        way[k + 1] = np.where(now == sign[k], way[k], 0.0) + np.abs(move)
        when[k + 1] = np.where(now == sign[k], when[k], path.time_s[k])
        sign[k + 1] = now
    here = sign[node + 1]
    kept = np.where(here == sign[node], way[node], 0.0)
    return here, kept + share[:, None] * np.abs(step[node]), when[node + 1]


def _cut_way(path: Path3, tool: np.ndarray, node: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Way cut by the tool in the spindle, up to a share of the way from each node to the next."""
    length = np.linalg.norm(np.diff(path.tip_mm, axis=0), axis=1) * path.cutting[1:]
    out = np.zeros(len(tool))
    for number in np.unique(tool):
        speed = TOOLS[number].rpm
        own = np.concatenate([[0.0], np.cumsum(length * (path.rpm[1:] == speed))])
        here = tool == number
        start, end = own[node[here]], own[np.minimum(node[here] + 1, len(own) - 1)]
        out[here] = start + share[here] * (end - start)
    return out


def history_of(path: Path3) -> History:
    """Resample a path to seconds."""
    seconds = np.arange(int(path.time_s[-1]) + 2)
    row = np.minimum(np.searchsorted(path.time_s, seconds, side="left"), len(path.time_s) - 1)
    total = np.concatenate(
        [np.zeros((1, 3)), np.cumsum(np.abs(np.diff(path.nose_mm, axis=0)), axis=0)]
    )
    way = np.stack([np.interp(seconds, path.time_s, total[:, k]) for k in range(3)], axis=1)
    nose = np.stack([np.interp(seconds, path.time_s, path.nose_mm[:, k]) for k in range(3)], axis=1)
    return History(path.rpm[row], np.gradient(way, axis=0), nose)
