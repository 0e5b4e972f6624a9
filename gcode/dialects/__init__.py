"""Controls other than RS274/NGC: recognised by their text, read as far as plain motion goes."""

from gcode.dialects.detect import DIALECTS, SYNONYMS, detect_dialect, dialect_name, dialect_of

__all__ = ["DIALECTS", "SYNONYMS", "detect_dialect", "dialect_name", "dialect_of"]
