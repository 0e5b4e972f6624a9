"""Okuma OSP: ends computed by hand from what the public posts for OSP write and mean.

Sources: okuma.cps of Autodesk and HSMWorks for OSP-E100M and OSP-P300 (G15 H, G56 Z H, G71 Z with
M53, G4 F), and the list of OSP's G codes (G53 cancels the tool's length).
"""

import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from gcode.language.registry import choose_dialect

TOOLS = {1: ToolEntry(100.0, 10.0), 7: ToolEntry(50.0, 10.0)}
OFFSETS = {"G54": (10.0, 0.0, 0.0), "G55": (20.0, 0.0, 0.0), "G54.1 P2": (80.0, 0.0, 0.0)}
HEAD = "$PART.MIN%\n(PLATE)\nO1000\nN1 G21\nN2 G40 G80 G90 G94 G17\nT1 M6\nS1000 M3\n"


def read(body, head=HEAD):
    text = f"{head}{body}\nM2\n%\n"
    return read_program(Source(text.encode(), "part.min"), tools=TOOLS, work_offsets_mm=OFFSETS,
                        home_mm=(0, 0, 500), dialect="okuma")  # fmt: skip


ENDS = {
    "G15 H1\nG0 X1. Y2.": (11, 2, 500),
    "G15 H2\nG0 X1.": (21, 0, 500),
    "G15 H8\nG0 X1.": (81, 0, 500),
    "G15 H1\nG0 X0.\nG56 Z50. H1": (10, 0, 150),
    "G15 H1\nG0 X0.\nG56 Z50. H7": (10, 0, 100),
    "G15 H1\nG56 Z50. H1\nG53\nG0 Z50.": (0, 0, 50),
    "G15 H1\nVC1=3\nN20 G1 X=VC1*2 F200\nVC1=VC1-1\nIF [VC1 GT 0] N20\nG1 Y1.": (12, 1, 500),
    "G15 H1\nG0 X1.\nGOTO N9\nG0 X2.\nN9 Y1.": (11, 1, 500),
    "G15 H1\nG0 X1.\nCALL O20 Q3\nM2\nO20\nG91 G1 X1. F100\nG90\nRTS": (14, 0, 500),
    "G15 H1\nG0 X0. Y0.\nG3 X10. Y10. I0. J10. F100\nG4 F1.\nM5": (20, 10, 500),
}


@pytest.mark.parametrize("body", ENDS)
def test_ends(body):
    assert read(body).moves.end_mm[-1] == pytest.approx(ENDS[body], abs=1e-9)


def test_cycles_return_to_the_level_of_g71_or_to_r():
    """G71 Z30. with M53 returns there, M54 to R."""
    body = "G15 H1\nG0 X0 Y0\nG56 Z50. H1\nG71 Z30.\nG81 X10. Y5. Z-5. R2. F100 M53\nX20.\n"
    places = read(body).moves.end_mm - [10, 0, 100]
    wanted = [(10, 2), (10, -5), (10, 30), (20, 30), (20, 2), (20, -5), (20, 30)]
    assert [tuple(place) for place in places[-7:, [0, 2]]] == wanted
    near = read(body.replace("M53", "M54")).moves.end_mm - [10, 0, 100]
    levels = [tuple(place) for place in near[-8:, [0, 2]]]
    assert list(dict.fromkeys(levels)) == [(10, 50), (10, 2), (10, -5), (20, 2), (20, -5)]
    assert levels[-1] == (20, 2)


@pytest.mark.parametrize(
    ("body", "word"),
    [
        ("G16 H0 G0 Z0", "G16"), ("G11 X1. P30", "G11"), ("G54 X1. H1", "G54"), ("G43 H1", "G43"),
        ("G76 X1. Z-1. R1. F9 M53", "G76"), ("G15", "G15 without H"), ("G56 Z9.", "G56 without H"),
        ("G81 X1. Z-1. R1. F9", "M53 or M54"), ("G81 X1. Z-1. R1. F9 M53", "M53"),
        ("G81 X1. Z-1. R1. F9 M52", "M52"), ("CALL OABC", "OABC|CALL"), ("NLAP1 G0 X1", "NLAP1"),
        ("VC300=1", "VC300"), ("G85 X1. Z-1. R1. FA=9 M54", "FA"), ("M98 P20", "M98"),
        ("M66", "ignore_m"), ("G71 Z9.\nG91 G81 X1. Z-1. R1. F9 M53", "G91"),
        ("G71 Z25.8.", "cannot read 'G71 Z25.8.'"), ("G71 Z.", "G71 Z and a level"),
    ],
)  # fmt: skip
def test_what_no_source_says_is_refused_by_word(body, word):
    with pytest.raises(ProgramError, match=word):
        read(body)


def test_it_is_recognised():
    assert choose_dialect("auto", HEAD.encode()).dialect.name == "okuma"
    assert choose_dialect("auto", b"O1\nG15 H1\nG0 X1\nM2\n").dialect.name == "okuma"
