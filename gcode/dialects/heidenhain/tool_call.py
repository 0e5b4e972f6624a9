"""TOOL CALL with its oversizes, and what FN 18 is told of the tools."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.state.tools import ToolEntry

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["call_tool", "tool_data", "tool_of_spindle"]

_TOOL = re.compile(r"TOOL CALL(?:\s+(\d+|Q\d+|\"[^\"]*\"))?(?:\s+([XYZ])(?!\w))?(.*)")
_WORD = re.compile(rf"\s*(DL|DR2|DR|S|F)\s*({NUMBER})")


def tool_of_spindle(reader: KlartextReader) -> ToolEntry:
    """The tool in the spindle with its oversizes."""
    return reader.controller.offsets.get(reader.controller.tool, ToolEntry())


def call_tool(reader: KlartextReader, content: str) -> None:
    """``TOOL CALL 1 Z S3500 F500 DL+0.1 DR-0.05``; without a tool new speed, feed or oversizes."""
    match = _TOOL.fullmatch(content)
    said, rest = match[1], match[3]
    if match[2] not in (None, "Z") or _WORD.sub("", rest).strip():
        raise ProgramError(
            f"cannot read '{content}'", accepted="TOOL CALL 1 Z S3500 F500 DL+0.1 DR-0.05"
        )
    words = {k: reader.parameters.number(v) for k, v in _WORD.findall(rest)}
    controller = reader.controller
    if "S" in words:
        reader.execute(f"s{number(words['S'])}")
    if "F" in words:
        reader.motion.feed = reader.motion.tool_feed = words["F"]
    if said is None:
        if words.keys() & {"DL", "DR"}:
            _apply_oversize(reader, controller.tool, words)
            reader.execute(f"g43h{controller.tool}")
        return
    named = said.startswith('"')
    tool = controller.tool_named(said[1:-1]) if named else int(reader.parameters.number(said))
    reader.execute("g40", f"t{tool}m6")
    if tool:
        _apply_oversize(reader, tool, words)
        reader.execute(f"g43h{tool}")
    else:
        reader.execute("g49")


def _apply_oversize(reader: KlartextReader, tool: int, words: dict[str, float]) -> None:
    """DL and DR of the call, for as long as the tool is in the spindle."""
    c = reader.controller
    c.check_tool(tool, word="TOOL CALL ")
    entry = c.first_offsets[tool] if tool in c.first_offsets else c.find_offset(tool, word="H")
    c.offsets[tool] = replace(
        entry,
        length_wear_mm=entry.length_wear_mm + words.get("DL", 0.0) * c.unit_mm,
        diameter_wear_mm=entry.diameter_wear_mm + 2.0 * words.get("DR", 0.0) * c.unit_mm,
    )


def tool_data(reader: KlartextReader, asked: str) -> float | None:
    """What FN 18 is told of the tools: ID20 NR1 number, ID50 NR1 length and NR2 radius."""
    match = re.match(rf"(?:SYSREAD\s+)?ID\s*(20|50)\s*NR\s*([12])\s*(?:IDX\s*({NUMBER}))?$",
                     asked.strip())  # fmt: skip
    if match is None or (match[1] == "20") != (match[3] is None) or match.group(1, 2) == (
        "20", "2"
    ):  # fmt: skip
        return None
    c = reader.controller
    if match[1] == "20":
        return float(c.tool)
    tool = int(reader.parameters.number(match[3]))
    entry = c.first_offsets.get(tool, c.offsets.get(tool, ToolEntry()))
    return (entry.length_mm if match[2] == "1" else entry.diameter_mm / 2.0) / c.unit_mm
