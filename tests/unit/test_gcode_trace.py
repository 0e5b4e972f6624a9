"""Which lines were obeyed, with which values and modes; the items of a block."""

from dataclasses import replace
from itertools import pairwise

import pytest

from gcode import PlainLines, ProgramError, Source, block_items, read_program

LOOP = (
    b"#1=2\nO1 WHILE [#1 GT 0]\nG1 G91 X#1 F[#1*100] (DEBUG, now #1)\n#1=[#1-1]\nO1 ENDWHILE\n"
    b"G20 G90\nM3 S500\nM2\n"
)


def steps(text, **options):
    return read_program(Source(text), **options).steps


def test_lines_in_the_order_in_which_they_run():
    found = steps(LOOP)
    assert [s.line for s in found] == [1, 2, 3, 4, 5, 2, 3, 4, 5, 2, 6, 7, 8]
    moves = [s for s in found if s.line == 3]
    assert [s.words for s in moves] == [{"X": 2.0, "F": 200.0}, {"X": 1.0, "F": 100.0}]
    assert [s.g_codes for s in moves] == [[1.0, 91.0], [1.0, 91.0]]
    assert [s.comment for s in moves] == ["DEBUG, now 2.000000", "DEBUG, now 1.000000"]
    assert [s.blocks for s in found if s.line in (2, 5)] == [0] * 5


def test_modes_before_and_after_every_line():
    found = steps(LOOP)
    inch = next(s for s in found if s.line == 6)
    assert (inch.before.unit_mm, inch.modes.unit_mm) == (1.0, 25.4)
    assert (inch.before.absolute, inch.modes.absolute) == (False, True)
    spindle = next(s for s in found if s.line == 7)
    assert (spindle.before.spindle, spindle.modes.spindle) == (0, 1)


def test_the_fast_lane_does_not_hide_lines():
    text = b"G21\n" + b"".join(b"G1 X%d. F100\n" % k for k in range(50)) + b"M2\n"
    program = read_program(Source(text), fast=True)
    assert [s.line for s in program.steps] == list(range(1, 53))


def flat(outline):
    """Line, motion before and after, and the rest of the modes of every line of an outline."""
    for part in outline:
        if isinstance(part, PlainLines):
            says = [f"G{n}" if n >= 0 else part.before.motion for n in part.motion.tolist()]
            for k, (before, after) in enumerate(pairwise([part.before.motion, *says])):
                yield part.first + k, before, after, replace(part.modes, motion=None)
        else:
            yield part.line, part.before.motion, part.modes.motion, replace(part.modes, motion=None)


def test_lines_of_plain_motion_are_kept_together():
    text = (b"G21 F100\nG0 X0 Y0\n" + b"G1 X1.\nY2\n\n(so)\nG02 X3 Y2 I1 J0\n; end\n" * 3
            + b"G81 X1 Y1 Z-1 R1\n" + b"X2 Y2\n" * 6 + b"G1 X1\nX2\nX3\nX4 (#1)\nG0 X5\n"
            + b"/X6\nX1\nX2\nX3\nX4\n#1=3\nX7\nX8\nX9\nX#1\nM2\n")  # fmt: skip
    whole: list = []
    read_program(Source(text), fast=True, steps=whole)
    assert sum(isinstance(part, PlainLines) for part in whole) == 2
    assert list(flat(whole)) == list(flat(steps(text)))


def test_what_a_control_does_by_itself_is_no_line():
    found = steps(b"N10 G1 X10 F100\nN20 X=20.0\nN30 M30\n", dialect="sinumerik")
    assert [s.line for s in found] == [1, 2, 3]
    assert found[1].words == {"X": 20.0}


def test_items_of_a_block():
    found = list(block_items("/n10 G1 X sin[30] #<a b> = [2*3] Y-#1 (Hi There) Z 1 .5 ; End"))
    assert found == [
        ("/", "/"),
        ("N", "10"),
        ("G", "1"),
        ("X", "sin[30]"),
        ("#", "#<ab>=[2*3]"),
        ("Y", "-#1"),
        ("(", "(Hi There)"),
        ("Z", "1.5"),
        (";", "; End"),
    ]


@pytest.mark.parametrize("line", ["X", "G1 X[1", "o1 while [1]"])
def test_what_is_no_block_has_no_items(line):
    with pytest.raises(ProgramError):
        list(block_items(line))
