"""Instruments beside the CMM: what each does on the machine, and the file that it leaves.

Every test starts cold. Centre, radius, zero, pose and noise are drawn for each.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .journey import Journey
from .machine_maker import TrueMachine
from .shares import displacement_mm
from .state import Hidden, State, state_without_cut

__all__ = ["INSTRUMENTS", "Site", "write_instrument"]

U_UM, TRACKER_U_UM = 0.3, 1.0


@dataclass(frozen=True)
class Site:
    """Where tests take place: a machine, what it suffers from, where its workpiece zero is."""

    machine: TrueMachine
    hidden: list[Hidden]
    zero_mm: np.ndarray

    @property
    def room_mm(self) -> np.ndarray:
        """(3, 2) travel of X, Y and Z."""
        return np.array([self.machine.travel_mm[a] for a in "XYZ"])

    def share(self, share: tuple[float, float, float] | np.ndarray) -> np.ndarray:
        """A place at these shares of the travels."""
        low, high = self.room_mm.T
        return low + np.asarray(share) * (high - low)

    def seen_um(self, state: State) -> np.ndarray:
        """Tool point against workpiece, (M, 3)."""
        return 1e3 * displacement_mm(state, self.machine, self.hidden)

    def state_at(self, journey: Journey, nodes: list[int], length_mm: float) -> State:
        """The machine at the ends of these moves of a journey, with a tool of this length."""
        return state_without_cut(
            journey.path(),
            node=np.array(nodes),
            share=np.ones(len(nodes)),
            tool_length_mm=length_mm,
            zero_mm=self.zero_mm,
        )


def write_instrument(folder: Path, name: str, rng: np.random.Generator, site: Site) -> str:
    """Do one test out of `INSTRUMENTS`, write its file, return its lines of the job."""
    kind, _, axis = name.partition("_")
    header, rows, settings = INSTRUMENTS[name](rng, site)
    file = f"{name}.csv"
    cells = (",".join(c if isinstance(c, str) else f"{c:.6g}" for c in row) for row in rows)
    (folder / file).write_text("\n".join([header, *cells]) + "\n")
    told = {"kind": kind, "file": file, **({"axis": axis} if kind == "laser" else {}), **settings}
    lines = [f"{key} = {_toml(value)}" for key, value in told.items()]
    return "\n".join(["", "[[measurements]]", *lines])


def _toml(value) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    return str([round(float(v), 3) for v in value]) if np.ndim(value) else f"{value:g}"


def _ballbar_xy(rng, site: Site):
    """Two feeds, both ways round, half a turn of run-up."""
    length, radius, run_up = 150.0, 150.0, np.pi / 2
    centre = np.round(site.share(rng.uniform(0.4, 0.6, 3)), 3)
    journey = Journey(centre - np.array([radius, 0, 0]))
    out_of_place, wrong_radius = rng.uniform(-8, 8, 2), rng.uniform(-5, 5)
    angle = np.deg2rad(np.arange(1.0, 360.0, 2.0))
    blocks = []
    for feed in (1000.0, 4000.0):
        for run, turn in (("ccw", 1), ("cw", -1)):
            way = turn * angle
            start = -turn * run_up
            journey.go(
                centre + radius * np.array([np.cos(start), np.sin(start), 0]), feed_mm_min=feed
            )
            first, last = journey.circle(centre, turn * (2 * run_up + 2 * np.pi), feed_mm_min=feed)
            blocks.append((run, feed, turn, way, first, last))
            journey.wait(5.0)
    path, rows, zero_s = journey.path(), [], None
    for run, feed, turn, way, first, last in blocks:
        along = (angle + run_up) / (2 * run_up + 2 * np.pi) * (last - first)
        node = first + np.minimum(along.astype(int), last - first - 1)
        out = np.stack([np.cos(way), np.sin(way), 0 * way], axis=1)
        tangent, speed = turn * np.stack([-out[:, 1], out[:, 0], 0 * way], axis=1), feed / 60
        state = state_without_cut(
            path,
            node=node,
            share=along - (node - first),
            tool_length_mm=length,
            zero_mm=site.zero_mm,
            nose_mm=centre + radius * out,
            velocity_mm_s=speed * tangent,
            acceleration_mm_s2=-(speed**2) / radius * out,
        )
        radial = np.einsum("ij,ij->i", site.seen_um(state), out)
        radial += wrong_radius + out[:, :2] @ out_of_place + U_UM * rng.normal(size=len(way))
        zero_s = state.time_s[0] if zero_s is None else zero_s
        degrees = np.rad2deg(way) % 360
        rows += [(run, feed, *r) for r in zip(degrees, state.time_s - zero_s, radial, strict=True)]
    settings = {
        "plane": "XY",
        "centre_mm": centre,
        "radius_mm": radius,
        "tool_length_mm": length,
        "u_um": U_UM,
    }
    return "run,feed_mm_min,angle_deg,t_s,radius_um", rows, settings


def _there_and_back(site: Site, place, stops: np.ndarray, *, sign: int, length_mm: float):
    """Stops along a line, both ways twice: the machine at each, and (run, stop, approach).

    `place` gives the nose at a stop, `sign` the direction in which the first way goes.
    """
    journey, nodes, told = Journey(place(stops[0] - sign * 5.0)), [], []
    for run in ("1", "2"):
        for way, targets in ((sign, stops), (-sign, stops[::-1])):
            journey.go(place(targets[0] - way * 5.0), feed_mm_min=6000)  # overrun
            for stop in targets:
                journey.go(place(stop), feed_mm_min=6000)
                journey.wait(4.0)
                nodes.append(journey.node - 1)
                told.append((run, stop, float(way)))
    return site.state_at(journey, nodes, length_mm), told


def _line_rows(told: list, state: State, seen_um: np.ndarray) -> list[tuple]:
    """Rows of a line's file: time and reading from those of the first stop."""
    time, seen = state.time_s - state.time_s[0], seen_um - seen_um[0]
    return [(*t, s, d) for t, s, d in zip(told, time, seen, strict=True)]


def _laser(axis: str):
    """One axis there and back twice, with a stretch of fine steps."""
    k, length = "XYZ".index(axis), 180.0

    def measure(rng, site: Site):
        low, high = site.room_mm[k]
        coarse = np.arange(high - 20.0, low + 20.0, -25.0)
        fine = high - rng.uniform(100, 140) - 1.3 * np.arange(31)
        there = np.sort(np.concatenate([coarse, fine]))[::-1]
        at = np.round(site.share(rng.uniform(0.4, 0.6, 3)), 3)
        at[k] = 0.0
        beam = rng.normal(size=2) * 2e-4  # the beam leans a little

        def place(q: float) -> np.ndarray:
            return np.where(np.arange(3) == k, q, at)

        state, told = _there_and_back(site, place, there, sign=-1, length_mm=length)
        shorter = -0.5 * beam @ beam * 1e3 * (state.nose_mm[:, k] - there[0])
        seen = site.seen_um(state)[:, k] + shorter + U_UM * rng.normal(size=len(told))
        settings = {"at_mm": at, "tool_length_mm": length, "u_um": U_UM}
        header = "run,position_mm,approach,t_s,deviation_um"
        return header, _line_rows(told, state, seen), settings

    return measure


def _diagonal(corner: int):
    """One diagonal of the working space, there and back twice; corner 0 has all axes rising."""
    toward = np.array([1.0, 1.0 - 2 * (corner & 1), 1.0 - 2 * (corner >> 1)])

    def measure(rng, site: Site):
        length, middle = 160.0, np.full(3, 0.5)
        ends = site.share(middle - 0.42 * toward), site.share(middle + 0.42 * toward)
        start, end = (np.round(e, 3) for e in ends)
        way = float(np.linalg.norm(end - start))
        unit, stops = (end - start) / way, np.linspace(0.0, way, 25)

        def place(s: float) -> np.ndarray:
            return start + s * unit

        state, told = _there_and_back(site, place, stops, sign=1, length_mm=length)
        seen = site.seen_um(state) @ unit + U_UM * rng.normal(size=len(told))
        settings = {"from_mm": start, "to_mm": end, "tool_length_mm": length, "u_um": U_UM}
        header = "run,distance_mm,approach,t_s,deviation_um"
        return header, _line_rows(told, state, seen), settings

    return measure


def _drift(rng, site: Site):
    """An hour with the spindle on, half an hour off."""
    length, at = 120.0, np.round(site.share((0.5, 0.5, 0.5)), 3)
    journey, nodes, rpm = Journey(at), [], []
    for k in range(181):
        rpm.append(8000.0 if k < 120 else 0.0)
        journey.wait(1e-3 if k == 0 else 30.0, rpm=8000.0 if k <= 120 else 0.0)
        nodes.append(journey.node - 1)
    state = site.state_at(journey, nodes, length)
    seen = site.seen_um(state) + rng.uniform(-5, 5, 3) + U_UM * rng.normal(size=(len(nodes), 3))
    rows = [(t, n, *s) for t, n, s in zip(np.round(state.time_s), rpm, seen, strict=True)]
    settings = {"at_mm": at, "tool_length_mm": length, "u_um": U_UM}
    return "t_s,spindle_rpm,dx_um,dy_um,dz_um", rows, settings


def _tip(rng, site: Site):
    """Places all over the volume, seen by a tracker whose pose nobody knows."""
    length, places = 140.0, site.share(rng.uniform(0.08, 0.92, (160, 3)))
    journey, nodes = Journey(np.zeros(3)), []
    for place in np.round(places, 6):
        journey.go(place, feed_mm_min=4000)
        journey.wait(3.0)
        nodes.append(journey.node - 1)
    state = site.state_at(journey, nodes, length)
    turn = rng.uniform(-30, 30, 3) * 1e-3  # um per mm
    seen = site.seen_um(state) + rng.uniform(-20, 20, 3)
    seen += np.cross(turn, state.nose_mm - places.mean(axis=0))
    seen += TRACKER_U_UM * rng.normal(size=seen.shape)
    rows = [
        (str(k), t, *(f"{v:.6f}" for v in nose), *sign, *s)
        for k, (t, nose, sign, s) in enumerate(
            zip(state.time_s, state.nose_mm, state.sign, seen, strict=True), 1
        )
    ]
    settings = {"frame": "rigid", "tool_length_mm": length, "u_um": TRACKER_U_UM}
    return "id,t_s,X,Y,Z,sx,sy,sz,dx_um,dy_um,dz_um", rows, settings


#: name of the file -> what makes it
INSTRUMENTS = {
    "ballbar_xy": _ballbar_xy,
    "laser_X": _laser("X"),
    "laser_Y": _laser("Y"),
    "laser_Z": _laser("Z"),
    "diagonal_0": _diagonal(0),
    "diagonal_1": _diagonal(1),
    "drift": _drift,
    "tip": _tip,
}
