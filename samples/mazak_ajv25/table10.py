"""Largest deviations of the tool tip along both toolpaths, beside Table 10 of the thesis.

Run from anywhere:  python samples/mazak_ajv25/table10.py

The thesis' model has one measuring point an axis, which is the Abbe-consistent form with
every reflector of an axis at that point; the conventional form is printed too.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gcode import MoveKind
from vmach.job import read_job
from vmach.machine import Machine, Variant, displacement, read_machine
from vmach.preparation import prepare
from vmach.toolpath import PathStates

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


def main() -> None:
    """Print the table."""
    print(f"{'largest deviation, um':42s}{'X':>8s}{'Y':>8s}{'Z':>8s}")
    for name, printed in PRINTED_UM.items():
        print(f"{name + ', printed in Table 10':42s}" + "".join(f"{v:8.1f}" for v in printed))
        nodes = prepare(read_job(FOLDER / f"{name}.toml")).path.nodes
        for reading, file in MACHINES.items():
            machine = read_machine(FOLDER / file)
            print(f"  {reading}")
            for label, variant in VARIANTS.items():
                largest = largest_um(machine, nodes, variant)
                print(f"    {label:38s}" + "".join(f"{v:8.1f}" for v in largest))


if __name__ == "__main__":
    main()
