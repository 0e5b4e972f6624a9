"""Machine coordinates of the nose: R (program + G92) + G5x + tool offset."""

import numpy as np
import pytest

from gcode import MoveKind, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(length_mm=150.0, diameter_mm=20.0), 2: ToolEntry(105.0, 12.0)}


def moves(text, **options):
    return read_program(Source(text.encode()), tools=TOOLS, **options).moves


def test_work_and_tool_offset_add_up():
    m = moves(
        "T1 M6\nG54 G43 H1\nG0 X1 Y2 Z3\nG55 X0 Y0 Z0\nM2\n",
        work_offsets_mm={"G54": (-940, -480, -400), "g55": (10, 20, 30)},
    )
    assert m.end_mm[1:].tolist() == [[-939, -478, -247], [10, 20, 180]]
    assert m.tool_offset_mm[1].tolist() == [0, 0, 150]
    assert m.work_offset[1:].tolist() == [1, 2]


def test_positions_are_continuous():
    m = moves("G0 X1\nG92 X5\nG1 X7 F100\nG10 L2 P1 R30\nG91 G2 X2 I1\nG90\nG4 P1\nG28\nM2\n")
    assert (m.end_mm[:-1] == m.start_mm[1:]).all()


def test_rotation_turns_lines_and_arcs():
    m = moves("G10 L2 P1 X10 Y0 R90\nF100\nG0 X5 Y0\nG3 X-5 Y0 I-5 J0\nM2\n")
    assert m.end_mm[:, :2] == pytest.approx(np.array([[10, 5], [10, -5]]), abs=1e-12)
    assert m.centre_mm[1] == pytest.approx([10, 0, 0], abs=1e-12)
    assert m.sweep_rad[1] == pytest.approx(np.pi)


def test_changing_the_tool_offset_does_not_move_the_machine():
    m = moves("T1 M6\nG43 H1\nG0 X0 Y0 Z10\nG49\nG0 X5\nM2\n")
    assert m.end_mm[-1].tolist() == [5, 0, 160]


def test_tool_change_with_offset_in_one_block_does_not_move_the_machine():
    text = "G0 Z300\nT1 M6 G43\nG0 X5\nM2\n"
    assert moves(text).end_mm[-1].tolist() == [5, 0, 300]
    assert moves(text, preview=True).end_mm[-1].tolist() == [5, 0, 450]


@pytest.mark.parametrize(
    ("plane", "axis", "text"),
    [
        ("G17", (0, 0, 1), "G2 X10 Y0 Z3 I5 J0"),
        ("G18", (0, 1, 0), "G2 Z10 X0 Y3 K5 I0"),
        ("G19", (1, 0, 0), "G2 Y10 Z0 X3 J5 K0"),
    ],
)
def test_arcs_turn_about_the_normal_of_their_plane(plane, axis, text):
    m = moves(f"{plane} F100\n{text} P2\nM2\n", home_mm=(0, 0, 0))
    assert m.kind[0] == MoveKind.ARC
    assert m.axis[0].tolist() == list(axis)
    assert m.sweep_rad[0] == pytest.approx(-3.0 * np.pi)
    arm_start, arm_end = m.start_mm[0] - m.centre_mm[0], m.end_mm[0] - m.centre_mm[0]
    assert arm_start @ m.axis[0] == 0.0
    assert arm_end @ m.axis[0] == pytest.approx(3.0)
    turned = np.cos(m.sweep_rad[0]) * arm_start + np.sin(m.sweep_rad[0]) * np.cross(axis, arm_start)
    assert arm_end - 3.0 * m.axis[0] == pytest.approx(turned, abs=1e-12)


def test_full_circle_is_a_full_circle():
    m = moves("F100\nG0 X457.8 Y400\nG2 X457.8 Y400 I-7.8 J0\nG3 I-7.8 P3\nM2\n")
    assert m.sweep_rad[1:] == pytest.approx([-2.0 * np.pi, 6.0 * np.pi])


def test_every_word_is_obeyed_or_listed():
    program = read_program(Source(b"M8 M3 S100\nG0 X1\nM9\nM48\nM2\n"), tools=TOOLS)
    assert [(n.line, n.word) for n in program.notes] == [(1, "M8"), (3, "M9"), (4, "M48")]
    assert program.moves.spindle_rpm.tolist() == [100.0]


def test_block_delete():
    text = "G0 X1\n/G0 X2\nM2\n"
    assert len(moves(text)) == 2
    assert len(moves(text, block_delete=True)) == 1


def test_moves_know_their_line():
    assert moves("G0 X1\n\n(a)\nX2\nG81 X5 Z-1 R1 F10\nM2\n").line.tolist() == [1, 4, 5, 5, 5, 5]


@pytest.mark.parametrize(
    "setting",
    [
        "G10 L20 P1 X3 Y4 Z5",
        "G10 L20 P1 X3\nG10 L20 P1 Y4 Z5",
        "G10 L10 P1 X3 Y4 Z5\nG43 H1",
        "G10 L10 P1 X3\nG43 H1\nG10 L10 P1 Y4 Z5\nG43 H1",
        "G10 L11 P1 X3 Y4 Z5\nG43 H1\nG59.3",
        "G92 X3 Y4 Z5",
        "G92 X3\nG92 Y4 Z5",
    ],
)
@pytest.mark.parametrize("turn", ["R0", "R30"])
def test_where_the_tool_stands_reads_as_it_was_set(setting, turn):
    """LinuxCNC, G10 L10, L11, L20 and G92: present coordinates become the given values."""
    frames = f"G10 L2 P1 X10 Y20 Z30 {turn}\nG10 L2 P9 X-4 Y7 Z2 {turn}\n"
    m = moves(f"T1 M6\n{frames}G54 G43 H1\nG0 X50 Y60 Z70\n{setting}\nG0 X3 Y4 Z5\nM2\n")
    assert m.end_mm[-1] == pytest.approx(m.end_mm[1], abs=1e-9)
    m = moves(f"T1 M6\n{frames}G54 G43 H1\nG0 X50 Y60 Z70\n{setting}\nG0 X3.25 Y4 Z5\nM2\n")
    assert np.linalg.norm(m.end_mm[-1] - m.end_mm[1]) == pytest.approx(0.25)


@pytest.mark.parametrize("change", ["G55", "G10 L2 P1 R0", "G10 L2 P1 X1 Y2 R70", "G55 G54"])
def test_a_change_of_the_frame_leaves_the_tool_where_it_is(change):
    """What stands still is seen by a move along one axis of the frame after the change."""
    text = "G10 L2 P1 X10 Y20 R30\nG10 L2 P2 X-5 Y3 R-40\nG54 G0 X50 Y60 Z5\n"
    change = change.replace(" G5", "\nG5")
    before = moves(f"{text}M2\n").end_mm[-1]
    for word in "XYZ":
        end = moves(f"{text}{change}\nG91 G0 {word}2\nM2\n").end_mm[-1]
        assert np.linalg.norm(end - before) == pytest.approx(2.0)
        step = end - before
        absolute = moves(f"{text}{change}\nG0 {word}2\nG0 {word}4\nM2\n").end_mm
        # along the same axis of the frame, through where the tool stands
        away = np.cross(absolute[-1] - before, step)
        assert away == pytest.approx(np.zeros(3), abs=1e-9)
