"""Klartext with cycles, radius compensation, parameters and corners, corrected.

`tests.oracle.other_controls` reads the plain lines by the manual and shares no code with the
project; what is written is read again by the same control and run through the machine.
"""

import numpy as np
import pytest

from gcode import MoveKind, Source, ToolEntry, read_program
from tests.oracle.other_controls import read_klartext
from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate
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
C X+40 Y+20 DR+
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
APPROACH = """L X-40 Y-30 Z+0 FMAX
APPR LT X+0 Y+0 LEN15 RL F100
L X+50 Y+0
C X+50 Y+0 DR+
DEP LN LEN20
L Z+50 FMAX"""
BODIES = {"contour": CONTOUR, "holes": HOLES, "polar": POLAR, "pocket": POCKET,
          "everything": "\n".join([CONTOUR, HOLES, POLAR, POCKET])}  # fmt: skip


def text_of(body):
    head = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\nL X+0 Y+0 Z+50 R0 FMAX M3\n"
    return f"{head}{body}\nM30\nEND PGM A MM\n"


def read(text):
    return read_program(Source(text.encode(), "part.h"), tools=TOOLS, dialect="heidenhain")


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_plain_lines_are_the_path_that_the_manual_makes_of_them(body):
    program = read(text_of(body))
    plain, expansion = expanded(program)
    text = plain.source.data.decode()
    assert expansion.reasons
    assert "M99" not in text and "RND" not in text and " RL" not in text
    moves = program.moves
    rows = (moves.kind != MoveKind.DWELL) & (
        (np.abs(moves.end_mm - moves.start_mm).max(axis=1) > 1e-9) | (moves.kind == MoveKind.ARC)
    )
    verdict = read_klartext(text, np.zeros(3))
    far = [np.abs(np.subtract(a, b)).max() > 1e-9 or arc is not None
           for a, b, arc in zip(verdict.start, verdict.end, verdict.arc, strict=True)]  # fmt: skip
    ends, wanted = np.array(verdict.end)[far], moves.end_mm[rows] - [0, 0, 100]
    assert len(ends) >= len(wanted) > 3
    assert ends[-len(wanted) :] == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_the_written_program_read_again_makes_the_intended_path(tmp_path, body):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text(text_of(body))
    found = compensate(job, effects)
    assert found.after.largest_mm < 2e-3 < found.before.largest_mm
    again = read_program(Source(found.text, "part.h"), tools=TOOLS, dialect="heidenhain")
    assert len(again.moves) > 0
