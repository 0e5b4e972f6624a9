"""H and D are rows of the offset memory: geometry and wear, apart from the number of the tool."""

import numpy as np
import pytest

from gcode import OffsetEntry, ProgramError, Source, ToolEntry, read_program
from tests.small_job import write_job
from vmach.job import read_job
from vmach.path.preparation import prepare

TOOLS = {1: ToolEntry(length_mm=100.0, diameter_mm=10.0)}
OFFSETS = {
    21: OffsetEntry(diameter_mm=10.8),
    22: OffsetEntry(diameter_mm=10.0, diameter_wear_mm=-0.02),
    31: OffsetEntry(length_mm=101.0, length_wear_mm=0.25),
    1: OffsetEntry(length_wear_mm=-0.1),
}

#: a square pocket of 40 mm, entered along the wall, once with every D
CONTOUR = """G0 Z5
X0 Y-10
G1 Z-5 F200
G41 D{d} G1 X10 Y-20 F500
X20
Y20
X-20
Y-20
X10
G40 X0 Y0
"""
POCKET = "T1 M6\nG43 H1\n" + CONTOUR.format(d=21) + CONTOUR.format(d=22) + "M2\n"


def moves(text, **options):
    options = {"tools": TOOLS, "offsets": OFFSETS} | options
    return read_program(Source(text.encode()), **options).moves


def largest_x(found, lines):
    inside = np.isin(found.line, lines)
    return found.end_mm[inside, 0].max()


def test_one_tool_roughs_and_finishes_a_contour_with_two_d():
    found = moves(POCKET)
    roughing, finishing = range(7, 12), range(17, 22)
    assert largest_x(found, roughing) == pytest.approx(20.0 - 10.8 / 2, abs=1e-12)
    assert largest_x(found, finishing) == pytest.approx(20.0 - (10.0 - 0.02) / 2, abs=1e-12)
    assert set(found.tool[3:]) == {1}


@pytest.mark.parametrize(
    ("word", "length"), [("H1", 99.9), ("H31", 101.25), ("", 99.9), ("H0", 99.9)]
)
def test_h_gives_geometry_and_wear(word, length):
    found = moves(f"T1 M6\nG0 X1\nG43 {word} Z0\nM2\n")
    assert found.end_mm[-1, 2] == pytest.approx(length, abs=1e-12)


def test_a_diameter_that_no_row_gives_is_the_tools():
    found = moves("T1 M6\nG0 X0 Y0\nG41 D1 G1 X10 Y0 F9\nX20\nM2\n")
    assert found.end_mm[-1, 1] == pytest.approx(5.0, abs=1e-12)


def test_parameters_show_the_sum():
    found = moves("T1 M6\nG0 X#5403 Y#5410\nM2\n")
    assert found.end_mm[-1, :2] == pytest.approx([99.9, 10.0], abs=1e-12)


def test_written_geometry_replaces_the_sum():
    found = moves("T1 M6\nG10 L1 P1 Z120\nG43 H1\nG0 Z0\nM2\n")
    assert found.end_mm[-1, 2] == pytest.approx(120.0, abs=1e-12)


def test_a_row_is_no_tool_of_the_magazine():
    with pytest.raises(ProgramError, match=r"tool 21 is not in .*; accepted: tools 1"):
        moves("T21 M6\nM2\n")
    with pytest.raises(ProgramError, match="D5: there is neither a tool nor an offset 5"):
        moves("T1 M6\nG41 D5 G1 X10 F9\nM2\n")


def test_a_job_gives_the_memory(tmp_path):
    rows = "[offsets.21]\ndiameter_mm = 10.8\n[offsets.22]\ndiameter_wear_mm = -0.02\n"
    path = write_job(tmp_path, more=rows + "diameter_mm = 10\n")
    (tmp_path / "part.nc").write_text("G54\n" + POCKET)
    found = prepare(read_job(path)).program.moves
    for lines, diameter in ((range(8, 13), 10.8), (range(18, 23), 9.98)):
        assert largest_x(found, lines) == pytest.approx(-200 + 20 - diameter / 2, abs=1e-9)
