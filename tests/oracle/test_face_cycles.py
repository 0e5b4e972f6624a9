"""Face milling: what is left stands at the level, everywhere in the rectangle and not beyond."""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from tests.oracle.test_klartext_cycles import tip

TOOLS = {1: ToolEntry(100.0, 20.0)}
KLARTEXT = """BEGIN PGM A MM
TOOL CALL 1 Z S1000 F300
L Z+60 R0 FMAX M3
CYCL DEF 232 FACE MILLING ~
 Q389={way} ~
 Q225=+10 ~
 Q226=+12 ~
 Q227=+2.5 ~
 Q386=-3 ~
 Q218={length} ~
 Q219={width} ~
 Q202=2 ~
 Q369=0.5 ~
 Q370=1.4 ~
 Q207=500 ~
 Q385=800 ~
 Q253=2000 ~
 Q200=2 ~
 Q357=3 ~
 Q204=50
CYCL CALL
END PGM A MM
"""


def read(text, dialect):
    return read_program(Source(text.encode(), "part"), tools=TOOLS, dialect=dialect,
                        home_mm=(0, 0, 200))  # fmt: skip


def swept(places, level, spots):
    """Whether the mill, 20 wide, has been over each spot (S, 2) at a level."""
    low = places[np.abs(places[:, 2] - level) < 1e-9, :2]
    apart = np.hypot(spots[:, None, 0] - low[None, :, 0], spots[:, None, 1] - low[None, :, 1])
    return apart.min(axis=1) <= 10.0 + 0.3


def spots_of(x, y):
    grid = np.meshgrid(np.linspace(*x, 14), np.linspace(*y, 14))
    return np.stack([g.ravel() for g in grid], axis=1)


@pytest.mark.parametrize("way", [0, 1, 2])
@pytest.mark.parametrize(("length", "width"), [(80, 50), (-80, 50), (80, -50)])
def test_cycle_232(way, length, width):
    program = read(KLARTEXT.format(way=way, length=length, width=width), "heidenhain")
    places = tip(program)
    x, y = sorted((10, 10 + length)), sorted((12, 12 + width))
    assert places[:, 2].min() == pytest.approx(-3)
    inner = spots_of((x[0] + 3, x[1] - 3), (y[0] + 3, y[1] - 3))
    assert swept(places, -3, inner).all()
    low = places[places[:, 2] < 2.5 - 1e-9]
    beyond = 10 + 3  # radius and Q357
    assert low[:, 0].min() >= x[0] - beyond - 1e-9 and low[:, 0].max() <= x[1] + beyond + 1e-9
    assert low[:, 1].min() >= y[0] - 1e-9 and low[:, 1].max() <= y[1] + 1e-9
    moves = program.moves
    levels = (moves.end_mm[:, 2] - 100).round(6)
    # from 2.5 to -2.5 in infeeds of at most 2: three; then -3 for finishing at Q385
    wanted = {round(2.5 - 5 * k / 3, 6) for k in (1, 2, 3)} | {-3.0}
    found = {v for v in levels if v < 2.5}
    assert found == wanted if way < 2 else found >= wanted
    long = np.hypot(*(moves.end_mm - moves.start_mm)[:, :2].T) > 55
    finishing = moves.feed_mm_per_min[long & (levels == -3.0)]
    assert set(finishing) <= {800.0, 2000.0} and 800.0 in finishing
    ends = moves.end_mm[long & (levels == -3.0), 0]
    outside = (ends < x[0]) | (ends > x[1])
    assert outside.all() if way != 1 else outside.sum() <= 1, "the first line begins outside"
    assert moves.end_mm[-1, 2] == pytest.approx(100 + 2.5 + 50)


@pytest.mark.parametrize("vari", [11, 21, 31, 41])
def test_cycle71(vari):
    """A rectangle of 60 by 40 turned by 30 degrees about its corner, lines at most 12 apart."""
    body = f"CYCLE71(20,5,2,-4,15,25,60,40,30,3,12,4,0.5,900,{vari})"
    text = f"G17 G71 G90 G54\nT1 D1 M6\nS1000 M3 F300\nG0 X0 Y0 Z80\n{body}\nM30\n"
    program = read(text, "sinumerik")
    places = tip(program)
    assert places[:, 2].min() == pytest.approx(-3.5), "0.5 is left for finishing"
    turn = np.radians(30.0)
    axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    own = np.column_stack([(places[:, :2] - [15, 25]) @ axes, places[:, 2]])
    assert swept(own, -3.5, spots_of((0, 60), (0, 40))).all()
    low = own[own[:, 2] < 5 - 1e-9]
    along, across = (0, 1) if vari in (11, 31) else (1, 0)
    size = (60, 40)
    assert low[:, along].min() == pytest.approx(-4) and low[:, across].min() >= -1e-9
    assert low[:, along].max() == pytest.approx(size[along] + 4)
    assert low[:, across].max() <= size[across] + 1e-9
    assert program.moves.end_mm[-1, 2] == pytest.approx(120)


def test_cycle71_as_the_manual_calls_it():
    """840D Cycles, "Face milling": 60 by 40 at 100, 100, turned by 10 degrees, down to -11."""
    body = "CYCLE71(10,0,2,-11,100,100,60,40,10,6,10,5,0,4000,31,2)"
    text = f"G17 G0 G90 G54 G94\nT1 D1 M6\nS1000 M3 F2000\nX0 Y0 Z20\n{body}\nM30\n"
    program = read(text, "sinumerik")
    places, turn = tip(program), np.radians(10.0)
    axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    own = np.column_stack([(places[:, :2] - [100, 100]) @ axes, places[:, 2]])
    assert own[:, 2].min() == pytest.approx(-11)
    for level in (-5.5, -11.0):
        assert swept(own, level, spots_of((0, 60), (0, 40))).all()
    moves = program.moves
    cutting = np.abs(moves.end_mm[:, 2] - 89.0) < 1e-9
    assert set(moves.feed_mm_per_min[cutting]) == {4000.0}


QUICK = "BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\nL X+50 Y+60 Z+60 R0 FMAX M3\n"


def klartext_cycle(number, **q):
    lines = "".join(f" ~\n {key}={value:+g}" for key, value in q.items())
    return read(f"{QUICK}CYCL DEF {number} FACE{lines}\nCYCL CALL\nEND PGM A MM\n", "heidenhain")


def test_cycle_230_makes_so_many_lines_at_one_level():
    program = klartext_cycle(230, Q225=10, Q226=12, Q227=2.5, Q218=80, Q219=60, Q240=7, Q206=150,
                             Q207=500, Q209=200, Q200=2)  # fmt: skip
    moves = program.moves
    lines = moves.feed_mm_per_min == 500
    assert lines.sum() == 7
    assert moves.end_mm[lines, 1] == pytest.approx(12 + 10 * np.arange(7))
    assert moves.start_mm[lines, 0] == pytest.approx([0, 100] * 3 + [0]), "a radius beyond the face"
    assert moves.end_mm[lines, 2] == pytest.approx(102.5)
    assert (moves.feed_mm_per_min == 200).sum() == 6
    assert swept(tip(program), 2.5, spots_of((10, 90), (12, 72))).all()
    assert moves.end_mm[-1, 2] == pytest.approx(104.5)


def test_cycle_231_goes_from_the_first_line_to_the_last():
    corners = [(0, 5, -2), (100, 15, 5), (15, 125, 25), (15, 125, 25)]
    q = {f"Q{225 + 3 * k + a}": v for k, p in enumerate(corners) for a, v in enumerate(p)}
    moves = klartext_cycle(231, **q, Q240=40, Q207=500).moves
    lines = np.flatnonzero(moves.feed_mm_per_min == 500)
    begins, ends = moves.end_mm[lines[::2]] - [0, 0, 100], moves.end_mm[lines[1::2]] - [0, 0, 100]
    share = np.linspace(0, 1, 40)[:, None]
    one, two, three, four = np.array(corners, float)
    assert begins == pytest.approx(one + (four - one) * share)
    assert ends == pytest.approx(two + (three - two) * share)
    between = moves.feed_mm_per_min > 500
    assert moves.end_mm[between][3:, 2].min() > 105, "above the line that was cut, by the diameter"


@pytest.mark.parametrize("place", [0, 1, 2, 3, 4])
@pytest.mark.parametrize(("way", "axis"), [(0, 1), (1, 2), (2, 1), (3, 2)])
def test_cycle_233_lies_as_its_place_says(way, axis, place):
    program = klartext_cycle(
        233, Q215=0, Q389=way, Q350=axis, Q218=70, Q219=40, Q227=2, Q386=-1, Q369=0.5, Q202=3,
        Q370=1.2, Q207=500, Q385=800, Q253=2000, Q357=1, Q200=2, Q204=50, Q367=place,
    )  # fmt: skip
    corner = {0: (15, 40), 1: (50, 60), 2: (-20, 60), 3: (-20, 20), 4: (50, 20)}[place]
    x, y = (corner[0], corner[0] + 70), (corner[1], corner[1] + 40)
    places = tip(program)
    assert places[:, 2].min() == pytest.approx(-1)
    for level in (-0.5, -1.0):
        assert swept(places, level, spots_of((x[0] + 3, x[1] - 3), (y[0] + 3, y[1] - 3))).all()
    long = program.moves.feed_mm_per_min == 500
    assert np.ptp(program.moves.end_mm[long], axis=0)[2] < 1e-9
    across = program.moves.end_mm[long, 1 if axis == 1 else 0]
    low, high = (y, x)[axis - 1]
    assert across.min() >= low and across.max() <= high


def test_what_is_missing_is_refused():
    with pytest.raises(ProgramError, match="Q347=1"):
        klartext_cycle(233, Q389=0, Q218=70, Q219=40, Q227=2, Q386=0, Q200=1, Q347=1)
    with pytest.raises(ProgramError, match="Q240=1"):
        klartext_cycle(230, Q225=1, Q226=1, Q227=1, Q218=8, Q219=6, Q240=1, Q206=1, Q207=1)
    with pytest.raises(ProgramError, match="CYCLE71 without MIDA"):
        read("CYCLE71(20,5,2,-4,15,25,60,40,30,3)\nM30", "sinumerik")
    with pytest.raises(ProgramError, match="Q389=7"):
        read(KLARTEXT.format(way=7, length=9, width=9), "heidenhain")
