"""Fanuc and Haas: words, cycles and compensation as the makers' manuals state them.

B-64484EN: FANUC 30i/31i/32i-B Operator's Manual, common to lathe and machining centre systems;
B-64484EN-2: the same for machining centres. 96-8000: Haas Mill Operator's Manual (June 1999).
"""

import math

import numpy as np
import pytest

from gcode import (
    ControlSettings,
    MoveKind,
    OffsetEntry,
    ProgramError,
    Source,
    ToolEntry,
    read_program,
)

TOOLS = {1: ToolEntry(100.0, 10.0), 2: ToolEntry(80.0, 6.0)}
LENGTH = 100.0


def read(text, dialect="fanuc", **options):
    options = {"tools": TOOLS} | options
    return read_program(Source(text.encode(), "part.nc"), dialect=dialect, **options)


def places(text, dialect="fanuc", **options):
    """Ends of the moves, X Y Z."""
    moves = read(text, dialect, **options).moves
    moved = np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9
    return np.round(moves.end_mm[moved], 6).tolist()


def last(text, dialect="fanuc", **options):
    return np.round(read(text, dialect, **options).moves.end_mm[-1], 6).tolist()


def refusal(text, dialect="fanuc", **options):
    with pytest.raises(ProgramError) as error:
        len(read(text, dialect, **options).moves)
    return str(error.value)


# G04: B-64484EN "Dwell": X in seconds, P in 0.001 s without a decimal point.
# Haas 96-8000 p. 164: P without a fraction in milliseconds, otherwise in seconds.
@pytest.mark.parametrize(
    ("word", "dialect", "seconds"),
    [("P500", "fanuc", 0.5), ("X1.5", "fanuc", 1.5), ("U2.", "fanuc", 2.0),
     ("P500", "haas", 0.5), ("P2.", "haas", 2.0), ("P0.25", "haas", 0.25)],
)  # fmt: skip
def test_dwell(word, dialect, seconds):
    moves = read(f"O1\nG0 X1.\nG4 {word}\nM30\n", dialect).moves
    assert moves.duration_s.sum() == pytest.approx(seconds)


def test_dwell_with_a_point_in_p_is_refused():
    assert "P takes no decimal point" in refusal("O1\nG4 P0.5\nM30\n")


# G10: B-64484EN-2 6.5, tool compensation memory C; 96-8000 p. 164
def test_g10_writes_the_offset_memory():
    length = "G10 L10 P1 R150.\nG10 L11 P1 R-0.5\nT1 M6\nG43 H1 Z0.\nM30\n"
    assert last("O1\nG0 X0.\n" + length)[2] == pytest.approx(149.5)
    assert last("O1\nG0 X0.\nG91 G10 L10 P1 R1.\nG90 T1 M6\nG43 H1 Z0.\nM30\n")[2] == 101.0


@pytest.mark.parametrize(("dialect", "radius"), [("fanuc", 4.0), ("haas", 2.0)])
def test_g10_l12_writes_radii_on_fanuc_and_diameters_on_haas(dialect, radius):
    text = (
        "O1\nG10 L12 P3 R4.\nT1 M6\nG0 X0. Y0.\nG41 D3 G1 X10. F100.\nX20.\nX30.\nG40 X40.\nM30\n"
    )
    assert places(text, dialect)[1][1] == pytest.approx(radius)


# B-64484EN 7.2 "Changing workpiece coordinate system": P0 external offset, G91 adds
def test_g10_l2_p0_shifts_all_systems():
    offsets = {"G54": (10, 0, 0), "G55": (20, 0, 0)}
    text = "O1\nG10 L2 P0 X5.\n{} G0 X0. Y0.\nM30\n"
    assert last(text.format("G54"), work_offsets_mm=offsets)[0] == 15.0
    assert last(text.format("G55"), work_offsets_mm=offsets)[0] == 25.0


def test_g10_in_g91_adds():
    text = "O1\nG91 G10 L2 P1 X5.\nG90 G54 G0 X0. Y0.\nM30\n"
    assert last(text, work_offsets_mm={"G54": (10, 0, 0)})[0] == 15.0


# B-64484EN-2 6.1: the offset of H0 is zero; G49 and H0 cancel
def test_h0_is_no_offset():
    assert last("O1\nT1 M6\nG0 X0.\nG43 H1 Z0.\nG43 H0 Z0.\nM30\n")[2] == 0.0
    assert last("O1\nT1 M6\nG0 X0.\nG43 H0 Z7.\nM30\n")[2] == 7.0
    assert last("O1\nT1 M6\nG0 X0.\nG43 H1 Z0.\nH2 Z0.\nM30\n")[2] == 80.0
    assert last("O1\nT1 M6\nG0 X0.\nG44 H1 Z0.\nM30\n")[2] == -LENGTH
    assert last("O1\nT1 M6\nG0 X0. Z0.\nG91 G43 H1 Z-10.\nM30\n")[2] == LENGTH - 10.0


# B-64484EN 16.5.1: argument specification II
def test_arguments_of_specification_two():
    text = "O1\nG65 P2 A1. I1. J2. K3. I4. J5.\nM30\nO2\nG0 X#4 Y#5 Z#6\nX#7 Y#8\nX#1\nM99\n"
    found = places(text, home_mm=(0, 0, 0))
    assert found == [[1, 2, 3], [4, 5, 3], [1, 5, 3]]


def test_the_later_of_two_arguments_counts():
    text = "O1\nG65 P2 I-3. I4. D5.\nM30\nO2\nG0 X#4 Y#7\nM99\n"
    assert last(text)[:2] == [-3.0, 5.0]


# B-64484EN 16.4: GOTO searches forward first
def test_goto_searches_forward():
    text = "O1\nN10 G0 X1.\nGOTO 10\nX9.\nN10 Y2.\nM30\n"
    assert last(text) == [1.0, 2.0, 0.0]


# B-64484EN 16.1: <null> is zero in a formula, and no word at all in a block
def test_null():
    assert last("O1\nG0 X5. Y#1\n#2=#1+3\nZ#2\nM30\n") == [5.0, 0.0, 3.0]
    assert last("O1\nIF[#1EQ#0]THEN #2=7.\nIF[#1EQ0]THEN #2=1.\nG0 X#2\nM30\n")[0] == 7.0
    assert last("O1\n#1=FIX[-1.5]\n#2=FUP[-1.2]\n#3=ATAN[-1.]/[-1.]\nG0 X#1 Y#2 Z#3\nM30\n") == [
        -1.0, -2.0, 225.0]  # fmt: skip


# B-64484EN 8.4 "Decimal point programming"
@pytest.mark.parametrize(
    ("increment", "x"), [("IS-B", 10.0), ("IS-C", 1.0), ("calculator", 10000.0), (None, 10000.0)]
)
def test_numbers_without_a_point(increment, x):
    program = read("O1\nG0 X10000 Y1.\nM30\n", control=ControlSettings(increment=increment))
    assert program.moves.end_mm[-1, 0] == pytest.approx(x)
    assert any("decimal point" in note.meaning for note in program.notes) == (increment is None)


def test_inches_and_angles_without_a_point():
    control = ControlSettings(increment="IS-B")
    moves = read("O1\nG20\nG0 X10000 A90000\nM30\n", control=control).moves
    assert moves.end_mm[-1, 0] == pytest.approx(25.4)
    assert moves.rotary_end_deg[-1, 0] == pytest.approx(90.0)


# B-64113EN 11.12: R of G68 has 0.001 degree, in inches too; the same for the angle of G16.
# B-64484EN-2 "Polar coordinate command".
@pytest.mark.parametrize("turned", ["G68 X0 Y0 R45000\nG1 X10000 F10.", "G16 G1 X10000 Y45000 F10.",
                                    "G16\nG1 X10000 Y45000 F10."])  # fmt: skip
@pytest.mark.parametrize(("unit", "radius_mm"), [("G21", 10.0), ("G20", 25.4)])
def test_angles_in_the_plane_have_no_increment_of_lengths(turned, unit, radius_mm):
    control = ControlSettings(increment="IS-B")
    end = last(f"O1\n{unit} G17 G90 G0 X0 Y0\n{turned}\nM30\n", control=control)
    assert end == pytest.approx([radius_mm * math.sqrt(0.5)] * 2 + [0.0], abs=1e-6)


# B-63324EN, "Relationship with three-dimensional coordinate conversion"
def test_a_rotation_about_an_axis_in_space_is_refused():
    said = refusal("O1\nG0 X0\nG68 X0 Y0 Z0 I0 J1. K0 R30.\nG1 X9. F9.\nM30\n")
    assert "part.nc:3: G68 with I J K" in said


def test_unit_of_the_block_is_that_of_its_numbers():
    text = "O1\nG21 G0 X0\nG20 X10000\nM30\n"
    assert last(text, control=ControlSettings(increment="IS-B"))[0] == pytest.approx(25.4)


# B-64484EN 2.3: the least input increment of IS-B is 0.0001 inch and 0.001 degree
@pytest.mark.parametrize(
    ("text", "x_inch", "y_inch"),
    [
        ("G0 X10000 Y20000", 1.0, 2.0),
        ("G0 X0 Y0\nG3 X20000 Y0 R10000 F100.", 2.0, 0.0),
        ("G68 X0 Y0 R90000\nG0 X10000 Y0", 0.0, 1.0),
        ("G16\nG0 X10000 Y90000", 0.0, 1.0),
        ("G16\nG52 X10000 Y20000\nG15\nG0 X0 Y0", 1.0, 2.0),
    ],
)
def test_lengths_in_inches_and_angles_have_increments_of_their_own(text, x_inch, y_inch):
    control = ControlSettings(increment="IS-B")
    found = read(f"O1\nG20 G17 G90\n{text}\nM30\n", control=control).moves
    assert found.end_mm[-1, :2] == pytest.approx([25.4 * x_inch, 25.4 * y_inch], abs=1e-9)
    if found.sweep_rad[-1]:
        assert found.sweep_rad[-1] == pytest.approx(np.pi)  # about the middle, one inch away


# "Command value range of the dwell time (command by X)": IS-B 0.001 s, IS-C 0.0001 s, with any
# unit of length (Siemens, SINUMERIK ISO Milling, 04.07, table 3-7; FANUC B-64484EN)
@pytest.mark.parametrize(("increment", "seconds"), [("IS-B", 2.5), ("IS-C", 0.25)])
@pytest.mark.parametrize("unit", ["G20", "G21"])
@pytest.mark.parametrize("word", ["X2500", "U2500"])
def test_dwell_without_a_point(increment, seconds, unit, word):
    control = ControlSettings(increment=increment)
    moves = read(f"O1\n{unit} G0 X1.\nG4 {word}\nM30\n", control=control).moves
    assert moves.duration_s.sum() == pytest.approx(seconds)


# B-63324EN, section 4.16: Q of G5.1 is a mode
@pytest.mark.parametrize("increment", ["IS-B", None])
def test_mode_of_look_ahead_is_no_length(increment):
    program = read(
        "O1\nG5.1 Q2 X0 Y0 Z0\nG0 X1.\nM30\n", control=ControlSettings(increment=increment)
    )
    assert program.moves.end_mm[-1, 0] == 1.0
    assert not any(note.word == "increment" for note in program.notes)


# B-64484EN "Direct drawing dimension programming": ,A is the angle of a line, no radius
def test_angle_of_a_line_is_no_corner():
    assert ",A (the angle of a line)" in refusal("O1\nG1 X20. ,A3. F99.\nY20.\nM30\n")


# B-64484EN-2 "Canned cycle": K is the number of repeats
@pytest.mark.parametrize("fast", [False, True])
@pytest.mark.parametrize("increment", ["IS-B", None])
def test_repetitions_of_a_cycle_are_no_length(increment, fast):
    text = "O1\nG21 G90 G0 X0. Y0. Z50.\nG91 G99 G81 X10. Z-5. R-48. F100 K3\nX1. K2\nG80\nM30\n"
    program = read(text, control=ControlSettings(increment=increment), fast=fast)
    bottoms = program.moves.end_mm[program.moves.end_mm[:, 2] < 0.0]
    assert bottoms[:, 0].tolist() == pytest.approx([10.0, 20.0, 30.0, 31.0, 32.0])
    assert not any(note.word == "increment" for note in program.notes)


# B-63684EN 16.7.1: "The units used for argument data passed without a decimal point correspond
# to the least input increment of each address"; M is #13, whatever its value
@pytest.mark.parametrize(
    ("increment", "arguments", "end"),
    [("IS-B", "X10000 Y-2. D3", [10.0, -2.0, 3.0]), ("IS-B", "X1. Y.5 D2.", [1.0, 0.5, 2.0]),
     ("IS-C", "I10000 I20000 D3", [0.0, 0.0, 3.0]), (None, "X10 Y-2. D3", [10.0, -2.0, 3.0])],
)  # fmt: skip
def test_arguments_without_a_point(increment, arguments, end):
    text = f"O1\nG65 P2 {arguments}\nM30\nO2\nG0 X#24 Y#25 Z#7\nM99\n"
    assert last(text, control=ControlSettings(increment=increment)) == pytest.approx(end)


@pytest.mark.parametrize("call", ["G65 P2 M7. Y3.", "G65 P2 Y3. M7", "G66 P2 M7. Y3.\nG0 X1."])
def test_m_of_a_macro_call_is_an_argument(call):
    assert last(f"O1\n{call}\nM30\nO2\nG0 X#13 Y#25\nM99\n") == [7.0, 3.0, 0.0]


def test_fraction_in_m_of_a_macro_call():
    """Renishaw's cycles take a tolerance in M."""
    assert last("O1\nG65 P2 D50. M.2\nM30\nO2\nG0 X#13 Y#7\nM99\n") == [0.2, 50.0, 0.0]
    assert "M code beside a macro call" in refusal("O1\nM8 G65 P2\nM30\nO2\nM99\n")
    assert refusal("O1\nG65 P2 M77.\nM88\nM30\nO2\nM99\n").count("M77") == 0


# B-64484EN-2 6.7: start-up type A, cancel, corners
POCKET = """O1
T1 M6
G0 X0. Y0.
G41 D1 G1 X20. Y{lead} F500.
G3 I-20.
G40 G1 X0. Y0.
M30
"""


@pytest.mark.parametrize("lead", [0.0, -8.0])
def test_the_whole_circle_of_a_pocket_is_cut(lead):
    """The first line ends square beside the arc's start; all 360 degrees follow at R - r."""
    text = POCKET.format(lead="0.") if lead == 0 else POCKET.format(lead=f"{lead}").replace(
        "G3 I-20.", "Y0.\nG3 I-20.")  # fmt: skip
    moves = read(text, offsets={1: OffsetEntry(diameter_mm=10.0)}).moves
    arc = np.flatnonzero(np.abs(moves.sweep_rad) > 1.0)
    assert len(arc) == 1
    assert abs(moves.sweep_rad[arc[0]]) == pytest.approx(2 * math.pi)
    radius = np.linalg.norm(moves.start_mm[arc[0], :2] - moves.centre_mm[arc[0], :2])
    assert radius == pytest.approx(15.0)
    assert moves.start_mm[arc[0], :2] == pytest.approx([15.0, 0.0], abs=1e-9)
    assert moves.end_mm[-1] == pytest.approx(moves.end_mm[arc[0]] * 0)


def test_start_up_with_a_plunge_between():
    text = "O1\nT1 M6\nG0 X0. Y0. Z5.\nG41 D1 X20. Y-10.\nG1 Z-5. F100.\nY10.\nG40 X0.\nM30\n"
    assert places(text, home_mm=(0, 0, 0))[1:] == [
        [15.0, -10.0, 5.0], [15.0, -10.0, -5.0], [15.0, 10.0, -5.0], [0.0, 10.0, -5.0]]  # fmt: skip


def test_outer_corners_go_on_straight():
    """To the intersection at 90 degrees; by the radius at an acute corner."""
    square = "O1\nT1 M6\nG0 X-20. Y-5.\nG42 D1 G1 X0. F100.\nX20.\nY20.\nX0.\nG40 Y40.\nM30\n"
    found = places(square)
    assert [25.0, -10.0, 0.0] in found  # (20, -5) with both offsets of 5
    acute = "O1\nT1 M6\nG0 X-20. Y0.\nG42 D1 G1 X0. F100.\nX20.\nX0. Y1.\nX-9.\nG40 Y40.\nM30\n"
    assert [25.0, -5.0, 0.0] in places(acute)


def test_compensation_does_not_begin_with_an_arc():
    assert "begins with an arc" in refusal("O1\nT1 M6\nG0 X0.\nG41 D1 G2 X9. I4. F9.\nM30\n")


# B-64484EN-2 5.1: canned cycles
def test_a_cycle_returns_to_the_initial_level_after_power_on():
    text = "O1\nG0 X0. Y0. Z20.\nG81 X5. Z-3. R2. F100.\nX9.\nG99 X12.\nG80\nM30\n"
    assert places(text) == [
        [5, 0, 20], [5, 0, 2], [5, 0, -3], [5, 0, 20],
        [9, 0, 20], [9, 0, 2], [9, 0, -3], [9, 0, 20],
        [12, 0, 20], [12, 0, 2], [12, 0, -3], [12, 0, 2]]  # fmt: skip


def test_another_depth_or_another_r_by_itself_makes_a_hole_where_the_tool_stands():
    text = "O1\nG0 X0. Y0. Z20.\nG81 X5. Z-3. R2. F100.\nZ-4.\nR1.\nF50.\nG80\nM30\n"
    assert places(text) == [
        [5, 0, 20], [5, 0, 2], [5, 0, -3], [5, 0, 20],
        [5, 0, 2], [5, 0, -4], [5, 0, 20],
        [5, 0, 1], [5, 0, -4], [5, 0, 20]]  # fmt: skip


def test_k_repeats_in_g91():
    text = "O1\nG0 X0. Y0. Z5.\nG91 G99 G81 X10. R-3. Z-4. K3 F100.\nG80\nM30\n"
    bottoms = [p for p in places(text) if p[2] == -2.0]
    assert bottoms == [[10, 0, -2], [20, 0, -2], [30, 0, -2]]


def test_cycle_dwell_is_in_milliseconds_and_k0_stores_only():
    moves = read("O1\nG0 X0. Z5.\nG82 Z-1. R1. P1500 K0 F100.\nX5.\nG80\nM30\n").moves
    assert moves.duration_s[moves.kind == 3].sum() == pytest.approx(1.5)
    assert sorted({x for x, _, z in moves.end_mm.tolist() if z == -1.0}) == [5.0]


def test_pecks_retract_to_r_and_go_back_above_the_last_depth():
    text = "O1\nG0 X0. Y0. Z5.\nG99 G83 Z-5. R0. Q2. F100.\nG80\nM30\n"
    levels = [p[2] for p in places(text, "haas")]
    assert levels[-8:] == [-2.0, 0.0, -0.73, -4.0, 0.0, -2.73, -5.0, 0.0]


# B-64484EN 4.8, B-64484EN-2 5.7 to 5.9: rotation, scaling, mirror image, polar coordinates
def test_rotation_scaling_and_mirror():
    rotated = "O1\nG0 X0. Y0.\nG68 X10. Y0. R90.\nX20. Y0.\nG69\nX0. Y0.\nM30\n"
    assert places(rotated) == [[10, 10, 0], [0, 0, 0]]
    scaled = "O1\nG0 X0. Y0.\nG51 X10. Y10. P2.\nX20. Y10.\nG50\nM30\n"
    assert places(scaled) == [[30, 10, 0]]
    mirrored = "O1\nG0 X0. Y0.\nG51.1 X10.\nG1 X15. Y0. F9.\nG3 X20. Y5. J5.\nG50.1 X0.\nM30\n"
    moves = read(mirrored).moves
    assert moves.end_mm[-1] == pytest.approx([0.0, 5.0, 0.0])
    assert moves.sweep_rad[-1] < 0.0  # G3 becomes clockwise


def test_a_rotated_arc_is_the_arc_rotated():
    body = "G0 X10. Y0.\nG1 X20. F100.\nG3 X30. Y10. I0. J10.\nG91 G1 X5.\nG90\n"
    plain = read(f"O1\n{body}M30\n").moves.end_mm
    turned = read(f"O1\nG68 X0. Y0. R30.\n{body}G69\nM30\n").moves.end_mm
    angle = math.radians(30.0)
    matrix = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    assert np.abs(plain[:, :2] @ matrix.T - turned[:, :2]).max() < 1e-9


def test_polar_coordinates():
    text = "O1\nG0 X0. Y0.\nG17 G90 G16\nG81 X100. Y30. Z-20. R-5. F200.\nY150.\nG15 G80\nM30\n"
    bottoms = [p for p in places(text) if p[2] == -20.0]
    expected = [[100 * math.cos(math.radians(a)), 100 * math.sin(math.radians(a)), -20]
                for a in (30, 150)]  # fmt: skip
    assert np.abs(np.array(bottoms) - expected).max() < 1e-5


# B-64484EN 13.3, 96-8000: subprograms
@pytest.mark.parametrize(
    "call", ["M98 P2 L3", "M98 P30002", "M98 P2\nM98 P2\nM98 P2", "M97 P7 L3", "G65 P2 L3"]
)
def test_subprograms_in_every_form(call):
    text = f"O1\nG0 X0.\n{call}\nG90\nM30\nN7 G91 X2.\nM99\nO2\nG91 X2.\nM99\n"
    assert last(text)[0] == pytest.approx(6.0)


def test_modal_macro_call_follows_every_move():
    macro = "O2\nG1 Z#26 F100.\nG0 Z5.\nM99\n"
    text = f"O1\nG0 X0. Z5.\nG66 P2 Z-3.\nX10.\nX20.\nG67\nX30.\nM30\n{macro}"
    assert [p for p in places(text) if p[2] == -3.0] == [[10, 0, -3], [20, 0, -3]]


def test_block_skip_with_switches():
    text = "O1\nG0 X1.\n/X2.\n/2 X3.\nM30\n"
    assert last(text)[0] == 3.0
    assert last(text, control=ControlSettings(block_delete=True))[0] == 1.0
    assert last(text, control=ControlSettings(block_delete=frozenset({2})))[0] == 2.0


# G28 beside G0; G53 stays rapid and leaves the modal motion
def test_reference_point_and_machine_position():
    offsets = {"G54": (10, 20, 30)}
    assert last("O1\nG0 X5. Y5. Z5.\nG91 G0 G28 Z0.\nM30\n", work_offsets_mm=offsets) == [15, 25, 0]
    found = read("O1\nG1 X1. F100.\nG53 Z-5.\nX2.\nM30\n", work_offsets_mm=offsets).moves
    assert found.kind.tolist() == [1, 0, 1]
    assert found.end_mm[-1].tolist() == [12.0, 0.0, -5.0]


# B-64484EN-2 5.6: optional chamfer and corner R
def test_corner_r_and_chamfer():
    rounded = "O1\nG1 X0. Y0. F100.\nX20. ,R5.\nY20.\nM30\n"
    assert places(rounded) == [[15, 0, 0], [20, 5, 0], [20, 20, 0]]
    chamfered = "O1\nG1 X0. Y0. F100.\nX20. ,C5.\nY20.\nM30\n"
    assert places(chamfered) == [[15, 0, 0], [20, 5, 0], [20, 20, 0]]


@pytest.mark.parametrize("corner", [",C5.", ",R5."])
def test_the_feed_of_a_block_with_a_corner_holds_from_there_on(corner):
    moves = read(f"O1\nG1 X10. F600.\nX30. {corner} F1200.\nY20.\nM30\n").moves
    assert moves.feed_mm_per_min.tolist() == [600.0, 1200.0, 1200.0, 1200.0]


def test_further_work_offsets():
    offsets = {"G54": (1, 0, 0), "G54.1 P7": (70, 0, 0)}
    assert last("O1\nG54.1 P7 G0 X0.\nM30\n", work_offsets_mm=offsets)[0] == 70.0
    assert last("O1\nG154 P7 G0 X0.\nM30\n", "haas", work_offsets_mm=offsets)[0] == 70.0


def test_system_variables():
    text = "O1\nG0 X3. Y4.\n#1=#5041\n#2=#5221\n#3=#11001\nG0 X[#1+#2] Y#3\nM30\n"
    assert last(text, work_offsets_mm={"G54": (10, 0, 0)})[:2] == [10.0 + 13.0, 100.0]
    assert "raises alarm 1" in refusal("O1\n#3000=1(STOP)\nM30\n")


def test_builders_m_codes_are_refused_once_together():
    text = "O1\nM131\nG0 X1.\nM201\nM131\nM30\n"
    assert "M131 M201; accepted: ignore_m = [131, 201]" in refusal(text)
    program = read(text, control=ControlSettings(ignore_m=frozenset({131, 201})))
    assert {note.word for note in program.notes} >= {"M131", "M201"}
    assert read("O1\nM31\nG0 X1.\nM33\nM30\n", "haas").notes[0].meaning == "chip conveyor forward"


@pytest.mark.parametrize(
    "text", ["O1\nG50 S2000\nG96 S200 M3\nT0101\nG0 X50. Z2.\nG1 Z-20. F0.2\nM30\n",
             "%\nT0202\nG0 X50. Z2.\nG1 U-2. W-1. F0.2\nG28 U0. W0.\nM30\n%\n"]
)  # fmt: skip
@pytest.mark.parametrize("dialect", ["auto", "fanuc", "haas"])
def test_turning_programs_are_refused(text, dialect):
    assert "a turning program" in refusal(text, dialect)


@pytest.mark.parametrize("code", ["G43.4 H1", "G68.2 X0. Y0.", "G12.1"])
def test_what_turns_is_refused(code):
    assert "is not read" in refusal(f"O1\n{code}\nM30\n")


def test_compiled_reading_is_the_same_to_the_bit():
    line = "G1 X{0:.3f} Y-{0:.2f} F{1}.\nZ-{1}.5\nG0 Z5.\n"
    plain = "".join(line.format(k * 0.37, 300 + k) for k in range(40))
    text = (f"O1\nT1 M6\nG43 H1 Z50.\nS900 M3\n{plain}G68 X0. Y0. R30.\n{plain}G69\n{plain}"
            f"G81 X1. Y2. Z-3. R2. F90.\n{plain}G41 D1 G1 X90. F99.\nY90.\nG40 X0.\n{plain}"
            f"M98 P7\n{plain}M30\nO7\n{plain}G91\n{plain}G90\nM99\n")  # fmt: skip
    fast, slow = (read(text, fast=flag).moves for flag in (True, False))
    for name in ("kind", "line", "end_mm", "feed_mm_per_min", "duration_s", "tool"):
        assert np.array_equal(getattr(fast, name), getattr(slow, name)), name


# "Cancel" codes of one block: B-64484EN-2, modal groups 01 and 09 are apart
@pytest.mark.parametrize("block", ["G80 G00 Z5. M09", "G00 G80 Z5.", "G80 Z5."])
def test_end_of_a_cycle_with_a_motion(block):
    assert last(f"O1\nG0 X1. Z9.\nG81 Z-2. R1. F100.\n{block}\nM30\n")[2] == 5.0


def test_a_program_number_on_the_leader_of_the_tape():
    assert last("%O1200(BOLT)\nG0 X7.\nM30\n%\n")[0] == 7.0
    assert "FAGOR" in refusal("%00213\nG0 X7.\nM30\n")


def test_output_to_a_device_moves_nothing():
    assert last("O1\nPOPEN\nG0 X7.\nDPRNT[X#5041[53]]\nPCLOS\nM30\n")[0] == 7.0


def test_haas_g28_without_axes_moves_all():
    text = "O1\nG0 X7. Y8. Z9.\nG91 G28\nM30\n"
    assert last(text, "haas") == [0.0, 0.0, 0.0]
    assert "without axes" in refusal(text)


def test_a_program_without_a_unit_says_so():
    said = {note.word for note in read("O1\nG0 X7.\nM30\n").notes}
    assert "units" in said
    assert "units" not in {note.word for note in read("O1\nG21 G0 X7.\nM30\n").notes}


#: B-64484EN-2, "Tool movement in start-up" and "in offset mode cancel": from (-30, 0) to a contour
#: that turns away from the tool by 45 and by 120 degrees; the tool's radius is 5, on the left
CONTOUR = "G0 X-30. Y0.\nG1 G41 D1 X0. Y0. F100.\nX{x} Y{y}\nG40 X{u} Y{v}"


def _path(body, **options):
    text = f"O1\nG21 G90 G54\n{body}\nM30\n"
    return read_program(Source(text.encode(), "part"), dialect="fanuc",
                        tools={1: ToolEntry(0.0, 10.0)}, work_offsets_mm={"G54": (0, 0, 0)},
                        control=ControlSettings(options=options)).moves  # fmt: skip


@pytest.mark.parametrize("turn_deg", [45.0, 120.0])
def test_type_b_goes_round_outer_corners_at_start_and_end(turn_deg):
    turn = math.radians(turn_deg)
    along = np.array([math.cos(turn), -math.sin(turn)])  # to the right, away from the tool
    normal = np.array([-along[1], along[0]])
    end = 40.0 * along
    last = np.array([math.cos(2 * turn), -math.sin(2 * turn)])
    out = end + 30.0 * last
    body = CONTOUR.format(x=end[0], y=end[1], u=out[0], v=out[1])
    found = {kind: _path(body, start_up=kind).end_mm[1:, :2] for kind in "AB"}
    assert found["A"] == pytest.approx(np.array([5 * normal, end + 5 * normal, out]))
    reach = 5.0 * min(math.tan(turn / 2.0), 1.0) if turn_deg > 90 else 5.0 * math.tan(turn / 2.0)
    first = np.array([reach, 5.0])  # on the line beside the first move
    second = 5 * normal - reach * along
    after, normal_last = end + 5 * normal + reach * along, np.array([-last[1], last[0]])
    before = end + 5 * normal_last - reach * last
    wanted = [first, second, after, before, out] if turn_deg > 90 else [first, after, out]
    assert found["B"] == pytest.approx(np.array(wanted))


def test_type_b_is_square_at_inner_corners():
    body = CONTOUR.format(x=20.0, y=20.0, u=0.0, v=40.0)
    assert _path(body, start_up="B").end_mm == pytest.approx(_path(body, start_up="A").end_mm)


def test_a_program_that_ends_behind_g40_ends_square():
    body = "G0 X-30. Y0.\nG1 G41 D1 X0. Y0. F100.\nX20. Y-20.\nG40"
    for more in ("", "\nG0 Z5.", "\nG28 Z0."):
        a, b = (_path(body + more, start_up=kind) for kind in "AB")
        assert b.end_mm[-1] == pytest.approx(a.end_mm[-1])


def test_outer_corners_may_be_arcs():
    body = "G0 X-30. Y0.\nG1 G41 D1 X0. Y0. F100.\nX20.\nY-20.\nG40 X50."
    assert (_path(body, outer_corners="arcs").kind == MoveKind.ARC).sum() == 1
    assert (_path(body).kind == MoveKind.ARC).sum() == 0


def test_options_of_another_control_are_refused():
    with pytest.raises(ProgramError, match="options: start_up = 'C'; accepted: A, B"):
        _path("G0 X1.", start_up="C")
    with pytest.raises(ProgramError, match="options: corners; accepted: start_up, outer_corners"):
        _path("G0 X1.", corners="C")
