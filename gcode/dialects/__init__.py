"""Controls other than RS274/NGC: recognised by their text, read as far as plain motion goes."""

from gcode.dialects.detect import DIALECTS, detect_dialect

__all__ = ["DIALECTS", "detect_dialect"]
