"""Roundings between lines and arcs, corners of G450 and G451, scales: closed forms.

A rounding of radius r touches a line where its centre is r from it, and a circle of radius R where
its centre is R + r or R - r from the circle's own.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from gcode.geometry.corners import Piece, broken_corner
from gcode.moves.moves import MoveKind

TOOLS = {1: ToolEntry(100.0, 10.0)}
OFFSETS = {"G54": (0.0, 0.0, 0.0)}


def moves(body, dialect):
    if dialect == "heidenhain":
        body = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\n{body}\nEND PGM A MM\n"
    else:
        body = ("O1\nG21\n" if dialect == "fanuc" else "") + f"{body}\nM30\n"
    return read_program(Source(body.encode(), "part"), tools=TOOLS, work_offsets_mm=OFFSETS,
                        dialect=dialect, home_mm=(0, 0, 500)).moves  # fmt: skip


#: a line along X to (30, 0), then an arc about (30, 20), then a line; both corners are rounded
ROUNDED = {
    "heidenhain": "L X+0 Y+0 R0 FMAX\nL X+30 Y+0 F100\nRND R4\nCC X+50 Y+0\nC X+50 Y+20 DR{sign}\n"
    "RND R3\nL X+80 Y{last}",
    "fanuc": "G54 G0 X0. Y0.\nG1 X30. F100. ,R4.\nG{code} X50. Y20. I20. J0. ,R3.\n"
    "G1 X80. Y{last}.",
    "sinumerik": "G54 G0 X0 Y0\nG1 X30 F100 RND=4\nG{code} X50 Y20 I20 J0 RND=3\nG1 X80 Y{last}",
}


@pytest.mark.parametrize("dialect", ROUNDED)
@pytest.mark.parametrize("clockwise", [True, False])
def test_a_rounding_touches_line_and_arc(dialect, clockwise):
    last = 40 if clockwise else -40
    body = ROUNDED[dialect].format(sign="-" if clockwise else "+", code=2 if clockwise else 3,
                                   last=last)  # fmt: skip
    run = moves(body, dialect)
    arcs = np.flatnonzero(run.kind == MoveKind.ARC)
    centres = run.centre_mm[arcs, :2]
    radii = np.linalg.norm(run.end_mm[arcs, :2] - centres, axis=1)
    assert radii == pytest.approx([4, 20, 3])
    assert abs(centres[0, 1]) == pytest.approx(4)  # from the line Y = 0
    inside = math.dist(centres[0], (50, 0)) < 20
    assert math.dist(centres[0], (50, 0)) == pytest.approx(16 if inside else 24)
    along = np.array([30, last - 20]) / math.hypot(30, last - 20)
    out = centres[2] - [50, 20]
    assert abs(out[0] * along[1] - out[1] * along[0]) == pytest.approx(3)
    assert abs(math.dist(centres[2], (50, 0)) - 20) == pytest.approx(3)
    # the way has no corner: it arrives as it leaves
    way = np.flatnonzero(run.at_feed)
    for before, after in pairwise(way):
        assert heading(run, before, 1.0) == pytest.approx(heading(run, after, 0.0), abs=1e-9)


def heading(run, index, where):
    """Unit direction of a move at its start (0) or end (1)."""
    if run.kind[index] != MoveKind.ARC:
        along = (run.end_mm - run.start_mm)[index, :2]
    else:
        place = run.start_mm[index] if where == 0.0 else run.end_mm[index]
        out = (place - run.centre_mm[index])[:2]
        along = np.array([-out[1], out[0]]) * np.sign(run.sweep_rad[index] * run.axis[index, 2])
    return along / np.linalg.norm(along)


def around(centre, radius, degrees):
    angle = math.radians(degrees)
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def left_of(piece, place):
    """Unit vector to the left of the way of an arc."""
    out = np.subtract(place, piece.centre) / math.dist(place, piece.centre)
    return -out * piece.sense


@pytest.mark.parametrize("senses", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
@pytest.mark.parametrize("meeting_deg", [50.0, 75.0, 100.0, 120.0])
def test_a_rounding_touches_both_arcs(senses, meeting_deg):
    """Its centre is 2 mm beside both arcs, on one side of the way, and not beyond their ends."""
    corner = (7.0, -3.0)
    centres = around(corner, 20.0, 10.0), around(corner, 15.0, 10.0 + meeting_deg)
    first = Piece(
        around(centres[0], 20.0, 190.0 - 150.0 * senses[0]), corner, centres[0], senses[0]
    )
    start_deg = 190.0 + meeting_deg
    end = around(centres[1], 15.0, start_deg + 150.0 * senses[1])
    second = Piece(corner, end, centres[1], senses[1])
    found = broken_corner(first, second, 2.0, chamfer=False)
    assert math.dist(found.begin, centres[0]) == pytest.approx(20.0)
    assert math.dist(found.end, centres[1]) == pytest.approx(15.0)
    beside = 2.0 * found.sense
    middle = np.add(found.begin, beside * left_of(first, found.begin))
    assert middle == pytest.approx(np.add(found.end, beside * left_of(second, found.end)))
    for piece, place, way in ((first, found.begin, -1.0), (second, found.end, 1.0)):
        out, at = np.subtract(corner, piece.centre), np.subtract(place, piece.centre)
        turned = math.degrees(math.atan2(out[0] * at[1] - out[1] * at[0], out @ at))
        assert 0.0 < way * piece.sense * turned < 90.0  # before the corner, behind it


def test_a_whole_circle_is_rounded_where_it_ends():
    """A circle about (0, 10) from the origin, and a line that leaves it straight down."""
    circle, line = Piece((0.0, 0.0), (0.0, 0.0), (0.0, 10.0), 1), Piece((0.0, 0.0), (0.0, -9.0))
    found = broken_corner(circle, line, 2.0, chamfer=False)
    # the centre is 12 mm from (0, 10), 2 mm from the line
    height = 10.0 - math.sqrt(12.0**2 - 2.0**2)
    assert found.sense == -1
    assert found.end == pytest.approx((0.0, height))
    assert found.begin == pytest.approx((-2.0 * 10.0 / 12.0, 10.0 + (height - 10.0) * 10.0 / 12.0))


@pytest.mark.parametrize("dialect", ROUNDED)
def test_a_rounding_that_does_not_fit_is_refused(dialect):
    body = ROUNDED[dialect].format(sign="-", code=2, last=40)
    for small, large in (("R4", "R99"), ("RND=4", "RND=99")):
        body = body.replace(small, large)
    with pytest.raises(ProgramError, match="does not fit"):
        moves(body, dialect)


def test_a_rounding_of_fanuc_with_a_point_is_in_mm():
    from gcode.language.options import ControlSettings

    text = "O1\nG21 G90 G54 G0 X0 Y0\nG1 X10000 F100,R{size}\nY10000\nM30\n"
    for size in ("2.", "2000"):
        run = read_program(Source(text.format(size=size).encode(), "part"), dialect="fanuc",
                           work_offsets_mm=OFFSETS,
                           control=ControlSettings(increment="IS-B")).moves  # fmt: skip
        arc = np.flatnonzero(run.kind == MoveKind.ARC)[0]
        assert math.dist(run.centre_mm[arc], run.end_mm[arc]) == pytest.approx(2)


@pytest.mark.parametrize(("corner", "arcs"), [("G450", 1), ("G451", 0)])
def test_outer_corners_of_sinumerik(corner, arcs):
    run = moves(f"G54 T1 D1 M6\nG0 X-20 Y0\nG1 {corner} G41 X0 Y0 F100\nX0 Y30\nX30 Y30\nX30 Y0\n"
                "G40 X50", "sinumerik")  # fmt: skip
    assert (run.kind == MoveKind.ARC).sum() == 2 * arcs
    places = run.end_mm[run.at_feed, :2]
    meeting = np.abs(places - [-5, 35]).sum(axis=1).min()
    assert meeting == pytest.approx(0, abs=1e-9) if corner == "G451" else meeting > 1


def test_a_pointed_corner_of_g451_gets_an_arc():
    run = moves("G54 T1 D1 M6\nG0 X-20 Y0\nG1 G451 G41 X0 Y0 F100\nX0 Y30\nX10 Y0\nG40 X50",
                "sinumerik")  # fmt: skip
    assert (run.kind == MoveKind.ARC).sum() == 1


@pytest.mark.parametrize(
    ("body", "end"),
    [
        ("SCALE X2 Y3\nG0 X5 Y5", (10, 15)),
        ("TRANS X10\nASCALE X2 Y2\nG0 X5 Y5", (20, 10)),
        ("SCALE X2 Y2\nATRANS X10\nG0 X5", (30, 0)),
        ("SCALE X2 Y2\nAROT Z90\nG0 X5 Y0", (0, 10)),
        ("SCALE X2 Y2\nG91 G0 X5\nX5", (20, 0)),
        ("SCALE X2 Y2\nG0 X5\nX=IC(1)\nY=AC(2)", (12, 4)),
        ("SCALE X2 Y2\nG0 X5\nSUPA X7", (7, 0)),
        ("SCALE X2 Y2\nG0 X5\nSCALE\nG0 X6", (6, 0)),
        ("SCALE X2 Y2\nG111 X5 Y5\nG0 RP=10 AP=90", (10, 30)),
        ("SCALE X2 Y2\nASCALE X2\nG0 X1 Y1", (4, 2)),
        ("G111 RP=10 AP=90\nG0 RP=5 AP=0", (5, 10)),
    ],
)
def test_scales_and_poles_of_sinumerik(body, end):
    assert moves("G54 G0 X0 Y0 Z0\n" + body, "sinumerik").end_mm[-1, :2] == pytest.approx(end)


def test_arcs_are_scaled_with_their_centre_or_radius():
    for words in ("I10 J0", "CR=10", "AR=180", "I=AC(20) J=AC(0)"):
        run = moves(f"G54 G0 X10 Y0\nSCALE X2 Y2\nG0 X10\nG2 X30 Y0 {words} F100", "sinumerik")
        assert run.centre_mm[-1, :2] == pytest.approx([40, 0])
    with pytest.raises(ProgramError, match="an arc with scale factors 2 and 3"):
        moves("G54 G0 X10 Y0\nSCALE X2 Y3\nG2 X30 Y0 I10 J0 F100", "sinumerik")


@pytest.mark.parametrize(
    ("block", "end"),
    [
        ("G3 I0 J10 AR=90", (10, 10)),
        ("G2 X10 Y10 AR=90", (10, 10)),
        ("G2 I-10 J0 AR=180", (-20, 0)),
    ],
)
def test_an_arc_by_its_opening_angle(block, end):
    run = moves(f"G54 G0 X0 Y0\n{block} F100", "sinumerik")
    assert run.end_mm[-1, :2] == pytest.approx(end, abs=1e-9)
    assert math.degrees(abs(run.sweep_rad[-1])) == pytest.approx(180 if "180" in block else 90)
