"""Sinumerik as its manuals state it, computed by hand.

SINUMERIK 840D sl/828D Programming Manuals Fundamentals, Job Planning and Cycles: AC and IC, frames,
poles, tool radius compensation (NORM, G450), variables, program jumps and loops, drilling cycles.
"""

import math

import numpy as np
import pytest

from gcode import ControlSettings, ProgramError, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}


def read(body, **options):
    options = {"dialect": "sinumerik", "tools": TOOLS, "home_mm": (0, 0, 0)} | options
    return read_program(Source(f"{body}\nM30\n".encode(), "part.mpf"), **options)


def places(body, **options):
    """Ends of the moves, X Y Z."""
    moves = read(body, **options).moves
    moved = np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9
    return np.round(moves.end_mm[moved], 6).tolist()


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("2+3*4", 14), ("(2+3)*4", 20), ("SIN(30)*10", 5), ("POT(3)", 9), ("SQRT(16)", 4),
        ("7 DIV 2", 3), ("7 MOD 4", 3), ("ATAN2(30,80)", 20.5560452196), ("ABS(-4)", 4),
        ("TRUNC(3.9)", 3), ("R2/4", 5), ("R[1+1]", 20), ("DEPTH*2", 6), ("-R2+25", 5),
    ],
)  # fmt: skip
def test_expressions(expression, value):
    body = f"DEF REAL DEPTH=3\nR2=20\nG0 X={expression}"
    assert read(body).moves.end_mm[-1, 0] == pytest.approx(value)


def test_absolute_and_incremental_words():
    assert places("G90 G0 X10 Y10\nX=IC(5) Y20\nG91 X=AC(3) Y1") == [
        [10, 10, 0], [15, 20, 0], [3, 21, 0]]  # fmt: skip
    moves = read("G0 X10 Y0\nG3 X0 Y10 I=AC(0) J=AC(0) F100").moves
    assert moves.sweep_rad[-1] == pytest.approx(np.pi / 2)


def test_frames():
    body = "TRANS X10 Y5\nG0 X1 Y1\nATRANS X10\nX2 Y2\nTRANS X1\nX0 Y0\nTRANS\nX3 Y3"
    assert [p[:2] for p in places(body)] == [[11, 6], [22, 7], [1, 0], [3, 3]]


def test_poles():
    body = "G111 X10 Y10\nG0 AP=0 RP=5\nG1 AP=90 F100\nG3 AP=180 CR=5\nG110 X-1\nG0 AP=0 RP=9"
    found = [p[:2] for p in places(body)]
    assert found == [[15, 10], [10, 15], [5, 10], [13, 10]]


# 6FC5398-4DP10-0BA1 (808D), page 76, and 6FC5298-7AB00-0BP1 (840D), page 4-29: the pole is the
# circle's centre
@pytest.mark.parametrize(
    ("body", "pole", "end_deg", "sweep_deg"),
    [("G0 X30 Y40\nG111 X40 Y33\nG2 RP=12.207 AP=21 F500", (40, 33), 21, -124.008),
     ("G0 X67.5 Y80.211\nG111 X50 Y50\nG3 RP=34.913 AP=200.052 F500", (50, 50), 200.052, 140.133),
     ("G0 X10 Y0\nG111 X0 Y0\nG3 AP=90 F500\nAP=200.052", (0, 0), 200.052, 110.052),
     ("G0 X10 Y0\nG111 X0 Y0\nG91 G2 AP=-90 Z-5 TURN=1 F500", (0, 0), -90, -450.0)],
)  # fmt: skip
def test_arcs_about_the_pole(body, pole, end_deg, sweep_deg):
    moves = read(body).moves
    assert np.allclose(moves.centre_mm[-1, :2], pole, atol=1e-3)
    out = moves.end_mm[-1, :2] - pole
    assert math.degrees(math.atan2(out[1], out[0])) % 360 == pytest.approx(end_deg % 360)
    assert math.degrees(moves.sweep_rad[-1]) == pytest.approx(sweep_deg, abs=0.01)


def test_arcs_about_the_pole_in_another_plane():
    moves = read("G18 G0 X0 Z10\nG111 X0 Z0\nG3 AP=90 RP=10 F500").moves
    assert moves.end_mm[-1] == pytest.approx([10.0, 0.0, 0.0])
    assert np.allclose(moves.centre_mm[-1], [0.0, 0.0, 0.0])


def test_compensation_is_square_at_its_ends_and_round_outside():
    body = "T1 D1 M6\nG0 X-30 Y0\nG1 G41 X0 Y0 F200\nY40\nX40\nY-20\nG40 X-60"
    moves = read(body).moves
    ends = np.round(moves.end_mm[-7:, :2], 6).tolist()
    assert ends == [[-5, 0], [-5, 40], [0, 45], [40, 45], [45, 40], [45, -20], [-60, -20]]


JUMPS = {
    "GOTOB": ("R1=0\nAGAIN: R1=R1+1\nG0 X=R1\nIF R1<3 GOTOB AGAIN\nY7", [[1], [2], [3]]),
    "GOTOF": ("GOTOF SKIP\nG0 X99\nSKIP: G0 X5", [[5]]),
    "WHILE": ("R1=0\nWHILE R1<2\nR1=R1+1\nG0 X=R1\nENDWHILE", [[1], [2]]),
    "FOR": ("DEF INT K\nFOR K=1 TO 3\nG0 X=K*10\nENDFOR", [[10], [20], [30]]),
    "nested FOR": ("FOR R1=1 TO 2\nFOR R2=1 TO 2\nG0 X=R1*10+R2\nENDFOR\nENDFOR",
                   [[11], [12], [21], [22]]),
    "REPEAT": ("R1=0\nREPEAT\nR1=R1+1\nG0 X=R1\nUNTIL R1>=2", [[1], [2]]),
    # "Program section repetition", fourth form: from the label to the block of ENDLABEL
    "REPEAT to ENDLABEL": ("G91 G0\nA1: X10\nENDLABEL: X1\nX100\nREPEAT A1 P=2\nX1000",
                           [[10], [11], [111], [121], [122], [132], [133], [1133]]),
    "LOOP": ("R1=0\nLOOP\nR1=R1+1\nG0 X=R1\nIF R1==2 GOTOF OUT\nENDLOOP\nOUT: G0 X9",
             [[1], [2], [9]]),
    "IF ELSE": ("R1=5\nIF R1>9\nG0 X1\nELSE\nG0 X2\nENDIF\nIF R1<9\nG0 X3\nELSE\nG0 X4\nENDIF",
                [[2], [3]]),
}  # fmt: skip


@pytest.mark.parametrize("name", JUMPS)
def test_jumps_and_loops(name):
    body, expected = JUMPS[name]
    found = [p[:1] for p in places(body)]
    assert found[: len(expected)] == expected


def test_endless_loop():
    with pytest.raises(ProgramError, match="loop without end"):
        read("WHILE TRUE\nG0 X1\nX0\nENDWHILE")


def test_modal_drilling_and_patterns():
    body = ("G0 X0 Y0 Z50\nF200\nMCALL CYCLE82(20,0,2,-15,,0.5)\nX10 Y0\nX20\nMCALL\nX30\n"
            "MCALL CYCLE81(20,0,2,,5)\nHOLES2(100,0,10,90,0,2)\nMCALL")  # fmt: skip
    found = places(body)
    assert [p for p in found if p[2] == -15] == [[10, 0, -15], [20, 0, -15]]
    assert [p for p in found if p[2] == -5] == [[100, 10, -5], [100, -10, -5]]
    moves = read(body).moves
    assert moves.duration_s[moves.kind == 3].sum() == pytest.approx(1.0)


def test_pecks():
    body = "G0 X0 Y0 Z50\nF200\nCYCLE83(20,0,2,-10,,-4,,0,0,0,1,1)"
    assert [p[2] for p in places(body)] == [50, 2, -4, 2, -3.4, -7, 2, -6.4, -10, 20]


def test_block_skip():
    body = "G0 X1\n/X2\n/2 X3"
    assert places(body)[-1][0] == 3
    assert places(body, control=ControlSettings(block_delete=True))[-1][0] == 1


# Job Planning, "Modal subprogram call (MCALL)": behind every block with a path motion
MODAL = """%_N_M_MPF
G17 G90 G54 G0 X0 Y0 Z10 F100
MCALL {call}
{moves}
MCALL
G0 X90
M30
%_N_L70_SPF
PROC L70(REAL D=5)
G91 G1 Z=-D
G0 Z=D
G90
M17
"""


@pytest.mark.parametrize(
    ("call", "depth"), [("L70", 5.0), ("L70(5)", 5.0), ("L70(7)", 7.0), ("L70()", 5.0)]
)
@pytest.mark.parametrize(
    ("moves", "places"),
    [("X10\nR1=3\nX20 Y5", [[10, 0], [20, 5]]),
     ("HOLES1(1,2,0,10,10,3)", [[11, 2], [21, 2], [31, 2]]),
     ("HOLES2(0,0,10,0,90,4)\nX50", [[10, 0], [0, 10], [-10, 0], [0, -10], [50, -10]])],
)  # fmt: skip
def test_a_subprogram_is_called_behind_every_move(call, depth, moves, places):
    text = MODAL.format(call=call, moves=moves)
    found = read_program(Source(text.encode(), "part.mpf"), dialect="sinumerik").moves
    fed = found.end_mm[found.at_feed]
    assert np.allclose(fed, [[*place, 10.0 - depth] for place in places])
    assert found.end_mm[-1, 0] == 90.0


# The control's own HOLES1, HOLES2, CYCLE801 (4.000, V06.02.09): FDIS, DBH, RAD, DIS1 and DIS2 are
# taken without their signs; INDA keeps its own.
@pytest.mark.parametrize(
    ("pattern", "holes"),
    [("HOLES1(1,2,90,-10,-5,2)", [[1, 12], [1, 17]]),
     ("HOLES2(0,0,-10,0,-90,2)", [[10, 0], [0, -10]]),
     ("CYCLE801(0,0,0,-10,-20,2,2)", [[0, 0], [10, 0], [10, 20], [0, 20]])],
)  # fmt: skip
def test_distances_of_patterns_have_no_sign(pattern, holes):
    moves = read(f"F100\nMCALL CYCLE81(10,0,2,-3)\n{pattern}\nMCALL").moves
    assert moves.end_mm[moves.at_feed][:, :2] == pytest.approx(np.array(holes))


# The control's own CYCLE83 and CYCLE84 keep $P_F and give it back at their end.
@pytest.mark.parametrize(
    "cycle",
    ["CYCLE84(10,0,2,-5,,0,3,,1.5,0,300,400)", "CYCLE840(10,0,2,-5,,0,0,3,0,,1)",
     "CYCLE85(10,0,2,-5,,0,80,200)", "CYCLE83(10,0,2,-5,,-5,,0,0,0,0.5,0)"],
)  # fmt: skip
@pytest.mark.parametrize(("units", "unit_mm"), [("G71", 1.0), ("G70", 1.0), ("G700", 25.4)])
def test_the_feed_behind_a_cycle_is_the_one_before_it(cycle, units, unit_mm):
    moves = read(f"{units} S500 M3\nG0 X0 Y0 Z20 F120\n{cycle}\nG1 X10").moves
    assert moves.feed_mm_per_min[-1] == pytest.approx(120 * unit_mm)


def test_a_pattern_with_a_subprogram_that_fails_is_told_by_its_line():
    text = MODAL.format(call="L70", moves="HOLES1(1,2,0,10,10,3)").replace("G91 G1", "G91 G1 Q=5")
    with pytest.raises(ProgramError, match=r"part.mpf:(4|10):"):
        read_program(Source(text.encode(), "part.mpf"), dialect="sinumerik")


# SINUMERIK, Cycles: G functions that are active before a cycle is called remain active beyond it
@pytest.mark.parametrize("call", ["L70", "CYCLE81(10,0,2,-5)"])
@pytest.mark.parametrize("pattern", ["HOLES1(0,0,0,10,10,2)", "CYCLE801(0,0,0,10,10,2,1)"])
def test_modes_stay_behind_a_pattern(call, pattern):
    text = MODAL.format(call=f"{call}\nG91 G1", moves=f"{pattern}\nMCALL\nX5")
    found = read_program(Source(text.encode(), "part.mpf"), dialect="sinumerik").moves
    assert found.end_mm[-2] == pytest.approx([found.end_mm[-3, 0] + 5.0, 0.0, 10.0])
    assert found.at_feed[-2]
