"""Can what a user's files say be true? Units, places, squareness and tools, asked in one room.

Every command reads its machine through `admitted_machine` and its tools through `check_tools`.
What certainly is wrong is refused there. What is doubtful is noted in the same words everywhere.
Contradictions within one statement, such as a squareness in two units that disagree, are refused
on reading (`vmach.machine.squareness`).
"""

from vmach.base.note import Kind, Level, Note
from vmach.plausibility.gate import (
    admitted_machine,
    check_tools,
    doubts,
    machine_notes,
)
from vmach.plausibility.tools import cutting_notes, doubtful_length, lengths_meant_mm, tool_notes

__all__ = [
    "Kind",
    "Level",
    "Note",
    "admitted_machine",
    "check_tools",
    "cutting_notes",
    "doubtful_length",
    "doubts",
    "lengths_meant_mm",
    "machine_notes",
    "tool_notes",
]
