"""Clock against closed forms of constant and trapezoidal speed."""

import numpy as np
import pytest

from gcode import MachineLimits, MoveKind, ProgramError, Source, ToolEntry, read_program

HOME = (0.0, 0.0, 0.0)


def moves(text, home_mm=HOME, tools=None, **limits):
    limits = MachineLimits(**{"rapid_mm_per_min": 6000.0, **limits})
    return read_program(Source(text.encode()), limits=limits, home_mm=home_mm, tools=tools).moves


def test_infinite_acceleration_takes_length_over_feed():
    m = moves("G21\nG0 X30 Y40\nG1 X30 Y100 F600\nG2 X30 Y120 I0 J10\nG4 P2.5\nM2\n")
    arc = np.pi * 10.0
    assert m.duration_s == pytest.approx([0.5, 6.0, arc / 10.0, 2.5])
    assert m.start_s == pytest.approx(np.concatenate(([0.0], np.cumsum(m.duration_s)[:-1])))


def test_tool_change_takes_its_time_and_stands_still():
    m = moves("T1 M6\nG0 X10\nM2\n", tool_change_s=8.0, tools={1: ToolEntry(100.0)})
    assert m.kind[0] == MoveKind.DWELL
    assert m.duration_s[0] == 8.0
    assert (m.start_mm[0] == m.end_mm[0]).all()
    assert m.tool.tolist() == [1, 1]


def test_unknown_start_makes_the_first_positioning_free():
    m = moves("G0 X300 Y400 Z50\nG1 Z0 F600\nM2\n", home_mm=None)
    assert m.duration_s == pytest.approx([0.0, 5.0])
    assert (m.start_mm[0] == [300.0, 400.0, 50.0]).all()


def test_feed_modes_agree():
    per_minute = moves("F300\nG1 X30\nM2\n")
    inverse = moves("G93 G1 X30 F10\nM2\n")
    per_turn = moves("G95 S1500 M3 F.2\nG1 X30\nM2\n")
    for other in (inverse, per_turn):
        assert other.duration_s == pytest.approx(per_minute.duration_s)


@pytest.mark.parametrize("arc", ["G2 X10 Y0", "G3 X10 Y0", "G2 X0 Y-10", "G3 X0 Y-10"])
@pytest.mark.parametrize("turns", [1, 2, 4])
def test_a_helix_in_inverse_time_takes_the_time_that_it_says(arc, turns):
    m = moves(f"G0 X10\nG93 {arc} Z-5 I-10 P{turns} F2\nM2\n")
    assert m.duration_s[1] == pytest.approx(30.0)


def test_rotary_axes_alone_move_in_degrees():
    m = moves("G1 A90 F180\nG1 X10 A0 F100\nM2\n")
    assert m.duration_s == pytest.approx([30.0, 6.0])


def test_one_move_is_a_trapezoid():
    m = moves("G61.1\nG1 X100 F6000\nM2\n", acceleration_mm_per_s2=1000.0)
    assert m.duration_s == pytest.approx([1.0 + 0.1])


def test_a_short_move_is_a_triangle():
    m = moves("G61.1\nG1 X4 F60000\nM2\n", acceleration_mm_per_s2=1000.0)
    assert m.duration_s == pytest.approx([2.0 * np.sqrt(4.0 / 1000.0)])


def test_tangent_moves_run_through_and_exact_stop_stops():
    through = moves("F6000\nG1 X50\nX100\nM2\n", acceleration_mm_per_s2=1000.0)
    stopped = moves("G61.1\nF6000\nG1 X50\nX100\nM2\n", acceleration_mm_per_s2=1000.0)
    assert through.duration_s.sum() == pytest.approx(1.1)
    assert stopped.duration_s.sum() == pytest.approx(1.2)
    assert stopped.exact_stop.all() and not through.exact_stop.any()


@pytest.mark.parametrize(("turn", "way"), [("G3", 1.0), ("G2", -1.0)])
def test_a_helix_runs_through_where_a_line_goes_on_as_it_ends(turn, way):
    """A turn of 20 mm radius that rises 10 mm ends along (0, 2 pi 20, 10)."""
    ahead = np.array([0.0, way * 40.0 * np.pi, 10.0])
    after = np.array([20.0, 0.0, 10.0]) + ahead / 2.0
    before = np.array([20.0, 0.0, 0.0]) - ahead / 2.0
    start, end = (f"X20 Y{y:.6f} Z{z:.6f}" for _, y, z in (before, after))
    text = f"G61\nG0 {start}\nG1 X20 Y0 Z0 F6000\n{turn} X20 Y0 Z10 I-20\nG1 {end}\nM2\n"
    m = moves(text, acceleration_mm_per_s2=1000.0)
    length = 2.0 * np.linalg.norm(ahead)
    assert m.duration_s[1:].sum() == pytest.approx(length / 100.0 + 0.1, rel=1e-6)
    leaning = text.replace(end, f"X20 Y{after[1]:.6f} Z{20.0 - after[2]:.6f}")  # goes down again
    slower = moves(leaning, acceleration_mm_per_s2=1000.0)
    assert slower.duration_s[1:].sum() == pytest.approx(length / 100.0 + 0.2, rel=1e-6)


def test_exact_path_stops_at_corners_only():
    m = moves("G61\nF6000\nG1 X50\nX100\nY100\nM2\n", acceleration_mm_per_s2=1000.0)
    assert m.duration_s.sum() == pytest.approx(1.1 + 1.1)


def test_blending_costs_less_than_stopping_and_more_than_running_through():
    corner = "F6000\nG1 X100\nY100\nM2\n"
    limits = {"acceleration_mm_per_s2": 1000.0}
    blended = moves(corner, corner_tolerance_mm=0.05, **limits).duration_s.sum()
    assert 2.1 < blended < 2.2
    speed = np.sqrt(1000.0 * 0.05 * np.sqrt(0.5) / (1.0 - np.sqrt(0.5)))
    slower = (100.0 - speed) ** 2 / (1000.0 * 100.0)  # lost at each side of the corner
    assert blended == pytest.approx(2.1 + slower)


def test_p_of_g64_is_the_corner_tolerance():
    limits = {"acceleration_mm_per_s2": 1000.0}
    corner = "F6000\nG1 X100\nY100\nM2\n"
    by_word = moves("G20 G64 P.002\nG21\n" + corner, **limits).duration_s
    by_limit = moves(corner, corner_tolerance_mm=0.0508, **limits).duration_s
    assert by_word == pytest.approx(by_limit)


def test_centripetal_acceleration_limits_small_arcs():
    m = moves("F6000\nG2 X0 Y0 I2\nM2\n", acceleration_mm_per_s2=1000.0)
    speed = np.sqrt(1000.0 * 2.0)
    length = 4.0 * np.pi
    assert m.duration_s == pytest.approx([length / speed + speed / 1000.0])


def test_acceleration_never_makes_a_program_faster():
    text = "F3000\nG1 X5 Y2\nX9\nG3 X5 Y6 R4\nG0 Z20\nG1 Y0\nX-3 Y-3\nM2\n"
    slow = moves(text, acceleration_mm_per_s2=500.0).duration_s
    fast = moves(text).duration_s
    assert (slow >= fast - 1e-12).all()
    assert moves(text, acceleration_mm_per_s2=1e12).duration_s == pytest.approx(fast, abs=1e-4)


def test_a_move_without_speed_is_refused_by_the_clock():
    program = read_program(Source(b"M3 G0 Z5\nG33 Z-5 K1\nM2\n", "part.nc"))
    with pytest.raises(ProgramError, match=r"part\.nc:2: move with feed zero"):
        _ = program.moves


def test_the_tapers_of_a_thread_take_as_many_turns_as_it_is_long():
    """Z keeps the pitch while X moves too: two turns for a taper of 2 mm at a pitch of 1 mm."""
    m = moves("G18 S600 M3\nG0 X20 Z0\nG76 P1 Z-20 I-2 J1.5 K3 E2 L3\nM2\n", rapid_mm_per_min=1e9)
    moved = m.end_mm - m.start_mm
    tapers = (np.abs(moved[:, 0]) == 3.0) & (np.abs(moved[:, 2]) == 2.0)
    straight = (moved[:, 0] == 0.0) & (np.abs(moved[:, 2]) > 10.0) & (m.kind == MoveKind.LINE)
    assert tapers.sum() > straight.sum() > 0
    assert m.duration_s[tapers] == pytest.approx(np.full(tapers.sum(), 0.2))
    assert m.duration_s[straight] == pytest.approx(np.abs(moved[straight, 2]) / 10.0)
