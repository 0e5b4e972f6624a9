"""Programs of TNC controls in DIN/ISO: one part in ISO and in Klartext, and places by hand."""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}

ISO = """%PART G71 *
N10 G30 G17 X+0 Y+0 Z-20 *
N20 G31 G90 X+100 Y+100 Z+0 *
N30 G99 T1 L+0 R+5 *
N40 T1 G17 S4000 *
N50 G00 G40 G90 Z+250 *
N60 X-10 Y-10 *
N70 G01 Z-5 F1000 M3 *
N80 G01 G41 X+5 Y+5 F300 *
N90 Y+95 *
N100 G25 R10 *
N110 X+95 *
N120 G24 R3 *
N130 Y+50 *
N140 G02 X+75 Y+30 R+20 *
N150 I+75 J+20 *
N160 G03 X+65 Y+20 *
N170 G01 X+5 Y+5 *
N180 G00 G40 X-20 Y-20 *
N190 Z+50 *
N200 I+50 J+50 *
N210 G10 R+30 H+90 *
N220 G91 H+30 *
N230 G90 G200 DRILLING Q200=2 Q201=-15 Q206=250 Q202=5 Q210=0 Q203=0 Q204=50 Q211=0 *
N240 D00 Q1 P01 +30 *
N250 G98 L1 *
N260 G00 X+Q1 Y+35 M3 *
N270 G79 *
N280 D01 Q1 P01 +Q1 P02 +20 *
N290 L1,2 *
N300 D09 P01 +Q1 P02 +90 P03 2 *
N310 G00 X+999 *
N320 G98 L2 *
N330 G54 X+10 *
N340 G73 H+90 *
N350 G00 X+5 Y+0 *
N360 G73 H+0 *
N370 G54 X+0 *
N380 G83 P01 -2 P02 -20 P03 -10 P04 0 P05 250 *
N390 G00 X+1 Y+2 *
N400 Z+2 M99 *
N410 L7,0 *
N420 G00 Z+250 M2 *
N430 G98 L7 *
N440 G00 X+7 Y+7 *
N450 G98 L0 *
N99999 %PART G71 *
"""
KLARTEXT = """BEGIN PGM PART MM
TOOL CALL 1 Z S4000
L Z+250 R0 FMAX
L X-10 Y-10 FMAX
L Z-5 F1000 M3
L X+5 Y+5 RL F300
L Y+95
RND R10
L X+95
CHF 3
L Y+50
CR X+75 Y+30 R+20 DR-
CC X+75 Y+20
C X+65 Y+20 DR+
L X+5 Y+5
L X-20 Y-20 R0 FMAX
L Z+50 FMAX
CC X+50 Y+50
LP PR+30 PA+90 FMAX
LP IPA+30 FMAX
CYCL DEF 200 DRILLING Q200=2 Q201=-15 Q206=250 Q202=5 Q210=0 Q203=0 Q204=50 Q211=0
L X+30 Y+35 FMAX M3
CYCL CALL
L X+50 Y+35 FMAX
CYCL CALL
L X+70 Y+35 FMAX
CYCL CALL
L X+10 Y+5 FMAX
CYCL DEF 1.0 PECKING
CYCL DEF 1.1 SET UP-2
CYCL DEF 1.2 DEPTH-20
CYCL DEF 1.3 PECKG-10
CYCL DEF 1.4 DWELL 0
CYCL DEF 1.5 F250
L X+1 Y+2 FMAX
L Z+2 FMAX
CYCL CALL
L X+7 Y+7 FMAX
L Z+250 FMAX M2
END PGM PART MM
"""


def read(text, name="part.i"):
    return read_program(Source(text.encode(), name), tools=TOOLS)


def test_iso_is_recognised_and_makes_the_path_of_klartext():
    iso, klartext = read(ISO), read(KLARTEXT, "part.h")
    assert (iso.dialect, klartext.dialect) == ("tnciso", "heidenhain")
    one, other = iso.moves, klartext.moves
    assert one.end_mm == pytest.approx(other.end_mm, abs=1e-9)
    assert (one.kind == other.kind).all()
    assert one.feed_mm_per_min == pytest.approx(other.feed_mm_per_min)
    assert one.sweep_rad == pytest.approx(other.sweep_rad)


def test_moves_have_the_lines_of_the_iso_program():
    moves = read(ISO).moves
    row = np.flatnonzero(np.abs(moves.end_mm[:, :2] - 7).max(axis=1) < 1e-9)[0]
    assert moves.line[row] == ISO.splitlines().index("N440 G00 X+7 Y+7 *") + 1


@pytest.mark.parametrize(
    ("block", "end"),
    [
        ("G02 I+10 J+0 X+10 Y+10", (10, 10)),
        ("G01 X+10 Y+0 F99 *\nG06 X+20 Y+10", (20, 10)),
        ("G91 G01 X+3 F99 *\nX+3", (6, 0)),
        ("G29 *\nG11 R+5 H+90 F99", (0, 5)),
        ("I+0 J+0 *\nG00 X+10 *\nG13 H+90 F99", (0, 10)),
        ("G28 X *\nG00 X+5", (-5, 0)),
        ("G72 F2 *\nG00 X+5", (10, 0)),
        ("G54 G91 X+5 *\nG90 G00 X+1", (6, 0)),
        ("Q3 = 2 * 3 *\nG00 X+Q3", (6, 0)),
        ("D05 Q3 P01 +16 *\nG00 X+Q3", (4, 0)),
        ("D13 Q3 P01 +1 P02 +1 *\nG00 X+Q3", (45, 0)),
        ("G04 F1 *\nG00 X+2", (2, 0)),
        ("G17 *\nG07 X+4 F99", (4, 0)),
        ("G01 X+4 M118 X1 Y1 M8", (4, 0)),
        ("M118 X1 Y1 *\nG00 X+5 M120 LA10", (5, 0)),
        ("G01 X+6 M138 A C", (6, 0)),
    ],
)
def test_words_of_iso(block, end):
    head = "%A G71 *\nT1 G17 S1 *\nG00 G40 G90 X+0 Y+0 Z+0 *\nF300 *\n"
    moves = read(head + block + " *\nN9 %A G71 *\n").moves
    assert moves.end_mm[-1, :2] == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("G43 X+5", "part.i:2: G43"),
        ("G16 R5 H7", "part.i:2: G16"),
        ("D18 Q1 P01 +1", "part.i:2: D18"),
        ("D01 Q1 P01 +1", "part.i:2: D01 lacks"),
        ("G83 P01 -2", "part.i:2: G83 lacks"),
        ("L9,0", "LBL 9 does not exist"),
        ("G00 X+", "cannot read 'X\\+'"),
        ("T1 G18 S5", "cannot read 'TOOL CALL"),
        ("G01 X+5 R5", "part.i:2: word R beside G01"),
        ("G11 R5 H5 K5", "part.i:2: word K beside G11"),
    ],
)
def test_refusals_name_word_and_line(block, message):
    with pytest.raises(ProgramError, match=message):
        read(f"%A G71 *\n{block} *\nN9 %A G71 *\n")


def test_the_feed_share_of_m103_is_no_feed_of_the_block():
    head = "%A G71 *\nT1 G17 S1 *\nG00 G40 G90 X+0 Y+0 Z+0 *\nF300 *\n"
    moves = read(head + "G01 X+5 M103 F50 *\nY+5 *\nZ-5 *\nN9 %A G71 *\n").moves
    assert moves.feed_mm_per_min[-3:] == pytest.approx([300, 300, 150])


def test_it_is_not_written_back(tmp_path):
    from vmach.errors import InputError
    from vmach.program_text.control import target_control

    with pytest.raises(InputError, match="DIN/ISO are read, not written back"):
        target_control("tnciso", None, file=tmp_path / "part.i")


HEXAGON = """%HEX G71 *
N40 T1 G17 S4000 *
N50 G00 G40 G90 Z+250 *
N60 I+50 J+50 *
N70 G10 R+60 H+180 *
N80 G01 Z-5 F1000 M3 *
N90 G11 G41 R+45 H+180 F250 *
N100 G26 R5 F150 *
N110 H+120 *
N120 H+60 *
N130 H+0 *
N140 H-60 *
N150 H-120 *
N160 H+180 *
N170 G27 R5 F500 *
N180 G40 R+60 H+180 F1000 *
N190 G00 Z+250 M2 *
N99999999 %HEX G71 *
"""


def cutting(text, radius):
    tools = {1: ToolEntry(0.0, 2.0 * radius)}
    moves = read_program(Source(text.encode(), "part.i"), tools=tools, dialect="tnciso").moves
    feed = moves.at_feed & (np.abs(moves.end_mm - moves.start_mm)[:, :2].max(axis=1) > 1e-9)
    return moves.start_mm[feed, :2], moves.end_mm[feed, :2], moves.centre_mm[feed, :2]


# TNC 320 (34055x-06), User's Manual for DIN/ISO Programming, 5/2013, page 172: G26 and G27 go on
# an arc between the contour's point and the start or end, which is tangent to the contour
@pytest.mark.parametrize("radius", [2.0, 5.0, 10.0])
def test_a_contour_is_approached_and_left_on_tangent_arcs(radius):
    starts, ends, centres = cutting(HEXAGON, radius)
    along = np.array([np.sin(np.radians(30)), np.cos(np.radians(30))])  # first side, upwards
    left = np.array([-along[1], along[0]])
    contact = [5.0, 50.0] + radius * left
    assert ends[1] == pytest.approx(contact)
    assert centres[1] == pytest.approx(contact + 5.0 * left)
    out = ends[0] - centres[1]
    assert np.hypot(*out) == pytest.approx(5.0)
    assert out @ (ends[0] - starts[0]) == pytest.approx(0.0, abs=1e-6)
    # the hexagon is symmetric, and so are its approach and departure
    mirrored = [[1.0, -1.0]] * (ends[-2:] - [0.0, 50.0]) + [0.0, 50.0]
    assert mirrored == pytest.approx(np.array([ends[0], [-10.0, 50.0]]))
    assert starts[-2] == pytest.approx(contact * [1.0, -1.0] + [0.0, 100.0])


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [("N90 G11 G41 R+45", "N90 G11 R+45", "part.i:8: G26 behind no block with G41 or G42"),
     ("N180 G40 R", "N180 R", "part.i:16: G27 without G40")],
)  # fmt: skip
def test_an_arc_of_approach_or_departure_needs_its_block(old, new, says):
    with pytest.raises(ProgramError, match=says):
        cutting(HEXAGON.replace(old, new), 5.0)


# TNC 407 (280 580), ISO Programming, page 5-25, "Circular arc connecting to a straight line"
CONNECTING = """%S525I G71 *
N40 T1 G17 S1000 *
N50 G00 G40 G90 Z+100 M06 *
N60 X+30 Y-30 *
N70 Z-15 M03 *
N80 G01 G41 X+50 Y+0 F100 *
N90 X+10 Y+40 *
N100 G06 X+50 Y+50 *
N110 G01 X+100 *
N120 G00 G40 X+130 Y+70 *
N130 Z+100 M02 *
N99999 %S525I G71 *
"""


@pytest.mark.parametrize("radius", [5.0, 20.0])
def test_a_tangent_arc_goes_on_from_the_contour_under_compensation(radius):
    starts, ends, centres = cutting(CONNECTING, radius)
    centre = np.array([27.0, 57.0])  # as far from (10, 40), square to the line, as from (50, 50)
    assert centres[2] == pytest.approx(centre)
    out = np.hypot(17.0, 17.0) + radius
    assert starts[2] == pytest.approx(centre + out * np.array([-1.0, -1.0]) / np.sqrt(2.0))
    # the corner behind it is an inner one: where the circle meets the line beside Y+50
    assert ends[2] == pytest.approx([27.0 + np.sqrt(out**2 - (radius - 7.0) ** 2), 50.0 + radius])
