"""SINUMERIK's CYCLE72: the wall beside a contour, its levels, feeds, approaches; by hand.

NC Programming 6FC5398-2EP40-0BA0, page 1053.
"""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from tests.oracle.test_klartext_cycles import tip

TOOLS = {1: ToolEntry(100.0, 10.0)}
#: up at x = 10, a quarter round 30, 50, on at y = 70; then where the label's block stands
CONTOUR = "G1 X10 Y10\nY50\nG2 X30 Y70 CR=20\nG1 X60"


def read(call, tail=f"%_N_SIDE_SPF\n{CONTOUR}\nM17\n"):
    text = f"T1 M6\nG0 X0 Y0 Z50\n{call}\nM30\n{tail}"
    return read_program(Source(text.encode(), "a.mpf"), tools=TOOLS, dialect="sinumerik",
                        home_mm=(0, 0, 300))  # fmt: skip


def apart(places):
    """Distance from the contour, its left side above zero."""
    x, y = places[:, 0], places[:, 1]
    line = np.where(x > 30, y - 70, 10 - x)
    return np.where((x < 30) & (y > 50), np.hypot(x - 30, y - 50) - 20, line)


@pytest.mark.parametrize(("side", "sign"), [(41, 1), (42, -1)])
@pytest.mark.parametrize(("kind", "wall", "levels"), [(1, 6.0, [-2.75, -5.5]), (2, 5.0, [-3, -6])])
def test_wall_and_levels(side, sign, kind, wall, levels):
    """Infeeds of at most 3 to 6, roughing leaves 1 at the wall and 0.5 at the floor."""
    program = read(f'CYCLE72("SIDE",20,0,2,-6,3,1,0.5,300,100,{kind},{side},2,4,,2,4)')
    places = tip(program)
    along = (places[:, 1] > 10.5) & (places[:, 0] < 59.5) & (places[:, 2] < 0)
    assert sorted(set(np.round(places[along, 2], 6))) == sorted(levels)
    inner = along & (np.abs(apart(places)) < 9) & (places[:, 1] < 75 if sign < 0 else along)
    assert apart(places[inner]) == pytest.approx(np.full(inner.sum(), sign * wall), abs=1e-9)
    moves = program.moves
    assert moves.end_mm[-1, 2] == pytest.approx(120)
    down = (moves.end_mm - moves.start_mm)[:, 2] < 0
    assert set(moves.feed_mm_per_min[moves.at_feed & down]) == {100.0}
    assert set(moves.feed_mm_per_min[moves.at_feed & ~down]) == {300.0}


@pytest.mark.parametrize(
    ("approach", "start", "end"),
    [(1, (5, 2), (68, 75)), (2, (-3, 2), (68, 83)), (3, (-11, 10), (60, 91))],
)
def test_approach_and_retraction(approach, start, end):
    """8 before the wall on a line, a quarter or half of a circle; the same behind it."""
    program = read(f'CYCLE72("SIDE",20,0,2,-6,,,,300,100,2,41,{approach},8)')
    moves = program.moves
    low = np.abs(moves.end_mm[:, 2] - 94) < 1e-9
    assert moves.end_mm[low][0, :2] == pytest.approx(start)
    assert moves.end_mm[low][-1, :2] == pytest.approx(end)


def test_between_labels_and_on_the_contour():
    tail = "AA: G0 X10 Y10\nX50\nBB: Y40\n"
    places = tip(read('CYCLE72("AA:BB",20,0,2,-6,,,,300,100,2,40,1,3)', tail))
    low = places[np.abs(places[:, 2] + 6) < 1e-9, :2]
    on_first = np.abs(low[:, 1] - 10) < 1e-9
    assert (on_first | (np.abs(low[:, 0] - 50) < 1e-9)).all()
    assert low.min(axis=0) == pytest.approx([7, 10]) and low.max(axis=0) == pytest.approx([50, 43])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ('CYCLE72("NONE",20,0,2,-6,,,,300,100,2,41,1,3)', "subprograms NONE"),
        ('CYCLE72("SIDE",20,0,2,-6,,,,300,100,5,41,1,3)', "VARI 5"),
        ('CYCLE72("SIDE",20,0,2,-6,,,,300,100,2,43,1,3)', "RL 43"),
        ('CYCLE72("SIDE",20,0,2,-6,,,,300,100,2,40,2,3)', "AS1 or AS2 2"),
        ('CYCLE72("SIDE",20,0,2,-6)', "without FFP1"),
    ],
)
def test_refusals(call, message):
    with pytest.raises(ProgramError, match=message) as error:
        read(call)
    assert error.value.line == 3
