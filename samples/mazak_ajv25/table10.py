"""Largest deviations of the tool tip along both toolpaths, beside Table 10 of the thesis.

Run from anywhere:  python samples/mazak_ajv25/table10.py

The thesis' model has one measuring point an axis, which is the Abbe-consistent form with
every reflector of an axis at that point; the conventional form is printed too. Since the curves
are reconstructed, only their sizes count. "At most" is what no curves of those sizes can exceed:
every error as large as its printed range M wherever it hurts, all with the same sign.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from gcode import MoveKind
from vmach.job import read_job
from vmach.machine import ComponentError, Machine, Variant, displacement, read_machine
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates

FOLDER = Path(__file__).resolve().parent
PRINTED_UM = {"toolpath1": (8.5, 24.3, 26.7), "toolpath2": (12.7, 24.4, 27.6)}
MACHINES = {
    "EA0Z as meant, 66.697 um/m": "machine.toml",
    "EA0Z as printed, 13.757 um/m": "machine_ea0z_as_printed.toml",
}
VARIANTS = {"measuring points": Variant.ABBE, "conventional HTM": Variant.HTM}


def largest_um(machine: Machine, nodes: PathStates, variant: Variant) -> np.ndarray:
    """Largest |dx|, |dy|, |dz| of the tip on the toolpath proper: feed moves at one height, um."""
    shift = displacement(machine, nodes.nose_mm, nodes.tool_mm, variant).shift_mm
    moves = nodes.moves
    level = moves.start_mm[:, 2] == moves.end_mm[:, 2]
    cutting = level & np.isin(moves.kind, [MoveKind.LINE, MoveKind.ARC])
    return 1e3 * np.abs(shift[cutting[nodes.move]]).max(axis=0)


def bound_um(machine: Machine, nodes: PathStates, variant: Variant) -> np.ndarray:
    """Sum over all errors of the largest share that one of its size can have, um."""
    nothing = {name: _constant(error, 0.0) for name, error in machine.components.items()}
    total = largest_um(replace(machine, components=nothing), nodes, variant)
    straight = replace(machine, squareness_rad=np.zeros((3, 3)))
    for name, error in machine.components.items():
        alone = nothing | {name: _constant(error, np.ptp(error.mean))}
        total = total + largest_um(replace(straight, components=alone), nodes, variant)
    return total


def _constant(error: ComponentError, value: float) -> ComponentError:
    table = np.full(len(error.position_mm), value)
    return replace(error, forward=table, backward=table)


def main() -> None:
    """Print the table."""
    print(f"{'largest deviation, um':44s}{'X':>8s}{'Y':>8s}{'Z':>8s}")
    for name, printed in PRINTED_UM.items():
        print(f"\n{name + ', printed in Table 10':44s}" + _numbers(printed))
        nodes = prepare(read_job(FOLDER / f"{name}.toml")).path.nodes
        for reading, file in MACHINES.items():
            machine = read_machine(FOLDER / file)
            print(f"  {reading}")
            for label, variant in VARIANTS.items():
                print(f"    {label:40s}" + _numbers(largest_um(machine, nodes, variant)))
                print(f"    {'  at most':40s}" + _numbers(bound_um(machine, nodes, variant)))


def _numbers(values: Iterable[float]) -> str:
    return "".join(f"{value:8.1f}" for value in values)


if __name__ == "__main__":
    main()
