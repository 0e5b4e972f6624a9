"""The programs of `bench_commands` in the languages of other controls, one line for most lines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

__all__ = ["CONTROLS", "written_for"]

_WORD = re.compile(r"([A-Z])([-+.\d]+)")
_DRILLING = "CYCL DEF 200 DRILLING Q200=2 Q201=-9 Q206=200 Q202=9 Q210=0 Q203=0 Q204=20 Q211=0"


def _words(line: str) -> dict[str, str]:
    return {letter: number for letter, number in _WORD.findall(line) if letter not in "GM"}


def _sinumerik(lines: Iterable[str]) -> Iterator[str]:
    """Tool, drilling and comments are said otherwise."""
    yield "G71 G17 G90 G94 G54"
    drills = False
    for line in lines:
        if line.startswith("("):
            yield f"; {line[1:-1]}"
        elif line.startswith("G43"):
            yield "D1"
        elif line.startswith("G99"):
            drills = True
            yield from ("G0 F200", "MCALL CYCLE81(20,0,2,-9)")
            yield " ".join(word for word in line.split() if word[0] in "XY")
        elif line == "G80":
            drills = False
            yield "MCALL"
        else:
            yield line.replace("M6", "D1 M6") if not drills else line
    yield "M30"


def _klartext(lines: Iterable[str]) -> Iterator[str]:
    """Every line is another; centres are places."""
    yield "BEGIN PGM PART MM"
    x = y = 0.0
    tool = drilling = ""
    for line in lines:
        words = _words(line)
        if line.startswith("("):
            yield f"; {line[1:-1]}"
            continue
        if "T" in words:
            tool = words["T"]
        elif line.startswith("S"):
            yield from (f"TOOL CALL {tool} Z {line.split()[0]}", "L M3")
        elif line.startswith("M"):
            yield line
        elif line.startswith("G80"):
            drilling = ""
        elif line[:3] not in ("G21", "G43"):
            if line.startswith("G99"):
                drilling = " FMAX M99"
                yield _DRILLING
                words = {letter: words[letter] for letter in "XY"}
            centre = x + float(words.get("I", 0)), y + float(words.get("J", 0))
            x, y = (float(words.get(a, old)) for a, old in (("X", x), ("Y", y)))
            places = "".join(f" {a}{float(words[a]):+.4f}" for a in "XYZ" if a in words)
            feed = f" F{words['F']}" if "F" in words else ""
            if line[:2] in ("G2", "G3"):
                yield f"CC X{centre[0]:+.4f} Y{centre[1]:+.4f}"
                yield f"C{places} DR{'-' if line[1] == '2' else '+'}{feed}"
            else:
                yield f"L{places}{' FMAX' if line.startswith('G0') else feed}{drilling}"
    yield "END PGM PART MM"


CONTROLS = {"sinumerik": _sinumerik, "heidenhain": _klartext}


def written_for(control: str, lines: Iterable[str]) -> list[str]:
    """Lines of RS274/NGC, without head and end, in the language of a control, numbered."""
    if control == "heidenhain":
        return [f"{number} {line}" for number, line in enumerate(_klartext(lines))]
    return list(CONTROLS[control](lines))
