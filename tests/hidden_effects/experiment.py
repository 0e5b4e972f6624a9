"""One experiment on disk: job, machine, programs, measured points, instruments, truth."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .instruments import Site, write_instrument
from .machine_maker import TrueMachine, random_machine, write_machine
from .measuring import measuring_error_um, stated_um
from .nature_clamping import CLAMPING
from .nature_cutting import CUTTING
from .nature_foreign import FOREIGN
from .nature_heat import HEAT
from .nature_motion import MOTION
from .nature_tables import TABLES
from .nature_unforeseen import TRIED_ALONE, UNFORESEEN
from .part import TOOLS, Part, PartDesign, random_part
from .shares import alignment_columns, deviation_um, least_own_um, share_um, visible_um
from .state import Hidden, State, state_of

__all__ = ["FOREIGN_KINDS", "SINGLE_KINDS", "Experiment", "make_experiment"]

KNOWN = (*MOTION, *HEAT, *CLAMPING, *CUTTING, *TABLES)
KINDS = {f.__name__: f for f in (*KNOWN, *FOREIGN, *UNFORESEEN, *TRIED_ALONE)}
FOREIGN_KINDS = tuple(f.__name__ for f in (*FOREIGN, *UNFORESEEN))
SINGLE_KINDS = tuple(f.__name__ for f in KNOWN)
#: an effect that shows less than this after the part's alignment is drawn again, and so are
#: several of which one shows less than the second number beside the others
LEAST_VISIBLE_UM, LEAST_OWN_UM = 1.2, 0.8
_DRAWS = 20


@dataclass(frozen=True)
class Experiment:
    """Where it lies and what is true."""

    folder: Path
    hidden: list[Hidden]
    machine: TrueMachine
    part: Part
    check: Part
    deviation_um: np.ndarray  #: of the part, noise-free, unaligned
    check_deviation_um: np.ndarray  #: of the check part
    share_um: list[np.ndarray]  #: of each hidden effect
    check_share_um: list[np.ndarray]  #: of each hidden effect, on the check part


def make_experiment(
    folder: Path,
    *,
    effects: list[str],
    seed: int,
    chain: str | None = None,
    noise_um: float = 0.8,
    noise: str = "white",
    noisy_tables: bool = True,
    spindle_stops: bool | None = None,
    design: PartDesign | None = None,
    instruments: tuple[str, ...] = (),
) -> Experiment:
    """Draw and write one experiment.

    Parameters
    ----------
    effects : kinds out of `KINDS`; empty for a machine in good health
    noise_um : standard uncertainty of a measured point
    noise : kind of it, out of `NOISES` and `PEERS`
    noisy_tables : False: the calibration was perfect
    design : what kind of part; an effect that needs corners or two clampings gets them
    instruments : names out of `INSTRUMENTS`
    """
    rng = np.random.default_rng([seed, *(sum(map(ord, e)) for e in effects)])
    folder.mkdir(parents=True, exist_ok=True)
    for _ in range(_DRAWS):
        machine = random_machine(rng, chain)
        stops = bool(rng.random() < 0.5) if spindle_stops is None else spindle_stops
        how = {"spindle_stops": stops, "design": _design_for(effects, design)}
        parts = _draw_parts(rng, machine, how)
        states = {role: state_of(part) for role, part in parts.items()}
        hidden = _draw(rng, effects, machine, state=states["part"], part=parts["part"])
        if hidden is not None:
            break
    else:
        raise ValueError(f"{' and '.join(effects)} cannot be seen")
    missing = tuple(name for h in hidden for name in h.missing)
    turned = tuple(name for h in hidden for name in h.turned_round)
    wrong = {n: machine.reflector_mm[n] + d for h in hidden for n, d in h.misplaced.items()}
    write_machine(
        folder, machine, rng,
        missing=missing, misplaced=wrong, turned_round=turned, noisy=noisy_tables,
    )  # fmt: skip
    for h in hidden:
        machine.extra.update(h.changed)
    truth = {
        "effects": [
            _told(shown, states["part"])
            for h in hidden
            for shown in h.told_as(states["part"]) or (h,)
        ],
        "noise_um": noise_um,
        "noise": noise,
        "spindle_stops": stops,
    }
    totals, shares = {}, {}
    for role, made in parts.items():
        acting = hidden if role == "part" else [_on_another_day(h) for h in hidden]
        totals[role] = deviation_um(made, states[role], machine, acting)
        (folder / f"{role}.nc").write_text(made.text)
        file = folder / f"{role}_measured.csv"
        _write_measured(file, made, totals[role], rng=rng, noise=(noise, noise_um))
        shares[role] = [share_um(h, made, states[role], machine) for h in acting]
        truth[role] = {
            "points": len(totals[role]),
            "duration_s": float(made.path.time_s[-1]),
            "hidden_visible_um": [visible_um(s, made) for s in shares[role]],
        }
    site = Site(machine, hidden, parts["part"].offsets_mm[0])
    _write_jobs(folder, parts, [write_instrument(folder, name, rng, site) for name in instruments])
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))
    return Experiment(
        folder,
        hidden,
        machine,
        parts["part"],
        parts["check"],
        totals["part"],
        totals["check"],
        shares["part"],
        shares["check"],
    )


def _design_for(effects: list[str], design: PartDesign | None) -> PartDesign:
    design = design or PartDesign()
    if "corner_rounding" in effects:
        design = replace(design, corners=True)
    if "fixture" in effects:
        design = replace(design, two_set_ups=True)
    return design


def _draw_parts(rng: np.random.Generator, machine: TrueMachine, how: dict) -> dict[str, Part]:
    """The part to learn from, and another that stands in its place."""
    motion = {"rapid_mm_min": machine.rapid_mm_min, "tool_change_s": machine.tool_change_s}
    part = random_part(rng, machine.travel_mm, motion=motion, **how)
    place = {"cells": 12, "offset_mm": part.offsets_mm[0]}
    return {
        "part": part,
        "check": random_part(rng, machine.travel_mm, motion=motion, **place, **how),
    }


def _draw(
    rng, kinds: list[str], machine: TrueMachine, *, state: State, part: Part
) -> list[Hidden] | None:
    """The effects, drawn again while one of them would hardly show beside the others."""
    for _ in range(_DRAWS):
        hidden = [_draw_one(rng, kind, machine, state=state, part=part) for kind in kinds]
        if None in hidden:
            return None
        if len(hidden) < 2 or least_own_um(hidden, part, state, machine) > LEAST_OWN_UM:
            return hidden
    return None


def _draw_one(rng, kind: str, machine: TrueMachine, *, state: State, part: Part) -> Hidden | None:
    for _ in range(_DRAWS):
        hidden = KINDS[kind](rng, machine)
        if visible_um(share_um(hidden, part, state, machine), part) > LEAST_VISIBLE_UM:
            return hidden
    return None


def _write_measured(path: Path, part: Part, deviation, *, rng, noise: tuple[str, float]) -> None:
    kind, noise_um = noise
    pose = np.concatenate([rng.uniform(-10, 10, 3), rng.uniform(-15, 15, 3)])
    seen = deviation + alignment_columns(part) @ pose
    place = {"feature": part.feature, "place_mm": part.place_mm, "normal": part.normal}
    seen = seen + noise_um * measuring_error_um(kind, rng, **place)
    measured = part.place_mm + seen[:, None] * 1e-3 * part.normal
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    rows = zip(part.feature, part.place_mm, part.normal, measured, strict=True)
    for number, (name, place, normal, m) in enumerate(rows, 1):
        cells = [f"{v:.6f}" for v in (*place, *normal, *m)]
        lines.append(f"{number},{name},{','.join(cells)},{stated_um(kind, noise_um):g}")
    path.write_text("\n".join(lines) + "\n")


def _on_another_day(hidden: Hidden) -> Hidden:
    return replace(hidden, displacement_mm=hidden.another_day or hidden.displacement_mm)


def _told(hidden: Hidden, state: State) -> dict:
    return {
        "name": hidden.name,
        "target": hidden.target,
        "parameters": hidden.parameters,
        "comparable": {k: float(v) for k, v in hidden.comparable.items()},
        "accept": [*hidden.accept, *hidden.shows_as(state)],
        "twins": list(hidden.twins),
    }


def _write_jobs(folder: Path, parts: dict[str, Part], instruments: list[str]) -> None:
    """job.toml for the part, check.toml for the check part."""
    for role, name in (("part", "job.toml"), ("check", "check.toml")):
        part = parts[role]
        offsets = [f"G5{4 + k} = {o.tolist()}" for k, o in enumerate(part.offsets_mm)]
        lines = [
            "schema = 1",
            'machine = "machine.toml"',
            f'program = "{role}.nc"',
            f'measured = "{role}_measured.csv"',
            *(['workpiece_zero = "G54"'] if len(offsets) > 1 else []),
            "",
            "[work_offsets_mm]",
            *offsets,
            "",
            "[stock]",
            "min_mm = [-40, -40, -60]",
            f"max_mm = [{part.size_mm[0] + 40:.0f}, {part.size_mm[1] + 40:.0f}, 0]",
        ]
        for tool in TOOLS:
            lines += [
                "",
                f"[tools.{tool.number}]",
                'shape = "flat"',
                f"diameter_mm = {tool.diameter_mm:g}",
                f"length_mm = {tool.length_mm:g}",
                f"flutes = {3 if tool.number == 1 else 4}",
            ]
        lines += instruments if role == "part" else []
        (folder / name).write_text("\n".join(lines) + "\n")
