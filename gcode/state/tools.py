"""Tool table and offset memory: the lengths and diameters that G43, G41 and G42 look up."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from gcode.errors import ProgramError
from gcode.text.regular_file import read_regular_file

__all__ = ["OffsetEntry", "ToolEntry", "offset_memory", "read_tool_table"]

_ENTRY = re.compile(r"([A-Za-z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")


@dataclass(frozen=True)
class ToolEntry:
    """One row of the tool table.

    Attributes
    ----------
    length_mm : float
        Tool length offset along Z, nose minus tip (G43).
    diameter_mm : float
        Cutter diameter (G41, G42); negative swaps the sides.
    x_mm, y_mm : float
        Tool offsets along X and Y.
    rotary_deg : tuple of float
        Offsets of A, B, C in degrees.
    orientation : int
        Lathe tool orientation 1 ... 9, 0 for a mill.
    length_wear_mm, diameter_wear_mm : float
        Added to length and diameter.
    name : str
        By which a program may call it: ``TOOL CALL "MILL_D20"``, ``T="MILL_D20"``.
    """

    length_mm: float = 0.0
    diameter_mm: float = 0.0
    x_mm: float = 0.0
    y_mm: float = 0.0
    rotary_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation: int = 0
    length_wear_mm: float = 0.0
    diameter_wear_mm: float = 0.0
    name: str = ""

    @property
    def offset_length_mm(self) -> float:
        """What G43 applies along Z."""
        return self.length_mm + self.length_wear_mm

    @property
    def offset_diameter_mm(self) -> float:
        """What G41 and G42 apply."""
        return self.diameter_mm + self.diameter_wear_mm


@dataclass(frozen=True)
class OffsetEntry:
    """One row of the offset memory: what the words H and D of its number mean.

    Controls keep geometry and wear apart for both (Fanuc's tool compensation memory C; Haas'
    offset page: H length geometry and wear, D diameter geometry and wear).

    Attributes
    ----------
    length_mm, diameter_mm : float or None
        Geometry of H and D; None for that of the tool with the same number.
    length_wear_mm, diameter_wear_mm : float
        Added to them.
    """

    length_mm: float | None = None
    length_wear_mm: float = 0.0
    diameter_mm: float | None = None
    diameter_wear_mm: float = 0.0


def offset_memory(
    tools: Mapping[int, ToolEntry], offsets: Mapping[int, OffsetEntry]
) -> dict[int, ToolEntry]:
    """What H and D of every number mean: the tools' own dimensions, and over them the offsets.

    A row that gives neither geometry nor a tool's number is zero there.
    """
    memory = dict(tools)
    for number, row in offsets.items():
        given = {"length_mm": row.length_mm, "diameter_mm": row.diameter_mm}
        memory[number] = replace(
            memory.get(number, ToolEntry()),
            length_wear_mm=row.length_wear_mm,
            diameter_wear_mm=row.diameter_wear_mm,
            **{name: value for name, value in given.items() if value is not None},
        )
    return memory


def read_tool_table(path: str | Path, *, unit_mm: float = 1.0) -> dict[int, ToolEntry]:
    """Read a LinuxCNC tool table (``T1 P1 D6.0 Z50.2 ; end mill``).

    Parameters
    ----------
    path : path
        The table.
    unit_mm : float
        Length of the table's unit in mm: 1, or 25.4 for a machine in inches.

    Returns
    -------
    dict
        Tool number -> entry.

    Raises
    ------
    ProgramError
        For a row without T, or with two rows for one tool.
    """
    tools: dict[int, ToolEntry] = {}
    data = read_regular_file(path)
    if b"\0" in data:
        what = "the tool table is no text: it holds zero bytes"
        raise ProgramError(what, file=path, accepted="rows such as T1 P1 D6.0 Z50.2 ; remark")
    text = data.decode("utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        content = line.split(";")[0].strip()
        if not content:
            continue
        words = {letter.upper(): float(value) for letter, value in _ENTRY.findall(content)}
        if "T" not in words or _ENTRY.sub("", content).strip():
            raise ProgramError(
                f"not a row of a tool table: '{content}'",
                file=path,
                line=number,
                accepted="T1 P1 D6.0 Z50.2 ; remark",
            )
        if int(words["T"]) in tools:
            raise ProgramError(f"tool T{int(words['T'])} is listed twice", file=path, line=number)
        tools[int(words["T"])] = ToolEntry(
            length_mm=words.get("Z", 0.0) * unit_mm,
            diameter_mm=words.get("D", 0.0) * unit_mm,
            x_mm=words.get("X", 0.0) * unit_mm,
            y_mm=words.get("Y", 0.0) * unit_mm,
            rotary_deg=(words.get("A", 0.0), words.get("B", 0.0), words.get("C", 0.0)),
            orientation=int(words.get("Q", 0)),
        )
    return tools
