"""Roundings and chamfers of Fanuc programs, written out: against corners worked out by hand.

B-64484EN, "Optional chamfering and corner R": ``,R`` lays an arc of that radius to both pieces,
``,C`` leaves the corner by that length on both.
"""

import numpy as np
import pytest

from gcode import Source, ToolEntry, read_program
from vmach.program_text.expanding.expansion import expanded

HEAD = "G90 G94 G17 G21 G40\nT1 M6\nG54\nG0 X-40. Y-20. Z-2.\n"
TOOLS = {1: ToolEntry(length_mm=0.0, diameter_mm=8.0)}
SQUARE = "G1 X20. ,R5. F300.\nY20. , C2. (chamfer)\nX-20.\nM30\n"


def read(body, **options):
    text = HEAD + body
    return read_program(Source(text.encode()), dialect="fanuc", tools=TOOLS, **options)


def lines_of(program):
    return program.source.data.decode().splitlines()[4:-1]


def test_lines_and_arcs_take_the_place_of_the_words():
    assert lines_of(expanded(read(SQUARE))[0]) == [
        "G1 X15. F300.",
        "G3 X20. Y-15. I0. J5.",
        "G1 Y18. (chamfer)",
        "G1 X18. Y20.",
        "G1 X-20.",
    ]


@pytest.mark.parametrize(
    ("body", "ends"),
    [
        (SQUARE, [(15, -20), (20, -15), (20, 18), (18, 20), (-20, 20)]),
        # the next line counts from the programmed corner, and begins behind the rounding
        ("G91 G1 X60. ,R5. F300.\nY40. ,R3.\nX-10.\nM30\n",
         [(15, -20), (20, -15), (20, 17), (17, 20), (10, 20)]),
        # the tool's centre in the pocket: 4 mm inside, the arc of 9 mm has 5 mm left
        ("G41 D1 G1 X0. Y-10. F300.\nX20. ,R9.\nY20.\nX-20.\nG40 Y40.\nM30\n",
         [(0, -6), (11, -6), (16, -1), (16, 16), (-20, 16), (-20, 40)]),
    ],
)  # fmt: skip
def test_the_path_is_that_of_the_corners(body, ends):
    written = expanded(read(body))[0]
    assert "," not in written.source.data.decode()
    found = written.moves.end_mm[written.moves.feed_mm_per_min == 300.0, :2]
    np.testing.assert_allclose(found, ends, atol=1e-9)


#: the same square for other controls
SINUMERIK = "G90 G17 G71\nT1 M6\nG54\nG0 X-40 Y-20 Z-2\nG1 X20 RND=5 F300\nY20 CHR=2\nX-20\nM30\n"
KLARTEXT = """\
0 BEGIN PGM A MM
1 TOOL CALL 1 Z S3000
2 L X-40 Y-20 Z-2 R0 FMAX
3 L X+20 R0 F300
4 RND R5
5 L Y+20
6 CHF 2
7 L X-20
8 END PGM A MM
"""


@pytest.mark.parametrize(
    ("control", "text", "lines"),
    [
        ("fanuc", HEAD + SQUARE, [5, 5, 6, 6, 7]),
        ("sinumerik", SINUMERIK, [5, 5, 6, 6, 7]),
        ("heidenhain", KLARTEXT, [4, 4, 6, 6, 8]),
    ],
)
def test_a_corner_belongs_to_the_line_that_asks_for_it(control, text, lines):
    """Before, the wall of 35 mm was told as that of the next line."""
    moves = read_program(Source(text.encode()), dialect=control, tools=TOOLS).moves
    cuts = moves.feed_mm_per_min == 300.0
    np.testing.assert_allclose(
        moves.end_mm[cuts, :2], [(15, -20), (20, -15), (20, 18), (18, 20), (-20, 20)], atol=1e-9
    )
    assert moves.line[cuts].tolist() == lines


def test_modal_rounding_of_sinumerik_is_written_out():
    """RNDM rounds every corner until it is zero; its words would round the new ones again."""
    body = "G90 G17 G71\nT1 M6\nG54\nG0 X-40 Y-20 Z-2\nG1 X20 RNDM=5 F300\nY20\nRNDM=3\nX-20\nY0\n"
    program = read_program(
        Source(f"{body}RNDM=0\nX0\nM30\n".encode()), dialect="sinumerik", tools=TOOLS
    )
    written = expanded(program)[0]
    assert b"RNDM" not in written.source.data
    ends = [(15, -20), (20, -15), (20, 15), (15, 20), (-17, 20), (-20, 17), (-20, 3), (-17, 0)]
    for moves in (program.moves, written.moves):
        found = moves.end_mm[moves.feed_mm_per_min == 300.0, :2]
        np.testing.assert_allclose(found, [*ends, (0, 0)], atol=1e-9)
