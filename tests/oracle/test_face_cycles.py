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


def test_what_is_missing_is_refused():
    with pytest.raises(ProgramError, match="CYCLE71 without MIDA"):
        read("CYCLE71(20,5,2,-4,15,25,60,40,30,3)\nM30", "sinumerik")
    with pytest.raises(ProgramError, match="Q389=7"):
        read(KLARTEXT.format(way=7, length=9, width=9), "heidenhain")
