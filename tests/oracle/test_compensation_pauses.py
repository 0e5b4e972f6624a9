"""Pauses of programs that are written out last as long as the control's manual says.

FANUC B-64484EN and Mazak: P of G4, G82 and G89 counts milliseconds. Haas 96-8210: milliseconds
without a decimal point, seconds with one. Mach3 and Centroid: seconds.
"""

import re

import pytest

from gcode import Source, ToolEntry, read_program
from vmach.errors import InputError
from vmach.program_text.expanding.expansion import expanded

HEAD = "G90 G94 G17 G21\nG54\nG0 X0. Y0. Z10.\n"
TOOLS = {1: ToolEntry(length_mm=100.0, diameter_mm=8.0)}


def pauses_s(text: str, control: str) -> list[float]:
    """Seconds of the blocks with G4, by the manuals."""
    found = re.findall(r"^G4 P([\d.]+)\s*$", text, re.MULTILINE)
    if control in ("mach", "centroid", "linuxcnc"):
        return [float(number) for number in found]
    if control == "haas":
        return [float(number) * (1.0 if "." in number else 1e-3) for number in found]
    assert all(number.isdigit() for number in found)  # a point is an alarm
    return [float(number) * 1e-3 for number in found]


def written_out(body: str, control: str) -> str:
    text = f"{HEAD}{body}M30\n"
    program = read_program(Source(text.encode()), dialect=control, tools=TOOLS)
    return expanded(program)[0].source.data.decode()


@pytest.mark.parametrize(
    ("control", "word", "seconds"),
    [
        ("fanuc", "P1000", 1.0),
        ("fanuc", "P200", 0.2),
        ("mazak", "P1500", 1.5),
        ("haas", "P1000", 1.0),
        ("haas", "P0.25", 0.25),
        ("haas", "P2.", 2.0),
        ("mach", "P0.5", 0.5),
        ("centroid", "P1", 1.0),
        ("linuxcnc", "P0.5", 0.5),
    ],
)
def test_the_pause_of_a_drilling_cycle(control, word, seconds):
    text = written_out(f"G82 X5. Y5. Z-3. R2. {word} F100.\nX10.\nG80\n", control)
    assert pauses_s(text, control) == pytest.approx([seconds, seconds])


@pytest.mark.parametrize("control", ["fanuc", "haas"])
def test_pauses_of_a_subprogram(control):
    body = "M98 P2000\nM30\nO2000\nG4 P300\nG82 X5. Y5. Z-3. R2. P500 F100.\nG80\n"
    last = "G4 P2.\nG4 P.5\nM99\n" if control == "haas" else "M99\n"
    told = [0.3, 0.5, 2.0, 0.5] if control == "haas" else [0.3, 0.5]
    assert pauses_s(written_out(body + last, control), control) == pytest.approx(told)


def test_a_pause_of_another_length_is_refused(monkeypatch):
    """Whatever writes the text: it is read again, and pauses count."""
    monkeypatch.setattr("gcode.dialects.fanuc.Fanuc.pause", lambda seconds: f"G4 P{seconds:.0f}")
    with pytest.raises(InputError, match="pause for another time"):
        written_out("G82 X5. Y5. Z-3. R2. P1000 F100.\nG80\n", "fanuc")
