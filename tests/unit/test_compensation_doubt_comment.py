"""Doubts in a compensated program: one comment at the end of a line, and not one word changed."""

from __future__ import annotations

import pytest

from gcode import read_program
from vmach.compensation.doubt_comment import with_doubts
from vmach.plausibility import Kind, Level, Note

DOUBTS = (
    Note(Level.DOUBT, Kind.SQUARENESS, "EC0Y", "a squareness of 300 urad"),
    Note(Level.DOUBT, Kind.DIAMETER, "tool 2", "diameter_mm = 254"),
)
SAID = "doubtful input: squareness of EC0Y, diameter of tool 2"


@pytest.mark.parametrize(
    ("text", "dialect", "line"),
    [
        ("%\nO0001 (PART)\n(MSG, START)\nG21 G90\nG0 X1\nM30\n%\n", "rs274", 4),
        ("%\r\nO0001\r\nG21 G90\r\nG0 X1\r\nM30\r\n%\r\n", "fanuc", 3),
        ("%\nO0001\nG21 G90\nG0 X1\nM30\n%\n", "haas", 3),  # a semicolon would end the block
        ("G21 G90\nG0 X1\nM30\n", "linuxcnc", 1),
        ("%_N_A_MPF\n;$PATH=/_N_MPF_DIR\nG71 G90\nMSG(\"A\")\nM30\n", "sinumerik", 3),
        ("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S100\n2 END PGM A MM\n", "heidenhain", 2),
    ],
)  # fmt: skip
def test_the_first_line_of_code_takes_the_comment(text, dialect, line):
    found = with_doubts(text.encode(), DOUBTS, dialect).decode()
    was, now = text.splitlines(), found.splitlines()
    assert [k for k in range(len(was)) if was[k] != now[k]] == [line - 1]
    mark = f" ; {SAID}" if dialect in ("sinumerik", "heidenhain") else f" ({SAID})"
    assert now[line - 1] == was[line - 1] + mark
    assert found.count("\r") == text.count("\r")


def test_nothing_is_written_where_nothing_is_doubtful_or_no_line_is_free():
    assert with_doubts(b"G21\n", (), "rs274") == b"G21\n"
    assert with_doubts(b"G21 (MSG, A)\n", DOUBTS, "rs274") == b"G21 (MSG, A)\n"


def test_the_program_is_read_as_before(tmp_path):
    text = b"G21 G90 G17\nG0 X10 Y5\nG1 Z-1 F100\nM30\n"
    moves = []
    for name, written in (("was", text), ("now", with_doubts(text, DOUBTS, "rs274"))):
        (tmp_path / name).write_bytes(written)
        moves.append(read_program(tmp_path / name).moves)
    assert moves[0].end_mm.tolist() == moves[1].end_mm.tolist()
    assert moves[0].line.tolist() == moves[1].line.tolist()
