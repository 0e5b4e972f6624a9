"""Grbl: recognised, read as far as the firmware reads, and written back."""

import numpy as np
import pytest

from gcode import ProgramError, Source, read_program
from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate

PART = """$H
G21 G90 G94 G17
G54 G0 X0 Y0 Z5
M3 S8000
G1 Z-1 F200
X20
G3 X20 Y10 I0 J5 F400 ; half a circle
G38.2 Z-2 F50
M5
M30
"""


def read(text, **options):
    return read_program(Source(text.encode(), "part.nc"), **options)


def test_recognised_and_read():
    program = read(PART)
    assert program.dialect == "grbl"
    assert program.notes[0].word == "$H"
    assert np.round(program.moves.end_mm[-1], 9).tolist() == [20.0, 10.0, -2.0]


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("G81 X1 R1 Z-2", "G81 is no word of Grbl"),
        ("G41 D1 X1", "G41 is no word of Grbl"),
        ("T1 M6", "M6 is no word of Grbl"),
        ("#1=2", "parameters"),
        ("G0 X[1+1]", "parameters"),
        ("$J=G91 X10 F100", "no jogging"),
        ("G0 A10", "A is no word of Grbl"),
    ],
)
def test_what_the_firmware_refuses_is_refused(line, reason):
    with pytest.raises(ProgramError, match=reason) as error:
        read(f"G21\n{line}\nM30\n", dialect="grbl")
    assert error.value.line == 2


def test_written_back(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(PART.replace("G38.2 Z-2 F50\n", "").replace("M3 S8000\n", ""))
    text = compensate(job, effects).text.decode()
    assert "$H\n" in text
    # the workpiece zero is at machine X 100; the scale is 200 ppm
    assert f"X{(20 + 100) / (1 + 200e-6) - 100:.3f}" in text
    written = read_program(Source(text.encode()))
    assert written.dialect == "grbl"
    nominal = read_program(job.program).moves
    assert np.abs(written.moves.end_mm[-1] - nominal.end_mm[-1]).max() < 0.05
