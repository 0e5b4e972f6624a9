"""NC programs: from text to resolved moves. Knows neither machines' errors nor stock."""

from gcode.canon import canon_calls, canon_lines, canon_text
from gcode.errors import ProgramError, UnknownToolError
from gcode.geometry.arc_tolerance import ARC_TOLERANCES, ArcTolerance
from gcode.language.dialect import Dialect
from gcode.language.options import INCREMENT_SYSTEMS, ControlSettings
from gcode.language.registry import dialect_called, dialect_name, dialect_names, dialect_of
from gcode.moves.clock import MachineLimits
from gcode.moves.moves import MoveKind, Moves
from gcode.program import Note, Program, read_program
from gcode.state.controller import WORK_OFFSETS
from gcode.state.tools import OffsetEntry, ToolEntry, read_tool_table
from gcode.state.trace import Modes, PlainLines, Step
from gcode.text.items import block_items
from gcode.text.source import Source, Word, readable
from gcode.writing.block_text import BlockText, Labels
from gcode.writing.line_edit import AS_PROGRAMMED, SAME, UNKNOWN, BlockMotion, LineEdit
from gcode.writing.plain_blocks import PlainArc, PlainBlocks

__all__ = [
           "ARC_TOLERANCES",
           "AS_PROGRAMMED",
           "INCREMENT_SYSTEMS",
           "SAME",
           "UNKNOWN",
           "WORK_OFFSETS",
           "ArcTolerance",
           "BlockMotion",
           "BlockText",
           "ControlSettings",
           "Dialect",
           "Labels",
           "LineEdit",
           "MachineLimits",
           "Modes",
           "MoveKind",
           "Moves",
           "Note",
           "OffsetEntry",
           "PlainArc", "PlainBlocks",
           "PlainLines",
           "Program",
           "ProgramError",
           "Source",
           "Step",
           "ToolEntry",
           "UnknownToolError",
           "Word",
           "block_items",
           "canon_calls",
           "canon_lines",
           "canon_text",
           "dialect_called",
           "dialect_name",
           "dialect_names",
           "dialect_of",
           "read_program",
           "read_tool_table",
           "readable",
]  # fmt: skip
