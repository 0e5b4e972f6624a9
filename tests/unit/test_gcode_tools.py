"""LinuxCNC tool tables."""

import pytest

from gcode import ProgramError, ToolEntry, read_tool_table
from vmach.commands.canon import canon

TABLE = """; a remark
T1 P1 D6.0 Z50.25 ; end mill
t2 p7 z-1.5 x+.5 y-2 a10 q2 d12
"""


def test_reads_offsets_and_diameters(tmp_path):
    path = tmp_path / "tool.tbl"
    path.write_text(TABLE)
    assert read_tool_table(path) == {
        1: ToolEntry(length_mm=50.25, diameter_mm=6.0),
        2: ToolEntry(-1.5, 12.0, x_mm=0.5, y_mm=-2.0, rotary_deg=(10.0, 0.0, 0.0), orientation=2),
    }


def test_inches_become_mm(tmp_path):
    path = tmp_path / "tool.tbl"
    path.write_text(TABLE)
    assert read_tool_table(path, unit_mm=25.4)[1].length_mm == 50.25 * 25.4


def test_a_file_that_is_no_text_is_no_table(tmp_path):
    path = tmp_path / "tool.tbl"
    path.write_bytes(b"\x7fELF\x02\0\0\x1b[2J\n")
    with pytest.raises(ProgramError, match="the tool table is no text: it holds zero bytes"):
        read_tool_table(path)


def test_canon_says_where_its_tools_come_from(tmp_path):
    program, table = tmp_path / "part.ngc", tmp_path / "tool.tbl"
    program.write_text("G43 H1\nM2\n")
    table.write_text("T2 P2 Z50\n")
    with pytest.raises(ProgramError, match=r"part.ngc:1: .*\(hint: .* --tools\)"):
        canon(program)
    with pytest.raises(ProgramError, match=r"accepted: tools 2 \(hint: add it to .*tool.tbl\)"):
        canon(program, tools=table)
