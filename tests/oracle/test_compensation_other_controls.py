"""Klartext, Sinumerik and Fanuc texts held against the intended path by readers of the tests.

Rounding alone may stand between the text and the intended path (`compensation_paths`); what the
control's arcs may be off by is refused here as there.
"""

import re

import numpy as np
import pytest

from tests.oracle.compensation_corpus import compensated
from tests.oracle.compensation_paths import compared, intended_pieces
from tests.oracle.linuxcnc_interpreter import is_installed, judge
from tests.oracle.other_controls import read_klartext, read_sinumerik
from tests.oracle.test_compensation_programs import MACHINE, SCALE, job_with
from tests.oracle.test_compensation_text_dialects import FANUC, KLARTEXT, SINUMERIK

EFFECTS = SCALE + (
    "[effects.scale.Y]\nscale_ppm = -150\n[effects.scale.Z]\nscale_ppm = 300\n"
    "[effects.cyclic_pitch.X]\namplitude_um = 4\npitch_mm = 40\nphase_rad = 0.3\n"
    "[effects.cyclic_pitch.Y]\namplitude_um = 3\npitch_mm = 55\nphase_rad = 1.3\n"
)
BENT = MACHINE + "[squareness]\nEC0Y = 80.0\nEB0X = -60.0\n"
ZERO_MM = (100.0, 50.0, -300.0)

POCKET = """0 BEGIN PGM POCKET MM
1 TOOL CALL 1 Z S3000
2 L X+0 Y+0 Z+5 R0 FMAX M3
3 L Z-2.5 F150
4 CC X+0 Y+0
5 L X+12.5 F400
6 C X+12.5 Y+0 DR+
7 C X-12.5 Y+0 Z-3.5 DR-
8 CC X-40 Y+0
9 C X-67.5 Y+0 DR+
10 CR X-67.5 Y+30 R-20 DR-
11 CR IX+30 IY+10 R+60 DR+
12 L IX+1.234 IY-5.6 IZ+.5
13 L X+200 Y+130.5 Z+1
14 CC IX+10 IY-10
15 C X+220 Y+130.5 DR-
16 L Z+50 FMAX M5
17 END PGM POCKET MM
"""
INCHES = """BEGIN PGM SMALL INCH
TOOL CALL 1 Z S3000 F20
L X+0 Y+0 Z+.2 R0 FMAX M3
L Z-.1
CC X+1 Y+0
L X+.5
C X+1.5 Y+0 DR-
CR X+2.5 Y+1.2345 R+2 DR+
L X+0 Y+3.0001
END PGM SMALL INCH
"""
TURNS = """%_N_TURNS_MPF
N10 G71 G90 G17 G54
N20 T1 D1 M6
N30 S3000 M3
N40 G0 X0 Y0 Z5
N50 G1 Z=-1.0 F200
N60 X30. Y-20
N70 G3 X30 Y-20 Z-4 I15 J0 TURN=2
N80 G91 G1 X10 Y5.5
N90 G2 X20 Y0 I10 J3
N100 G90 G1 X100
N110 G18 G2 X120 Z-24 I0 K-20
N120 G19 G3 Y16.5 Z7 J12 K19
N130 G17 G70
N140 G1 X5 Y1.5
N150 G2 X5.5 Y2 CR=-.5
N160 G71 G0 Z=100
N170 M30
"""
#: FANUC as it runs, in plain blocks
FANUC_PLAIN = "G21G90G17G54\nT1M6\nG0X0.Y0.\nG43H1Z5.\n" + "".join(
    f"G0X{x}.Y0.\nG1Z-2.F200\nG2X{x + 10}.R5.F100\nG0Z5.\n" for x in (0, 20, 40)
) + "G0Z50.\nM30\n"  # fmt: skip


def comparison(tmp_path, text, read, *, before=None, change=lambda written: written, **options):
    """The written text beside the intended path, both as `read` reads them."""
    job_with(tmp_path, "", EFFECTS)
    (tmp_path / "machine.toml").write_text(BENT)
    (tmp_path / "part.nc").write_text(text)
    found, kept = compensated(tmp_path, **options)
    after = read(change(found.text.decode()), ZERO_MM)
    assert after.refusal is None
    nominal = before or read(text, ZERO_MM)
    return compared(nominal, after, intended_pieces(kept, numbers_only=False))


CASES = [
    pytest.param(KLARTEXT, read_klartext, id="klartext"),
    pytest.param(POCKET, read_klartext, id="klartext pocket"),
    pytest.param(INCHES, read_klartext, id="klartext inches"),
    pytest.param(SINUMERIK, read_sinumerik, id="sinumerik"),
    pytest.param(TURNS, read_sinumerik, id="sinumerik turns and planes"),
]


@pytest.mark.parametrize(("text", "read"), CASES)
@pytest.mark.parametrize("resolution_mm", [1e-3, 1e-4])
def test_text_makes_the_intended_path(tmp_path, text, read, resolution_mm):
    found = comparison(tmp_path, text, read, resolution_mm=resolution_mm)
    assert found.wrong == []
    assert found.worst_mm > 0.1 * resolution_mm, "rounding is felt"
    assert len(found.middles_mm) > 1


@pytest.mark.parametrize(("text", "read"), CASES[1:])
@pytest.mark.parametrize("letter", ["X", "Y", "Z"])
def test_a_wrong_digit_is_noticed(tmp_path, text, read, letter):
    def change(written):
        at = list(re.finditer(rf"(?<![A-Z]){letter}=?[+-]?\d*\.\d+", written))[-1]
        nudged = float(at.group().lstrip("XYZ=")) + 0.003
        word = re.match(r"[XYZ]=?", at.group()).group()
        return written[: at.start()] + f"{word}{nudged:+.5f}" + written[at.end() :]

    assert comparison(tmp_path, text, read, change=change).wrong


@pytest.mark.skipif(not is_installed(), reason="LinuxCNC is not installed")
@pytest.mark.parametrize("dialect", ["fanuc", "haas"])
def test_fanuc_macros_make_the_intended_path(tmp_path, dialect):
    def read(text, zero_mm):
        plain = re.sub(r"(?m)^(%|O\d+).*", "", text)
        return judge(plain.encode(), tools=[(1, 100.0, 10.0)], work_offsets_mm={"G54": zero_mm})

    nominal = read(FANUC_PLAIN, ZERO_MM)
    assert nominal.refusal is None
    found = comparison(tmp_path, FANUC, read, before=nominal, dialect=dialect)
    assert found.wrong == []
    assert np.all(np.array(found.middles_mm) < 1.5e-3)
