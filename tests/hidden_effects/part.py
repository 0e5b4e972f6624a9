"""Random test parts: features in the cells of a grid, their cuts and their measured points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .features import TOOLS, FeatureBuilder
from .program_writer import Path3, ProgramWriter

__all__ = ["SECOND_DATUM_MM", "TOOLS", "Part", "PartDesign", "random_part"]


@dataclass(frozen=True)
class PartDesign:
    """What kind of part it is.

    Attributes
    ----------
    corners : square pockets take the place of some features
    two_set_ups : the second half is made in a second clamping, from a datum of its own
    tool_order : index of the tool of each block between tool changes
    """

    corners: bool = False
    two_set_ups: bool = False
    tool_order: tuple[int, ...] = (0, 1, 0, 1)


@dataclass
class Part:
    """Program text, path, measured surface points and the moments that made them."""

    text: str
    path: Path3
    feature: list[str]
    place_mm: np.ndarray
    normal: np.ndarray
    contacts: dict[str, np.ndarray]
    offsets_mm: np.ndarray  #: (S, 3) datum of each clamping, machine coordinates
    size_mm: np.ndarray


FEATURES = ("bore", "groove", "boss", "wave", "groove", "diamond", "spline")
#: with square pockets, whose walls begin right after a corner
CORNERED = ("bore", "groove", "boss", "pocket", "groove", "diamond", "pocket")
#: the datum of a second clamping, on the part
SECOND_DATUM_MM = np.array([240.0, 160.0, -5.0])


def random_part(
    rng: np.random.Generator,
    travel_mm: dict[str, tuple[float, float]],
    *,
    motion: dict[str, float],
    spindle_stops: bool = False,
    cells: int = 14,
    offset_mm: np.ndarray | None = None,
    design: PartDesign | None = None,
) -> Part:
    """A part that fits the travel, features in random cells in random order.

    Parameters
    ----------
    motion : keyword arguments of `ProgramWriter`
    spindle_stops : the spindle rests during some of the pauses
    offset_mm : machine coordinates of the workpiece zero, where another part stood before
    """
    design = design or PartDesign()
    pitch = np.array([rng.uniform(146, 152), rng.uniform(144, 150)])
    room = np.array([-travel_mm[a][0] for a in "XY"]) - 30.0
    height = float(rng.integers(-42, -36) * 10)
    offset = np.array([-room[0] - 10, -room[1] - 10, height]) if offset_mm is None else offset_mm
    offsets = np.array([offset, offset + SECOND_DATUM_MM])[: 2 if design.two_set_ups else 1]
    writer = ProgramWriter(offset, **motion)
    builder = FeatureBuilder(rng, writer)
    for number, (tool, cells_of_block) in enumerate(_blocks(rng, pitch, room, cells, design)):
        second = design.two_set_ups and number == len(design.tool_order) // 2
        writer.change(TOOLS[tool], clamp=("G55", SECOND_DATUM_MM) if second else None)
        for k, kind, place in cells_of_block:
            feed = float(rng.choice([400.0, 800.0, 1600.0, 2400.0]))
            name = f"T{writer.tool.number}.{kind}.{k}"
            getattr(builder, kind)(name, np.round(place, 3), feed)
            _rest(rng, writer, may_stop=spindle_stops)
    text, path = writer.finish()
    contacts = {name: np.array(value) for name, value in vars(builder.contacts).items()}
    size = np.array([*room, 0.0])
    return Part(
        text,
        path,
        builder.feature,
        np.array(builder.place),
        np.array(builder.normal),
        contacts,
        offsets,
        size,
    )


def _blocks(rng, pitch, room, cells: int, design: PartDesign):
    """Tool, and (number, kind, centre) of every cell, for each block between tool changes."""
    counts = np.floor(room / pitch).astype(int)
    grid = [(i + 0.5, j + 0.5) for i in range(counts[0]) for j in range(counts[1])]
    places = [pitch * grid[k] for k in rng.permutation(len(grid))[:cells]]
    order = design.tool_order
    blocks = np.array_split(np.arange(len(places)), len(order))
    features = CORNERED if design.corners else FEATURES
    kinds = {}
    for tool in (0, 1):  # every kind of feature by both tools
        mine = np.concatenate([b for b, t in zip(blocks, order, strict=True) if t == tool])
        kinds |= dict(zip(mine, rng.permutation(features), strict=False))
    return [
        (tool, [(k, kinds[k], places[k]) for k in block])
        for tool, block in zip(order, blocks, strict=True)
    ]


def _rest(rng: np.random.Generator, writer: ProgramWriter, *, may_stop: bool) -> None:
    """A pause between two features."""
    stop = may_stop and rng.random() < 0.35
    if stop:
        writer.spindle(False)
    writer.dwell(int(rng.integers(100, 400)) * (3 if stop else 1))
    if stop:
        writer.spindle(True)
