"""Klartext as HEIDENHAIN's manuals state it, computed by hand.

TNC 640 User's Manuals for Klartext Programming and for Cycle Programming: Q parameters, contour
functions, radius compensation, cycles 200, 201, 206, 240, label calls.
"""

import numpy as np
import pytest

from gcode import ControlSettings, ProgramError, Source, ToolEntry, read_program
from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate
from vmach.errors import InputError

TOOLS = {1: ToolEntry(100.0, 10.0)}


def read(body, **options):
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\n{body}\nEND PGM A MM\n"
    return read_program(Source(text.encode(), "part.h"), tools=TOOLS, **options)


def places(body, **options):
    """Ends of the moves of the tip, X Y Z."""
    moves = read(body, **options).moves
    moved = np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9
    return np.round(moves.end_mm[moved] - [0, 0, 100], 6).tolist()


# figures of the manual's examples of FN 0 to FN 8 and FN 13
@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("FN 0: Q5 = +60", 60), ("FN 1: Q5 = -Q2 + -5", -9), ("FN 2: Q5 = +10 - +5", 5),
        ("FN 3: Q5 = +3 * +3", 9), ("FN 4: Q5 = +4 DIV +Q2", 1), ("FN 5: Q5 = SQRT 4", 2),
        ("FN 6: Q5 = SIN 30", 0.5), ("FN 7: Q5 = COS +60", 0.5), ("FN 8: Q5 = +5 LEN +12", 13),
        ("FN 13: Q5 = +25 ANG +25", 45), ("Q5 = SIN 30 + 2 * Q2 ^ 2", 32.5),
        ("Q5 = ( Q2 + 1 ) * 3", 15), ("Q5 = INT 3.7", 3), ("Q5 = NEG Q2", -4), ("Q5 = 2,5", 2.5),
    ],
)  # fmt: skip
def test_functions_of_q_parameters(line, value):
    assert places(f"Q2 = 4\n{line}\nL X+Q5 R0 FMAX\nL X-999 FMAX")[0][0] == pytest.approx(-999)
    found = read(f"Q2 = 4\n{line}\nL X+Q5 R0 FMAX").moves.end_mm[-1, 0]
    assert found == pytest.approx(value)


def test_branches_and_labels_with_names():
    body = ("Q1 = 0\nLBL \"NEXT\"\nQ1 = Q1 + 1\nL X+Q1 R0 FMAX\n"
            "FN 12: IF +Q1 LT +3 GOTO LBL \"NEXT\"\nL Y+7 FMAX")  # fmt: skip
    assert [p[:2] for p in places(body)] == [[2, 0], [3, 0], [3, 7]]


def test_polar_coordinates_helix_and_tangent():
    body = ("L X+20 Y+0 R0 FMAX\nCC X+0 Y+0\nLP PR+20 PA+90 F100\nLP IPA+90 F100\n"
            "CP IPA-720 IZ-4 DR-\n")  # fmt: skip
    moves = read(body).moves
    assert moves.end_mm[-1] == pytest.approx([-20, 0, -4], abs=1e-9)
    assert moves.sweep_rad[-1] == pytest.approx(-4 * np.pi)
    tangent = read("L X+0 Y+0 R0 FMAX\nL X+10 F100\nCT X+20 Y+10\nL Y+20").moves
    assert tangent.centre_mm[-2, :2] == pytest.approx([10, 10])


def test_circles_in_the_planes_of_z():
    """DR+ turns from Z to X and from Y to Z; polar angles count from +Z and +Y."""
    body = "L X+20 Z+0 F100\nCC X+0 Z+0\nC X+0 Z+20 DR-\n"  # a quarter from +X to +Z
    moves = read(body).moves
    assert moves.end_mm[-1] == pytest.approx([0, 0, 120], abs=1e-9)
    assert abs(moves.sweep_rad[-1]) == pytest.approx(np.pi / 2)
    polar = read(body + "LP PR+10 PA+90\nCP IPA+180 IY+3 DR+\nL Y+5 Z+0\nCC Y+0 Z+0\n"
                 "LP PR+5 PA+0\nCP PA+90 DR+").moves.end_mm  # fmt: skip
    wanted = [[10, 0, 0], [-10, 3, 0], [-10, 5, 0], [-10, 5, 0], [-10, 0, 5]]
    assert polar[-5:] - [0, 0, 100] == pytest.approx(np.array(wanted, float), abs=1e-9)


def test_a_slash_before_the_number_of_the_block():
    said = "L X+1 F100\n/7 L X+2\n8 / L X+3\nL Y+4"
    assert places(said)[-1][:2] == [3, 4]
    skipping = places(said, control=ControlSettings(block_delete=True))
    assert skipping[-1][:2] == [1, 4]


def test_rounding_and_chamfer():
    body = "L X+0 Y+0 R0 FMAX\nL X+20 F100\nRND R5\nL Y+20\nCHF 2\nL X+0"
    assert [p[:2] for p in places(body)] == [[15, 0], [20, 5], [20, 18], [18, 20], [0, 20]]


def test_radius_compensation_is_square_at_its_ends_and_round_outside():
    body = ("L X-30 Y+0 R0 FMAX\nL X+0 Y+0 RL F200\nL Y+40\nL X+40\nL Y-20\n"
            "L X-60 R0\n")  # fmt: skip
    moves = read(body).moves
    ends = np.round(moves.end_mm[:, :2], 6).tolist()
    assert ends[2:] == [[-5, 0], [-5, 40], [0, 45], [40, 45], [45, 40], [45, -20], [-60, -20]]
    assert moves.kind[moves.sweep_rad != 0].tolist() == [2, 2]


def test_oversize_of_the_call_widens_the_path():
    body = "TOOL CALL 1 Z DL+0.5 DR+0.2\nL X-30 Y+0 R0 FMAX\nL X+0 RL F200\nL Y+40\nL X-9 R0"
    moves = read(body).moves
    assert -5.2 in np.round(moves.end_mm[:, 0], 6)
    assert moves.tool_offset_mm[-1, 2] == 100.5


CYCLE_200 = """CYCL DEF 200 DRILLING ~
  Q200=+2 ;SET-UP CLEARANCE ~
  Q201=-10 ;DEPTH ~
  Q206=+150 ;FEED ~
  Q202=+4 ;INFEED ~
  Q210=+0 ;DWELL ~
  Q203=+1 ;SURFACE ~
  Q204=+20 ;2ND CLEARANCE ~
  Q211=+0.5 ;DWELL"""


def test_cycle_200():
    body = f"{CYCLE_200}\nL X+10 Y+5 R0 FMAX M99\nL X+30 FMAX M99"
    levels = [p[2] for p in places(f"L Z+50 R0 FMAX\n{body}")]
    hole = [3, -3, 3, -2.8, -7, 3, -6.8, -9, 21]
    assert levels[-20:] == [50, *hole, 21, *hole][-20:]
    moves = read(body).moves
    assert moves.duration_s[moves.kind == 3].sum() == pytest.approx(1.0)


def test_datum_shift():
    body = ("CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 IY+5\n"
            "L X+1 Y+1 R0 FMAX\nCYCL DEF 7.0\nCYCL DEF 7.1 X+0\nL X+2 FMAX")  # fmt: skip
    assert [p[:2] for p in places(body, home_mm=(0, 0, 100))] == [[11, 6], [2, 6]]


def test_block_skip():
    body = "L X+1 R0 FMAX\n/ L X+9 FMAX"
    assert places(body)[-1][0] == 9
    skipped = read(body, control=ControlSettings(block_delete=True)).moves
    assert skipped.end_mm[-1, 0] == 1


@pytest.mark.parametrize(
    ("line", "word"),
    [("CYCL DEF 11.1 SCL 2\nL X+30 F200", "scaling"), ("CP IPA+90 IZ-3 DR+ F200", "a parameter"),
     ("CYCL DEF 207 TAP ~\nQ200=2 ~\nQ201=-9 ~\nQ239=1 ~\nQ203=0 ~\nQ204=9\nL X+9 FMAX M99",
      "tapping")],
)  # fmt: skip
def test_what_is_read_but_not_written_back_is_refused(tmp_path, line, word):
    job, effects = job_with(tmp_path, "", SCALE)
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nQ1 = 20\nCC X+0 Y+0\nL X+5 Y+0 Z+5 R0 FMAX\n"
    job.program.write_text(f"{head}{line}\nL Z+9 R0 FMAX\nEND PGM A MM\n")
    with pytest.raises((InputError, ProgramError), match=f"{word}.*cannot be compensated"):
        compensate(job, effects)


def test_radius_of_the_tool_and_a_tangent_without_a_move():
    assert read("L X+Q108 R0 FMAX").moves.end_mm[-1, 0] == 5.0
    with pytest.raises(ProgramError, match="CT without a move before it"):
        read("CT X+20 Y+10")


# Cycle programming manual, "Scaling": a factor about the datum; "Axis-specific scaling": about CC
@pytest.mark.parametrize(
    ("cycle", "line", "end"),
    [
        ("CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.75", "L X+20 Y-40 Z+8 F200", (15, -30, 6)),
        ("CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 2", "L IX+3 IY+4 F200", (6, 8, 0)),
        ("CYCL DEF 26.0 AXIS-SPEC. SCALING\nCYCL DEF 26.1 X1.4 Y0.6 CCX+15 CCY+20",
         "L X+25 Y+30 F200", (29, 26, 0)),
        ("CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 2\nCYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 1",
         "L X+7 F200", (7, 0, 0)),
    ],
)  # fmt: skip
def test_scaling(cycle, line, end):
    assert places(f"L X+0 Y+0 Z+0 R0 FMAX\n{cycle}\n{line}")[-1] == pytest.approx(end)


def test_scaled_circles_keep_their_shape():
    body = "L X+10 Y+0 Z+0 R0 FMAX\nCYCL DEF 11.1 SCL 0.5\nCC X+0 Y+0\n"
    moves = read(body.replace("X+10", "X+5") + "C X+0 Y+10 DR+ F100\n").moves
    assert np.hypot(*moves.centre_mm[-1, :2]) == pytest.approx(0.0)
    assert moves.end_mm[-1, :2] == pytest.approx([0, 5])
    oval = "CYCL DEF 26.1 X2 Y1\nL X+0 Y+0 F100\nCR X+4 Y+4 R+4 DR+\n"
    with pytest.raises(ProgramError, match="one factor for X and Y"):
        read("L X+0 Y+0 R0 FMAX\n" + oval)


# TNC 426 manual, cycles 3, 4 and 5: the tool stands at the set-up clearance above the surface
def test_first_milling_cycles():
    old = ("L X+50 Y+40 R0 FMAX M3\nL Z+2 FMAX\nCYCL DEF 5.0 CIRCULAR POCKET\n"
           "CYCL DEF 5.1 SET UP -2,000\nCYCL DEF 5.2 DEPTH -20\nCYCL DEF 5.3 PECKG -6 F80\n"
           "CYCL DEF 5.4 RADIUS 35\nCYCL DEF 5.5 F100 DR+\nL Z+2 FMAX M99")  # fmt: skip
    moves = read(old).moves
    cut = moves.end_mm[moves.at_feed] - [0, 0, 100]
    assert cut[:, 2].min() == pytest.approx(-20)
    assert np.hypot(*(cut[:, :2] - [50, 40]).T).max() == pytest.approx(35 - 5)
    slot = ("L X+0 Y+0 R0 FMAX M3\nL Z+2 FMAX\nCYCL DEF 3.0 SLOT\nCYCL DEF 3.1 SET UP -2\n"
            "CYCL DEF 3.2 DEPTH -10\nCYCL DEF 3.3 PECKG -5 F80\nCYCL DEF 3.4 X-12\n"
            "CYCL DEF 3.5 Y+50\nCYCL DEF 3.6 F100\nL Z+2 FMAX M99")  # fmt: skip
    moves = read(slot).moves
    cut = moves.end_mm[moves.at_feed, :2]
    assert np.ptp(cut, axis=0) == pytest.approx([12 - 10, 50 - 10])


def test_blocks_of_several_lines_and_words_of_early_controls():
    formula = "Q1 = 2 * ~\n   ( 3 + ~\n   4 )\nL X+Q1 R F FMAX M\n;a comment ~\nthat goes on\n"
    assert read(formula).moves.end_mm[-1, 0] == 14
    assert places("L X+1 Z+5 FMAX\nCYCLE DEF 9.0 DWELL\nCYCLE DEF 9.1 DWELL 2\nM140 MB20")[-1] == [
        1, 0, 25]  # fmt: skip


def test_tool_call_without_a_number_changes_the_oversize():
    longer = "L Z+10 R0 FMAX\nTOOL CALL DL+2\nL Z+10 F100"
    ends = read(longer).moves.end_mm[:, 2]
    assert ends[-1] == pytest.approx(100 + 2 + 10)


def test_fn18_knows_the_tools_and_nothing_of_the_machine():
    asked = "FN 18: SYSREAD Q10 = ID50 NR2 IDX1\nFN 18: SYSREAD Q11 = ID20 NR1\n"
    body = f"L X+0 FMAX\n{asked}L X+Q10 Y+Q11 FMAX"
    assert places(body)[-1][:2] == [5, 1]
    with pytest.raises(ProgramError, match="asked the machine"):
        read("FN 18: SYSREAD Q10 = ID270 NR1 IDX1\nL X+Q10 FMAX")


@pytest.mark.parametrize("line", ["CC X+0 Y+0 Z+0", "CC Z+0", "L X+1 FMAX M128", "L X+1 FMAX M97"])
def test_what_would_be_read_wrongly_is_refused(line):
    with pytest.raises(ProgramError) as error:
        read(line, control=ControlSettings(ignore_m=frozenset((97, 128))))
    assert "ignore_m" not in str(error.value)


@pytest.mark.parametrize(
    ("plane", "flat"),
    [("SPATIAL SPA+0 SPB+0 SPC+0 STAY", True), ("AXIAL A+0 C+0 STAY", True),
     ("VECTOR BX1 BY0 BZ0 NX0 NY0 NZ1 STAY SEQ- TABLE ROT", True), ("RESET STAY", True),
     ("EULER EULPR0 EULNU0 EULROT0 STAY", True), ("PROJECTED PROPR+0 PROMIN+0 ROT+0 STAY", True),
     ("VECTOR BX1 BY0 BZ0 NX0 NY1 NZ0 STAY", False), ("SPATIAL SPA+0 SPB+0 SPC+90 STAY", False),
     ("AXIAL B-90 TURN FMAX", False), ("POINTS P1X0", False)],
)  # fmt: skip
def test_planes_that_tilt_nothing_are_read(plane, flat):
    if flat:
        moves = read(f"PLANE {plane}\nL A+Q120 C+Q122 FMAX\nL X+7 FMAX").moves
        assert moves.end_mm[-1, 0] == 7
    else:
        with pytest.raises(ProgramError, match="tilts the plane"):
            read(f"PLANE {plane}\nL X+7 FMAX")


def test_plunging_feed_of_m103():
    """TNC 410 User's Manual, "Feed rate factor for plunging movements: M103", page 114."""
    body = "L X+20 Y+20 F500 M103 F20\nL Y+50\nL IZ-2.5\nL IY+5 IZ-5\nL IX+50\nL Z+5\nM103\nL IZ-1"
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX\n{body}\nEND PGM A MM\n"
    run = read_program(Source(text.encode(), "part.h"), tools={1: ToolEntry(0.0, 10.0)}).moves
    found = run.feed_mm_per_min[run.at_feed]
    assert np.round(found[:-1]) == pytest.approx([500, 500, 100, 141, 500, 500])
    assert found[-1] == pytest.approx(500)


def test_feeds_of_inch_programs_count_tenths():
    """CAM posts for these controls multiply feeds by ten in inch programs."""
    body = (
        "L X+1 F100\nCC X+2 Y+0\nC X+3 Y+0 DR+ F50\nCYCL DEF 200 D ~\nQ200=.1 ~\nQ201=-.2 ~\n"
        "Q206=30 ~\nQ202=1 ~\nQ203=0 ~\nQ204=2\nCYCL CALL\n"
        "CYCL DEF 207 T ~\nQ200=.1 ~\nQ201=-.2 ~\nQ239=.05 ~\nQ203=0 ~\nQ204=2\nCYCL CALL"
    )
    text = (
        f"BEGIN PGM A INCH\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX M3\n{body}\nEND PGM A INCH\n"
    )
    run = read_program(Source(text.encode(), "part.h"), tools={1: ToolEntry(0.0, 10.0)}).moves
    inch_per_min = run.feed_mm_per_min[run.at_feed] / 25.4
    assert inch_per_min == pytest.approx([10, 5, 3, 50, 50])


def test_the_worked_example_of_g221():
    """HEIDENHAIN TNC 410/426/430, User's Manual ISO Programming, cycle 221, its block N54."""
    text = (
        "%A G71 *\nN10 T1 G17 S1000 *\nN20 G00 G40 G90 Z+100 M03 *\n"
        "N30 G200 Q200=2 Q201=-15 Q206=250 Q202=5 Q210=0 Q203=+30 Q204=50 Q211=0 *\n"
        "N54 G221 Q225=+15 Q226=+15 Q237=+10 Q238=+8 Q242=6 Q243=4 Q224=+15 "
        "Q200=2 Q203=+30 Q204=50 Q301=1 *\nN60 G00 Z+100 M02 *\nN99999999 %A G71 *\n"
    )
    program = read_program(Source(text.encode(), "part.i"), tools=TOOLS, dialect="tnciso")
    ends = program.moves.end_mm - [0, 0, 100]
    holes = {tuple(place) for place in ends[np.abs(ends[:, 2] - 15.0) < 1e-9][:, :2].round(6)}
    turn = np.radians(15.0)
    column, line = np.meshgrid(10.0 * np.arange(6), 8.0 * np.arange(4))
    wanted = {
        tuple(np.round([15 + u * np.cos(turn) - v * np.sin(turn),
                        15 + u * np.sin(turn) + v * np.cos(turn)], 6))
        for u, v in zip(column.ravel(), line.ravel(), strict=True)
    }  # fmt: skip
    assert holes == wanted


# iTNC 530, User's Manual, section 11.5: M118 names how far the handwheel may go beside the path
@pytest.mark.parametrize(
    ("block", "end"),
    [
        ("L X+5 F100 M118 Z1", [5, 0, 9]), ("L X+5 F100 M118 X1 Y1 Z-2.5 M8", [5, 0, 9]),
        ("M118 X1 Y1 Z2", [0, 0, 9]), ("L M118 Z1 B2", [0, 0, 9]),
        ("L X+5 F100 M120 LA10", [5, 0, 9]),
        ("M120 LA10", [0, 0, 9]), ("L Y+5 M124 T0.01", [0, 5, 9]),
        ("L X+5 M112 T0.01 A10", [5, 0, 9]),
        ("M138 A C", [0, 0, 9]), ("L X+5 M138 C", [5, 0, 9]), ("L X+5 M118", [5, 0, 9]),
    ],
)  # fmt: skip
def test_words_that_belong_to_an_m_function_are_no_places(block, end):
    found = read(f"L X+0 Y+0 Z+9 R0 FMAX\n{block}\nL X+50 FMAX").moves
    assert found.start_mm[-1] - [0, 0, 100] == pytest.approx(end)
    assert found.end_mm[-1] - [0, 0, 100] == pytest.approx([50, *end[1:]])
