"""Drilling, boring and tapping cycles of three controls, step by step as the manuals list them.

B-64484EN-2 "Canned cycle for drilling"; TNC 640 User's Manual Cycle Programming, "Fixed cycles:
drilling" and "tapping"; SINUMERIK 840D sl/828D Programming Manual Cycles, "Drilling". Each row has
the levels to which the tool goes; f marks a feed. The tip is 100 mm below the nose.
"""

import numpy as np
import pytest

from gcode import Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0)}


def steps(text, dialect):
    """Levels of the tip behind its arrival over the hole, feeds marked."""
    program = read_program(Source(text.encode(), "part"), tools=TOOLS, dialect=dialect,
                           home_mm=(0, 0, 300))  # fmt: skip
    moves = program.moves
    over = np.flatnonzero(np.abs(moves.start_mm[:, :2] - [10, 5]).max(axis=1) < 1.0)
    moved = [i for i in over if abs(moves.end_mm[i, 2] - moves.start_mm[i, 2]) > 1e-9]
    return " ".join(f"{moves.end_mm[i, 2] - 100:g}{'f' * bool(moves.at_feed[i])}" for i in moved)


#: in G98 from 20 over R2 to Z-10; 5114 (retraction of G73) and 5115 are 1 mm
FANUC = {
    "G73 Q4.": "2 -2f -1 -6f -5 -10f 20",
    "G74": "2 -10f 2f 20",
    "G76 Q0.5": "2 -10f 20",
    "G81": "2 -10f 20",
    "G83 Q4.": "2 -2f 2 -1 -6f 2 -5 -10f 20",
    "G84": "2 -10f 2f 20",
    "G85": "2 -10f 2f 20",
    "G86": "2 -10f 20",
    "G88 P500": "2 -10f 20",
    "G89 P500": "2 -10f 2f 20",
}


@pytest.mark.parametrize(("cycle", "levels"), FANUC.items())
def test_fanuc(cycle, levels):
    text = ("O1\nG21 G90 G54 T1 M6\nG43 H1 G0 Z20.\nX10. Y5. S500 M3\n"
            f"G98 {cycle} Z-10. R2. F100.\nG80 M5\nM30\n")  # fmt: skip
    assert steps(text, "fanuc") == levels


@pytest.mark.parametrize("cycle", ["G84", "G85", "G81"])
def test_fanuc_g99_stays_at_r(cycle):
    text = ("O1\nG21 G90 G54 T1 M6\nG43 H1 G0 Z20.\nX10. Y5. S500 M3\n"
            f"G99 {cycle} Z-10. R2. F100.\nG80 M5\nM30\n")  # fmt: skip
    assert steps(text, "fanuc").split()[-1].rstrip("f") in ("2",)


#: set-up clearance 2, depth -10, surface 0, second clearance 30; stop ahead 0.2 mm
KLARTEXT = {
    "201 REAMING ~\nQ208=250": "2 -10f 2f 30",
    "202 BORING ~\nQ208=250 ~\nQ214=1": "2 -10f 2 30",
    "203 DRILLING ~\nQ202=4 ~\nQ213=2 ~\nQ256=0.5 ~\nQ205=4 ~\nQ212=0": (
        "2 -4f -3.5 -8f -7.5 -10f 30"),
    "206 TAPPING": "2 -10f 2f 30",
    "207 RIGID TAPPING ~\nQ239=1.5": "2 -10f 2f 30",
    "209 TAPPING ~\nQ239=1.5 ~\nQ257=6 ~\nQ256=1": "2 -6f -4.5f -10f 2f 30",
    "240 CENTERING ~\nQ343=0": "2 -10f 30",
    "241 SINGLE-LIP ~\nQ379=3 ~\nQ253=900 ~\nQ208=2000": "2 -1f -10f 2f 30",
}  # fmt: skip


@pytest.mark.parametrize(("cycle", "levels"), KLARTEXT.items())
def test_klartext(cycle, levels):
    text = ("BEGIN PGM A MM\nTOOL CALL 1 Z S500\nL Z+50 R0 FMAX M3\n"
            f"CYCL DEF {cycle} ~\nQ200=2 ~\nQ201=-10 ~\nQ206=100 ~\nQ203=0 ~\nQ204=30 ~\nQ211=0\n"
            "L X+10 Y+5 FMAX M99\nEND PGM A MM\n")  # fmt: skip
    assert steps(text, "heidenhain") == levels


#: RTP 20, RFP 0, SDIS 2, DP -10
SINUMERIK = {
    "CYCLE81(20,0,2,-10)": "2 -10f 20",
    "CYCLE82(20,0,2,-10,,0.5)": "2 -10f 20",
    "CYCLE84(20,0,2,-10,,0,3,,1.5,0,500,500)": "2 -10f 2f 20",
    "CYCLE840(20,0,2,-10,,0,4,3,0,,1.5)": "2 -10f 2f 20",
    "CYCLE85(20,0,2,-10,,0,100,300)": "2 -10f 2f 20",
    "CYCLE87(20,0,2,-10,,3)": "2 -10f 20",
    "CYCLE88(20,0,2,-10,,0.5,3)": "2 -10f 20",
    "CYCLE89(20,0,2,-10,,0.5)": "2 -10f 2f 20",
}


@pytest.mark.parametrize(("cycle", "levels"), SINUMERIK.items())
def test_sinumerik(cycle, levels):
    text = f"G54 G90 T1 D1 M6\nG0 Z20 S500 M3\nX10 Y5 F100\n{cycle}\nM30\n"
    assert steps(text, "sinumerik") == levels
