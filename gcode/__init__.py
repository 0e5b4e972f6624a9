"""NC programs: from text to resolved moves. Knows neither machines' errors nor stock."""

from gcode.moves import MoveKind, Moves

__all__ = ["MoveKind", "Moves"]
