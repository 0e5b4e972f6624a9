"""NC programs: from text to resolved moves. Knows neither machines' errors nor stock."""

from gcode.arc_tolerance import ARC_TOLERANCES, ArcTolerance
from gcode.canon import canon_calls, canon_lines
from gcode.clock import MachineLimits
from gcode.errors import ProgramError, UnknownToolError
from gcode.items import block_items
from gcode.moves import MoveKind, Moves
from gcode.program import Note, Program, read_program
from gcode.source import Source, Word
from gcode.state import WORK_OFFSETS
from gcode.tools import ToolEntry, read_tool_table
from gcode.trace import Modes, Step

__all__ = ["ARC_TOLERANCES", "WORK_OFFSETS", "ArcTolerance", "MachineLimits", "Modes", "MoveKind",
           "Moves", "Note", "Program", "ProgramError", "Source", "Step", "ToolEntry",
           "UnknownToolError", "Word", "block_items", "canon_calls", "canon_lines", "read_program",
           "read_tool_table"]  # fmt: skip
