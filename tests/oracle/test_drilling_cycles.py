"""Drilling, boring and tapping cycles of three controls, step by step as the manuals list them.

B-64484EN-2 "Canned cycle for drilling"; TNC 640 User's Manual Cycle Programming, "Fixed cycles:
drilling" and "tapping"; SINUMERIK 840D sl/828D Programming Manual Cycles, "Drilling". Each row has
the levels to which the tool goes; f marks a feed. The tip is 100 mm below the nose.
"""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, canon_lines, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}


def steps(text, dialect):
    """Levels of the tip behind its arrival over the hole, feeds marked."""
    program = read_program(Source(text.encode(), "part"), tools=TOOLS, dialect=dialect,
                           home_mm=(0, 0, 300))  # fmt: skip
    moves = program.moves
    over = np.flatnonzero(np.abs(moves.start_mm[:, :2] - [10, 5]).max(axis=1) < 1.0)
    moved = [i for i in over if abs(moves.end_mm[i, 2] - moves.start_mm[i, 2]) > 1e-9]
    return " ".join(f"{moves.end_mm[i, 2] - 100:g}{'f' * bool(moves.at_feed[i])}" for i in moved)


#: in G98 from 20 over R2 to Z-10; 5114 (retraction of G73) and 5115 are 1 mm
FANUC = {
    "G73 Q4.": "2 -2f -1 -6f -5 -10f 20",
    "G74": "2 -10f 2f 20",
    "G76 Q0.5": "2 -10f 20",
    "G81": "2 -10f 20",
    "G83 Q4.": "2 -2f 2 -1 -6f 2 -5 -10f 20",
    "G84": "2 -10f 2f 20",
    "G85": "2 -10f 2f 20",
    "G86": "2 -10f 20",
    "G88 P500": "2 -10f 20",
    "G89 P500": "2 -10f 2f 20",
}


@pytest.mark.parametrize(("cycle", "levels"), FANUC.items())
def test_fanuc(cycle, levels):
    text = ("O1\nG21 G90 G54 T1 M6\nG43 H1 G0 Z20.\nX10. Y5. S500 M3\n"
            f"G98 {cycle} Z-10. R2. F100.\nG80 M5\nM30\n")  # fmt: skip
    assert steps(text, "fanuc") == levels


@pytest.mark.parametrize("cycle", ["G84", "G85", "G81"])
def test_fanuc_g99_stays_at_r(cycle):
    text = ("O1\nG21 G90 G54 T1 M6\nG43 H1 G0 Z20.\nX10. Y5. S500 M3\n"
            f"G99 {cycle} Z-10. R2. F100.\nG80 M5\nM30\n")  # fmt: skip
    assert steps(text, "fanuc").split()[-1].rstrip("f") in ("2",)


#: set-up clearance 2, depth -10, surface 0, second clearance 30; stop ahead 0.2 mm
KLARTEXT = {
    "201 REAMING ~\nQ208=250": "2 -10f 2f 30",
    "202 BORING ~\nQ208=250 ~\nQ214=1": "2 -10f 2 30",
    "203 DRILLING ~\nQ202=4 ~\nQ213=2 ~\nQ256=0.5 ~\nQ205=4 ~\nQ212=0": (
        "2 -4f -3.5 -8f -7.5 -10f 30"),
    "206 TAPPING": "2 -10f 2f 30",
    "207 RIGID TAPPING ~\nQ239=1.5": "2 -10f 2f 30",
    "209 TAPPING ~\nQ239=1.5 ~\nQ257=6 ~\nQ256=1": "2 -6f -4.5f -10f 2f 30",
    "240 CENTERING ~\nQ343=0": "2 -10f 30",
    "241 SINGLE-LIP ~\nQ379=3 ~\nQ253=900 ~\nQ208=2000": "2 -1f -10f 2f 30",
}  # fmt: skip


@pytest.mark.parametrize(("cycle", "levels"), KLARTEXT.items())
def test_klartext(cycle, levels):
    text = ("BEGIN PGM A MM\nTOOL CALL 1 Z S500\nL Z+50 R0 FMAX M3\n"
            f"CYCL DEF {cycle} ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ203=0 ~\nQ204=30 ~\nQ211=0\n"
            "L X+10 Y+5 FMAX M99\nEND PGM A MM\n")  # fmt: skip
    assert steps(text, "heidenhain") == levels


#: RTP 20, RFP 0, SDIS 2, DP -10
SINUMERIK = {
    "CYCLE81(20,0,2,-10)": "2 -10f 20",
    "CYCLE82(20,0,2,-10,,0.5)": "2 -10f 20",
    "CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,500)": "2 -10f 2f 20",
    "CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,500,0,1,0,1,4,1)": "2 -4f -3f -7f -6f -10f 2f 20",
    "CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,500,0,1,0,2,4)": "2 -4f 2f -7f 2f -10f 2f 20",
    "CYCLE840(20,0,2,-10,,0,4,3,0,,1.5)": "2 -10f 2f 20",
    # VRT 2.5 between chip breaks; DAM 100 and 50 in percent (AMODE), steps at least MDEP 1.2
    "CYCLE83(20,0,2,-10,,-4,,0,0,0,1,0,0,0,2.5)": "2 -4f -1.5 -7f -4.5 -10f 20",
    "CYCLE83(20,0,2,,10,,4,100,0,0.5,100,1,0,1.2,1.4,0,1.6,0,1,11211111)": (
        "2 -4f 2 -2.4 -8f 2 -6.4 -10f 20"
    ),
    "CYCLE83(20,0,2,,10,,4,50,0,0.5,100,0,0,1.2,1,0,1.6,0,1,11211111)": (
        "2 -4f -3 -6f -5 -7.2f -6.2 -8.4f -7.4 -9.2f -8.2 -10f 20"
    ),
    "CYCLE83(20,0,2,-10,,-4,,1,0,0,1,0)": "2 -4f -3 -7f -6 -9f -8 -10f 20",
    # the rest below twice of DAM, or of MDEP, is shared by the last two steps
    "CYCLE83(20,0,2,-10,0,-4,0,3,0,0,1,0)": "2 -4f -3 -7f -6 -10f 20",
    "CYCLE83(20,0,2,-10,,-3,,2,0,0,1,0)": "2 -3f -2 -5f -4 -7f -6 -8.5f -7.5 -10f 20",
    "CYCLE83(20,0,2,-9,,-5,,3,0,0,1,0)": "2 -5f -4 -7f -6 -9f 20",
    "CYCLE83(20,0,2,-12,,-5,,3,0,0,1,0)": "2 -5f -4 -8f -7 -10f -9 -12f 20",
    "CYCLE83(20,0,2,-10,,-4,,-0.5,0,0,1,0,0,1.5)": (
        "2 -4f -3 -6f -5 -7.5f -6.5 -8.75f -7.75 -10f 20"
    ),
    # without DIS1 the rapid ends 0.6 mm above the last depth, 2 percent of it beyond 30 mm, <= 7 mm
    "CYCLE83(20,0,2,-1000,,-30,,400,0,0,1,1)": (
        "2 -30f 2 -29.4 -430f 2 -423 -715f 2 -708 -1000f 20"
    ),
    "CYCLE83(20,0,2,-150,,-100,,60,0,0,1,1)": "2 -100f 2 -98 -150f 20",
    "CYCLE82(20,0,2,-9,10,0.5,0,1,11)": "2 -10f 20",
    "CYCLE82(20,0,2,-10,9,0.5,0,1,12)": "2 -10f 20",
    "CYCLE85(20,0,2,-10,,0,100,300)": "2 -10f 2f 20",
    "CYCLE87(20,0,2,-10,,3)": "2 -10f 20",
    "CYCLE88(20,0,2,-10,,0.5,3)": "2 -10f 20",
    "CYCLE89(20,0,2,-10,,0.5)": "2 -10f 2f 20",
}


@pytest.mark.parametrize(("cycle", "levels"), SINUMERIK.items())
def test_sinumerik(cycle, levels):
    text = f"G54 G90 T1 D1 M6\nG0 Z20 S500 M3\nX10 Y5 F100\n{cycle}\nM30\n"
    assert steps(text, "sinumerik") == levels


def hole(cycle, units="G71"):
    text = f"{units} G54 G90 T1 D1 M6\nG0 Z2 S500 M3\nG4 F0.01\nF100\n{cycle}\nM30\n"
    return read_program(Source(text.encode(), "part.mpf"), tools=TOOLS, home_mm=(0, 0, 300))


def test_chips_break_by_a_millimetre_in_an_inch_program():
    moves = hole("CYCLE83(1,0,0.1,-0.5,,-0.2,,0,0,0,1,0)", "G70").moves
    levels = moves.end_mm[-6:, 2] - 100
    assert levels == pytest.approx([-5.08, -4.08, -8.89, -7.89, -12.7, 25.4])


@pytest.mark.parametrize(
    ("pitch", "feed"), [("1.5,0,500,500,0,1", 750.0), ("20,0,500,500,0,2", 635.0),
                        ("0.05,0,500,500,0,3", 635.0)],
)  # fmt: skip
def test_pita_says_what_the_pitch_counts(pitch, feed):
    moves = hole(f"CYCLE84(20,0,2,-10,,0,3,,{pitch})").moves
    assert moves.feed_mm_per_min[moves.at_feed] == pytest.approx(feed)


@pytest.mark.parametrize(
    ("cycle", "there", "back"),
    [("CYCLE84(20,0,2,-10,,0,3,5,,0,500,800)", 400.0, 640.0),  # MPIT 5 is M5, 0.8 mm
     ("CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,800,0,0,0,1,4)", 750.0, 1200.0),
     ("CYCLE84(20,0,2,-10,,0,3,-10,1.5,0,500)", 750.0, 750.0),
     ("CYCLE840(20,0,2,-10,,0,4,3,0,16)", 1000.0, 1000.0)],
)  # fmt: skip
def test_a_thread_may_be_said_by_its_size_and_come_out_faster(cycle, there, back):
    moves = hole(cycle).moves
    down = moves.at_feed & (moves.end_mm[:, 2] < moves.start_mm[:, 2])
    assert moves.feed_mm_per_min[down] == pytest.approx(there)
    assert moves.feed_mm_per_min[moves.at_feed & ~down] == pytest.approx(back)


@pytest.mark.parametrize(
    ("pitch", "said"),
    [("7,,0,500,500", "MPIT 7"), ("5,1,0,500,500", "differ"), (",,0,500,500", "without a pitch")],
)
def test_a_thread_without_a_clear_pitch_is_refused(pitch, said):
    with pytest.raises(ProgramError, match=said):
        hole(f"CYCLE84(20,0,2,-10,,0,3,{pitch})")


@pytest.mark.parametrize(
    ("vari", "seconds"), [(0, 0.5 + 0.5 + 2.0), (1, 0.5 + 0.25 + 0.5 + 0.25 + 2.0)]
)
def test_cycle83_waits_at_each_depth(vari, seconds):
    def waited(cycle):
        moves = hole(cycle).moves
        return moves.duration_s[moves.kind == 3].sum()

    named = f"CYCLE83(20,0,2,-10,,-4,,0,0.5,0.25,1,{vari},0,0,0,2)"
    silent = f"CYCLE83(20,0,2,-10,,-4,,0,0,0,1,{vari})"
    assert waited(named) - waited(silent) == pytest.approx(seconds)


@pytest.mark.parametrize("cycle", ["CYCLE82(20,0,2,-10,,-5)", "CYCLE82(20,0,2,-10,,5,0,0,22)"])
def test_a_dwell_may_count_turns_of_the_spindle(cycle):
    assert any(
        line.endswith("dwell 0.6") for line in canon_lines(hole(cycle.replace(",,", ",10,", 1)))
    )


@pytest.mark.parametrize(
    ("cycle", "said"),
    [
        ("CYCLE81(20,0,2,-10,,0,10,1,12)", "drills to a diameter"),
        ("CYCLE82(20,0,2,-10,,0,10,1,12)", "drills to the shank"),
        ("CYCLE83(20,0,2,-10,,-4,,0,0,0,1,0,0,0,1,0,0,10,1,11111112)", "drills to the shank"),
        ("CYCLE82(20,0,2,-10,,0,0,2,12)", "another plane"),
        ("CYCLE82(20,0,2,-10,,0,0,1,11)", "without a depth"),
        ("CYCLE83(20,0,2,-10,,-4,,-0.5)", "DAM -0.5"),
        ("POCKET3(50,0,2,-5,40,30,8,60,40,0,5,0,0,9,9,0,4,5)", "VARI 4"),
        ("CYCLE90(20,0,2,-11,,30,26,2,300,2,0,0,0,0,2,0)", "another plane"),
        ("CYCLE71(50,0,2,-5,0,0,60,40,0,5,8,5,0,300,11,5,0,0,11)", "AMODE 11"),
        ('CYCLE72("A",20,0,2,-6,3,1,0,9,9,2,41,1,2,9,1,2,0,0,0,0,0,11)', "AMODE 11"),
        ("MCALL CYCLE81(10,0,2,-5)\nCYCLE801(0,0,0,9,9,2,2,1)", "CYCLE801 with a frame"),
        (
            "POCKET4(10,0,2,5,11,0,0,1,0,0,200,200,0,21,50,9,15,5,1,0,1,2,10100,111,111)",
            "AMODE 111",
        ),
    ],
)
def test_modes_that_need_the_point_of_the_tool_are_refused(cycle, said):
    with pytest.raises(ProgramError, match=said):
        hole(cycle)


def test_the_depth_of_the_cylindrical_part_is_refused():
    text = ("BEGIN PGM A MM\nTOOL CALL 1 Z S500\nCYCL DEF 200 DRILLING ~\nQ200=2 ~\nQ201=-10 ~\n"
            "Q206=100 ~\nQ202=5 ~\nQ203=0 ~\nQ204=30 ~\nQ395={}\n"
            "L X+1 FMAX M99\nEND PGM A MM\n")  # fmt: skip
    read_program(Source(text.format("+0").encode(), "a.h"), tools=TOOLS)
    with pytest.raises(ProgramError, match="Q395=1"):
        read_program(Source(text.format("+1").encode(), "a.h"), tools=TOOLS)


@pytest.mark.parametrize("operation", [0, 2, 3])
def test_what_a_klartext_pocket_does_is_said_by_q215(operation):
    text = ("BEGIN PGM A MM\nTOOL CALL 1 Z S500\nCYCL DEF 252 CIRCULAR POCKET ~\n"
            f"Q215={operation} ~\nQ223=40 ~\nQ368=0 ~\nQ207=500 ~\nQ351=1 ~\nQ201=-5 ~\n"
            "Q202=5 ~\nQ369=0 ~\nQ206=100 ~\nQ338=0 ~\nQ200=2 ~\nQ203=0 ~\nQ204=20 ~\nQ370=1\n"
            "L X+0 Y+0 FMAX M3 M99\nEND PGM A MM\n")  # fmt: skip
    source = Source(text.encode(), "a.h")
    if operation == 3:
        with pytest.raises(ProgramError, match="Q215=3"):
            read_program(source, tools=TOOLS)
        return
    moves = read_program(source, tools=TOOLS).moves
    assert (moves.end_mm[moves.at_feed, 2] - 100).min() == -5


@pytest.mark.parametrize(
    ("vari", "places"),
    [(1000, [(20, 0), (0, 20), (-20, 0), (0, -20)]),
     (2000, [(20, 0), (10, 300**0.5), (-10, 300**0.5), (-20, 0)])],
)  # fmt: skip
def test_a_whole_circle_of_holes_whatever_its_step(vari, places):
    """VARI 1000 of HOLES2 is a whole circle, 2000 a part of one that INDA divides."""
    moves = hole(f"MCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,20,0,60,4,{vari})\nMCALL").moves
    assert moves.end_mm[moves.at_feed][:, :2] == pytest.approx(np.array(places), abs=1e-9)
