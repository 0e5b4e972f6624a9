"""One part, programmed by hand for three controls from one drawing, is one path.

Contour with rounded corners (outer corners differ by control), an arc, tool compensation, a turned
and shifted copy of three holes, a loop.
"""

import numpy as np
import pytest

from gcode import Source, ToolEntry, read_program
from gcode.moves.moves import MoveKind

TOOLS = {1: ToolEntry(0.0, 10.0)}
PROGRAMS = {
    "fanuc": """O1000
G21 G17 G90 G40 G80 G54
T1 M6
S2000 M3
G0 X-20. Y-20. Z10.
G1 Z-3. F200.
G41 D1 X0. Y0. F500.
Y50. ,R6.
X60. ,R4.
Y20.
G2 X40. Y0. R20.
G1 X-20.
G40 Y-20.
G0 Z10.
G52 X100. Y10.
G68 X0. Y0. R30.
#1=0
WHILE[#1 LT 3]DO1
G0 X[#1*12.] Y5.
G0 Z2.
G1 Z-8. F150.
G0 Z10.
#1=#1+1
END1
G69
G52 X0. Y0.
G0 X0. Y0.
M30
""",
    "sinumerik": """G71 G17 G90 G40 G54
T1 D1 M6
S2000 M3
G0 X-20 Y-20 Z10
G1 Z-3 F200
G41 X0 Y0 F500
Y50 RND=6
X60 RND=4
Y20
G2 X40 Y0 CR=20
G1 X-20
G40 Y-20
G0 Z10
TRANS X100 Y10
AROT Z30
FOR R1=0 TO 2
G0 X=R1*12 Y5
G0 Z2
G1 Z-8 F150
G0 Z10
ENDFOR
TRANS
G0 X0 Y0
M30
""",
    "heidenhain": """0 BEGIN PGM PART MM
1 TOOL CALL 1 Z S2000
2 L X-20 Y-20 Z+10 R0 FMAX M3
3 L Z-3 F200
4 L X+0 Y+0 RL F500
5 L Y+50
6 RND R6
7 L X+60
8 RND R4
9 L Y+20
10 CR X+40 Y+0 R+20 DR-
11 L X-20
12 L Y-20 R0
13 L Z+10 FMAX
14 CYCL DEF 7.0 DATUM SHIFT
15 CYCL DEF 7.1 X+100
16 CYCL DEF 7.2 Y+10
17 CYCL DEF 10.0 ROTATION
18 CYCL DEF 10.1 ROT+30
19 Q1 = 0
20 LBL 1
21 Q2 = Q1 * 12
22 L X+Q2 Y+5 FMAX
23 L Z+2 FMAX
24 L Z-8 F150
25 L Z+10 FMAX
26 Q1 = Q1 + 1
27 CALL LBL 1 REP 2
28 CYCL DEF 10.0 ROTATION
29 CYCL DEF 10.1 ROT+0
30 CYCL DEF 7.0 DATUM SHIFT
31 CYCL DEF 7.1 X+0
32 CYCL DEF 7.2 Y+0
33 L X+0 Y+0 FMAX
34 END PGM PART MM
""",
}


def path(control):
    moves = read_program(
        Source(PROGRAMS[control].encode(), "part.nc"), tools=TOOLS, dialect=control
    ).moves
    kept = (moves.kind != MoveKind.DWELL) & (
        np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9
    )
    turned = moves.sweep_rad * moves.axis[:, 2]
    return moves.kind[kept], moves.end_mm[kept], turned[kept], moves.feed_mm_per_min[kept]


@pytest.mark.parametrize("control", ["sinumerik", "heidenhain"])
def test_same_path_as_on_fanuc(control):
    for wanted, found in zip(path("fanuc"), path(control), strict=True):
        assert found == pytest.approx(wanted, abs=1e-9)


def test_the_holes_lie_where_the_drawing_has_them():
    kinds, ends, *_ = path("fanuc")
    holes = ends[(kinds == MoveKind.LINE) & (np.abs(ends[:, 2] + 8) < 1e-9)][:, :2]
    turn = np.radians(30)
    row = np.stack([np.arange(3) * 12.0, np.full(3, 5.0)], axis=1)
    wanted = [100, 10] + row @ np.array(
        [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    )
    assert holes == pytest.approx(wanted)
