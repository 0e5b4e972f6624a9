"""Klartext's milling cycles, patterns and transformations against closed forms.

TNC 640 User's Manual Cycle Programming: what the cycles leave (walls, floor), where patterns lie,
what mirror image and rotation make of a point.
"""

import itertools

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from gcode.moves.moves import MoveKind

RADIUS = 5.0
TOOLS = {1: ToolEntry(100.0, 2 * RADIUS, name="Mill_D10")}


def read(body):
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\nL Z+50 R0 FMAX M3\n{body}\nEND PGM A MM\n"
    return read_program(Source(text.encode(), "part.h"), tools=TOOLS)


def tip(program):
    """Places of the tip on every move at feed, (N, 3), arcs sampled."""
    moves, found = program.moves, []
    for i in np.flatnonzero(moves.at_feed):
        t = np.linspace(0.0, 1.0, 33)[:, None]
        places = moves.start_mm[i] + t * (moves.end_mm[i] - moves.start_mm[i])
        if moves.kind[i] == MoveKind.ARC:
            out = (moves.start_mm[i] - moves.centre_mm[i])[:2]
            angle = np.arctan2(out[1], out[0]) + t[:, 0] * moves.sweep_rad[i] * moves.axis[i, 2]
            places[:, :2] = moves.centre_mm[i, :2] + np.hypot(*out) * np.stack(
                [np.cos(angle), np.sin(angle)], axis=1
            )
        found.append(places)
    return np.concatenate(found) - [0.0, 0.0, 100.0]


def holes(program):
    """X and Y of every end of a feed along Z at the deepest level."""
    places = program.moves.end_mm[program.moves.at_feed] - [0, 0, 100]
    return places[np.abs(places[:, 2] - places[:, 2].min()) < 1e-9][:, :2]


POCKET = """CYCL DEF 251 RECTANGULAR POCKET ~
    Q215=+0 ~
    Q218=+60 ~
    Q219=+40 ~
    Q220=+8 ~
    Q368=+0.3 ~
    Q224=+{angle} ~
    Q367=+{place} ~
    Q207=+500 ~
    Q351=+1 ~
    Q201=-12 ~
    Q202=+5 ~
    Q369=+0.1 ~
    Q206=+150 ~
    Q200=+2 ~
    Q203=+3 ~
    Q204=+50 ~
    Q370=+1
L X+20 Y+10 R0 FMAX M99"""


def inside(points, centre, half, corner, angle_deg):
    """Signed distance of points to a rounded rectangle, negative inside."""
    angle = np.radians(angle_deg)
    out = points[:, :2] - centre
    along = out @ [np.cos(angle), np.sin(angle)]
    across = out @ [-np.sin(angle), np.cos(angle)]
    q = np.abs(np.stack([along, across], axis=1)) - (np.array(half) - corner)
    return np.hypot(*np.maximum(q, 0.0).T) + np.minimum(q.max(axis=1), 0.0) - corner


@pytest.mark.parametrize(("place", "aside"), [(0, (0, 0)), (1, (30, 20)), (3, (-30, -20))])
@pytest.mark.parametrize("angle", [0, 30])
def test_rectangular_pocket_leaves_its_wall_and_floor(place, aside, angle):
    places = tip(read(POCKET.format(angle=angle, place=place)))
    turn = np.radians(angle)
    centre = [20, 10] + np.array(
        [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    ) @ np.array(aside)
    distance = inside(places, centre, (30, 20), 8, angle)
    assert distance.max() == pytest.approx(-RADIUS, abs=1e-9)  # the finished wall
    assert places[:, 2].min() == pytest.approx(3 - 12)
    low = places[np.abs(places[:, 2] + 9) < 1e-9]
    grid = np.stack(np.meshgrid(np.linspace(-24, 24, 25), np.linspace(-14, 14, 15)), -1)
    floor = centre + grid.reshape(-1, 2) @ np.array(
        [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    )
    nearest = np.hypot(*(floor[:, None] - low[None, :, :2]).transpose(2, 0, 1)).min(axis=1)
    rough = places[np.abs(places[:, 2] + 8.9) < 1e-9]
    assert inside(rough, centre, (30, 20), 8, angle).max() == pytest.approx(-RADIUS - 0.3)
    assert nearest.max() < RADIUS  # nothing is left standing on the floor


def test_a_pocket_too_narrow_for_its_tool_is_refused():
    body = POCKET.format(angle=0, place=0).replace("Q219=+40", "Q219=+9")
    with pytest.raises(ProgramError, match="radius 5 is too large for 9"):
        read(body)


def test_circular_pocket_stud_slot_and_bore():
    def places(cycle, **q):
        q = {"Q200": 2, "Q201": -6, "Q203": 0, "Q204": 20, "Q206": 100, "Q207": 300, "Q202": 3} | q
        data = " ".join(f"{name}={value:+}" for name, value in q.items())
        return tip(read(f"CYCL DEF {cycle} {data}\nL X+7 Y-3 R0 FMAX M99"))

    out = np.hypot(*(places(252, Q223=30)[:, :2] - [7, -3]).T)
    assert out.max() == pytest.approx(15 - RADIUS)
    out = np.hypot(*(places(257, Q223=30, Q222=44)[:, :2] - [7, -3]).T)
    assert out.min() == pytest.approx(15 + RADIUS)
    slot = places(253, Q218=50, Q219=14, Q374=90)
    assert inside(slot, [7, -3], (25, 7), 7, 90).max() == pytest.approx(-RADIUS)
    bore = places(208, Q335=16, Q334=1.5)
    assert np.hypot(*(bore[:, :2] - [7, -3]).T).max() == pytest.approx(8 - RADIUS)
    stud = places(256, Q218=40, Q424=52, Q219=30, Q425=40, Q220=4)
    assert inside(stud, [7, -3], (20, 15), 4, 0).min() == pytest.approx(RADIUS)


DRILL = "CYCL DEF 200 Q200=+2 Q201=-15 Q206=+150 Q202=+5 Q203=+0 Q204=+20 Q211=+0 Q210=+0\n"


def test_patterns_lie_where_the_manual_says():
    circle = holes(
        read(
            DRILL + "CYCL DEF 220 Q216=+30 Q217=+70 Q244=+50 Q245=+0 Q246=+360 "
            "Q247=+0 Q241=+10 Q200=+2 Q203=+0 Q204=+100 Q301=+1"
        )
    )
    angle = np.radians(36.0 * np.arange(10))
    assert circle == pytest.approx(
        np.stack([30 + 25 * np.cos(angle), 70 + 25 * np.sin(angle)], axis=1)
    )
    lines = holes(
        read(
            DRILL + "CYCL DEF 221 Q225=+15 Q226=+15 Q237=+10 Q238=+8 Q242=+3 Q243=+2 "
            "Q224=+90 Q200=+2 Q203=+0 Q204=+50 Q301=+1"
        )
    )
    assert lines == pytest.approx(
        np.array([[15, 15], [15, 25], [15, 35], [7, 35], [7, 25], [7, 15]])
    )
    defined = holes(
        read(
            DRILL + "PATTERN DEF POS1 (X+25 Y+33.5 Z+0) "
            "ROW1 (X+0 Y+5 D+8 NUM3 ROT+0 Z+0)\nCYCL CALL PAT FMAX"
        )
    )
    assert defined == pytest.approx(np.array([[25, 33.5], [0, 5], [8, 5], [16, 5]]))


# "serves as an additional datum shift"; "in addition to the workpiece surface Q203"
@pytest.mark.parametrize(
    "call",
    ["CYCL CALL POS X+10 Y+10 Z+5 FMAX", "PATTERN DEF POS1 (X+10 Y+10 Z+5)\nCYCL CALL PAT FMAX"],
)
@pytest.mark.parametrize("surface", [0.0, 3.0, -20.0])
def test_z_of_a_place_raises_the_surface_of_the_cycle(call, surface):
    drill = f"CYCL DEF 200 DRILLING Q200=2 Q201=-8 Q206=99 Q202=8 Q203={surface} Q204=20\n"
    places = read(drill + call).moves.end_mm - [0, 0, 100]
    assert places[:, 2].min() == pytest.approx(surface + 5.0 - 8.0)
    assert places[-1, 2] == pytest.approx(surface + 5.0 + 20.0)


def test_z_of_a_place_beside_a_cycle_without_a_surface_is_refused():
    old = "CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP2\nCYCL DEF 1.2 DEPTH-9\nCYCL DEF 1.3 PECKG3\n"
    body = old + "CYCL DEF 1.4 DWELL0\nCYCL DEF 1.5 F100\nCYCL CALL POS X+1 Y+1 Z+4 FMAX"
    with pytest.raises(ProgramError, match=r"part.h:10: CYCL CALL POS with Z\+4"):
        read(body)


def test_mirror_image_rotation_and_shift():
    body = (
        "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+100\nCYCL DEF 7.2 Y+50\n"
        "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nCYCL DEF 10.0 ROTATION\n"
        "CYCL DEF 10.1 ROT+90\nL X+10 Y+0 R0 FMAX\nCC X+0 Y+0\nC X+0 Y+10 DR+ F100\n"
    )
    moves = read(body).moves
    # (10, 0) mirrored (-10, 0), turned (0, -10), shifted (100, 40)
    assert moves.start_mm[-1, :2] == pytest.approx([100, 40])
    assert moves.end_mm[-1, :2] == pytest.approx([90, 50])
    assert moves.centre_mm[-1, :2] == pytest.approx([100, 50])
    assert moves.sweep_rad[-1] * moves.axis[-1, 2] == pytest.approx(-np.pi / 2)


def test_compensation_keeps_its_side_in_a_mirrored_frame():
    body = (
        "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nL X-20 Y+0 R0 FMAX\n"
        "L X+0 Y+0 RL F100\nL X+0 Y+40\nL X-20 R0\n"
    )
    ends = read(body).moves.end_mm[:, :2]
    # left of the contour is x = -5 in the program, +5 on the machine
    assert any(end == pytest.approx([RADIUS, 40]) for end in ends)


def test_old_pecking_cycle_counts_from_where_the_tool_stands():
    body = (
        "L X+5 Y+6 R0 FMAX\nL Z+2 R0 FMAX\nCYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP -2\n"
        "CYCL DEF 1.2 DEPTH -10\nCYCL DEF 1.3 PECKG -4\nCYCL DEF 1.4 DWELL 0\n"
        "CYCL DEF 1.5 F80\nCYCL CALL M\n"
    )
    places = read(body).moves.end_mm[:, 2] - 100.0
    assert places.min() == pytest.approx(-10)
    assert sorted({round(z, 6) for z in places if z < 0}) == [-10, -8, -7.8, -4, -3.8]


def test_infeeds_shrink_by_q212_to_q205():
    body = (
        "CYCL DEF 205 Q200=+2 Q201=-30 Q206=+100 Q202=+12 Q203=+0 Q204=+20 Q212=+4 Q205=+3 "
        "Q258=+0.5 Q257=+0 Q211=+0\nL X+0 Y+0 R0 FMAX M99"
    )
    moves = read(body).moves
    down = moves.end_mm[moves.at_feed, 2] - 100.0
    assert down[down < 0] == pytest.approx([-12, -20, -24, -27, -30])


def test_deep_drilling_starts_below_the_surface_and_breaks_chips():
    """Q379: at the feed Q253 to the clearance above the start; every Q257 a way back of Q256."""
    body = (
        "CYCL DEF 205 Q200=+2 Q201=-30 Q206=+100 Q202=+12 Q203=+0 Q204=+20 Q212=+0 Q205=+3 "
        "Q258=+0.5 Q259=+0.5 Q257=+5 Q256=+0.3 Q211=+0 Q379=+6 Q253=+750\n"
        "L X+0 Y+0 R0 FMAX M99"
    )
    moves = read(body).moves
    level = moves.end_mm[:, 2] - 100.0
    first = int(np.flatnonzero(moves.at_feed)[0])
    assert level[first] == pytest.approx(-4) and moves.feed_mm_per_min[first] == 750
    assert level[first + 1 :] == pytest.approx(
        [-11, -10.7, -16, -15.7, -18, 2, -17.5, -23, -22.7, -28, -27.7, -30, 20]
    )
    # the last infeed too, which is the only one where Q202 is the whole depth
    at_once = read(body.replace("Q202=+12", "Q202=+30")).moves.end_mm[:, 2] - 100.0
    assert at_once[first + 1 :] == pytest.approx(
        [-11, -10.7, -16, -15.7, -21, -20.7, -26, -25.7, -30, 20]
    )
    drilled = first + 1 + np.flatnonzero(moves.at_feed[first + 1 :])
    assert (moves.feed_mm_per_min[drilled] == 100).all()


def test_tools_are_called_by_name():
    text = 'BEGIN PGM A MM\nTOOL CALL "MILL_D10" Z S1000\nL X+1 FMAX\nL M140 MB MAX\nEND PGM A MM\n'
    program = read_program(Source(text.encode(), "part.h"), tools=TOOLS)
    assert set(program.moves.tool.tolist()) == {1}
    with pytest.raises(ProgramError, match='no tool has the name "DRILL"'):
        read_program(Source(text.replace("MILL_D10", "DRILL").encode(), "part.h"), tools=TOOLS)


def feeds(body):
    """Ends of the moves at feed in the plane, X Y."""
    moves = read(body).moves
    moved = moves.at_feed & (np.abs(moves.end_mm - moves.start_mm)[:, :2].max(axis=1) > 1e-9)
    return np.round(moves.end_mm[moved][:, :2], 6).tolist()


SQUARE = "L X+0 Y+40\nL X+40\nL Y+0\nL X+0\n"


def test_contours_are_approached_and_left():
    # a square gone round clockwise with the tool (radius 5) on its left, from (0, 0) upwards
    body = "L X-40 Y-40 R0 FMAX\n{}\n" + SQUARE + "{}\n"
    found = feeds(body.format("APPR LT X+0 Y+0 LEN15 RL F300", "DEP LT LEN20 F300"))
    assert found[:2] == [[-5, -15], [-5, 0]]
    assert found[-2:] == [[0, -5], [-20, -5]]
    found = feeds(body.format("APPR LN X+0 Y+0 LEN15 RL F300", "DEP LN LEN20 F300"))
    assert found[:2] == [[-20, 0], [-5, 0]]
    assert found[-2:] == [[0, -5], [0, -25]]
    found = feeds(body.format("APPR CT X+0 Y+0 CCA90 R+10 RL F300", "DEP CT CCA90 R+8 F300"))
    assert found[:2] == [[-15, -10], [-5, 0]]
    assert found[-2:] == [[0, -5], [-8, -13]]


def test_an_approach_by_an_arc_and_its_tangent():
    body = "L X-40 Y-10 R0 FMAX\nAPPR LCT X+0 Y+0 R10 RL F300\n" + SQUARE + "DEP LCT X-40 Y-30 R8\n"
    moves = read(body).moves
    feed = np.flatnonzero(moves.at_feed)
    line, arc = feed[:2]
    touch, centre = moves.end_mm[line, :2], np.array([-15, 0])
    assert moves.centre_mm[arc, :2] == pytest.approx(centre)
    assert np.hypot(*(touch - centre)) == pytest.approx(10)
    assert (touch - centre) @ (touch - [-40, -10]) == pytest.approx(0, abs=1e-6)
    assert moves.end_mm[arc, :2] == pytest.approx([-5, 0])
    assert moves.end_mm[-1, :2] == pytest.approx([-40, -30])
    end, centre = moves.end_mm[feed[-2], :2], moves.centre_mm[feed[-2], :2]
    assert centre == pytest.approx([0, -13])
    assert (end - centre) @ (end - [-40, -30]) == pytest.approx(0, abs=1e-6)


def test_a_polar_approach_goes_to_the_same_point():
    body = "L X-40 Y-10 R0 FMAX\nCC X+10 Y+0\nAPPR {} R10 RL F300 M8\n{}DEP {} R8 M9\n"
    square = "LP PR+41.231056256 PA+104.036243468\nL X+40 Y+40\nL Y+0\nL X+0\n"
    polar = read(body.format("PLCT PR+10 PA+180", square, "PLCT PR+30 PA-90"))
    plain = read(body.format("LCT X+0 Y+0", SQUARE, "LCT X+10 Y-30"))
    assert polar.moves.end_mm == pytest.approx(plain.moves.end_mm, abs=1e-6)
    assert {"M8", "M9"} <= {note.word for note in polar.notes}


def test_rounding_at_an_end_of_the_compensation_is_noted():
    """TNC 406, TNC 416, page 91: RND behind the first and last block with RL is an approach."""
    square = "L X-40 Y-10 R0 FMAX\nL X+0 Y+0 RL F300\n{}" + SQUARE + "{}L X-40 Y-30 R0\n"
    for body in (square.format("RND R8\n", ""), square.format("", "RND R8\n")):
        assert any("APPR LCT" in note.meaning for note in read(body).notes)
    inside = square.format("", "").replace("L X+40\n", "L X+40\nRND R8\n")
    assert not any("APPR LCT" in note.meaning for note in read(inside).notes)


def test_a_departure_behind_a_tangent_arc():
    found = feeds(
        "L X-40 Y-10 R0 FMAX\nAPPR LN X+0 Y+0 LEN15 RL F300\nL Y+40\nCT X+20 Y+60\nDEP LT LEN10"
    )
    assert found[-2:] == [[20, 65], [30, 65]]


def test_an_approach_needs_a_contour_behind_it():
    with pytest.raises(ProgramError, match="APPR needs a line L"):
        read("L X-40 Y-10 R0 FMAX\nAPPR LT X+0 Y+0 LEN15 RL F300\nSTOP M0")
    with pytest.raises(ProgramError, match="LT without LEN"):
        read("L X-40 Y-10 R0 FMAX\nAPPR LT X+0 Y+0 RL F300\nL X+10")


def test_a_called_program_shares_q_parameters_and_has_its_own_labels(tmp_path):
    (tmp_path / "HOLE.H").write_text(
        "BEGIN PGM HOLE MM\nLBL 1\nL IZ-Q1 F100\nCALL LBL 1 REP 1\nQ2 = Q2 + 1\nEND PGM HOLE MM\n"
    )
    main = tmp_path / "main.h"
    text = (
        "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL Z+0 R0 FMAX\nQ1 = 3\nQ2 = 0\nLBL 1\n"
        "CALL PGM TNC:\\work\\HOLE.H\nCALL LBL 1 REP 1\nL X+Q2 FMAX\nEND PGM A MM\n"
    )
    main.write_text(text)
    moves = read_program(main, tools=TOOLS).moves
    assert moves.end_mm[-1].tolist() == [2, 0, 100 - 12]
    assert moves.line[moves.at_feed].tolist() == [7] * 4
    main.write_text(text.replace("HOLE.H", "OTHER.H"))
    with pytest.raises(
        ProgramError,
        match=r"main.h:7: what it calls is neither in this file nor beside it: OTHER.H",
    ):
        read_program(main, tools=TOOLS)
    (tmp_path / "HOLE.H").write_text("BEGIN PGM HOLE MM\nM128\nEND PGM HOLE MM\n")
    main.write_text(text)
    with pytest.raises(ProgramError, match=r"HOLE.H:2: M128"):
        read_program(main, tools=TOOLS)
    (tmp_path / "HOLE.H").write_text("CALL PGM HOLE.H\n")
    with pytest.raises(ProgramError, match="nested deeper"):
        read_program(main, tools=TOOLS)


@pytest.mark.parametrize(("circumscribed", "corner"), [(0, 0.0), (1, 0.0), (0, 3.0)])
def test_cycle_258_leaves_a_polygon(circumscribed, corner):
    """The mill touches every flat of a hexagon, and no place within it."""
    body = (
        f"L X+30 Y+20 R0 FMAX\nCYCL DEF 258 POLYGON STUD ~\n Q573={circumscribed} ~\n Q571=40 ~\n"
        f" Q222=50 ~\n Q572=6 ~\n Q224=+15 ~\n Q220={corner:g} ~\n Q368=0 ~\n Q207=500 ~\n"
        " Q351=1 ~\n Q201=-6 ~\n Q202=3 ~\n Q206=100 ~\n Q200=2 ~\n Q203=0 ~\n Q204=20 ~\n"
        " Q370=1 ~\n Q215=0\nCYCL CALL"
    )
    places = tip(read(body))
    flat = 20 * np.cos(np.pi / 6) if circumscribed else 20.0
    deep = places[np.abs(places[:, 2] + 6) < 1e-9, :2] - [30, 20]
    angles = np.radians(15 + 60 * np.arange(7))
    sharp = np.stack([np.cos(angles), np.sin(angles)], axis=1) * (flat - corner) / np.cos(np.pi / 6)
    share = np.linspace(0, 1, 400)[:, None]
    edge = np.concatenate([a + (b - a) * share for a, b in itertools.pairwise(sharp)])
    apart = np.hypot(*(deep[:, None] - edge[None]).transpose(2, 0, 1)) - corner
    assert apart.min() == pytest.approx(RADIUS, abs=1e-3)
    assert np.abs(apart - RADIUS).min(axis=0).max() < 0.3, "every place of the wall is touched"
    assert places[:, 2].min() == pytest.approx(-6)


@pytest.mark.parametrize(
    "q", ["Q218=4000 ~\n Q219=4000 ~\n Q202=0.01", "Q218=9e9 ~\n Q219=9e9 ~\n Q202=5"]
)
def test_a_pocket_of_too_many_rings_is_refused_at_once(q):
    body = (f"CYCL DEF 251 RECTANGULAR POCKET ~\n {q} ~\n Q207=500 ~\n Q201=-12 ~\n Q206=150 ~\n"
            " Q200=2 ~\n Q203=0 ~\n Q370=1\nCYCL CALL")  # fmt: skip
    with pytest.raises(ProgramError, match="rings or lines on"):
        read(body.replace("9e9", "999999"))


def test_blocks_of_cycles_count_as_blocks_of_a_loop():
    body = "LBL 1\nL X+1 Y+1 FMAX M99\nCALL LBL 1 REP 9000"
    drill = "CYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-9 ~\n Q206=99 ~\n Q202=0.01 ~\n Q203=0\n"
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1 F300\n{drill}{body}\nEND PGM A MM\n"
    with pytest.raises(ProgramError, match="more than 20"):
        read_program(Source(text.encode(), "a.h"), tools=TOOLS, max_blocks=20_000)


PRESET = "CYCL DEF 247 DATUM SETTING ~\n Q339=+{row} ;ROW\n"


def places(program):
    return program.moves.end_mm[1:, :2].round(9).tolist()


def test_a_preset_takes_shift_mirror_rotation_and_scaling_away():
    """Two bores at -60 and +60: the second shift counts from the preset, not from the first."""
    body = PRESET.format(row=1)
    for shift in ("IX-60", "IX+60"):
        body += f"CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 {shift}\nL X+0 Y+0 R0 FMAX\n"
        body += (
            "CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X\nCYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n"
        )
        body += "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.5\n" + PRESET.format(row=1)
    found = places(read(body + "L X+5 Y+7 R0 FMAX"))
    assert found[-3:] == [[-60.0, 0.0], [60.0, 0.0], [5.0, 7.0]]


def presets(rows, **offsets):
    body = "".join(PRESET.format(row=row) + "L X+1 Y+2 R0 FMAX\n" for row in rows)
    text = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\n{body}\nEND PGM A MM\n"
    return read_program(Source(text.encode(), "part.h"), tools=TOOLS, work_offsets_mm=offsets)


def test_several_presets_are_work_offsets_of_the_job():
    """One row is G54 whatever its number; of several, 1 to 6 are G54 to G59 and 7 is G54.1 P1."""
    program = presets((12, 12), G54=(100, 0, 0), G55=(7, 7, 7))
    assert program.moves.end_mm[-1, :2].tolist() == [101.0, 2.0]
    program = presets(
        (1, 4, 7, 1), **{"G54": (100, 0, 0), "G57": (200, 0, 0), "G54.1 P1": (9, 9, 9)}
    )
    found = program.moves.end_mm[-4:, :2].tolist()
    assert found == [[101.0, 2.0], [201.0, 2.0], [10.0, 11.0], [101.0, 2.0]]
    assert any("preset 4: G57 of the job" in note.meaning for note in program.notes)


def test_a_second_preset_that_the_text_does_not_name_is_refused():
    with pytest.raises(ProgramError, match="preset 3 behind preset 1"):
        read("Q7 = 3\n" + PRESET.format(row=1) + "CYCL DEF 247 DATUM ~\n Q339=+Q7\n")


SKIPPED = """10 TOOL CALL 1 Z S500 F200
/ 20 * - deeper
/ 21 CYCL DEF 200 DRILLING ~
    Q200=+2    ;CLEARANCE ~
    Q201=-9    ;DEPTH ~
    Q206= AUTO ;FEED ~
    Q202=+9    ;INFEED ~
    Q203=+0    ;SURFACE ~
    Q204=+20   ;SECOND CLEARANCE
/ 22 L X+0 Y+0 R0 FMAX M99
23 L X+Q204 R0 FMAX"""


def test_a_skipped_block_before_its_number_keeps_or_loses_all_its_lines():
    obeyed = read("22 Q204 = 3\n" + SKIPPED)
    assert (obeyed.moves.end_mm[:, 2] - 100).min() == -9
    assert obeyed.moves.end_mm[-1, 0] == 20
    text = f"0 BEGIN PGM A MM\n1 Q204 = 3\n{SKIPPED}\n99 END PGM A MM\n"
    left_out = read_program(Source(text.encode(), "part.h"), tools=TOOLS, block_delete=True)
    assert left_out.moves.end_mm[-1, 0] == 3


def test_a_mode_on_every_line_is_noted_once():
    program = read("L X+1 F500 M90\n" * 5)
    assert [note.word for note in program.notes].count("M90") == 1
