"""SINUMERIK's soft approach and retraction against the manual's example and closed forms.

The line or circle that a tool comes on touches its compensated path: there it has the contour's
direction, and its radius, or its length beyond the tool's radius, is DISR.
"""

import math

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(0.0, 10.0)}
CODES = {"line": ("G147", "G148"), "quadrant": ("G247", "G248"), "semicircle": ("G347", "G348")}


def read(body):
    text = f"T1 D1 M6\nG0 X0 Y0 Z30\n{body}\nM30\n"
    return read_program(
        Source(text.encode(), "part.mpf"), tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 30)
    )


def moved(body):
    """The moves that go anywhere, as rows of their record."""
    moves = read(body).moves
    rows = np.flatnonzero(np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9)
    return moves, rows


def direction(moves, row, *, at_end):
    """Unit direction in the plane at an end of a move."""
    place = (moves.end_mm if at_end else moves.start_mm)[row, :2]
    if moves.sweep_rad[row] == 0.0:
        along = (moves.end_mm - moves.start_mm)[row, :2]
    else:
        out = place - moves.centre_mm[row, :2]
        along = np.array([-out[1], out[0]]) * np.sign(moves.sweep_rad[row] * moves.axis[row, 2])
    return along / np.linalg.norm(along)


def test_the_example_of_the_manual():
    """808D, 6FC5398-4DP10-0BA1, page 121: by G0 to P1 in Z30, to P2, by FAD to P3, then F."""
    moves, rows = moved(
        "G41 G341 G247 DISCL=5 DISR=13 FAD=500 X40 Y-10 Z=0 F800\nG1 X60\nY20\nG40 X0"
    )
    # the contour runs along X, the tool 5 mm beside it at Y-5; the circle is about X40 Y8
    wanted = [[27, 8, 30], [27, 8, 5], [27, 8, 0], [40, -5, 0], [55, -5, 0]]
    assert moves.end_mm[rows][:5] == pytest.approx(np.array(wanted, dtype=float))
    assert moves.at_feed[rows][:5].tolist() == [False, False, True, True, True]
    assert moves.feed_mm_per_min[rows][2:5].tolist() == [500, 800, 800]
    assert moves.sweep_rad[rows][3] == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("plane", ["G340", "G341"])
@pytest.mark.parametrize("kind", CODES)
@pytest.mark.parametrize(("side", "begins"), [
    ("G41", "G1 X60 Y5"), ("G42", "G1 X60 Y5"), ("G41", "G3 X60 Y10 I0 J20"),
    ("G42", "G2 X60 Y-30 I0 J-20"),
])  # fmt: skip
def test_a_way_in_touches_the_compensated_contour(plane, kind, side, begins):
    moves, rows = moved(f"{side} {plane} {CODES[kind][0]} DISCL=4 DISR=7 X40 Y-10 Z-2 F800\n"
                        f"{begins}\nG1 G40 X99")  # fmt: skip
    arrives = [math.dist(place[:2], (40, -10)) == pytest.approx(5.0) for place in moves.end_mm]
    last = next(k for k in rows if arrives[k] and moves.end_mm[k, 2] == -2)
    first = next(k for k in rows if k > last)
    assert direction(moves, last, at_end=True) == pytest.approx(
        direction(moves, first, at_end=False)
    )
    assert moves.start_mm[last, 2] == (2 if plane == "G340" else -2)
    quarters = {"line": 0, "quadrant": 1, "semicircle": 2}[kind]
    assert abs(moves.sweep_rad[last]) == pytest.approx(quarters * math.pi / 2)
    reach = math.dist(moves.start_mm[last, :2], moves.end_mm[last, :2])
    assert reach == pytest.approx([12.0, 7.0 * math.sqrt(2.0), 14.0][quarters])


@pytest.mark.parametrize("plane", ["G340", "G341"])
@pytest.mark.parametrize("kind", CODES)
@pytest.mark.parametrize("side", ["G41", "G42"])
def test_the_way_out_is_the_way_in_gone_backwards(plane, kind, side):
    """A contour gone there and back, the tool on the same flank of it."""
    to, away = CODES[kind]
    other = {"G41": "G42", "G42": "G41"}[side]
    ways = []
    for body in (
        f"{side} {plane} {to} DISCL=4 DISR=7 X40 Y-10 Z-2 F800\nG1 X60 Y5\nG1 G40 X99",
        f"G0 X99 Y5\nZ-2\n{other} G1 X60 Y5 F800\nX40 Y-10\n"
        f"{plane} G40 {away} DISCL=4 DISR=7 X0 Y0 Z30",
    ):
        moves, rows = moved(body)
        line = 4 if body.startswith(side) else 7
        ways.append([(moves.start_mm[k], moves.end_mm[k]) for k in rows if moves.line[k] == line])
    there, back = ways
    assert len(there) >= 3
    points_in = np.array([there[0][0], *(end for _, end in there)])  # its last is the contour's
    points_out = np.array([back[0][0], *(end for _, end in back)])
    at = np.flatnonzero(np.abs(points_in[:, :2] - points_out[0, :2]).max(axis=1) < 1e-9)[0]
    assert points_out == pytest.approx(points_in[: at + 1][::-1], abs=1e-9)


@pytest.mark.parametrize(("body", "said"), [
    ("G41 G247 X40 Y-10 Z0 F800\nG1 X60", "G247 without DISR"),
    ("G41 G247 DISR=7 X40 Y-10 Z0 F800\nM8\nG1 X60", "without a line or arc at feed behind it"),
    ("G41 G247 DISR=7 X40 Y-10 Z0 F800\nG0 X60", "without a line or arc at feed behind it"),
    ("G41 G247 DISR=7 X40 Y-10 Z0 F800", "without a line or arc at feed behind it"),
    ("G247 DISR=7 X40 Y-10 Z0 F800\nG1 X60", "or a circle without it"),
    ("G41 G247 DISR=7 DISCL=31 X40 Y-10 Z0 F800\nG1 X60", "below its DISCL"),
    ("G41 G247 DISR=7 FAD=50 X40 Y-10 Z0 F800\nG1 X60", "with FAD and G340"),
    ("G41 G142 G247 DISR=7 X40 Y-10 Z0 F800\nG1 X60", "with G142"),
    ("G1 X1 DISR=7 F800", "without a soft approach"),
    ("G1 G41 X9 F800\nX20\nG248 DISR=7 X40 Y0 Z9", "where it ends cutter compensation"),
    ("G18 G41 G247 DISR=7 X40 Y-10 Z0 F800\nG1 X60", "G247 beside G18"),
])  # fmt: skip
def test_what_no_source_states_is_refused(body, said):
    with pytest.raises(ProgramError, match=said):
        read(body)
