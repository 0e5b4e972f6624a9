"""Fanuc macros, Heidenhain Klartext and Sinumerik: read right, or refused with line and word."""

from pathlib import Path

import numpy as np
import pytest

from gcode import MoveKind, ProgramError, Source, ToolEntry, dialect_name, read_program
from gcode.language.registry import choose_dialect, dialect_of

CONTROLS = Path(__file__).parents[1] / "golden" / "controls"
TOOLS = {1: ToolEntry(100.0, 10.0), 2: ToolEntry(80.0, 6.0)}


def read(text, **options):
    return read_program(Source(text.encode(), "part.nc"), tools=TOOLS, **options)


def ends(text, **options):
    return np.round(read(text, **options).moves.end_mm, 9).tolist()


def refusal(text, **options):
    with pytest.raises(ProgramError) as error:
        read(text, **options)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        ("%\nO100\nG0 X1\nIF[#1 GT 2]GOTO 10\nM30\n", "fanuc"),
        ("O1\nG65 P100 A1\nM30\n", "fanuc"),
        ("0 BEGIN PGM PART MM\n1 L X+1 FMAX\n", "heidenhain"),
        ("BEGIN PGM A INCH\nL X+1\n", "heidenhain"),
        ("%_N_PART_MPF\nG0 X10\n", "sinumerik"),
        ("N10 G2 X10 Y0 CR=5\nM30\n", "sinumerik"),
        ("DEF REAL A\n", "sinumerik"),
        ('G17 G90\nT="MILL_20" D1\nM6\n', "sinumerik"),
        ("G17 G90\nR1=10\nG0 X0\n", "sinumerik"),
        ("G17 G90\nG0 SUPA Z0 D0\n", "sinumerik"),
        ("G0 X1\nIF R1<2 GOTOF END2\nX5\nEND2: M5\n", "sinumerik"),
        ("G17 G90\nAROT Z45\n", "sinumerik"),
        ("G2 X10 Y0 I=AC(5) J=AC(0)\n", "sinumerik"),
        ("DEF REAL A1,C1\n", "sinumerik"),
        ('GROUP_BEGIN(0,"A,R1",0,0)\n', "sinumerik"),
        ("G1 X10. , R2.\n", "fanuc"),
        ("WHILE[#1 LT 3]DO2\nEND 2\n", "fanuc"),
        ("G21 G90\nG43.4 H1\nM30\n", "fanuc"),
        ("G21\nN20 G68.2 X0 Y0 Z0 I10 J20 K30\n", "fanuc"),
        ("(G68.2)\nG43.1 Z5\nM2\n", "linuxcnc"),
        ("O100 if [#1 GT 2]\nG0 X1\nO100 endif\nM2\n", "linuxcnc"),
        ("(CR=5) G0 X1\n#<x>=5 G1 X#<x>\nM2\n", "linuxcnc"),
        ("G10 L2 P1 X0\n; Y=3\nM2\n", "linuxcnc"),
    ],
)
def test_recognised_by_the_text(text, dialect):
    assert choose_dialect("auto", text.encode()).dialect.name == dialect


@pytest.mark.parametrize(
    ("name", "text", "dialect"),
    [
        ("part.MPF", "G54 G71 G90\nT1 D1\nG0 X1\nM30\n", "sinumerik"),
        ("part.spf", "G0 X1\nM17\n", "sinumerik"),
        ("part.min", "G0 X1\nM2\n", "okuma"),
        ("part.ngc", "G0 X1\nM2\n", "linuxcnc"),
        ("part.nc", "G0 X1\nM2\n", "linuxcnc"),
        ("part.mpf", "O1000\nWHILE[#1 LT 3]DO2\nEND 2\nM30\n", "fanuc"),
    ],
)
def test_recognised_by_the_file_where_the_text_says_nothing(tmp_path, name, text, dialect):
    found = choose_dialect("auto", text.encode(), path=tmp_path / name)
    assert found.dialect.name == dialect
    assert found.is_fallback == (name == "part.nc")
    (tmp_path / name).write_text(text)
    assert dialect_of(tmp_path / name) == dialect


def test_units_of_a_main_program_of_sinumerik(tmp_path):
    """G70 and G71 are lathe cycles elsewhere: the name of the file says whose they are."""
    path = tmp_path / "part.mpf"
    path.write_text("G54 G70 G90 F100\nG1 X1\nG71\nX1\nM30\n")
    assert read_program(path).moves.end_mm[:, 0].tolist() == [25.4, 1.0]


@pytest.mark.parametrize("other", [0, 1])
def test_a_move_beside_a_cycle_is_told(other):
    """Most programs mean the cycle; the maker's manual forbids it, and controls may cancel it."""
    text = f"O1\nG21\nG0 X0. Y0. Z9.\nG{other} G81 X1. Z-5. R2. F99.\nX3.\nG80\nM30\n"
    program = read_program(Source(text.encode(), "part.nc"), dialect="fanuc")
    told = [note for note in program.notes if note.word == "two motions"]
    assert [(note.line, note.is_of_reading) for note in told] == [(4, True)]
    assert told[0].meaning.startswith(f"G{other} beside G81 is read as the cycle")
    assert program.moves.end_mm[:, 2].min() == -5.0


FANUC = """%
O1000 (MAIN)
G21 G90 G54
#100=2
G0 X0 Y0 Z10.
G65 P2000 A10. B3 F200.
#101=0
WHILE[#101 LT 3]DO1
G1 X[#101*#100] F100.
#101=#101+1
END1
IF[#101 EQ 3]THEN #102=7
IF[#102 NE 7]GOTO 90
M98 P3000 L2
GOTO 95
N90 G0 X999
N95 G0 Z#102
M30
O2000 (ROW)
#5=1
N1 IF[#5 GT #2]GOTO 2
G1 Y[#1*#5] F#9
#5=#5+1
GOTO 1
N2 M99
O3000
G91 G1 Z-1.
G90
M99
%
"""


def test_fanuc_macro_program():
    program = read(FANUC)
    assert program.dialect == "fanuc"
    assert ends(FANUC) == [
        [0, 0, 10], [0, 10, 10], [0, 20, 10], [0, 30, 10],
        [0, 30, 10], [2, 30, 10], [4, 30, 10], [4, 30, 9], [4, 30, 8], [4, 30, 7],
    ]  # fmt: skip
    assert program.moves.feed_mm_per_min[1] == 200.0


def test_fanuc_d_word_stays_in_force():
    base = "O1\nIF[1 EQ 2]GOTO 1\nF100\nT2M6\nG0 G43H2{}Z5.\nX-20.Y0\n"
    base += "G41{} G1 X0 Y0\nX20.\nG40 X40.\nN1 M30\n"
    assert ends(base.format("D1", "")) == ends(base.format("", " D1"))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("O1\nG65 P2\nM30\n", 2, "what it calls is neither in this file nor beside it: O2"),
        ("O1\nGOTO 5\nM30\n", 2, "no block N5"),
        ("O1\nWHILE[1 EQ 0]DO1\nG0 X1\nM30\n", 2, "without END1"),
        ("O1\nG65 P1 G1\nM30\n", 2, "another G code"),
        ("O1\nIF[1 EQ 0]GOTO 1\nS100 M113\nN1 M30\n", 3, "M113"),
        ("O1\nWHILE[1 EQ 1]DO1\nEND1\nM30\n", 2, "loop without end"),
        ("O1\nF9\nN7 G1 X1\nX0\nGOTO 7\nM30\n", 3, "loop without end"),
    ],
)
def test_fanuc_refusals(text, line, words):
    message = refusal(text, dialect="fanuc", max_blocks=500)
    assert message.startswith(f"part.nc:{line}:") and words in message


KLARTEXT = """0 BEGIN PGM PLATE MM
1 BLK FORM 0.1 Z X+0 Y+0 Z-20
2 TOOL CALL 2 Z S3500
3 L X+0 Y+0 Z+50 R0 FMAX M3
4 L Z-5 F250
5 L X+20
6 L IX+10 IY+5 F300 M8
7 CC X+40 Y+5
8 C X+50 Y+5 DR-
9 CR X+60 Y+15 R+10 DR+
10 LBL 1
11 L IZ-1 F100
12 CALL LBL 1 REP 2/2
13 L Z+0 FMAX M91
14 CALL LBL 7
15 L X+0 FMAX M2
16 LBL 7 ; subprogram
17 L IY+1 FMAX
18 LBL 0
19 END PGM PLATE MM
"""


def test_klartext():
    program = read(KLARTEXT, work_offsets_mm={"G54": (0, 0, -200)})
    moves = program.moves
    motion = moves.kind != MoveKind.DWELL
    tip = np.round(moves.end_mm[motion] - [0, 0, 80 - 200], 9).tolist()
    assert tip == [
        [0, 0, 50], [0, 0, -5], [20, 0, -5], [30, 5, -5], [50, 5, -5], [60, 15, -5],
        [60, 15, -6], [60, 15, -7], [60, 15, -8], [60, 15, 120], [60, 16, 120], [0, 16, 120],
    ]  # fmt: skip
    arcs = moves.kind == MoveKind.ARC
    assert moves.sweep_rad[arcs] == pytest.approx([-np.pi, np.pi / 2])
    assert moves.tool[-1] == 2
    assert program.dialect == "heidenhain"


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("L X+Q1 F100", "Q1 was never set"),
        ("FN 17: SYSWRITE ID50 NR1 = 2", "FN 17"),
        ("CYCL DEF 275 TROCHOIDAL SLOT", "CYCL"),
        ("CYCL DEF 8.1 Z", "CYCL"),
        ("PLANE SPATIAL SPA+0 SPB+30 SPC+0 STAY", "tilts"),
        ("M128", "M128"),
        ('TOOL CALL "MILL" Z S100', "numbers"),
        ("RND R2", "behind anything but a line"),
        ("L X+1", "without feed"),
        ("C X+1 Y+1 DR+", "CC first"),
        ("CR X+1 Y+1 DR+", "CR without R"),
        ("L X+1 FMAX M128", "M128"),
        ("LBL A", "label"),
        ("CALL LBL 9", "LBL 9"),
        ("APPR LT X+1 LEN10", "APPR"),
    ],
)
def test_klartext_refusals_name_line_and_word(line, words):
    message = refusal(f"BEGIN PGM A MM\nTOOL CALL 1 Z S100\n{line}\nEND PGM A MM\n")
    assert message.startswith("part.nc:3:")
    assert words in message


def test_klartext_lines_without_motion():
    program = read("0 BEGIN PGM A MM\n1 ; contour\n2 * - contour\n3\n4 CYCL DEF 7.0 DATUM SHIFT\n"
                   "5 CYCL DEF 7.1 X+0 Y-0.000\n6 CYCL DEF 32.0 TOLERANCE\n7 CYCL DEF 32.1 T0.01\n"
                   "8 TOOL CALL 1 Z S100 F50 DL+0.0 DR+0\n9 L X+5 R0 FMAX\n"
                   "10 END PGM A MM\n")  # fmt: skip
    assert program.moves.end_mm[:, 0].tolist()[-1] == 5.0
    assert {note.word for note in program.notes} >= {"CYCL DEF 32"}


SINUMERIK = """%_N_PART_MPF
N10 G90 G17 G71 G54 ; start
N20 T2 D1 M6
N30 S2000 M3
N40 G0 X=10 Y=20 Z5
N50 G1 Z-2 F300
N60 G2 X30 Y20 CR=10
N70 G3 X30 Y20 I-5 J0 TURN=1
N80 G4 F2.5
N90 G91 G1 X5 G60
N100 G90 G64 G0 Z50 D0
N110 M30
"""


def test_sinumerik():
    program = read(SINUMERIK)
    moves = program.moves
    motion = moves.kind != MoveKind.DWELL
    assert program.dialect == "sinumerik"
    assert np.round(moves.end_mm[motion], 9).tolist() == [
        [10, 20, 85], [10, 20, 78], [30, 20, 78], [30, 20, 78], [35, 20, 78], [35, 20, 50],
    ]  # fmt: skip
    assert moves.sweep_rad[moves.kind == MoveKind.ARC] == pytest.approx([-np.pi, 4 * np.pi])
    assert moves.duration_s[moves.kind == MoveKind.DWELL].tolist() == [0.0, 2.5]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("X=R[", "ends too early"),
        ("G1 X=NOTHING", "NOTHING"),
        ("CYCLE90(10,0,2,-5)", "CYCLE90"),
        ("ROT X10", "ROT"),
        ("G1 F=AC(5)", "AC with F"),
        ('CYCLE800(1,"",0,57,0,0,0,0,30,0)', "CYCLE800"),
        ("SUPA TRANS X5", "TRANS"),
        ("G4 P2", "G4"),
        ("FOR I=0 TO 5", "FOR"),
    ],
)
def test_sinumerik_refusals_name_line_and_word(line, words):
    message = refusal(f"%_N_A_MPF\nG1 F100\n{line}\nM30\n")
    assert message.startswith("part.nc:3:")
    assert words in message


def test_sinumerik_lines_without_motion():
    text = ('WORKPIECE(,,,"BOX",112,0,-20,-80,-50,-50,50,50)\nMSG("X5 (a) Y6")\nN5 G71 G90 FFWON\n'
            "N6 T1 D1 M6\nCYCLE832(0.01,1,1)\nSTOPRE\nN7 G0 X7 SOFT G451\n"
            "N8 G0 SUPA Z0 D0\nM30\n")  # fmt: skip
    program = read(text, dialect="auto", work_offsets_mm={"G54": [100.0, 0.0, -50.0]})
    assert program.dialect == "sinumerik"
    assert program.moves.end_mm[-2:, 0].tolist() == [107.0, 107.0]
    assert program.moves.end_mm[-1, 2] == 0.0, "SUPA: machine coordinates"
    assert {"MSG", "WORKPIECE", "CYCLE832", "SOFT"} <= {note.word for note in program.notes}


@pytest.mark.parametrize(
    ("name", "known"), [("siemens", "sinumerik"), ("RS274", "linuxcnc"), ("klartext", "heidenhain"),
                        ("Haas", "haas"), ("auto", "auto")]
)  # fmt: skip
def test_synonyms_mean_one_name(name, known):
    assert dialect_name(name) == known
    text = b"BEGIN PGM A MM\nEND PGM A MM\n" if known == "heidenhain" else b"G0 X1\nM30\n"
    found = read_program(Source(text), dialect=name).dialect
    assert found == known.replace("auto", "linuxcnc")


def test_a_word_far_down_still_names_the_dialect():
    text = "%\nO1\n" + "G0 X1\n" * 10_000 + "G65 P5 A3.\nM30\nO5\nG0 X#1\nM99\n"
    assert len(text) > 30_000
    program = read(text)
    assert program.dialect == "fanuc"
    assert program.moves.end_mm[-1, 0] == 3.0


@pytest.mark.parametrize(
    "text", ["$PART.MIN%\nO1\nG15 H1\nG0 X1\nM2\n", "O1\nVC1=5\nG1 X=VC1\nM2\n", "CALL O100\nM2\n"]
)
def test_okuma_is_recognised(text):
    assert choose_dialect("auto", text.encode()).dialect.name == "okuma"


@pytest.mark.parametrize("path", sorted(CONTROLS.iterdir()), ids=lambda p: p.name)
def test_programs_that_hold_every_word_of_a_control_are_read(path):
    tools = {1: ToolEntry(100.0, 10.0, name="MILL_10"), 2: ToolEntry(80.0, 6.0)}
    program = read_program(path, tools=tools, dialect=path.name.split(".")[1])
    assert len(program.moves) > 40
    again = read_program(path, tools=tools, dialect=program.dialect, fast=True)
    assert np.array_equal(again.moves.end_mm, program.moves.end_mm)


def test_a_numbered_program_that_linuxcnc_refuses_is_asked_about():
    with pytest.raises(ProgramError, match="is it for FANUC or Haas"):
        read_program(Source(b"%\nO1000 (PLATE)\nG0 G91 G28 Z0\nM30\n", "part.nc"))
    with pytest.raises(ProgramError) as error:
        read_program(Source(b"G0 G91 G28 Z0\nM30\n", "part.nc"))
    assert "FANUC" not in str(error.value)


FADAL = (
    "N1 O3 (EDGE E9)\nN2 G0 G90 M6 T7\nN3 G90 G0 X-40. Y0 E1\nN4 H7 Z5.\nN5 E0 X0 Y250.\nN6 M2\n"
)


@pytest.mark.parametrize("dialect", ["auto", "fanuc", "linuxcnc"])
def test_a_program_of_fadals_own_format_is_refused_by_the_name_of_its_control(dialect):
    with pytest.raises(ProgramError, match=r"part\.nc:3: .*Fadal.*E1 chooses.*G54 to G59"):
        read_program(Source(FADAL.encode(), "part.nc"), dialect=dialect)


@pytest.mark.parametrize(
    "text",
    [
        "G0 X1 Y2 E1.25\nX2 E12",
        "G1 X1 Y2 E0.5",
        "X1 E99",
        "E1 Z5",
        "X1 E#1",
        "X1e5",
        "G70 Q100 X15 Z3.041 E0 D0.5 P2",
    ],
)
def test_another_e_is_no_mark_of_fadal(text):
    with pytest.raises(ProgramError) as error:
        read_program(Source(f"{text}\nM2\n".encode(), "part.nc"))
    assert "Fadal" not in str(error.value)


@pytest.mark.parametrize("code", ["G70", "G71", "G71.1"])
def test_units_of_other_controls_are_named_where_they_stand_alone(code):
    assert "SINUMERIK and HEIDENHAIN" in refusal(f"G17 {code} G90\nM2\n")


def test_an_m_function_of_klartext_needs_a_number():
    text = b"BEGIN PGM A MM\nL X+1 R0 FMAX M MAX\nEND PGM A MM\n"
    with pytest.raises(ProgramError, match="MMAX is no M function"):
        read_program(Source(text, "part.h"))


@pytest.mark.parametrize("told", ["heidenhain", "fanuc"])
def test_a_text_that_another_control_owns_says_so(told):
    text = "%TEST G71 *\nN10 T1 G17 S3000 *\nN20 G00 Z+50 M3 *\nN30 %TEST G71 *\n"
    said = refusal(text, dialect=told)
    assert "is it for HEIDENHAIN TNC, DIN/ISO (tnciso)? '%TEST G71 *' in line 1" in said
