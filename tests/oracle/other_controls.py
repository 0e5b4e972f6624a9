"""Klartext and Sinumerik texts as paths, read by the manuals and by nothing of the project.

Plain motion only: what the tests write. Rows are those of `linuxcnc_interpreter.Verdict`, so
that a compensated text can be compared with its original as LinuxCNC's are.
"""

import re

import numpy as np

from tests.oracle.linuxcnc_interpreter import ARC, AXES_OF_PLANE, LINE, RAPID, Verdict

__all__ = ["read_klartext", "read_sinumerik"]

#: radii at the start and the end of an arc differ by no more, mm: refused otherwise
RADII = {"heidenhain": 0.016, "sinumerik": 0.01}


class Drawing:
    """Rows that are added one by one, in machine coordinates."""

    def __init__(self, zero_mm, unit_mm=1.0):
        self.zero, self.unit, self.verdict = np.array(zero_mm, float), unit_mm, Verdict()
        self.here = np.zeros(3)  # program coordinates, program units

    def add(self, line, kind, end, *, arc=None):
        there = [self.unit * np.asarray(p) + self.zero for p in (self.here, end)]
        verdict = self.verdict
        verdict.line.append(line)
        verdict.kind.append(kind)
        verdict.start.append(there[0])
        verdict.end.append(there[1])
        verdict.arc.append(arc)
        verdict.feed.append(0.0)
        self.here = np.array(end, float)

    def add_arc(self, line, end, *, centre, axis, sense, largest, turns=1):
        """An arc about a centre, seen against the axis: sense 1 is counter-clockwise."""
        flat = [np.delete(p - centre, axis) for p in (self.here, end)]
        first, last = (np.linalg.norm(v) for v in flat)
        if self.unit * abs(first - last) > largest:
            self.verdict.refusal = f"line {line}: radii {first} and {last}"
        unit = np.eye(3)[axis]
        arc = self.unit * centre + self.zero, unit, sense * turns
        self.add(line, ARC, end, arc=arc)

    def centre_by_radius(self, end, radius, *, plane, sense):
        """Centre of the arc of a radius; a negative one turns by more than half a circle."""
        first, second, _ = AXES_OF_PLANE[plane]
        chord = np.array([end[first] - self.here[first], end[second] - self.here[second]])
        half = 0.5 * np.linalg.norm(chord)
        away = np.sqrt(max(radius**2 - half**2, 0.0)) * sense * np.sign(radius)
        left = np.array([-chord[1], chord[0]]) / (2.0 * half)
        centre = np.array(end, float)
        centre[[first, second]] = self.here[[first, second]] + 0.5 * chord + away * left
        return centre


def read_klartext(text, zero_mm):
    """L, C, CR, CC, LBL; positions with signs, I for distances."""
    lines = [re.sub(r"^\s*\d+\s+", "", s.split(";")[0]).strip() for s in text.splitlines()]
    drawing = Drawing(zero_mm, 25.4 if lines[0].endswith("INCH") else 1.0)
    pole = None
    for number in _klartext_order(lines):
        content = lines[number]
        head = content.split(" ")[0]
        if head not in ("L", "C", "CR", "CC"):
            continue
        found = re.findall(r"(I?[XYZ]|DR|(?<!D)R(?=[+-]))\s*([+-]\d*\.?\d*)", content)
        words = dict(found)
        assert len(words) == len(found), content
        place = drawing.here.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in words:
                place[axis] = float(words[letter])
            if "I" + letter in words:
                place[axis] += float(words["I" + letter])
        sense = -1 if words.get("DR") == "-" else 1
        if head == "CC":
            pole = place
        elif head == "L":
            if set("XYZ") & set("".join(words)):
                drawing.add(number + 1, RAPID if "FMAX" in content else LINE, place)
        else:
            centre = pole if head == "C" else drawing.centre_by_radius(
                place, float(words["R"]), plane=1, sense=sense)  # fmt: skip
            drawing.add_arc(number + 1, place, centre=centre, axis=2, sense=sense,
                            largest=RADII["heidenhain"])  # fmt: skip
    return drawing.verdict


def _klartext_order(lines):
    """Indices of the lines as they run: program parts that CALL LBL n REP m repeats."""
    for number, content in enumerate(lines):
        yield number
        repeated = re.match(r"CALL LBL (\d+) REP (\d+)", content)
        if repeated:
            first = lines.index(f"LBL {repeated[1]}")
            for _ in range(int(repeated[2])):
                yield from range(first, number)


def read_sinumerik(text, zero_mm):
    """G0 to G3 with G17 to G19, G70, G71, G90, G91, CR= and TURN=."""
    drawing = Drawing(zero_mm)
    motion, plane, absolute = 1, 1, True
    for number, line in enumerate(text.splitlines(), 1):
        content = re.sub(r"^\s*/?\s*N\d+", "", line.split(";")[0])
        if content.strip().startswith("%"):
            continue
        found = re.findall(r"(CR|TURN|[A-Z])\s*=?\s*([+-]?\d*\.?\d+|[+-]?\d+\.?)", content)
        codes = [float(value) for letter, value in found if letter == "G"]
        words = {letter: float(value) for letter, value in found if letter != "G"}
        for code in codes:
            motion = int(code) if code in (0, 1, 2, 3) else motion
            plane = {17: 1, 18: 3, 19: 2}.get(code, plane)
            absolute = {90: True, 91: False}.get(code, absolute)
            drawing.here *= drawing.unit
            drawing.unit = {70: 25.4, 71: 1.0}.get(code, drawing.unit)
            drawing.here /= drawing.unit
        if 4 in codes or not set("XYZIJK") & set(words):
            continue
        place = drawing.here.copy()
        for axis, letter in enumerate("XYZ"):
            if letter in words:
                place[axis] = words[letter] + (0.0 if absolute else place[axis])
        if motion < 2:
            drawing.add(number, RAPID if motion == 0 else LINE, place)
            continue
        sense = 1 if motion == 3 else -1
        if "CR" in words:
            centre = drawing.centre_by_radius(place, words["CR"], plane=plane, sense=sense)
        else:
            centre = drawing.here + [words.get(letter, 0.0) for letter in "IJK"]
        drawing.add_arc(number, place, centre=centre, axis=AXES_OF_PLANE[plane][2], sense=sense,
                        largest=RADII["sinumerik"],
                        turns=1 + int(words.get("TURN", 0)))  # fmt: skip
    return drawing.verdict
