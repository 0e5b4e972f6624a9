"""Programs in turned frames, loops that count and lists of parameters, corrected.

The machine's axes have scale errors only, so that a place of the program has its true place in
closed form; the texts are read here by a few lines of their own.
"""

import re
from itertools import pairwise

import numpy as np
import pytest

from tests.oracle.test_compensation_plain_lines import text_of
from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate
from vmach.errors import InputError

EFFECTS = SCALE + "[effects.scale.Y]\nscale_ppm = -150\n"
SCALES = np.array([200e-6, -150e-6])
ZERO_MM = np.array([100.0, 50.0])
ANGLE_DEG = 40.0
#: an inserted or programmed end may go along its move, but not so far across
STEPS_MM = 1.5e-3

TURNED = {
    "heidenhain": """L X+0 Y+0 FMAX
CYCL DEF 7.0 DATUM SHIFT
CYCL DEF 7.1 X+5
CYCL DEF 10.0 ROTATION
CYCL DEF 10.1 ROT+40
L X+10 Y+10 FMAX
L Z-1 F200
L X+70 F500
L Y+60
CYCL DEF 10.0 ROTATION
CYCL DEF 10.1 ROT+0
CYCL DEF 7.0 DATUM SHIFT
CYCL DEF 7.1 X+0
L Z+50 FMAX""",
    "sinumerik": """TRANS X5
AROT RPL=40
G0 X10 Y10
G1 Z-1 F200
X70 F500
Y60
G0 Z50
TRANS""",
}


def compensated(tmp_path, dialect, body):
    job, effects = job_with(tmp_path, "", EFFECTS)
    job.program.write_text(text_of(body, dialect))
    return compensate(job, effects)


def turned(points, angle_deg):
    angle = np.radians(angle_deg)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return points @ turn.T + [5.0, 0.0]


def cut_places(text):
    """Ends X Y at depth Z-1, from where the tool goes down."""
    here, found = {}, []
    for line in text.splitlines():
        if "ROT" in line or "TRANS" in line or "CYCL" in line:
            continue
        here |= {a: float(v) for a, v in re.findall(r"\b([XYZ])([-+]?[\d.]+)", line)}
        if "Z" in here and here["Z"] < 0:
            found.append([here["X"], here["Y"]])
    return np.array(found)


def off_the_line(points, begin, end):
    way = (end - begin) / np.linalg.norm(end - begin)
    return np.abs((points - begin) @ [-way[1], way[0]])


@pytest.mark.parametrize("dialect", TURNED)
def test_a_turned_frame_is_corrected_along_the_axes_of_the_machine(tmp_path, dialect):
    found = compensated(tmp_path, dialect, TURNED[dialect])
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm
    machine = (turned(cut_places(found.text.decode()), ANGLE_DEG) + ZERO_MM) * (1 + SCALES)
    corners = turned(np.array([[10.0, 10.0], [70.0, 10.0], [70.0, 60.0]]), ANGLE_DEG) + ZERO_MM
    assert np.linalg.norm(machine[-1] - corners[-1]) < 3 * STEPS_MM
    nearest = np.minimum(*(off_the_line(machine, a, b) for a, b in pairwise(corners)))
    assert len(machine) >= 3
    assert nearest.max() < STEPS_MM


def test_a_frame_turned_again_and_again_is_corrected(tmp_path):
    body = """L X+0 Y+0 FMAX
LBL 1
L X+20 Y+0 FMAX
L Z-2 F200
L X+40 F500
CC X+30 Y+0
C X+20 Y+0 DR+
L Z+5 FMAX
CYCL DEF 10.0 ROTATION
CYCL DEF 10.1 IROT+60
CALL LBL 1 REP 4
CYCL DEF 10.0 ROTATION
CYCL DEF 10.1 ROT+0"""
    found = compensated(tmp_path, "heidenhain", body)
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm
    assert not found.uncorrected


@pytest.mark.parametrize(
    ("dialect", "body"),
    [
        ("heidenhain", "CYCL DEF 8.0 MIRROR IMAGE\nCYCL DEF 8.1 X\nL X+9 Y+9 FMAX\nL X+40 F100"),
        ("sinumerik", "MIRROR X0\nG0 X9 Y9\nG1 Z-1 F100\nX40 RND=2\nY40\nMIRROR"),
    ],
)  # fmt: skip
def test_a_mirror_image_is_refused_by_line(tmp_path, dialect, body):
    with pytest.raises(InputError, match=r"part\.nc:\d+: mirror image cannot be compensated"):
        compensated(tmp_path, dialect, body)


CYCLE_AND_LOOP = """CYCL DEF 200 DRILLING ~
    Q200=2 ~
    Q201=-10 ~
    Q206=150 ~
    Q202=4 ~
    Q210=0 ~
    Q203=0 ~
    Q204=20 ~
    Q211=0.5
L X+10 Y+10 FMAX M99
LBL 1
L IX+30 Y+30 FMAX
L Z-1 F300
L IX+6
L Z+5 FMAX
CALL LBL 1 REP2"""
PARAMETERS_BETWEEN = """Q1 = 12
L X+Q1 Y+20 FMAX
Q1 = Q1 * 3
L Z-1 F100
L X+Q1
Q1 = 90
L X+Q1 Y-Q1"""
LOOPS = {
    "a counter in the words": "FOR R1=1 TO 3\nG0 X=R1*25 Y9\nG1 Z-1 F9\nX=R1*25+14\nG0 Z5\nENDFOR",
    "one loop in another": "DEF REAL WW[3]\nFOR R3=0 TO 2\nWW[R3]=R3*20\nFOR R2=1 TO 2\n"
    "G0 X=WW[R3] Y=30*R2\nG1 Z=-(R2) F300\nX=IC(-8)\nG0 Z5\nENDFOR\nENDFOR",
    "a minus before a parameter": "R1=2\nG0 X20 Y30\nG1 Z=-R1 F300\nX= 70\nX=-R1 Y=+R1",
}  # fmt: skip


@pytest.mark.parametrize(
    ("dialect", "body"),
    [("heidenhain", CYCLE_AND_LOOP), ("heidenhain", PARAMETERS_BETWEEN),
     *(("sinumerik", body) for body in LOOPS.values())],
    ids=["a cycle before a loop", "parameters between moves", *LOOPS],
)  # fmt: skip
def test_what_is_written_out_keeps_its_values(tmp_path, dialect, body):
    found = compensated(tmp_path, dialect, body)
    text = found.text.decode()
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm
    assert "FOR" not in text
    assert not re.search(r"\b[XYZ]=?[-+ ]*[QRW]", text)
