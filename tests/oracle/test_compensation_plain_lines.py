"""Klartext and Sinumerik with cycles, compensation, parameters and corners, corrected.

`tests.oracle.other_controls` reads the plain lines by the manual and shares no code with the
project; what is written is read again by the same control and run through the machine.
"""

import re
from dataclasses import replace

import numpy as np
import pytest

from gcode import MoveKind, Source, ToolEntry, read_program
from tests.oracle.other_controls import read_klartext, read_sinumerik
from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate
from vmach.errors import InputError
from vmach.program_text.expanding.expansion import expanded

TOOLS = {1: ToolEntry(100.0, 10.0)}

CONTOUR = """Q1 = 12
L X+Q1 Y+20 FMAX
L Z+2 FMAX
L Z-5 F100 M8
L X+20 Y+20 RL F200
L X+60 ; along
RND R8
L Y+50
CHF 3
L X+20
L Y+10
L X+0 Y+0 R0 F500
L Z+30 FMAX"""
HOLES = """CYCL DEF 200 DRILLING ~
    Q200=2 ~
    Q201=-10 ~
    Q206=150 ~
    Q202=4 ~
    Q210=0 ~
    Q203=0 ~
    Q204=20 ~
    Q211=0.5
L X+10 Y+10 FMAX M99
L X+30 FMAX M99"""
POLAR = """L X+60 Y+40 Z+3 FMAX
CC X+40 Y+40
LP PR+20 PA+90 F250
C X+40 Y+20 DR-
L X+0
CT X-20 Y+10
L Z+50 FMAX"""
POCKET = """CYCL DEF 252 CIRCULAR POCKET ~
    Q215=0 ~
    Q223=40 ~
    Q207=500 ~
    Q201=-6 ~
    Q202=3 ~
    Q206=150 ~
    Q200=2 ~
    Q203=0 ~
    Q204=20
CYCL CALL POS X+50 Y+45 Z+0 FMAX
L X+0 Y+0 FMAX"""
BODIES = {"contour": CONTOUR, "holes": HOLES, "polar": POLAR, "pocket": POCKET,
          "everything": "\n".join([CONTOUR, HOLES, POLAR, POCKET])}  # fmt: skip


S_CONTOUR = """R1=12
G0 X=R1 Y20 Z2
G1 Z-5 F100 M8
G41 X20 Y20 F200
X60 RND=8 ; along
Y50 CHR=3
X20
Y10
G40 X0 Y0
G0 Z30"""
S_SOFT = """G0 X0 Y0 Z30
G41 G341 G247 DISCL=5 DISR=13 FAD=50 X40 Y-10 Z-2 F200
G1 X60
G3 X70 Y0 CR=10
G1 Y20
G40 G248 DISCL=5 DISR=13 X0 Y0 Z30 F900
G42 G340 G347 DISCL=3 DISR=4 X10 Y40 Z-1 F200
G1 X30 Y50
G0 G40 G148 DISR=3 X0 Y0 Z30"""
S_HOLES = """F150
MCALL CYCLE81(20,0,2,-10)
X10 Y10
X30
HOLES2(50,50,20,0,0,5)
MCALL
G0 Z30 Y60
CYCLE83(20,0,2,-10,,-4,,0,0.5,0,1,1)
X15"""
S_POLAR = """G0 X60 Y40 Z3
G111 X40 Y40
G1 AP=90 RP=20 F250
X0
G2 X=IC(10) Y=AC(50) CR=12
CT X30 Y10
G0 Z50"""
HELIX = """L X+60 Y+40 Z+3 FMAX
L Z+0 F100
CC X+40 Y+40
CP IPA-270 IZ-3 DR- F250
CP IPA-360 IZ-4 DR-
L Z+50 FMAX"""
S_INCH = """G70
G0 X.5 Y1 Z.2
G1 Z-.1 F100
G41 X1 Y1 F200
X3 RND=.25
Y2
G40 X.5 Y.5
MCALL CYCLE81(1,0,.1,-.5)
X2 Y2
MCALL
G700 G1 Z-.1 F10
G91 X1 RND=.1
Y1
G90 X0
G71 G0 Z30"""
S_G91 = """G0 X5 Y5 Z3
G1 Z-1 F100
G91 X10 RND=2
Y12 CHR=1
G2 X=R1+5 Y5 CR=5
G1 X-8 RND=1
G90 X0 Y0
G91
G41 X5 Y5
X20
Y10
G40 X-5 Y-5
G90 G0 Z30"""
S_HELIX = """R1=-3
G0 X60 Y40 Z3
G1 Z0 F100
G2 X40 Y60 Z=R1 I-20 J0
G3 X40 Y60 Z=R1-9 I0 J-20 TURN=2
G0 Z50"""
S_POCKET = """POCKET4(20,0,2,-6,20,50,45,3,0,0,500,150,0,11,0,0,0,0,0)
G0 X0 Y0"""
CASES = [
    *(pytest.param("heidenhain", body, id=f"klartext {name}") for name, body in BODIES.items()),
    *(pytest.param("sinumerik", body, id=f"sinumerik {name}") for name, body in {
        "contour": S_CONTOUR, "holes": S_HOLES, "polar": S_POLAR, "pocket": S_POCKET,
        "inch": S_INCH, "G91": S_G91, "helix": S_HELIX, "soft": S_SOFT,
        "everything": "\n".join([S_CONTOUR, S_HOLES, S_POLAR, S_POCKET])}.items()),
]  # fmt: skip
READERS = {"heidenhain": read_klartext, "sinumerik": read_sinumerik}


INCH = """L X+0.4 Y+0.8 FMAX
L Z-.2 F40 M8
L X+.8 Y+.8 RL F80
L X+2.4
RND R.3
L Y+2
L X+.4
L X+0 Y+0 R0 F200
CC X+1 Y+0
CP IPA+180 DR+
L Z+1.2 FMAX"""


def text_of(body, dialect):
    if dialect == "sinumerik":
        return f"G17 G71 G90 G54\nT1 D1 M6\nS1000 M3\nG0 X0 Y0 Z50\n{body}\nM30\n"
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\nL X+0 Y+0 Z+50 R0 FMAX M3\n"
    return f"{head}{body}\nM30\nEND PGM A MM\n"


def read(text, dialect):
    return read_program(Source(text.encode(), "part"), tools=TOOLS, dialect=dialect)


@pytest.mark.parametrize(("dialect", "body"), CASES)
def test_plain_lines_are_the_path_that_the_manual_makes_of_them(dialect, body):
    program = read(text_of(body, dialect), dialect)
    plain, expansion = expanded(program)
    text = plain.source.data.decode()
    assert expansion.reasons
    for word in ("M99", "RND", " RL", "G41", "CYCLE8", "MCALL", "POCKET4", "AP=", "=R"):
        assert word not in text
    moves = program.moves
    rows = (moves.kind != MoveKind.DWELL) & (
        (np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9) | (moves.kind == MoveKind.ARC)
    )
    poleless = re.sub(r"(?m)^G111.*\n", "", text)  # says a pole and moves nothing
    verdict = READERS[dialect](poleless, np.zeros(3))
    far = [np.abs(np.subtract(a, b)).max() > 1e-9 or arc is not None
           for a, b, arc in zip(verdict.start, verdict.end, verdict.arc, strict=True)]  # fmt: skip
    ends, wanted = np.array(verdict.end)[far], moves.end_mm[rows] - [0, 0, 100]
    assert len(ends) >= len(wanted) > 3
    assert ends[-len(wanted) :] == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(("dialect", "body"), CASES)
def test_the_written_program_read_again_makes_the_intended_path(tmp_path, dialect, body):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(text_of(body, dialect))
    found = compensate(job, effects)
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm
    assert len(read(found.text.decode(), dialect).moves) > 0


@pytest.mark.parametrize(
    ("dialect", "body", "word"),
    [
        ("sinumerik", "CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,500)", "tapping"),
        ("sinumerik", "F100\nCYCLE86(20,0,2,-10,,0,3,1,1,1,0)", "boring"),
        ("sinumerik", "G331 Z-5 K1", "tapping"),
        ("heidenhain", "CC X+0 Y+0\nCP IPA+90 IZ-3 DR+ F200", "polar coordinates"),
        ("heidenhain", "L X+50 F200 M118 Z1", "M118"),
    ],
)
def test_what_has_no_plain_lines_is_refused_by_line_and_word(tmp_path, dialect, body, word):
    job, effects = job_with(tmp_path, "", SCALE)
    start = "G0 X9 Y0\n" if dialect == "sinumerik" else "L X+9 Y+0 FMAX\n"
    text = text_of(start + body, dialect).replace("G17 G71", 'MSG("A")\nG17 G71')
    job.program.write_text(text)
    with pytest.raises(InputError, match=rf"part\.nc:\d+: .*{word}.*cannot be compensated"):
        compensate(job, effects)


SUBPROGRAM = "L100 P2\nG0 Z9\nM30\n%_N_L100_SPF\nPROC L100\nG1 X5 F100\nG91 X9\nG90\nM17"


def test_subprograms_of_sinumerik_are_written_out_where_they_run(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    text = text_of(SUBPROGRAM, "sinumerik").removesuffix("M30\n")
    job.program.write_text(text)
    found = compensate(job, effects)
    assert "L100" not in found.text.decode()
    again = read(found.text.decode(), "sinumerik").moves
    assert again.end_mm == pytest.approx(read(text, "sinumerik").moves.end_mm, abs=0.05)


def test_an_arc_by_its_opening_angle_is_written_out(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(text_of("G3 X9 Y9 AR=90 F100\nG2 I5 J0 AR=45", "sinumerik"))
    found = compensate(job, effects)
    assert "AR" not in found.text.decode()
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm


@pytest.mark.parametrize("block", ["G68 X0 Y0 R30.", "G51 X0 Y0 P2.", "G51.1 X0.", "G16"])
def test_transformed_blocks_of_fanuc_are_refused_by_line(tmp_path, block):
    job, effects = job_with(tmp_path, "", SCALE)
    job = replace(job, dialect="fanuc")
    head = "O1\nG17 G21 G90 G54\nT1 M6\nS1000 M3\nG43 H1 Z50.\nG0 X0 Y0\n"
    job.program.write_text(f"{head}{block}\nG1 X9. Y9. F100.\nM30\n")
    with pytest.raises(InputError, match=r"part\.nc:8: rotation, scaling, mirror image or G16"):
        compensate(job, effects)


def feeds_of(text, unit_mm):
    """F of every line and arc at feed, mm/min."""
    words = re.findall(r"(?m)^(?:\d+ )?(?:L|C)\b.*?\bF([\d.]+)", text)
    return [float(word) * unit_mm for word in words]


def test_klartext_in_inches_is_written_in_inches(tmp_path):
    text = text_of(INCH, "heidenhain").replace("A MM", "A INCH").replace("Z+50", "Z+2")
    program = read(text, "heidenhain")
    plain, expansion = expanded(program)
    written = plain.source.data.decode()
    assert expansion.reasons
    assert "RND" not in written and "CP" not in written
    verdict = read_klartext(written, np.zeros(3))
    ends, moves = np.array(verdict.end), program.moves
    wanted = moves.end_mm[moves.kind != MoveKind.DWELL] - [0, 0, 100]
    assert ends[-6:] == pytest.approx(wanted[-6:], abs=1e-9)
    assert wanted[-2] == pytest.approx([2 * 25.4, 0, -0.2 * 25.4], abs=1e-9), "half a turn about 1"
    # F counts 0.1 inch/min: TNC 640, Klartext Programming, "Feed rate F" of inch programs
    assert set(np.round(feeds_of(written, 2.54), 6)) == {101.6, 203.2, 508.0}
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(text)
    found = compensate(job, effects)
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm


def test_a_helix_of_klartext_is_written_where_the_control_has_the_words(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(text_of(HELIX, "heidenhain"))
    with pytest.raises(InputError, match=r"polar coordinates .*cannot be comp.*helix = \"C\""):
        compensate(job, effects)
    job = replace(job, control=replace(job.control, options={"helix": "C"}))
    found = compensate(job, effects)
    assert " IPA" not in found.text.decode()
    source = Source(text_of(HELIX, "heidenhain").encode(), "part")
    program = read_program(source, tools=TOOLS, dialect="heidenhain", control=job.control)
    verdict = read_klartext(expanded(program)[0].source.data.decode(), np.zeros(3))
    # three quarters, then a whole turn, clockwise about (40, 40)
    assert verdict.end[-3:-1] == [pytest.approx([40, 60, -3]), pytest.approx([40, 60, -7])]
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm


def test_feeds_of_g70_stay_metric_and_those_of_g700_do_not():
    """6FC5398-3CP10-0BA0, section 8.2.3: "feedrates ... are not influenced by G70/G71"."""
    blocks = "G0 X0\nG70 G1 X1 F10\nX2 F20\nG700 X3 F10\nX2\nG71 X0\nX5 F100\nG70 X1\nG700 F5\nX0"
    moves = read(text_of(blocks, "sinumerik"), "sinumerik").moves
    ends = (moves.end_mm[-8:, 0]).tolist()
    assert ends == pytest.approx([25.4, 50.8, 76.2, 50.8, 0, 5, 25.4, 0], abs=1e-9)
    # the speed in force stays when the codes change: 6FC5397-0BP40-2BA0, section 7.3
    wanted = [10, 20, 254, 254, 254, 100, 100, 127]
    assert moves.feed_mm_per_min[-8:].tolist() == pytest.approx(wanted, rel=1e-12)


def test_system_variables_of_g70_count_in_the_basic_system():
    """The worked example of 6FC5397-0BP40-2BA0, section 7.3: $AA_IW in G70 is in mm."""
    blocks = "R1=0 R2=0\nG0 X0\nG1 G70 X1 F1000\nIF $AA_IW[X]>10\nR1=1\nENDIF\nG71 X=R1*7"
    assert read(text_of(blocks, "sinumerik"), "sinumerik").moves.end_mm[-1, 0] == 7.0
