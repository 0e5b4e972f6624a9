"""Vocabulary of RS274/NGC: every G and M code with its modal group, its words and its meaning.

LinuxCNC 2.9, "G-Codes", "M-Codes" and "Modal Groups"; what is checked before a block is obeyed
reads this table (`gcode.control.checks`).
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["ARCS", "AXES", "CODES", "CYCLES", "PATH_CONTROL", "Code", "code_of"]

#: Axis words in the order of every position of six numbers.
AXES = "xyzabc"


@dataclass(frozen=True, slots=True)
class Code:
    """One G or M code.

    Attributes
    ----------
    name : str
        As in a program: ``G38.2``.
    group : str
        Codes of one modal group exclude each other in a block.
    text : str
        What it does.
    words : str
        Letters that it takes beside those of axes, F, S and T.
    needs : str
        Letters that must stand in its block.
    first : str
        Letters that must stand in the first block of a row of equal cycles.
    is_noted : bool
        It does not change where the tool goes: it is listed, not obeyed.
    """

    name: str
    group: str
    text: str
    words: str = ""
    needs: str = ""
    first: str = ""
    is_noted: bool = False


_TABLE = (
    Code("G4", "nonmodal", "dwell, P in seconds", "p", needs="p"),
    Code("G5.3", "nonmodal", "end of a NURBS block"),
    Code("G10", "nonmodal", "write tool table or work offsets", "ijlpqr"),
    Code("G28", "nonmodal", "go to the first reference point"),
    Code("G28.1", "nonmodal", "set the first reference point"),
    Code("G30", "nonmodal", "go to the second reference point"),
    Code("G30.1", "nonmodal", "set the second reference point"),
    Code("G52", "nonmodal", "local coordinate system"),
    Code("G53", "nonmodal", "machine coordinates"),
    Code("G92", "nonmodal", "set the coordinates of the present position"),
    Code("G0", "motion", "rapid traverse"),
    Code("G1", "motion", "straight line at feed"),
    Code("G2", "motion", "arc, clockwise", "ijkpr"),
    Code("G3", "motion", "arc, counter-clockwise", "ijkpr"),
    Code("G5", "motion", "cubic spline", "ijpq"),
    Code("G5.1", "motion", "quadratic spline", "ij"),
    Code("G5.2", "motion", "NURBS block", "lp"),
    Code("G33", "motion", "spindle-synchronised motion", "ek", needs="k"),
    Code("G33.1", "motion", "rigid tapping", "eik", needs="k"),
    Code("G38.2", "motion", "probe towards the workpiece, error if it is missed"),
    Code("G38.3", "motion", "probe towards the workpiece"),
    Code("G38.4", "motion", "probe away from the workpiece, error if contact stays"),
    Code("G38.5", "motion", "probe away from the workpiece"),
    Code("G73", "motion", "drilling with chip breaking", "dlqr", first="q"),
    Code("G74", "motion", "left-hand tapping", "pr"),
    Code("G76", "motion", "threading", "ehijklpqr", needs="pijk"),
    Code("G80", "motion", "cancel motion"),
    Code("G81", "motion", "drilling", "lr"),
    Code("G82", "motion", "drilling with dwell", "lpr", first="p"),
    Code("G83", "motion", "deep-hole drilling", "dlqr", first="q"),
    Code("G84", "motion", "right-hand tapping", "lpr"),
    Code("G85", "motion", "boring, feed out", "lr"),
    Code("G86", "motion", "boring, spindle stop, rapid out", "lpr", first="p"),
    Code("G87", "motion", "back boring", "ijklr", first="ijk"),
    Code("G88", "motion", "boring, retraction by hand", "lpr", first="p"),
    Code("G89", "motion", "boring with dwell, feed out", "lpr", first="p"),
    Code("G17", "plane", "plane XY"),
    Code("G18", "plane", "plane ZX"),
    Code("G19", "plane", "plane YZ"),
    Code("G90", "distance", "absolute positions"),
    Code("G91", "distance", "incremental positions"),
    Code("G90.1", "arc_distance", "absolute centres of arcs"),
    Code("G91.1", "arc_distance", "incremental centres of arcs"),
    Code("G93", "feed_mode", "inverse-time feed"),
    Code("G94", "feed_mode", "feed per minute"),
    Code("G95", "feed_mode", "feed per revolution"),
    Code("G20", "units", "inches"),
    Code("G21", "units", "millimetres"),
    Code("G40", "compensation", "cutter compensation off"),
    Code("G41", "compensation", "cutter compensation left", "dl"),
    Code("G41.1", "compensation", "cutter compensation left, diameter in D", "dlr"),
    Code("G42", "compensation", "cutter compensation right", "dl"),
    Code("G42.1", "compensation", "cutter compensation right, diameter in D", "dlr"),
    Code("G43", "tool_length", "tool length offset", "h"),
    Code("G43.1", "tool_length", "tool length offset by axis words"),
    Code("G43.2", "tool_length", "further tool length offset", "h"),
    Code("G49", "tool_length", "tool length offset off"),
    Code("G98", "retract", "retract to the initial level"),
    Code("G99", "retract", "retract to the R level"),
    Code("G54", "system", "work offset 1"),
    Code("G55", "system", "work offset 2"),
    Code("G56", "system", "work offset 3"),
    Code("G57", "system", "work offset 4"),
    Code("G58", "system", "work offset 5"),
    Code("G59", "system", "work offset 6"),
    Code("G59.1", "system", "work offset 7"),
    Code("G59.2", "system", "work offset 8"),
    Code("G59.3", "system", "work offset 9"),
    Code("G61", "control", "exact path"),
    Code("G61.1", "control", "exact stop"),
    Code("G64", "control", "path blending, P is the tolerance", "pq"),
    Code("G96", "spindle_mode", "constant surface speed", "d", needs="s"),
    Code("G97", "spindle_mode", "constant spindle speed"),
    Code("G7", "diameter", "lathe diameter mode"),
    Code("G8", "diameter", "lathe radius mode"),
    Code("G92.1", "g92_applied", "cancel G92 and forget it"),
    Code("G92.2", "g92_applied", "cancel G92"),
    Code("G92.3", "g92_applied", "apply G92 again"),
    Code("M0", "stop", "program stop", is_noted=True),
    Code("M1", "stop", "optional stop", is_noted=True),
    Code("M2", "stop", "program end"),
    Code("M30", "stop", "program end"),
    Code("M60", "stop", "pallet shuttle and stop", is_noted=True),
    Code("M99", "stop", "end of a subprogram"),
    Code("M62", "io", "output", "p", needs="p", is_noted=True),
    Code("M63", "io", "output", "p", needs="p", is_noted=True),
    Code("M64", "io", "output", "p", needs="p", is_noted=True),
    Code("M65", "io", "output", "p", needs="p", is_noted=True),
    Code("M66", "io", "wait for an input", "elpq"),
    Code("M67", "io", "analog output", "eq", needs="e", is_noted=True),
    Code("M68", "io", "analog output", "eq", needs="e", is_noted=True),
    Code("M6", "tool_change", "tool change"),
    Code("M61", "tool_change", "number of the tool in the spindle", "q"),
    Code("M3", "spindle", "spindle clockwise"),
    Code("M4", "spindle", "spindle counter-clockwise"),
    Code("M5", "spindle", "spindle stop"),
    Code("M19", "spindle", "spindle orientation", "pqr", is_noted=True),
    Code("M70", "spindle", "save the modal state"),
    Code("M71", "spindle", "forget the saved modal state"),
    Code("M72", "spindle", "restore the modal state"),
    Code("M73", "spindle", "save the modal state, restore it on return"),
    Code("M7", "coolant", "mist coolant", is_noted=True),
    Code("M8", "coolant", "flood coolant", is_noted=True),
    Code("M9", "coolant", "coolant off", is_noted=True),
    Code("M48", "override", "enable overrides", is_noted=True),
    Code("M49", "override", "disable overrides", is_noted=True),
    Code("M50", "override", "feed override", "p", is_noted=True),
    Code("M51", "override", "spindle override", "p", is_noted=True),
    Code("M52", "override", "adaptive feed", "p", is_noted=True),
    Code("M53", "override", "feed stop", "p", is_noted=True),
)

#: Name -> code.
CODES: dict[str, Code] = {code.name: code for code in _TABLE}

#: Letter and number times ten -> code; a G number has one decimal at most.
_BY_TENTHS = {(c.name[0], round(10 * float(c.name[1:]))): c for c in _TABLE}

ARCS = frozenset(("G2", "G3"))
#: Canned cycles of holes.
CYCLES = frozenset(("G73", "G74", *(f"G{number}" for number in range(81, 90))))
#: Path control in the record of moves, a number for each code.
PATH_CONTROL = {"G61": 61.0, "G61.1": 61.1, "G64": 64.0}


def code_of(letter: str, tenths: int) -> Code | None:
    """The code with a number that is given in tenths; None where there is none."""
    return _BY_TENTHS.get((letter, tenths))
