"""LinuxCNC tool tables."""

from gcode import ToolEntry, read_tool_table

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
