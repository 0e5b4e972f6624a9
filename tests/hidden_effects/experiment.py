"""One experiment on disk: job, machine, programs, measured points, truth."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .machine_maker import TrueMachine, random_machine, write_machine
from .nature_cutting import CUTTING
from .nature_foreign import FOREIGN
from .nature_heat import HEAT
from .nature_motion import MOTION
from .nature_tables import TABLES
from .part import TOOLS, Part, random_part
from .state import Hidden, State, state_of

__all__ = [
    "FOREIGN_KINDS",
    "SINGLE_KINDS",
    "Experiment",
    "alignment_columns",
    "make_experiment",
    "share_um",
    "visible_um",
]

KINDS = {f.__name__: f for group in (MOTION, HEAT, CUTTING, TABLES, FOREIGN) for f in group}
FOREIGN_KINDS = tuple(f.__name__ for f in FOREIGN)
SINGLE_KINDS = tuple(k for k in KINDS if k not in FOREIGN_KINDS)
#: a hidden effect that shows less than this after the part's alignment is drawn again
LEAST_VISIBLE_UM = 1.2


@dataclass(frozen=True)
class Experiment:
    """Where it lies and what is true."""

    folder: Path
    hidden: list[Hidden]
    machine: TrueMachine
    part: Part
    check: Part
    deviation_um: np.ndarray  #: noise-free, unaligned
    share_um: list[np.ndarray]  #: of each hidden effect


def make_experiment(
    folder: Path,
    *,
    effects: list[str],
    seed: int,
    chain: str | None = None,
    noise_um: float = 0.8,
    noisy_tables: bool = True,
    spindle_stops: bool | None = None,
) -> Experiment:
    """Draw and write one experiment.

    Parameters
    ----------
    effects : kinds out of `KINDS`; empty for a machine in good health
    noise_um : standard uncertainty of a measured point
    noisy_tables : False: the calibration was perfect
    """
    rng = np.random.default_rng([seed, *(sum(map(ord, e)) for e in effects)])
    folder.mkdir(parents=True, exist_ok=True)
    machine = random_machine(rng, chain)
    motion = {"rapid_mm_min": machine.rapid_mm_min, "tool_change_s": machine.tool_change_s}
    stops = bool(rng.random() < 0.5) if spindle_stops is None else spindle_stops
    how = {"motion": motion, "spindle_stops": stops}
    part = random_part(rng, machine.travel_mm, **how)
    check = random_part(rng, machine.travel_mm, **how, cells=12, offset_mm=part.offset_mm)
    parts = {"part": part, "check": check}
    states = {role: state_of(part) for role, part in parts.items()}
    hidden = [_draw(rng, kind, machine, states["part"], parts["part"]) for kind in effects]
    missing = tuple(name for h in hidden for name in h.missing)
    wrong = {n: machine.reflector_mm[n] + d for h in hidden for n, d in h.misplaced.items()}
    write_machine(folder, machine, rng, missing=missing, misplaced=wrong, noisy=noisy_tables)
    _damage(machine, hidden)
    truth = {"effects": [_told(h) for h in hidden], "accept": [list(h.accept) for h in hidden]}
    for role, made in parts.items():
        total = _deviation_um(made, states[role], machine, hidden)
        (folder / f"{role}.nc").write_text(made.text)
        _write_measured(folder / f"{role}_measured.csv", made, total, rng=rng, noise_um=noise_um)
        shares = [share_um(h, made, states[role], machine) for h in hidden]
        truth[role] = {
            "points": len(total),
            "duration_s": float(made.path.time_s[-1]),
            "hidden_visible_um": [visible_um(s, made) for s in shares],
        }
        if role == "part":
            kept = (total, shares)
    _write_job(folder, parts)
    truth["noise_um"] = noise_um
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    return Experiment(folder, hidden, machine, part, check, *kept)


def _draw(rng, kind: str, machine: TrueMachine, state: State, part: Part) -> Hidden:
    """The effect, drawn again while it would hardly show."""
    best, most = None, -1.0
    for _ in range(12):
        hidden = KINDS[kind](rng, machine)
        seen = visible_um(share_um(hidden, part, state, machine), part)
        if seen > most:
            best, most = hidden, seen
        if most >= LEAST_VISIBLE_UM:
            break
    return best


def _damage(machine: TrueMachine, hidden: list[Hidden]) -> None:
    for h in hidden:
        machine.extra.update(h.changed)


def share_um(hidden: Hidden, part: Part, state: State, machine: TrueMachine) -> np.ndarray:
    """What one effect alone does to the deviations, um per measured point."""
    e = np.zeros_like(state.nose_mm)
    if hidden.displacement_mm:
        e = e + hidden.displacement_mm(state)
    for name, change in hidden.changed.items():
        e = e + _component_mm(name, change, state, machine)
    for name in hidden.missing:
        e = e + _component_mm(name, machine.curves[name], state, machine)
    for name, wrong in hidden.misplaced.items():
        e = e - _misread_mm(name, wrong, state, machine)
    return _per_point(np.einsum("ij,ij->i", e, state.normal), part) * 1e3


def _component_mm(name: str, curve, state: State, machine: TrueMachine) -> np.ndarray:
    """First-order displacement of one component error, mm."""
    axis = name[2]
    value = curve(state.nose_mm[:, "XYZ".index(axis)])[:, None]
    if name[1] in "XYZ":
        return value * 1e-3 * np.eye(3)["XYZ".index(name[1])]
    arm = state.contact_mm.copy()
    order = [c for c in machine.chain.split("b")[0] if c in "XYZ"]
    work = machine.work_side
    inner = order[: order.index(axis)] if axis in order else order + work[: work.index(axis) + 1]
    for other in inner:
        k = "XYZ".index(other)
        arm[:, k] += state.nose_mm[:, k]
    return np.cross(value * 1e-6 * np.eye(3)["ABC".index(name[1])], arm)


def _misread_mm(name: str, wrong: np.ndarray, state: State, machine: TrueMachine) -> np.ndarray:
    axis = name[2]
    q = state.nose_mm[:, "XYZ".index(axis)]
    turn = np.stack([machine.curves[f"E{c}{axis}"](q) for c in "ABC"], axis=1) * 1e-6
    e = np.zeros_like(state.nose_mm)
    k = "XYZ".index(name[1])
    e[:, k] = -np.cross(turn, wrong)[:, k]
    return e


def _per_point(row_mm: np.ndarray, part: Part) -> np.ndarray:
    """The deepest of all moments at which the tool was over a point."""
    point = part.contacts["point"]
    return np.minimum.reduceat(row_mm, np.flatnonzero(np.diff(point, prepend=-1)))


def _deviation_um(part: Part, state: State, machine: TrueMachine, hidden: list[Hidden]):
    e = machine.displacement_mm(state.nose_mm, state.contact_mm)
    for h in hidden:
        if h.displacement_mm:
            e = e + h.displacement_mm(state)
    row = np.einsum("ij,ij->i", e, state.normal) + part.contacts["geometry_mm"]
    return _per_point(row, part) * 1e3


def alignment_columns(part: Part) -> np.ndarray:
    """(N, 6): deviation per um of shift and per urad of rotation about the part's middle."""
    arm = part.place_mm - part.size_mm / 2
    return np.concatenate([part.normal, np.cross(arm, part.normal) * 1e-3], axis=1)


def visible_um(deviation_um: np.ndarray, part: Part) -> float:
    """RMS of what the part's alignment leaves."""
    columns = alignment_columns(part)
    fit = np.linalg.lstsq(columns, deviation_um, rcond=None)[0]
    return float(np.sqrt(np.mean((deviation_um - columns @ fit) ** 2)))


def _write_measured(path: Path, part: Part, deviation_um, *, rng, noise_um: float) -> None:
    pose = np.concatenate([rng.uniform(-10, 10, 3), rng.uniform(-15, 15, 3)])
    seen = deviation_um + alignment_columns(part) @ pose
    seen = seen + noise_um * rng.normal(size=len(seen))
    measured = part.place_mm + seen[:, None] * 1e-3 * part.normal
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for number, row in enumerate(zip(part.feature, part.place_mm, part.normal, measured,
                                     strict=True), 1):
        name, place, normal, m = row
        cells = [f"{v:.6f}" for v in (*place, *normal, *m)]
        lines.append(f"{number},{name},{','.join(cells)},{noise_um:g}")
    path.write_text("\n".join(lines) + "\n")


def _told(hidden: Hidden) -> dict:
    return {
        "name": hidden.name, "target": hidden.target, "parameters": hidden.parameters,
        "comparable": {k: float(v) for k, v in hidden.comparable.items()},
    }


def _write_job(folder: Path, parts: dict[str, Part]) -> None:
    """job.toml for the part, check.toml for the check part."""
    for role, name in (("part", "job.toml"), ("check", "check.toml")):
        part = parts[role]
        lines = [
            "schema = 1", 'machine = "machine.toml"', f'program = "{role}.nc"',
            f'measured = "{role}_measured.csv"', "", "[work_offsets_mm]",
            f"G54 = {part.offset_mm.tolist()}", "", "[stock]",
            "min_mm = [-40, -40, -60]",
            f"max_mm = [{part.size_mm[0] + 40:.0f}, {part.size_mm[1] + 40:.0f}, 0]",
        ]
        for tool in TOOLS:
            lines += [
                "", f"[tools.{tool.number}]", 'shape = "flat"',
                f"diameter_mm = {tool.diameter_mm:g}", f"length_mm = {tool.length_mm:g}",
                f"flutes = {3 if tool.number == 1 else 4}",
            ]
        (folder / name).write_text("\n".join(lines) + "\n")
