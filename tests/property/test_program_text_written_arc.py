"""The rounded centre of an arc against all that are near, found by plain arithmetic."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode import ArcTolerance
from vmach.program_text.blocks.written_arc import CENTRE, LINE, fit_arc

STEP = 1e-3
turn = st.floats(0.2, 2.8)
off = st.tuples(*[st.floats(-4e-4, 4e-4)] * 4)


def swept(centre, first, last):
    """Angle from one point to another, counter-clockwise."""
    angles = [math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (first, last)]
    return (angles[1] - angles[0]) % (2.0 * math.pi)


def badness(centre, wanted, start, stop):
    """Farthest of three places from the wanted circle, or half the difference of the radii."""
    (x, y), radius = wanted
    first, last = math.dist(centre, start), math.dist(centre, stop)
    begin = math.atan2(start[1] - centre[1], start[0] - centre[0])
    worst = 0.5 * abs(first - last)
    for share in (0.25, 0.5, 0.75):
        angle = begin + share * swept(centre, start, stop)
        here = first + share * (last - first)
        place = centre[0] + here * math.cos(angle), centre[1] + here * math.sin(angle)
        worst = max(worst, abs(math.dist(place, (x, y)) - radius))
    return worst


@settings(max_examples=200, deadline=None)
@given(st.floats(1.0, 40.0), turn, turn, off, st.sampled_from([1e-2, 1e-3, 5e-4]))
def test_no_centre_near_by_is_better(radius, begin, sweep, off, tolerance):
    points = [(radius * math.cos(a), radius * math.sin(a))
              for a in (begin, begin + 0.5 * sweep, begin + sweep)]  # fmt: skip
    start, stop = np.round(np.add(points[0], off[:2]), 3), np.round(np.add(points[2], off[2:]), 3)
    origin = start
    how, turns, i, j = fit_arc(np.array([*points, start, stop]), origin, STEP,
                               np.array([tolerance, 0.0, 0.00127]), False)  # fmt: skip
    near = np.round(-origin / STEP)
    centres = [
        np.add(origin, STEP * np.add(near, (a, b))) for a in range(-2, 3) for b in range(-2, 3)
    ]
    wanted = (0.0, 0.0), radius
    allowed = [c for c in centres
               if abs(math.dist(c, start) - math.dist(c, stop)) <= tolerance]  # fmt: skip
    if how == LINE:  # the sagitta is as small as what an arc would miss, or no centre is allowed
        assert not allowed or radius * (1.0 - math.cos(0.5 * sweep)) < 0.01
        return
    assert (how, turns) == (CENTRE, True)
    least = min(badness(c, wanted, start, stop) for c in allowed)
    found = badness(np.add(origin, (i, j)), wanted, start, stop)
    assert found == pytest.approx(least, abs=1e-9)


@pytest.mark.parametrize(("radius", "how"), [(0.0006, LINE), (0.0012, LINE), (0.0014, CENTRE)])
def test_an_arc_that_a_control_takes_for_none_is_a_line(radius, how):
    """LinuxCNC's RADIUS_TOLERANCE_MM, 0.00127: an arc of a smaller radius is refused."""
    points = [(radius * math.cos(a), radius * math.sin(a)) for a in (0.0, 0.7, 1.4)]
    limits = np.array(ArcTolerance(0.005, 0.005, 0.001, 100.0).limits(1.0))
    arc = np.array([*points, points[0], points[2]])
    assert fit_arc(arc, arc[0], 1e-7, limits, False)[0] == how
