"""Sinumerik's frames, corners, arcs, subprograms and milling cycles against closed forms.

SINUMERIK 840D sl/828D Programming Manuals Fundamentals, Job Planning and Cycles.
"""

import numpy as np
import pytest

from gcode import ControlSettings, OffsetEntry, ProgramError, Source, ToolEntry, read_program
from tests.oracle.test_klartext_cycles import inside, tip

TOOLS = {1: ToolEntry(100.0, 10.0, name="MILL_10"), 2: ToolEntry(80.0, 6.0)}


def read(body, path="part.mpf"):
    return read_program(
        Source(f"{body}\nM30\n".encode(), path), tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 0)
    )


def places(body, **options):
    moves = read(body, **options).moves
    moved = np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9
    return np.round(moves.end_mm[moved], 6)


def test_frames_turn_and_mirror_in_the_order_of_their_blocks():
    found = places(
        "TRANS X10 Y20\nAROT Z30\nG0 X5 Y0\nAMIRROR X0\nX5 Y1\nROT RPL=90\nX5 Y0\n"
        "MIRROR Y0\nX3 Y4\nROT\nX1 Y1"
    )[:, :2]
    turn = np.radians(30)
    first = [10 + 5 * np.cos(turn), 20 + 5 * np.sin(turn)]
    second = [10 - 5 * np.cos(turn) - np.sin(turn), 20 - 5 * np.sin(turn) + np.cos(turn)]
    assert found == pytest.approx(np.array([first, second, [0, 5], [3, -4], [1, 1]]), abs=1e-6)


def test_an_additive_shift_lies_in_the_turned_frame():
    found = places("ROT Z90\nATRANS X10\nG0 X1 Y2")[:, :2]
    assert found == pytest.approx(np.array([[-2, 11]]))


def test_arcs_in_a_mirrored_frame_turn_the_other_way():
    moves = read("MIRROR X0\nG0 X10 Y0\nG3 X0 Y10 I-10 J0 F100").moves
    assert moves.end_mm[-1] == pytest.approx([0, 10, 0])
    assert moves.start_mm[-1] == pytest.approx([-10, 0, 0])
    assert moves.sweep_rad[-1] * moves.axis[-1, 2] == pytest.approx(-np.pi / 2)


@pytest.mark.parametrize("word", ["ROT X30", "MIRROR Z0", "SCALE X0", "ROT Q3"])
def test_frames_that_turn_the_part_over_are_refused(word):
    with pytest.raises(ProgramError, match=word.split()[0]):
        read(word)


def test_polar_angles_in_g91_count_from_the_last_one_and_radii_from_the_pole():
    """NC Programming 6FC5398-2EP40, page 175: AP=IC(..) from the last angle, RP always absolute."""
    found = places(
        "G111 X10 Y10\nG0 AP=0 RP=5\nG91 AP=90\nAP=90 RP=8\nG90 AP=IC(90)\nG91 AP=AC(0)\n"
        "G90 X0 Y0\nAP=180"
    )[:, :2]
    assert found == pytest.approx(
        np.array([[15, 10], [10, 15], [2, 10], [10, 2], [18, 10], [0, 0], [2, 10]])
    )


def test_polar_places_lie_in_the_plane_that_is_chosen():
    found = places("G18 G111 Z5 X10\nG0 AP=90 RP=5\nG19 G111 Y1 Z2\nG0 AP=0 RP=3 X7")
    assert found == pytest.approx(np.array([[15, 0, 5], [7, 4, 2]]))
    with pytest.raises(ProgramError, match="IC with RP"):
        read("G0 AP=0 RP=IC(5)")


def test_settable_frames_are_written_and_read_by_their_number():
    """G54 is frame 1, G505 is frame 5."""
    found = places(
        "$P_UIFR[5,X,TR]=10\n$P_UIFR[(1),Y,TR]=$P_UIFR[5,X,TR]*2\nG505\nG0 X1\nG54\nX0 Y1\n"
        "R2=2\nDEF INT WO[2]=(0,1)\n$P_UIFR[R2,X,TR]=9\n$P_UIFR[WO[1]+1]=CTRANS(Z,-5)\n"
        "G55 Z0\nG500 X3"
    )
    assert found == pytest.approx(np.array([[11, 0, 0], [0, 21, 0], [0, 21, -5], [3, 21, -5]]))


CONTOUR = "G41 G1 X10 Y0 F100\nY30\nX40\nG40 X60 Y{y}"


def test_kont_is_norm_in_front_of_the_contour():
    """Function Manual 6FC5397-0BP40-2BA0, section 18.5.3."""
    body = "T1 M6\nG0 X0 Y-20\n{}\n" + CONTOUR.format(y=10)
    assert places(body.format("KONT")) == pytest.approx(places(body.format("NORM")))


@pytest.mark.parametrize("before", ["G0 X0 Y20", "G0 X0 Y-20\n"])
def test_kont_behind_the_contour_is_refused(before):
    contour = CONTOUR.format(y=10) if "-" not in before else CONTOUR.replace("X60", "X30")
    with pytest.raises(ProgramError, match="behind the contour"):
        read(f"T1 M6\n{before}\nKONT\n" + contour.format(y=10))
    read(f"T1 M6\n{before}\nKONT NORM\n" + contour.format(y=10))


def test_corners():
    moves = read("G0 X0 Y0\nG1 X20 RND=5 F100\nY20 CHR=3\nX0 CHF=4\nY0").moves
    ends = np.round(moves.end_mm[1:, :2], 6).tolist()
    half = round(4 / np.sqrt(2), 6)
    assert ends == [
        [15, 0], [20, 5], [20, 17], [17, 20], [half, 20], [0, round(20 - half, 6)], [0, 0],
    ]  # fmt: skip
    assert moves.sweep_rad[2] == pytest.approx(np.pi / 2)


def test_modal_rounding_ends_with_zero_and_before_a_rapid():
    moves = read("G0 X0 Y0\nG1 RNDM=2 X10 F100\nY10\nX0\nRNDM=0\nG0 X-5").moves
    ends = np.round(moves.end_mm[1:, :2], 6).tolist()
    assert ends == [[8, 0], [10, 2], [10, 8], [8, 10], [0, 10], [-5, 10]]


def test_corners_of_incremental_blocks():
    found = places("G1 G91 X20 RND=5 F100\nY20\nX-20")[:, :2].tolist()
    assert found == [[15, 0], [20, 5], [20, 20], [0, 20]]


def test_circle_over_a_point_and_tangent_circle():
    moves = read("G0 X10 Y0\nCIP X-10 Y0 I1=0 J1=10 F100").moves
    assert moves.centre_mm[-1, :2] == pytest.approx([0, 0])
    assert moves.sweep_rad[-1] == pytest.approx(np.pi)
    moves = read("G0 X10 Y0\nCIP X-10 Y0 I1=0 J1=-10 F100").moves
    assert moves.sweep_rad[-1] == pytest.approx(-np.pi)
    moves = read("G0 X0 Y0\nG1 X10 F100\nCT X20 Y10\nG1 Y20").moves
    assert moves.centre_mm[-2, :2] == pytest.approx([10, 10])


def test_subprograms_in_the_same_file_and_beside_it(tmp_path):
    (tmp_path / "HOLE.SPF").write_text(
        "PROC HOLE(REAL DEPTH, REAL FEED=50)\nG1 Z=-DEPTH F=FEED\nG0 Z5\nRET\n"
    )
    main = tmp_path / "part.mpf"
    main.write_text(
        "%_N_PART_MPF\nG0 X0 Y0 Z5\nHOLE(3)\nX10\nHOLE(4,80)\nL10 P2\nM30\n"
        "%_N_L10_SPF\nG91 X1\nG90\nM17\n"
    )
    program = read_program(main, tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 0))
    moves = program.moves
    assert moves.end_mm[:, 2].min() == -4
    assert moves.end_mm[-1, 0] == pytest.approx(12)
    assert set(moves.feed_mm_per_min[moves.at_feed].tolist()) == {50.0, 80.0}
    down = np.flatnonzero(moves.end_mm[:, 2] == -4)[0]
    assert moves.line[down] == 5  # the line that calls
    assert moves.line[-1] == 9  # a line of its own


def test_a_comment_of_a_file_beside_it_ends_with_its_line(tmp_path):
    """Latin-1 takes byte 85 of a capital A with a ring for the end of a line."""
    (tmp_path / "TRACK.SPF").write_text("; SK\u00c5R1 X99\nG0 X1\nG1 X2 F100\nRET\n", "utf-8")
    main = tmp_path / "part.mpf"
    main.write_text("G0 X0\nTRACK\nM30\n")
    moves = read_program(main, tools=TOOLS, dialect="sinumerik").moves
    assert moves.end_mm[:, 0].tolist() == [0, 1, 2]


def test_a_fault_in_a_file_beside_it_is_named_there(tmp_path):
    (tmp_path / "BAD.SPF").write_text("G0 X1\nFOO=3\nRET\n")
    main = tmp_path / "part.mpf"
    main.write_text("G0 X0\nBAD\nM30\n")
    with pytest.raises(ProgramError, match=r"BAD.SPF:2: .*FOO"):
        read_program(main, tools=TOOLS, dialect="sinumerik")
    with pytest.raises(ProgramError, match="subprograms NOWHERE"):
        read("NOWHERE(1)")


PARTED = """DEF REAL _HALF, _N[2]
R1=0
PARTS(20, _HALF, _N[1], R1, 7)
G0 X=_HALF Y=_N[1] Z=R1
M30
PROC PARTS(REAL WHOLE, VAR REAL HALF, VAR REAL FOURTH, VAR REAL SUM, VAR REAL NOWHERE) DISPLOF
HALF=WHOLE/2
FOURTH=HALF/2
SUM=SUM+HALF+FOURTH
WHOLE=0
NOWHERE=1
RET
"""


def test_var_parameters_give_their_values_back():
    assert places(PARTED)[-1].tolist() == [10, 5, 15]


def test_var_parameters_count_from_round_to_round():
    body = "R1=1\nTWICE(R1) P3\nG0 X=R1\nM30\nPROC TWICE(VAR REAL AA)\nAA=AA*2\nRET\n"
    assert places(body)[-1, 0] == 8


def test_a_subprogram_that_calls_itself_is_refused():
    with pytest.raises(ProgramError, match="nested deeper"):
        read("%_N_A_MPF\nL1\nM30\n%_N_L1_SPF\nL1\nM17")


def test_a_program_whose_own_name_is_wanted_looks_beside_it(tmp_path):
    main = tmp_path / "part.mpf"
    main.write_text("; as delivered\nN1 PROC L_TIME(INT _KIND)\nG0 X0\nL_TIME(7)\nM30\n")
    with pytest.raises(ProgramError, match="builder made: subprograms L_TIME"):
        read_program(main, tools=TOOLS, dialect="sinumerik")
    (tmp_path / "L_TIME.SPF").write_text("PROC L_TIME(INT _KIND)\nG0 X=_KIND\nRET\n")
    moves = read_program(main, tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 0)).moves
    assert moves.end_mm[-1, 0] == 7


def test_an_auxiliary_function_with_a_number_is_noted():
    program = read("G0 X1\nN50 H41=5\nH41=R1+2 X3")
    assert program.moves.end_mm[:, 0].tolist()[-1] == 3
    assert any("H41=5" in note for note in map(str, program.notes))


def test_case_and_repeats():
    body = "R1=6\nCASE(R1) OF 8 GOTOF AA 6 GOTOF BB DEFAULT GOTOF CC\nAA: X1\nBB: G0 X2\nCC: X3"
    assert places("G0 Y1\n" + body)[1:, 0].tolist() == [2, 3]
    assert places("G0 G91\nSTEP: X1\nY1\nREPEAT STEP P=2")[:, :2].tolist()[-1] == [3, 3]
    assert places("G0 G91\nSTEP: X1\nY1\nREPEATB STEP P=3")[:, :2].tolist()[-1] == [4, 1]
    assert places("G0 G91\nAA: X1\nBB: Y1\nX5\nREPEAT AA BB")[:, :2].tolist()[-1] == [7, 2]


def test_settable_frames_and_tools_by_name():
    found = places(
        'T="mill_10" M6\n$P_UIFR[1,X,TR]=7\n$P_UIFR[2]=CTRANS(X,1,Y,2)\nG54 G0 X1\nG55 X0 Y0'
    )
    assert found[:, :2].tolist()[-2:] == [[8, 0], [1, 2]]
    with pytest.raises(ProgramError, match='no tool has the name "X9"'):
        read('T="X9"')


def test_milling_cycles():
    body = "T1 D1 M6\nS1000 M3 F300\n"
    pocket = read(body + "POCKET3(20,0,2,-6,60,40,8,20,10,30,3,0.2,0.1,300,100,0,11)")
    places_ = tip(pocket)
    assert inside(places_, [20, 10], (30, 20), 8, 30).max() == pytest.approx(-5 - 0.2)
    assert places_[:, 2].min() == pytest.approx(-6 + 0.1)
    circle = tip(read(body + "POCKET4(20,0,2,-6,25,7,-3,3,0,0,300,100,0,11)"))
    assert np.hypot(*(circle[:, :2] - [7, -3]).T).max() == pytest.approx(20)
    slots = tip(read(body + "SLOT1(20,0,2,-5,,4,30,12,40,45,20,45,90,100,300,5,2,0,0)"))
    low = slots[slots[:, 2] < 0]
    turns = np.radians([45, 135, 225, 315])
    centres = [40, 45] + (20 + 15) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    each = np.array(
        [inside(low, c, (15, 6), 6, np.degrees(t)) for c, t in zip(centres, turns, strict=True)]
    )
    assert each.min(axis=0).max() == pytest.approx(-5)
    assert (each < -4.999).any(axis=1).all()


def test_spigots_keep_their_walls():
    """Nothing cuts nearer to the middle than the wall and the mill's radius of 5 allow."""
    body = "T1 D1 M6\nS1000 M3 F300\n"
    # a spigot of 50 from a blank of 55, to -20 by infeeds of 10; 0.5 is left at the wall
    read_ = read(body + "CYCLE77(10,0,3,-20,,50,60,70,10,0.5,0,900,800,1,1,55)")
    round_ = tip(read_)
    low = round_[round_[:, 2] < -1e-9]
    out = np.hypot(*(low[:, :2] - [60, 70]).T)
    assert out.min() == pytest.approx(25.5 + 5)
    assert out.max() > 27.5 + 5, "it comes from outside the blank"
    ends = (read_.moves.end_mm[:, 2] - 100.0).round(9).tolist()
    assert {level for level in ends if -99.0 < level < 0.0} == {-20, -10}
    turns = read_.moves.sweep_rad * read_.moves.axis[:, 2]
    assert (turns[read_.moves.sweep_rad > 1e-9] > 0).all(), "up-cut round a spigot: to the left"
    square = read(body + "CYCLE76(10,0,2,-6,,60,40,8,20,10,30,3,0,0,300,100,2,2,66,46)")
    low = tip(square)
    low = low[low[:, 2] < -5.999]
    turn = np.radians(30.0)
    across = (low[:, :2] - [20, 10]) @ np.array([[np.cos(turn), -np.sin(turn)],
                                                 [np.sin(turn), np.cos(turn)]])  # fmt: skip
    beyond = np.maximum(np.abs(across) - [30 - 8, 20 - 8], 0.0)
    assert (np.hypot(*beyond.T) - 8).min() == pytest.approx(5, abs=1e-6)
    sweep = square.moves.sweep_rad * square.moves.axis[:, 2]
    assert (sweep[square.moves.sweep_rad > 1e-9] < 0).all(), "CDIR 2 is G2"


@pytest.mark.parametrize("step", ["120", "0", ""], ids=["said", "zero", "left out"])
def test_slots_along_a_circle(step):
    """Three slots of 15 over 70 degrees on a radius of 42: walls at 34.5 and 49.5."""
    body = "T1 D1 M6\nS1000 M3 F300\nSLOT2(2,0,2,-23,,3,70,15,60,60,42,0,STEP,100,300,6,2,0,0)"
    body = body.replace("STEP", step)
    moves = tip(read(body))
    low = moves[moves[:, 2] < -22.999][:, :2] - [60, 60]
    out, angle = np.hypot(*low.T), np.degrees(np.arctan2(*low.T[::-1])) % 360.0
    assert (out.min(), out.max()) == pytest.approx((42 - 2.5, 42 + 2.5))
    end = np.degrees(np.arcsin(2.5 / 42.0)) + 1e-6  # round the middles of the ends
    from_start = (angle + end) % 120.0
    assert from_start.max() <= 70 + 2.0 * end
    assert sorted({int(a // 120) for a in (angle + end) % 360.0}) == [0, 1, 2]


def test_boring_cycle_leaves_the_wall():
    moves = read("G0 X10 Y20\nF100\nCYCLE86(10,0,2,-8,,1,3,-1,-1,1,0)").moves
    aside = moves.end_mm[np.abs(moves.end_mm[:, 2] + 7) < 1e-9]
    assert aside == pytest.approx(np.array([[9, 19, -7]]))
    assert moves.end_mm[-1] == pytest.approx([10, 20, 10])


def test_a_grid_of_holes():
    found = places("F100\nMCALL CYCLE81(10,0,2,-3)\nCYCLE801(30,20,0,10,15,3,2)\nMCALL\nX0 Y0")
    holes = found[np.abs(found[:, 2] + 3) < 1e-9][:, :2].tolist()
    assert holes == [[30, 20], [40, 20], [50, 20], [50, 35], [40, 35], [30, 35]]


# Job Planning, "User variables": a name of DEF must not be an address, so that no such axis exists
@pytest.mark.parametrize("filling", ["", "G1 X1 F500\n" * 6000])
def test_a_variable_may_be_called_like_an_axis_that_the_machine_lacks(filling):
    program = read_program(
        Source(f"DEF REAL B\nDEF REAL C=4\n{filling}B=5\nG0 X=B Y=C\nC=C+3\nG0 Y=C\nM30\n".encode(),
               "part.mpf"), dialect="sinumerik", home_mm=(0, 0, 0))  # fmt: skip
    assert program.moves.end_mm[-2:, :2].tolist() == [[5, 4], [5, 7]]
    assert not program.moves.rotary_end_deg.any()


def test_fields():
    found = places(
        "DEF INT KK\nDEF REAL AA[2,3], BB[3]=SET(4,5,6)\nAA[1,2]=7\nFOR KK=0 TO 2\n"
        "G0 X=BB[KK] Y=AA[1,KK]\nENDFOR"
    )[:, :2]
    assert found.tolist() == [[4, 0], [5, 0], [6, 7]]


def test_system_variables_of_the_program_and_its_tool():
    found = places("T1 D1 M6\nG0 X7 Y2\nX=$P_EP[X]+$P_TOOLR Y=$P_TOOLNO\n")
    assert found[-1, :2].tolist() == [12, 1]
    with pytest.raises(ProgramError, match=r"builder made: variables \$AA_MEAS\[X\]"):
        read("G0 X=$AA_MEAS[X]")


def test_rigid_tapping_feeds_by_the_pitch():
    moves = read("S500 M3\nG0 X0 Z2\nG331 Z-18 K1.5\nG332 Z2 K1.5\nG0 X9").moves
    assert moves.feed_mm_per_min[moves.at_feed] == pytest.approx([750, 750])
    assert moves.end_mm[moves.at_feed, 2].tolist() == [-18, 2]
    assert not moves.at_feed[-1]


def test_fixed_points_are_machine_zero():
    found = places("G54\nG0 X7 Y8 Z9\nG75 Z1=0\nG74 X1=0 Y1=0\nX3")
    assert found.tolist() == [[7, 8, 9], [7, 8, 0], [0, 0, 0], [3, 0, 0]]


@pytest.mark.parametrize(
    "block",
    ["CIP X5 Y5 I1=2 J1=3", "G1 X9 RND=2 F100", 'CYCLE72("A",9,0,2,-6,,,,9,9,1,41,1,3)'],
)  # fmt: skip
def test_what_is_worked_out_in_xy_is_refused_in_other_planes(block):
    with pytest.raises(ProgramError, match="in G18 or G19 is not read"):
        read(f"G18 F100\nG0 X1 Y1 Z5\n{block}")


@pytest.mark.parametrize(("sense", "turn"), [(2, -1), (3, 1)])
@pytest.mark.parametrize(("kind", "radius"), [(0, 15.0), (1, 25.0)])
def test_cycle90_mills_a_helix(sense, turn, kind, radius):
    """Thread of 40 by a mill of 10, pitch 2, from 0 to -11: six turns that end at -11."""
    body = f"T1 D1 M6\nS9 M3\nCYCLE90(20,0,2,-11,,40,36,2,300,{sense},{kind},60,50)\n"
    text = f"G17 G71 G90 G54\n{body}M30\n"
    run = read_program(Source(text.encode(), "part"), tools={1: ToolEntry(0.0, 10.0)},
                       dialect="sinumerik").moves  # fmt: skip
    rise = run.end_mm[:, 2] - run.start_mm[:, 2]
    (row,) = np.flatnonzero((np.abs(run.sweep_rad) > 0) & (np.abs(rise) > 0))
    assert run.centre_mm[row, :2] == pytest.approx([60, 50])
    assert np.hypot(*(run.start_mm - run.centre_mm)[row, :2]) == pytest.approx(radius)
    assert run.sweep_rad[row] * run.axis[row, 2] == pytest.approx(turn * 6 * 2 * np.pi)
    assert (run.start_mm[row, 2], run.end_mm[row, 2]) == pytest.approx((1, -11))
    assert run.end_mm[-1, 2] == pytest.approx(20)


@pytest.mark.parametrize(("more", "said"), [("", False), (",100,300,6,2,0,0", True)])
def test_arguments_whose_order_no_second_source_has_are_named(more, said):
    call = f"SLOT2(2,0,2,-23,,3,70,15,60,60,42,0,120{more})"
    notes = read(f"T1 M6\nS1000 M3 F300\n{call}").notes
    told = [n.meaning for n in notes if "order of the arguments of SLOT2" in n.meaning]
    assert len(told) == said


def test_the_length_of_the_tool_in_another_plane_is_told():
    assert any("stays along Z" in note.meaning for note in read("G18\nG0 X1").notes)
    assert not any("stays along Z" in note.meaning for note in read("G17\nG0 X1").notes)


CYCLES_OF_PLANES = (
    "CYCLE83(10,0,2,-20,,-5,,1,0.5,0,1,1)\nCYCLE86(10,0,2,-5,,0.5,3,1,-1,1,90)\n"
    "MCALL CYCLE82(10,0,2,-5,,0.5)\nHOLES2(5,6,20,30,0,3)\n{a}7 {b}8\nMCALL\n"
    "POCKET3(5,0,2,-5,60,40,8,3,4,15,2,0,0,100,50,0,1,5)\nPOCKET4(5,0,2,-5,20,3,4,2,0,0,100,50,0,1)\n"
    "CYCLE90(20,0,2,-11,,40,36,2,300,2,0,60,50)\nCYCLE71(20,5,2,-4,15,25,60,40,30,3,6,4,0.5,900,31)"
)


@pytest.mark.parametrize(("code", "axes"), [(18, "ZXY"), (19, "YZX")])
def test_cycles_in_other_planes_are_those_of_g17_turned(code, axes):
    """First and second axis of the plane and the one across take the places of X, Y and Z."""
    paths = []
    for plane, (a, b, c) in ((17, "XYZ"), (code, axes)):
        start = f"S1000 M3 F300\nG{plane}\nG0 {a}1 {b}2 {c}30\n"
        moves = read("T1\nM6 D0\n" + start + CYCLES_OF_PLANES.format(a=a, b=b)).moves
        order = ["XYZ".index(axis) for axis in (a, b, c)]
        length = moves.end_mm[-1, order]
        paths.append((moves.end_mm[:, order], moves.centre_mm[:, order], moves.sweep_rad,
                      (moves.axis * moves.sweep_rad[:, None])[:, order], length))  # fmt: skip
    skip = 3  # the ways to the start differ
    for flat, turned in zip(*paths, strict=True):
        assert turned[skip:] == pytest.approx(flat[skip:], abs=1e-9, nan_ok=True)


def test_numbers_are_equal_but_for_rounding_in_every_comparison():
    """Job Planning 6FC5398-2BP10-1BA0, page 1-23: the manual's own example does not jump."""
    example = "R1=61.01 R2=61.02 R3=0.01\nIF ABS(R2-R1)>R3 GOTOF WRONG\nG0 X1\nGOTOF DONE\n"
    assert places(example + "WRONG: G0 X9\nDONE:")[:, 0].tolist() == [1]
    rounds = "R1=0\nR2=-10\nWHILE(R2>=-20)\nR2=R2-0.1\nR1=R1+1\nENDWHILE\nG0 X=R1"
    assert places(rounds)[-1, 0] == 101, "down to -20.00000000000004 as well"
    assert places("R1=0\nFOR R2=1 TO 3\nR1=R1+(R2<2)+10*(R2<=2)\nENDFOR\nG0 X=R1")[-1, 0] == 21


def test_comparisons_are_worked_out_last():
    """NC Programming 6FC5398-2EP40-0BA0, page 444."""
    inner = "R1=5 R2=0\nIF {} GOTOF DONE\nG0 X9\nDONE: G0 Y1"
    assert places(inner.format("(R1==5) AND (R2==0)"))[:, 0].tolist() == [0]
    assert places(inner.format("R1==5 OR 0"))[:, 0].tolist() == [9, 9], "5 OR 0 is 1"


@pytest.mark.parametrize(
    ("end", "turn", "turns"),
    [("X39 Y0", 0, 1), ("X39 Y0", 1, 2), ("X-39 Y0", 0, 0.5), ("X-39 Y0", 2, 2.5)],
)
def test_turn_adds_full_turns_before_the_arc_to_the_end(end, turn, turns):
    moves = read(f"G0 X39 Y0\nG2 {end} Z-2 I=AC(0) J=AC(0) TURN={turn} F100").moves
    assert abs(moves.sweep_rad[-1]) == pytest.approx(2 * np.pi * turns)


@pytest.mark.parametrize("turn", [".5", "-1", "1.5", "1000"])
def test_turn_is_a_whole_number(turn):
    """0.5 once became one further full turn."""
    with pytest.raises(ProgramError, match=r"no number of turns.*accepted"):
        read(f"G0 X39 Y0\nG2 X-39 Y0 Z-2 I=AC(0) J=AC(0) TURN={turn} F100")


def test_path_control_may_change_within_cutter_compensation():
    """Only LinuxCNC forbids it; the path beside the contour stays the same."""
    contour = "T1 D1\nG0 X0 Y0\nG1 G41 X10 Y0 F100\n{}X20\n{}Y10\nG1 G40 X0"
    plain = places(contour.format("", ""))
    for first, second in (("G642 ", "G64 "), ("G9 ", ""), ("G60 ", "G601 G64 ")):
        assert places(contour.format(first, second)) == pytest.approx(plain)


def test_an_exact_stop_within_cutter_compensation_is_that_of_its_block():
    moves = read("T1 D1\nG64 G0 X0 Y0\nG1 G41 X10 Y0 F100\nX20\nG9 X30\nX40\nG40 Y20").moves
    stops = {line: stop for line, stop in zip(moves.line, moves.exact_stop, strict=True)}
    assert [stops[line] for line in (4, 5, 6)] == [False, True, False]


def flat(body, **offsets):
    """Read with flat D numbers, and rows D7 and D8 of the offset memory."""
    rows = {7: OffsetEntry(length_mm=60.0, diameter_mm=4.0), 8: OffsetEntry(length_mm=90.0)}
    settings = ControlSettings(options={"d_numbers": "flat"})
    return read_program(Source(f"{body}\nM30\n".encode(), "part.mpf"), tools=TOOLS, offsets=rows,
                        control=settings, dialect="sinumerik", home_mm=(0, 0, 0))  # fmt: skip


def test_flat_d_numbers_choose_an_offset_whatever_t_says():
    """Function Manual 6FC5397-0BP10-0BA0, W1, 2.2.5: D is found without reference to T."""
    body = "T1 M6 D8\nG0 Z10\nD7\nZ10\nT2 M6\nD1\nZ10\nD0\nZ10"
    levels = flat(body).moves.end_mm[:, 2].tolist()
    assert [level for level, after in zip(levels, [*levels[1:], 0.0], strict=True)
            if level != after] == [0, 100, 70, 110, 10]  # fmt: skip
    beside = flat("T1 D7 M6\nG0 X0 Y-9\nG1 G41 X0 Y0 F100\nY20\nG40 X-9").moves
    assert beside.end_mm[:, 0].min() == -9 and -2.0 in beside.end_mm[:, 0]


@pytest.mark.parametrize("call", ["T2\nM6\nD8\nT1", "T2 D8\nM6\nT1", "T2 M6\nSUPA G0 Z0\nD8"])
def test_flat_d_numbers_stand_about_the_tool_change(call):
    """The next tool may be called ahead: its D is asked for at the change."""
    assert flat(f"{call}\nG0 Z10").moves.end_mm[-1, 2] == 100


def test_flat_d_numbers_are_asked_for_by_name():
    with pytest.raises(ProgramError, match="without D, and D numbers are flat"):
        flat("T1 D8 M6\nG0 Z10\nT2 M6\nZ5")
    with pytest.raises(ProgramError, match="there is no offset D9"):
        flat("T1 D9 M6")
    with pytest.raises(
        ProgramError, match=r'cutting edge D8: .*accepted: D0 D1 .*d_numbers = "flat"'
    ):
        read("T1 D8 M6")


def test_jumps_of_two_files_with_the_same_lines_go_to_their_own_labels(tmp_path):
    (tmp_path / "FIRST.SPF").write_text("R1=0\nAGAIN: R1=R1+1\nX=R1\nIF R1<3 GOTOB AGAIN\nRET\n")
    (tmp_path / "OTHER.SPF").write_text("R1=0\nR1=R1+1\nAGAIN: X=R1\nIF R1<3 GOTOB NEXT\nRET\n"
                                        "NEXT: RET\n")  # fmt: skip
    main = tmp_path / "part.mpf"
    main.write_text("G0 Y1\nFIRST\nFIRST\nX0\nM30\n")
    moves = read_program(main, tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 0)).moves
    assert moves.end_mm[1:, 0].tolist() == [1, 2, 3, 1, 2, 3, 0]
    main.write_text("G0 Y1\nFIRST\nOTHER\nM30\n")
    with pytest.raises(ProgramError, match=r"OTHER.SPF:4: GOTOB NEXT: there is no such label"):
        read_program(main, tools=TOOLS, dialect="sinumerik", home_mm=(0, 0, 0))
