"""What a block says besides its motion acts in its turn, though motion waits for a corner.

A block with RND, ,R or RND= is moved only when the next one is known. Truth: the order in which the
blocks stand, and the manuals' rule that M5 acts at the end of its block (HEIDENHAIN TNC 640,
Klartext Programming 892903, "Miscellaneous functions"; B-64484EN, "Auxiliary function").
"""

import pytest

from gcode import Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}
KLARTEXT = """BEGIN PGM A MM
TOOL CALL 1 Z S1000 F300
L X+0 Y+0 Z+50 R0 FMAX M3
L X+40 F100 M5
RND R5
L Y+20 M3
M30
END PGM A MM
"""
SINUMERIK = """G17 G71 G90 G54
T1 D1 M6
S1000 M3
G0 X0 Y0
G1 X40 F100 RND=5
M5 F50
S500 M4
Y20
M30
"""
FANUC = "O1\nG17G21G90G54\nT1M6\nS1000M3\nG0X0Y0\nG1X40.F100,R5.M5\nS500M4\nY20.\nM30\n"


def pieces(text, dialect):
    moves = read_program(Source(text.encode(), "part"), tools=TOOLS, dialect=dialect).moves
    rows = [k for k in range(len(moves)) if moves.kind[k] in (1, 2)]
    return [
        (
            tuple(moves.end_mm[k, :2].round(6).tolist()),
            float(moves.spindle_rpm[k]),
            float(moves.feed_mm_per_min[k]),
        )
        for k in rows
    ]


@pytest.mark.parametrize(
    ("text", "dialect", "wanted"),
    [
        # M5 ends its own line, M3 begins the other: the corner itself is without spindle
        (KLARTEXT, "heidenhain", [((35, 0), 1000, 100), ((40, 5), 0, 100), ((40, 20), 1000, 100)]),
        (
            SINUMERIK,
            "sinumerik",
            [((35, 0), 1000, 100), ((40, 5), 1000, 100), ((40, 20), -500, 50)],
        ),
        (FANUC, "fanuc", [((35, 0), 1000, 100), ((40, 5), 1000, 100), ((40, 20), -500, 100)]),
    ],
)
def test_events_beside_a_corner_keep_their_order(text, dialect, wanted):
    assert pieces(text, dialect) == wanted
