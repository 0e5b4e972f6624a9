"""Klartext's contour pockets, threads, curved slots and back boring against closed forms.

HEIDENHAIN User's Manuals, Cycle Programming: what the cycles leave is told by walls, floor, radius
and lead; distances to them are computed here from the contours themselves.
"""

import math

import numpy as np
import pytest
from scipy.spatial import KDTree

from gcode import ProgramError, Source, ToolEntry, read_program
from gcode.geometry.regions import Stretch, polyline
from gcode.moves.moves import MoveKind

RADIUS = 5.0
TOOLS = {1: ToolEntry(100.0, 2 * RADIUS), 2: ToolEntry(100.0, 4.0)}
STEP_MM = 1.1e-3  #: two chords of half a micrometre


def read(body):
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\nL Z+50 R0 FMAX M3\n{body}\nEND PGM A MM\n"
    return read_program(Source(text.encode(), "part.h"), tools=TOOLS)


def cuts(program):
    """Places of the tip at feed, (N, 3), every move sampled."""
    run, found = program.moves, []
    for i in np.flatnonzero(run.at_feed):
        t = np.linspace(0.0, 1.0, 41)[:, None]
        places = run.start_mm[i] + t * (run.end_mm[i] - run.start_mm[i])
        if run.kind[i] == MoveKind.ARC:
            out = (run.start_mm[i] - run.centre_mm[i])[:2]
            angle = np.arctan2(out[1], out[0]) + t[:, 0] * run.sweep_rad[i] * run.axis[i, 2]
            places[:, :2] = run.centre_mm[i, :2] + math.hypot(*out) * np.stack(
                [np.cos(angle), np.sin(angle)], axis=1
            )
        found.append(places)
    return np.concatenate(found) - [0.0, 0.0, 100.0]


def at_level(places, level):
    return places[np.abs(places[:, 2] - level) < 1e-9][:, :2]


def definition(title, words):
    """A cycle with its parameters, one a line."""
    return f"CYCL DEF {title} ~\n" + " ~\n".join(words.split()) + "\n"


DATA = definition("20 DATA", "Q1=-20 Q2=+1 Q3=+{side} Q4=+{floor} Q5=+0 Q6=+2 Q7=+50 Q8=+0 Q9=+1")
CALL = definition("{cycle}", "Q10=-6 Q11=100 Q12=350 Q13=1 Q14=+{side}") + (
    "CYCL CALL\nL Z+99 FMAX M2\n"
)
#: a rectangle with one round corner, and a round island in it
POCKET = "LBL 1\nL X+0 Y+0 RR\nL Y+60\nRND R10\nL X+100\nL Y+0\nL X+0\nLBL 0\n"
ISLAND = "LBL 2\nCC X+50 Y+30\nL X+40 Y+30 RL\nC X+40 Y+30 DR-\nLBL 0\n"
LABELS = "CYCL DEF 14.0 CONTOUR\nCYCL DEF 14.1 CONTOUR LABEL 1 /2\n"


def contour_pocket(cycle, *, side=0.0, floor=0.0, contours=POCKET + ISLAND):
    call = CALL.format(cycle=cycle, side=side)
    return LABELS + DATA.format(side=side, floor=floor) + call + contours


def wall_distance(places):
    """Distance to the wall of pocket and island, negative in the material."""
    x, y = places.T
    inside = np.minimum.reduce([x, y, 100 - x, 60 - y])
    corner = (x < 10) & (y > 50)
    inside = np.where(corner, 10 - np.hypot(x - 10, y - 50), inside)
    return np.minimum(inside, np.hypot(x - 50, y - 30) - 10)


@pytest.mark.parametrize(
    ("cycle", "levels"), [("22 ROUGH-OUT", 4), ("23 FLOOR", 1), ("24 SIDE", 4)]
)
@pytest.mark.parametrize("side", [0.0, 0.5])
def test_contour_pockets_keep_to_their_walls(cycle, levels, side):
    places = cuts(read(contour_pocket(cycle, side=side)))
    found = np.unique(np.round(places[:, 2], 9))
    wanted = [-6, -12, -18, -20] if levels == 4 else [-20]
    assert set(wanted) <= set(found)
    for level in wanted:
        away = wall_distance(at_level(places, level))
        assert away.min() == pytest.approx(RADIUS + side, abs=STEP_MM)
        nearest = at_level(places, level)[away < RADIUS + side + STEP_MM]
        for wall in ([5 + side, 30], [95 - side, 30], [50, 5 + side], [65 + side, 30]):
            assert np.linalg.norm(nearest - wall, axis=1).min() < 2.5  # it reaches every wall


def test_roughing_leaves_nothing_on_the_floor():
    path = at_level(cuts(read(contour_pocket("22 ROUGH-OUT"))), -20)
    grid = np.stack(np.meshgrid(np.arange(1, 100, 2), np.arange(1, 60, 2)), axis=-1).reshape(-1, 2)
    inner = grid[wall_distance(grid) > RADIUS]
    assert KDTree(path).query(inner)[0].max() < RADIUS


def test_an_allowance_on_the_floor_stays():
    assert cuts(read(contour_pocket("22 ROUGH-OUT", floor=0.3)))[:, 2].min() == pytest.approx(-19.7)


def test_pockets_that_overlap_are_one():
    two = "".join(
        f"LBL {k}\nCC X+{x} Y+30\nL X+{x - 25} Y+30 RR\nC X+{x - 25} Y+30 DR-\nLBL 0\n"
        for k, x in ((1, 35), (2, 65))
    )
    places = at_level(cuts(read(contour_pocket("24 SIDE", contours=two))), -20)
    angle = np.linspace(0, math.tau, 20_001)
    circles = [
        np.stack([x + 25 * np.cos(angle), 30 + 25 * np.sin(angle)], axis=1) for x in (35, 65)
    ]
    wall = np.concatenate(
        [circles[k][np.linalg.norm(circles[k] - (65 - 30 * k, 30), axis=1) > 25] for k in (0, 1)]
    )
    away = KDTree(wall).query(places)[0]
    assert away == pytest.approx(np.full(len(away), RADIUS), abs=2e-3)


def test_pilot_holes_stand_where_roughing_plunges():
    holes = at_level(cuts(read(contour_pocket("21 PILOT"))), -20)
    plunges = at_level(cuts(read(contour_pocket("22 ROUGH-OUT"))), -20)
    for hole in np.unique(np.round(holes, 6), axis=0):
        assert np.linalg.norm(plunges - hole, axis=1).min() < 1e-5


@pytest.mark.parametrize(("side", "wall"), [("RL", RADIUS), ("RR", -RADIUS)])
def test_a_contour_train_runs_beside_its_contour(side, wall):
    body = (
        LABELS.replace(" /2", "")
        + definition("25 TRAIN", "Q1=-9 Q3=+0 Q5=+0 Q7=+20 Q10=-5 Q11=100 Q12=200 Q15=+1")
        + f"CYCL CALL\nM2\nLBL 1\nL X+0 Y+0 {side}\nL X+40\nRND R20\nL Y+60\nLBL 0\n"
    )
    places = cuts(read(body))
    deep = at_level(places, -9)
    line = deep[deep[:, 0] < 19]
    assert line[:, 1] == pytest.approx(np.full(len(line), wall), abs=1e-9)
    arc = deep[(deep[:, 0] > 20.5) & (deep[:, 1] < 19.5)]
    assert np.hypot(*(arc - [20, 20]).T) == pytest.approx(20 - wall, abs=1e-9)
    assert at_level(places, -5).shape == deep.shape


def test_a_contour_train_is_left_straight_up():
    """The rapid out of the depth does not cross the wall."""
    train = definition("25 TRAIN", "Q1=-9 Q3=+0 Q5=+0 Q7=+20 Q10=-9 Q11=100 Q12=200 Q15=+1")
    body = "CYCL CALL\nM2\nLBL 1\nL X+0 Y+0 RL\nL X+40\nL Y+60\nLBL 0\n"
    moves = read(LABELS.replace(" /2", "") + train + body).moves
    assert moves.end_mm[-1, 2] > moves.start_mm[-1, 2]
    assert moves.end_mm[-1, :2] == pytest.approx(moves.start_mm[-1, :2])


def test_contour_train_takes_its_side_from_cycle_270():
    train = definition("25 TRAIN", "Q1=-9 Q3=+0 Q5=+0 Q7=+20 Q10=-9 Q11=100 Q12=200 Q15=+1")
    contour = "CYCL CALL\nM2\nLBL 1\nL X+0 Y+0 {side}\nL X+40\nL Y+60\nLBL 0\n"
    labels = LABELS.replace(" /2", "")
    for side, word in ((1, "RL"), (2, "RR"), (0, "R0")):
        data = definition("270 DATA", f"Q390=+1 Q391=+{side} Q392=+5 Q393=+90 Q394=+0")
        here = cuts(read(labels + data + train + contour.format(side="")))
        there = cuts(read(labels + train + contour.format(side=word)))
        assert here == pytest.approx(there)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (contour_pocket("22 X", contours=POCKET), "LBL 2 does not exist"),
        (contour_pocket("22 X", contours=POCKET.replace(" RR", "") + ISLAND), "without RL or RR"),
        (contour_pocket("22 X", contours=ISLAND.replace("2", "1", 1) + ISLAND), "without a pocket"),
        (contour_pocket("22 X", side=40), "too large"),
        (LABELS + CALL.format(cycle="22 X", side=0) + POCKET + ISLAND, "CYCL DEF 20"),
        (CALL.format(cycle="22 X", side=0), "CYCL DEF 14"),
    ],
)
def test_contours_that_are_none_are_refused(body, message):
    with pytest.raises(ProgramError, match=message):
        read(body)


THREAD = (
    definition(
        "{cycle} THREAD",
        "Q335=24 Q239={pitch} Q201=-15 Q355={steps} Q253=750 Q351={climb} Q200=2 Q203=+0 Q204=50 "
        "Q207=500 Q356=-20 Q202=8 Q206=150 Q254=200 Q358={front} Q359=3",
    )
    + "L X+10 Y+20 R0 FMAX\nCYCL CALL\n"
)


def helices(run):
    """Rows of the arcs that change their level."""
    rise = (run.end_mm - run.start_mm)[:, 2]
    return np.flatnonzero((run.kind == MoveKind.ARC) & (np.abs(rise) > 1e-9)), rise


@pytest.mark.parametrize(
    ("pitch", "climb", "turn", "up"),
    [(1.5, 1, 1, True), (1.5, -1, -1, False), (-1.5, 1, 1, False), (-1.5, -1, -1, True)],
)
@pytest.mark.parametrize(("steps", "count"), [(0, 1), (1, 1), (4, 3)])
def test_threads_have_their_radius_lead_and_sense(pitch, climb, turn, up, steps, count):
    body = THREAD.format(cycle=262, pitch=pitch, climb=climb, steps=steps, front=0)
    run = read(body).moves
    rows, rise = helices(run)
    assert len(rows) == count
    out = (run.start_mm - run.centre_mm)[rows, :2]
    assert np.hypot(*out.T) == pytest.approx(12 - RADIUS)
    assert run.centre_mm[rows, :2] == pytest.approx(np.tile([10, 20], (count, 1)))
    sweep = run.sweep_rad[rows] * run.axis[rows, 2]
    assert rise[rows] / sweep * math.tau * turn == pytest.approx(abs(pitch) * (1 if up else -1))
    assert np.sign(sweep) == pytest.approx(turn)
    levels = np.concatenate([run.start_mm[rows, 2], run.end_mm[rows, 2]]) - 100
    assert levels.min() == pytest.approx(-15)
    if steps == 1:
        assert levels.max() == pytest.approx(0)
    if steps == 4:
        assert sorted({round(v, 9) for v in levels}) == pytest.approx(
            [-15, -13.5, -9, -7.5, -3, -1.5]
        )


@pytest.mark.parametrize("cycle", [263, 264])
def test_the_hole_is_sunk_or_drilled_before_the_thread(cycle):
    run = read(THREAD.format(cycle=cycle, pitch=1.5, climb=1, steps=1, front=-1)).moves
    tip = run.end_mm - [0, 0, 100]
    first = helices(run)[0][0]
    before = tip[:first][run.at_feed[:first]]
    axial = before[np.hypot(*(before[:, :2] - [10, 20]).T) < 1e-9]
    assert axial[:, 2].min() == pytest.approx(-20)
    front = before[np.abs(before[:, 2] + 1) < 1e-9]
    assert np.hypot(*(front[:, :2] - [10, 20]).T).max() == pytest.approx(3)
    if cycle == 264:
        assert set(np.round(axial[:, 2], 6)) >= {-8.0, -16.0, -20.0}


def test_a_thread_that_is_too_small_for_the_tool_is_refused():
    body = THREAD.format(cycle=262, pitch=1.5, climb=1, steps=1, front=0)
    with pytest.raises(ProgramError, match="does not mill a thread of 8"):
        read(body.replace("Q335=24", "Q335=8"))


@pytest.mark.parametrize("place", [0, 1, 2, 3])
def test_a_curved_slot_has_its_walls(place):
    """Middle radius 30, width 14, from 20 to 80 degrees; the tool stands where Q367 says."""
    middle = math.radians({0: 33, 1: 20, 2: 50, 3: 80}[place])
    body = definition(
        "254 CIRCULAR SLOT",
        f"Q215=0 Q219=14 Q368=0 Q375=60 Q367={place} Q216=0 Q217=0 Q376=20 Q248=60 Q378=0 Q377=1 "
        "Q207=500 Q351=1 Q201=-4 Q202=4 Q369=0 Q206=150 Q338=0 Q200=2 Q203=0 Q204=50",
    )
    body += f"L X{30 * math.cos(middle):+} Y{30 * math.sin(middle):+} R0 FMAX\nCYCL CALL\n"
    places = at_level(cuts(read(body)), -4)
    radius, angle = np.hypot(*places.T), np.degrees(np.arctan2(places[:, 1], places[:, 0]))
    assert radius.max() == pytest.approx(37 - RADIUS)
    middle_part = (angle > 20) & (angle < 80)
    assert radius[middle_part].min() == pytest.approx(23 + RADIUS)
    for end, outside in ((20, angle < 20), (80, angle > 80)):
        centre = 30 * np.array([math.cos(math.radians(end)), math.sin(math.radians(end))])
        assert np.hypot(*(places[outside] - centre).T).max() == pytest.approx(7 - RADIUS)


def test_curved_slots_repeat_by_their_angle():
    body = definition(
        "254 CIRCULAR SLOT",
        "Q215=0 Q219=12 Q375=60 Q367=0 Q216=0 Q217=0 Q376=0 Q248=30 Q378=120 Q377=3 Q207=500 "
        "Q201=-4 Q202=4 Q206=150 Q200=2 Q203=0 Q204=50",
    )
    body += "CYCL CALL\n"
    places = at_level(cuts(read(body)), -4)
    angle = np.degrees(np.arctan2(places[:, 1], places[:, 0])) % 360
    for middle in (15, 135, 255):
        assert (np.abs(angle - middle) < 1).any()
    assert not (np.abs(angle - 75) < 20).any()


def test_back_boring_reaches_its_counterbore_from_below():
    body = definition(
        "204 BACK BORING",
        "Q200=2 Q249=+5 Q250=20 Q251=3.5 Q252=15 Q253=750 Q254=200 Q255=0 Q203=+0 Q204=50 Q214=1 "
        "Q336=0",
    )
    body += "L X+10 Y+20 R0 FMAX\nCYCL CALL\n"
    run = read(body).moves
    tip = run.end_mm - [0, 0, 100]
    aside = np.flatnonzero(np.abs(tip[:, 0] - 6.5) < 1e-9)
    assert tip[aside, 2].min() == pytest.approx(-20 - 2 - 15)  # the tooth 2 below the lower face
    fed = np.flatnonzero(run.feed_mm_per_min == 200)
    assert tip[fed] == pytest.approx(np.array([[10, 20, -20 + 5 - 15]]))


def test_an_arc_that_needs_more_chords_than_any_part_has_is_refused():
    """Its chords once took no angle at all, and a division by zero ended the reading."""
    huge = "LBL 2\nCC X+9999999999999999999950 Y+30\nL X+40 Y+30 RL\nC X+40 Y+30 DR-\nLBL 0\n"
    body = DATA.format(side=0, floor=0) + CALL.format(cycle="24 SIDE", side=0)
    with pytest.raises(ProgramError, match=r"an arc of radius 1e\+22 in a contour"):
        read(LABELS + body + POCKET + huge)


@pytest.mark.parametrize("radius", [1e-3, 1.0, 1e4, 1e9])
def test_chords_leave_an_arc_by_no_more_than_they_may(radius):
    sweep = min(1.0, 1e3 / radius)
    places = np.array(polyline((radius, 0.0), [Stretch((0.0, 0.0), (0.0, 0.0), sweep)], 5e-4)[:-1])
    step = sweep / len(places)
    assert radius * (1.0 - math.cos(step / 2.0)) <= 5e-4 * 1.0001 or radius >= 1e9
    assert radius * step**2 / 8.0 <= 5e-4 * 1.0001  # what the cosine rounds away at 1e9
    assert len(places) <= 1.0 + sweep / (4.0 * math.sqrt(2.5e-4 / radius))
