"""Where common words of three controls end, computed by hand from the makers' manuals."""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}
OFFSETS = {f"G5{k}": (10.0 * (k - 3), 0.0, 0.0) for k in range(4, 10)}


def moves(body, dialect):
    if dialect == "heidenhain":
        body = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\n{body}\nEND PGM A MM\n"
    else:
        body = ("O1\nG21\n" if dialect == "fanuc" else "") + f"{body}\nM30\n"
    return read_program(Source(body.encode(), "part"), tools=TOOLS, work_offsets_mm=OFFSETS,
                        dialect=dialect, home_mm=(0, 0, 500)).moves  # fmt: skip


PLACES = [
    # plane, unit and work offset
    ("fanuc", "G56 G0 X1.", (31, 0)), ("fanuc", "G57 G0 X1.", (41, 0)),
    ("fanuc", "G58 G0 X1.", (51, 0)), ("fanuc", "G59 G0 X1.", (61, 0)),
    ("fanuc", "G0 X5. Y5.\nG92 X0. Y0.\nG0 X1. Y1.", (16, 6)),
    ("fanuc", "G18 G0 X10. Z0.\nG2 X0. Z10. R10. F100.", (10, 0)),
    ("fanuc", "G19 G0 Y10. Z0.\nG3 Y0. Z10. R10. F100.", (0, 0)),
    ("fanuc", "#1=3\nIF [#1 GT 2] GOTO 5\nG0 X99.\nN5 G0 X1.", (11, 0)),
    ("fanuc", "#1=0\nWHILE [#1 LT 3] DO1\n#1=#1+1\nEND1\nG0 X#1", (13, 0)),
    ("fanuc", "G0 X7.\nG91 G30 X0.", (0, 0)), ("fanuc", "G1 G31 X7. F100.", (17, 0)),
    ("fanuc", "G9 G1 X7. F100.", (17, 0)), ("fanuc", "G93 G1 X7. F2.", (17, 0)),
    ("sinumerik", "G54 G700 G0 X1", (35.4, 0)), ("sinumerik", "G54 G70 G0 X1", (35.4, 0)),
    ("sinumerik", "G54 G710 G0 X1", (11, 0)), ("sinumerik", "G56 G0 X1", (31, 0)),
    ("sinumerik", "G57 G0 X1", (41, 0)), ("sinumerik", "G54 G0 X1\nG53 X2", (2, 0)),
    ("sinumerik", "G54 G0 X1\nG153 X2", (2, 0)), ("sinumerik", "G54 G0 X1\nSUPA X2", (2, 0)),
    ("sinumerik", "G54 G0 X1\nG53", (11, 0)), ("sinumerik", "G54 G0 X1\nG153 M5\nX2", (12, 0)),
    ("sinumerik", "G54 G0 X1\nSUPA D0\nX2", (12, 0)), ("sinumerik", "G0 X1\nG53 G57\nX2", (42, 0)),
    ("sinumerik", "G54 G0 X0 Y0\nG1 F100 X9\nG3 X19 Y10 CR=10", (29, 10)),
    ("sinumerik", "G54 G0 X0 Y0\nG2 X=IC(10) Y=IC(10) CR=10 F100", (20, 10)),
    ("sinumerik", "G54 G111 X5 Y5\nG0 RP=10 AP=90", (15, 15)),
    ("sinumerik", "G54 G111 X5 Y5\nG112 X1 Y1\nG0 RP=10 AP=0", (26, 6)),
    ("sinumerik", "G54\nR1=1\nGOTOF ZZ\nG0 X99\nZZ: G0 X1", (11, 0)),
    ("sinumerik", "G54\nR1=0\nAA1: R1=R1+1\nIF R1<3 GOTOB AA1\nG0 X=R1", (13, 0)),
    ("sinumerik", "G54\nR1=1\nIF R1==2\nG0 X9\nELSE\nG0 X8\nENDIF", (18, 0)),
    ("heidenhain", "FN 9: IF +1 EQU +1 GOTO LBL 1\nL X+9 FMAX\nLBL 1\nL X+1 FMAX", (11, 0)),
    ("heidenhain", "FN 10: IF +1 NE +2 GOTO LBL 1\nL X+9 FMAX\nLBL 1\nL X+1 FMAX", (11, 0)),
    ("heidenhain", "FN 11: IF +1 GT +2 GOTO LBL 1\nL X+9 FMAX\nLBL 1\nL Y+1 FMAX", (19, 1)),
    ("heidenhain", "L X+7 Y+8 R0 FMAX M91", (7, 8)),
    ("heidenhain", "QL1 = 3\nQR2 = 4\nL X+QL1 Y+QR2 FMAX", (13, 4)),
]  # fmt: skip


@pytest.mark.parametrize(("dialect", "body", "end"), PLACES)
def test_ends(dialect, body, end):
    assert moves(body, dialect).end_mm[-1, :2] == pytest.approx(end)


CONTOURS = {
    "fanuc": "G54 G0 X-30. Y0. Z0.\nG1 {side} D1 X0. Y0. F100.\nX40.\nG40 X40. Y{away}.",
    "sinumerik": "G54 T1 D1 M6\nG0 X-30 Y0\nG1 {side} X0 Y0 F100\nX40\nG40 Y{away}",
    "heidenhain": "L X-30 Y+0 R0 FMAX\nL X+0 Y+0 {side} F100\nL X+40\nL Y+{away} R0",
}


@pytest.mark.parametrize("dialect", CONTOURS)
@pytest.mark.parametrize("right", [False, True])
def test_the_tool_runs_beside_the_contour_on_its_side(dialect, right):
    names = ("RL", "RR") if dialect == "heidenhain" else ("G41", "G42")
    body = CONTOURS[dialect].format(side=names[right], away=-20 if right else 20).replace("+-", "-")
    run = moves(body, dialect)
    level = -5.0 if right else 5.0
    along = np.flatnonzero(np.ptp([run.start_mm[:, 1], run.end_mm[:, 1]], axis=0) < 1e-9)
    assert run.end_mm[along[run.at_feed[along]], 1] == pytest.approx(level)


#: cycle 4, 2 and 17 of the first controls, the call at a place and by M89
CALLS = {
    "CYCL DEF 2.0 TAPPING\nCYCL DEF 2.1 SET UP-2\nCYCL DEF 2.2 DEPTH-10\nCYCL DEF 2.3 DWELL0\n"
    "CYCL DEF 2.4 F100\nL X+5 Y+6 R0 FMAX\nL Z+2 FMAX\nCYCL CALL": -10,
    "CYCL DEF 17.0 RIGID\nCYCL DEF 17.1 SET UP2\nCYCL DEF 17.2 DEPTH-11\nCYCL DEF 17.3 PITCH+1\n"
    "L X+5 Y+6 R0 FMAX\nL Z+2 FMAX M99": -11,
    "CYCL DEF 4.0 POCKET\nCYCL DEF 4.1 SET UP2\nCYCL DEF 4.2 DEPTH-9\nCYCL DEF 4.3 PECKG3 F50\n"
    "CYCL DEF 4.4 X30\nCYCL DEF 4.5 Y20\nCYCL DEF 4.6 F200 DR+ RADIUS6\n"
    "L X+5 Y+6 R0 FMAX\nL Z+2 FMAX M99": -9,
    "CYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-8 ~\nQ206=99 ~\nQ202=8 ~\nQ203=0 ~\nQ204=20\n"
    "CYCL CALL POS X+5 Y+6 Z+0 FMAX": -8,
    "CYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-7 ~\nQ206=99 ~\nQ202=8 ~\nQ203=0 ~\nQ204=20\n"
    "L M89\nL X+5 Y+6 FMAX": -7,
}


@pytest.mark.parametrize(("body", "depth"), CALLS.items())
def test_klartext_cycles_reach_their_depth_at_their_place(body, depth):
    run = moves("L Z+50 R0 FMAX M3\n" + body, "heidenhain")
    cut = run.end_mm[run.at_feed] - [10, 0, 100]
    deep = cut[np.abs(cut[:, 2] - depth) < 1e-9]
    assert cut[:, 2].min() == pytest.approx(depth)
    assert np.abs(deep[:, :2].mean(axis=0) - [5, 6]).max() < 12
    if "POCKET" in body:
        assert np.ptp(deep[:, :2], axis=0) == pytest.approx([30 - 10, 20 - 10])


def test_feed_per_revolution():
    fanuc = moves("G54 G95 S500 M3\nG1 X10. F0.2", "fanuc")
    siemens = moves("G54 G95 S500 M3\nG1 X10 F0.2", "sinumerik")
    assert [run.feed_mm_per_min[-1] for run in (fanuc, siemens)] == pytest.approx([100, 100])


def test_refusals_of_words_that_have_no_meaning_here():
    with pytest.raises(ProgramError, match="GOTO"):
        moves("GOTO 99", "fanuc")
