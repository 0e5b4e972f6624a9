"""Klartext, Sinumerik and Fanuc texts: corrected in their own syntax.

The corrected place has a closed form where the axes have scale errors only; the texts are read
here by a few lines of their own, not by the project's readers.
"""

import re

import numpy as np
import pytest

from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate

SCALE_X, SCALE_Y = 200e-6, -150e-6
LINEAR = SCALE + "[effects.scale.Y]\nscale_ppm = -150\n"
BENT = LINEAR + "[effects.cyclic_pitch.X]\namplitude_um = 4\npitch_mm = 40\nphase_rad = 0.3\n"
#: the iteration ends within 2 nm
HALF_STEP = 0.5e-3 + 2e-6
#: ends are off by sqrt(2)/2 steps each, the centre by as much and in opposite ways
RADII_APART = 2 * 2**0.5 * 1e-3

KLARTEXT = """0 BEGIN PGM PART MM
1 BLK FORM 0.1 Z X+0 Y+0 Z-20
2 TOOL CALL 1 Z S3000 F500
3 L X-10 Y+0 Z+5 R0 FMAX M3
4 L Z-1.000 F200
5 L X+20.000 ; along
6 CC X+20 Y+10
7 C X+20.000 Y+20.000 DR+
8 L IX-10 M9
9 CR X+0 Y+10 R+10 DR+
10 L X+0 Y+0
11 LBL 1
12 L IX+2
13 L IY+1
14 CALL LBL 1 REP 2
15 L Z+100 R0 FMAX M5
16 END PGM PART MM
"""
#: ends of its feed moves in the plane
KLARTEXT_ENDS = [(-10, 0), (20, 0), (20, 20), (10, 20), (0, 10), (0, 0), (2, 0), (2, 1), (4, 1),
                 (4, 2), (6, 2), (6, 3)]  # fmt: skip

SINUMERIK = """%_N_PART_MPF
; siemens
N10 G71 G90 G17 G54
N20 T1 D1 M6
N30 S3000 M3
N40 G0 X0 Y0 Z5
N50 G1 Z=-1.0 F200
N60 X=30.000 Y0
N70 G2 X40 Y10 CR=10.0 F500
N80 G3 X50 Y20 I0 J10 M9
N90 G1 X0 Y0 ; back
N100 G0 Z100
N110 M30
"""


def corrected(x, y):
    """Program coordinates; the workpiece zero is at machine X 100, Y 50."""
    return (x + 100.0) / (1 + SCALE_X) - 100.0, (y + 50.0) / (1 + SCALE_Y) - 50.0


def compensated(tmp_path, text, effects, **options):
    job, found = job_with(tmp_path, "", effects)
    job.program.write_text(text)
    return compensate(job, found, **options)


def klartext_places(lines):
    """Ends of feed moves in the plane, and centres of circles."""
    here, ends, pole = [0.0, 0.0], [], None
    for line in lines:
        words = dict(re.findall(r"(I?[XY]|R(?=[+-]))\s*([+-][\d.]+)", line))
        head = line.split()[1]
        if head not in ("L", "C", "CR", "CC"):
            continue
        place = [float(words.get(a, here[k])) + float(words.get("I" + a, 0))
                 for k, a in enumerate("XY")]  # fmt: skip
        if head == "CC":
            pole = place
            continue
        start, here = here, place
        if head == "C":
            radii = [np.hypot(p[0] - pole[0], p[1] - pole[1]) for p in (start, here)]
            assert abs(radii[0] - radii[1]) < RADII_APART
        if head == "CR":
            assert np.hypot(here[0] - start[0], here[1] - start[1]) <= 2 * float(words["R"]) + 1e-3
        if "FMAX" not in line:
            ends.append(tuple(here))
    return ends


def test_klartext_is_corrected_in_its_own_words(tmp_path):
    found = compensated(tmp_path, KLARTEXT, LINEAR)
    lines = found.text.decode().splitlines()
    assert [int(line.split()[0]) for line in lines] == list(range(len(lines)))
    ends = klartext_places(lines)
    wanted = [corrected(x, y) for x, y in KLARTEXT_ENDS]
    near = [min(np.abs(np.subtract(end, w)).max() for end in ends) for w in wanted]
    assert max(near) <= 2 * HALF_STEP  # incremental words count on from a rounded place
    for word in ("BLK FORM 0.1 Z X+0 Y+0 Z-20", "TOOL CALL 1 Z S3000 F500", "; along"):
        assert any(word in line for line in lines)
    numbers = re.findall(r"\bI?[XYZ]\s*([+-]?[\d.]\S*)", "\n".join(lines[3:]))
    assert all(re.fullmatch(r"[+-]\d+(\.\d+)?", n) for n in numbers)


def test_klartext_arcs_keep_their_circles_and_stops_their_place(tmp_path):
    found = compensated(tmp_path, KLARTEXT, BENT)
    assert (found.arcs, found.arcs_kept) == (2, 2)
    assert found.unrounded.largest_mm <= 1.01e-4
    assert found.after.largest_mm < 1.6e-3
    lines = found.text.decode().splitlines()
    klartext_places(lines)
    stop = next(k for k, line in enumerate(lines) if "M9" in line)
    assert " CR " in lines[stop + 1], "coolant stays on until the line's last point"


def test_sinumerik_is_corrected_in_its_own_words(tmp_path):
    found = compensated(tmp_path, SINUMERIK, LINEAR)
    lines = found.text.decode().splitlines()
    x, y = corrected(30, 0)
    assert f"N60 X={x:.3f} Y{y:.3f}" in lines
    x, y = corrected(40, 10)
    first = next(k for k, line in enumerate(lines) if line.startswith("N70 G2 "))
    last = next(k for k, line in enumerate(lines) if line.startswith("N80 G3 ")) - 1
    assert re.fullmatch(r"N70 G2 X\S+ Y\S+ CR=\d+\.\d+ F500", lines[first])
    assert all(re.search(r"CR=\d+\.\d+", line) for line in lines[first : last + 1])
    end = [float(v) for v in re.findall(r"[XY]=?(-?[\d.]+)", lines[last])]
    assert np.abs(np.subtract(end, (x, y))).max() <= HALF_STEP
    assert lines[:2] == SINUMERIK.splitlines()[:2]
    assert "N90 G1" in found.text.decode()
    assert "; back" in found.text.decode()


def test_sinumerik_blocks_are_numbered_and_keep_radii(tmp_path):
    found = compensated(tmp_path, SINUMERIK, BENT)
    lines = found.text.decode().splitlines()
    numbers = [int(re.match(r"N(\d+) ", line)[1]) for line in lines[2:]]
    assert len(set(numbers)) == len(numbers) > 12
    assert found.after.largest_mm < 1.6e-3
    assert found.unrounded.largest_mm <= 1.01e-4


FANUC = """%
O0001(PART);
G21G90G17G54;
T1M6;
G0X0.Y0.;
G43H1Z5.;
S3000M3;
#101=0;
WHILE[#101LT3]DO1;
G65P100X[#101*20]Y0.;
#101=#101+1;
END1;
G0Z50.;
M30;
O100;
G0X#24Y#25;
G1Z-2.F200;
G2X[#24+10]R5.F100;
G0Z5.;
M99;
%
"""


@pytest.mark.parametrize("dialect", [None, "fanuc", "haas"])
def test_fanuc_macros_become_plain_blocks(tmp_path, dialect):
    found = compensated(tmp_path, FANUC, LINEAR, dialect=dialect)
    text = found.text.decode()
    assert text.startswith("%\nO0001(PART);\n")
    assert text.endswith("M30;\n%\n")
    assert not re.search(r"[#\[]|WHILE|G65|M99", text)
    assert all(line.endswith(";") for line in text.splitlines()[1:-1])
    plunges = [k for k, line in enumerate(text.splitlines()) if re.search(r"G1(?!\d)", line)]
    assert len(plunges) == 3
    for number, k in enumerate(plunges):
        before = text.splitlines()[k - 1]
        x, y = corrected(20.0 * number, 0.0)
        assert abs(float(re.search(r"X\s*(-?[\d.]+)", before)[1]) - x) <= HALF_STEP
        assert abs(float(re.search(r"Y\s*(-?[\d.]+)", before)[1]) - y) <= HALF_STEP
    assert found.after.largest_mm < 1.6e-3
