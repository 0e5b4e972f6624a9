"""Klartext's thread milling cycles 262, 265 and 267: radius, pitch, sense, turns and feed.

TNC 426/430 User's Manual, "Cycles for drilling, tapping and thread milling": the radius of the
helix, which way right-hand and left-hand threads are milled, and that the feed is that of the edge.
Numbers computed by hand.
"""

import numpy as np
import pytest

from gcode import Source, ToolEntry, read_program
from gcode.moves.moves import MoveKind

TOOLS = {1: ToolEntry(0.0, 6.0)}
HEAD = "BEGIN PGM A MM\nTOOL CALL 1 Z S2000 F300\nL X+50 Y+50 Z+50 R0 FMAX M3\n"
#: nominal diameter 16: the axis is on 8 - 3 in a hole and on 8 + 3 round a stud
IN_HOLE, ROUND_STUD = 5.0, 11.0


def helix(cycle, pitch, depth, *, climb=1, turns_a_helix=0):
    body = (
        f"CYCL DEF {cycle} THREAD ~\n Q335=16 ~\n Q239={pitch:+g} ~\n Q201={depth:g} ~\n"
        f" Q355={turns_a_helix} ~\n Q253=750 ~\n Q351={climb:+d} ~\n Q200=2 ~\n Q358=+0 ~\n"
        " Q359=+0 ~\n Q360=0 ~\n Q203=+0 ~\n Q204=50 ~\n Q254=150 ~\n Q207=500\n"
        "CYCL CALL\nEND PGM A MM\n"
    )
    program = read_program(Source((HEAD + body).encode(), "a.h"), tools=TOOLS, home_mm=(0, 0, 90))
    moves = program.moves
    assert moves.end_mm[-1] == pytest.approx([50, 50, 50]), "back above the thread's axis"
    found = []
    for i in np.flatnonzero((moves.kind == MoveKind.ARC) & (np.abs(moves.sweep_rad) > 6.0)):
        assert moves.centre_mm[i, :2] == pytest.approx([50, 50])
        found.append(
            (
                np.hypot(*(moves.start_mm[i] - moves.centre_mm[i])[:2]),
                moves.sweep_rad[i] * moves.axis[i, 2] / (2 * np.pi),
                moves.start_mm[i, 2],
                moves.end_mm[i, 2],
                moves.feed_mm_per_min[i],
            )
        )
    return found


@pytest.mark.parametrize(
    ("pitch", "climb", "turns", "begin", "end"),
    [(1.5, 1, 1, -20, -18.5), (-1.5, -1, -1, -20, -18.5), (1.5, -1, -1, -18.5, -20),
     (-1.5, 1, 1, -18.5, -20)],
)  # fmt: skip
def test_262_in_a_hole(pitch, climb, turns, begin, end):
    feed = 500 * IN_HOLE / 8
    assert helix(262, pitch, -20, climb=climb) == [
        pytest.approx((IN_HOLE, turns, begin, end, feed))
    ]


def test_262_in_one_helix_and_in_several():
    """Q355 = 1: 14 turns of 1.5 cover 20; Q355 = 3: one turn every 4.5, the last one ends at 20."""
    assert helix(262, 1.5, -20, turns_a_helix=1)[0][1:4] == pytest.approx((14, -20, 1))
    several = helix(262, 1.5, -20, climb=-1, turns_a_helix=3)
    assert [h[3] for h in several] == pytest.approx([-2, -6.5, -11, -15.5, -20])


@pytest.mark.parametrize(
    ("pitch", "climb", "turns", "begin", "end"),
    [(1.5, 1, -1, -18.5, -20), (1.5, -1, 1, -20, -18.5), (-1.5, 1, -1, -20, -18.5),
     (-1.5, -1, 1, -18.5, -20)],
)  # fmt: skip
def test_267_round_a_stud(pitch, climb, turns, begin, end):
    feed = 500 * ROUND_STUD / 8
    assert helix(267, pitch, -20, climb=climb) == [
        pytest.approx((ROUND_STUD, turns, begin, end, feed))
    ]


@pytest.mark.parametrize(("pitch", "turns"), [(1.5, -11), (-1.5, 11)])
def test_265_goes_down_on_one_helix(pitch, turns):
    """16 deep at 1.5 a turn: 11 turns, from 0.5 above the surface."""
    feed = 500 * IN_HOLE / 8
    assert helix(265, pitch, -16) == [pytest.approx((IN_HOLE, turns, 0.5, -16, feed))]
