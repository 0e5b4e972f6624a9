"""A machine taken apart: the same chain with one of its errors at a time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from vmach.machine.machine import Machine
from vmach.machine.squareness import squareness_name

__all__ = ["single_errors"]


def single_errors(machine: Machine) -> Iterator[tuple[str, Machine]]:
    """Every error by its ISO 230-1 symbol, with the machine that has no other.

    First-order displacements of these machines add up to that of the whole, as long as measuring
    points are taken from the whole.
    """
    bare = {
        name: replace(axis, components={}, location_mm=np.zeros(3), location_rad=np.zeros(3))
        for name, axis in machine.rotary.items()
    }
    perfect = replace(machine, components={}, squareness_rad=np.zeros((3, 3)), rotary=bare)
    for name, component in machine.components.items():
        yield name, replace(perfect, components={name: component})
    for axis, rotation in np.argwhere(machine.squareness_rad * (1.0 - np.eye(3))):
        sigma = np.zeros((3, 3))
        sigma[axis, rotation] = machine.squareness_rad[axis, rotation]
        yield squareness_name(axis, rotation), replace(perfect, squareness_rad=sigma)
    for letter, axis in machine.rotary.items():
        for name, component in axis.components.items():
            alone = replace(bare[letter], components={name: component})
            yield name, replace(perfect, rotary=bare | {letter: alone})
        for kinds, field in (("XYZ", "location_mm"), ("ABC", "location_rad")):
            for k in np.flatnonzero(getattr(axis, field)):
                alone = replace(bare[letter], **{field: getattr(axis, field) * np.eye(3)[k]})
                yield f"E{kinds[k]}0{letter}", replace(perfect, rotary=bare | {letter: alone})
