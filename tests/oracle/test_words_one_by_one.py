"""Every word of the controls' lists with a program of its own: where it ends, or why it is refused.

Ends are computed by hand from the makers' manuals. Zeros: G54 at X10, G55 at X20, ..., G54.1 P5
(G505, G154 P5, G114) at X500; machine zero is the origin; tool 1 is 100 long and 10 wide.
"""

import math

import pytest

from gcode import ProgramError, Source, ToolEntry, read_program

TOOLS = {1: ToolEntry(100.0, 10.0, name="MILL"), 2: ToolEntry(50.0, 4.0)}
OFFSETS = {f"G5{k}": (10.0 * (k - 3), 0.0, 0.0) for k in range(4, 10)} | {
    "G54.1 P5": (500.0, 0.0, 0.0)
}
ROOT = math.sqrt(0.5)


def run(body, dialect):
    if dialect == "heidenhain":
        body = f"BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F300\n{body}\nEND PGM A MM\n"
    else:
        body = (
            "O1\nG21 F100\n" if dialect in ("fanuc", "haas", "mazak") else "F100\n"
        ) + f"{body}\nM30\n"
    return read_program(Source(body.encode(), "part"), tools=TOOLS, work_offsets_mm=OFFSETS,
                        dialect=dialect, home_mm=(0, 0, 500))  # fmt: skip


#: program -> X Y Z where it ends
FANUC = {
    "G0 X5.\nG04 X1.": (15, 0, 500),
    "G0 X5.\nG04 P500": (15, 0, 500),
    "G0 X5.\nG04 U1.": (15, 0, 500),
    "G09 G1 X5.": (15, 0, 500),
    "G61 G1 X5.": (15, 0, 500),
    "G64 G1 X5.": (15, 0, 500),
    "G05 P10000\nG0 X5.\nG05 P0": (15, 0, 500),
    "G05.1 Q1\nG0 X5.\nG05.1 Q0": (15, 0, 500),
    "G5.1 Q2 X0 Y0 Z0\nG0 X5.\nG5.1 Q0": (15, 0, 500),
    "G5.1 Q2 X0 Y0 Z0 A0\nG91 G0 X1.\nG90": (1, 0, 500),
    "G08 P1\nG0 X5.": (15, 0, 500),
    "G187 P3 E0.01\nG0 X5.": (15, 0, 500),
    "G10 L1 P1 R1.\nG43 H1 Z0": (0, 0, 101),
    "G10 L2 P1 X5.\nG0 X0.": (5, 0, 500),
    "G10 L2 P0 X5.\nG0 X0.": (15, 0, 500),
    "G91 G10 L2 P1 X5.\nG90 G0 X0.": (15, 0, 500),
    "G10 L10 P1 R50.\nG43 H1 Z0": (0, 0, 50),
    "G10 L11 P1 R.1\nG43 H1 Z0": (0, 0, 100.1),
    "G10 L20 P5 X3.\nG54.1 P5 G0 X0": (3, 0, 500),
    "G16 G0 X10. Y30.\nG15": (10 + 10 * math.cos(math.pi / 6), 5, 500),
    "G0 X5.\nG28 X0. Y0.": (0, 0, 500),
    "G0 G28 Z5.": (0, 0, 0),
    "G91 G28 Z0.": (0, 0, 0),
    "G0 X5.\nG30 P2 X0": (0, 0, 500),
    "G0 X5.\nG53 X3.": (3, 0, 500),
    "G31 Z-5.": (0, 0, -5),
    "G60 X5.": (15, 0, 500),
    "G43 H1 Z50.": (0, 0, 150),
    "G44 H1 Z50.": (0, 0, -50),
    "G43 H1 Z50.\nG49 Z5.": (0, 0, 5),
    "G43 Z5. H0": (0, 0, 5),
    "G43 H1\nG0 Z1.\nG0 X1.": (11, 0, 101),
    "G51 X0 Y0 P2.\nG0 X5. Y1.": (20, 2, 500),
    "G51 X0 Y0 I2. J3. K1.\nG0 X5. Y1.": (20, 3, 500),
    "G51.1 X0.\nG0 X5.": (5, 0, 500),
    "G51.1 X0.\nG50.1 X0.\nG0 X5.": (15, 0, 500),
    "G52 X5. Y5.\nG0 X0 Y0": (15, 5, 500),
    "G54.1 P5\nG0 X1.": (501, 0, 500),
    "G54 P5\nG0 X1.": (501, 0, 500),
    "G68 X0. Y0. R45.\nG0 X10.": (10 + 10 * ROOT, 10 * ROOT, 500),
    "G68 X0. Y0. R45.\nG69\nG0 X10.": (20, 0, 500),
    "G65 P100 A1.\nM30\nO100\nG0 X#1\nM99": (11, 0, 500),
    "G66 P100 A1.\nG0 X5.\nG67\nM30\nO100\nG91 G0 Z-#1\nG90\nM99": (15, 0, 499),
    "G1 X10. ,R2.\nY10.": (20, 10, 500),
    "G1 X10. ,C2.\nY10.": (20, 10, 500),
    "M98 P30100\nM30\nO100\nG91 G0 X5.\nM99": (15, 0, 500),
    "M98 P100 L2\nM30\nO100\nG91 G0 X5.\nM99": (10, 0, 500),
    "M98 P0030100\nM30\nO100\nG91 G0 X5.\nM99": (15, 0, 500),
    "M97 P10\nM30\nN10 G0 X5.\nM99": (15, 0, 500),
    "M98 P100\nG0 X1.\nN5 G0 X7.\nM30\nO100\nM99 P5": (17, 0, 500),
    "M98 <PART>\nM30\nO<PART>\nG0 X5.\nM99": (15, 0, 500),
    "M98 P100 (A (B) C)\nM30\n:0100\nG0 X5.\nM99": (15, 0, 500),
    "#5221=7.\nG0 X1.": (8, 0, 500),
    "#5201=5.\nG0 X1.": (16, 0, 500),
    "G43 H1 Z0\n#1=#5083\nG0 X#1": (110, 0, 100),
    "G0 X[BIN[BCD[12]]]": (22, 0, 500),
    "#1=5 MOD 3\nG0 X[#1+ROUND[1.4]+FIX[1.5]+FUP[1.5]]": (16, 0, 500),
    "G0 X[POW[2,3]+ATAN[1,1]+SQRT[4]+ABS[-1]]": (66, 0, 500),
    "G98 G81 X1. Z-5. R1. K3": (11, 0, 500),
    "G99 G81 X1. Z-5. R1.": (11, 0, 1),
    "M29 S100\nG99 G84 X1. Z-5. R1.": (11, 0, 1),
    "S100 M3\nG99 G84.2 X1. Z-5. R1.": (11, 0, 1),
    "S100 M4\nG99 G84.3 X1. Z-5. R1.": (11, 0, 1),
    "G1 X5. (A (B) C) Y2.": (15, 2, 500),
    **{f"S100 M3\nG99 G{c} X1. Z-5. R1. Q1. P10": (11, 0, 1) for c in (73, 81, 82, 83, 85, 86, 89)},
    "S100 M4\nG99 G74 X1. Z-5. R1.": (11, 0, 1),
    "S100 M3\nG99 G76 X1. Z-5. R1. Q.1": (11, 0, 1),
    "S100 M3\nG99 G88 X1. Z-5. R1.": (11, 0, 1),
}
HAAS = {
    "G154 P5\nG0 X1.": (501, 0, 500), "G114\nG0 X1.": (501, 0, 500),
    "G0 X0 Y0\nG81 G99 X0 Y0 Z-5. R1. L0\nG72 I10. J90. L3": (10, 20, 1),
    "G0 X0 Y0\nG81 G99 X0 Y0 Z-5. R1. L0\nG70 I10. J90. L4": (20, 0, 1),
    "G0 X0\nG12 I15. D1": (10, 0, 500), "G0 X0\nG13 I15. K20. Q5. D1": (10, 0, 500),
}  # fmt: skip
SINUMERIK = {
    "G500\nG0 X5": (5, 0, 500),
    "G505 G0 X1": (501, 0, 500),
    "TRANS X5 Y5\nG0 X0 Y0": (15, 5, 500),
    "TRANS X5\nATRANS X5\nG0 X0": (20, 0, 500),
    "ROT Z90\nG0 X5 Y0": (10, 5, 500),
    "ROT RPL=90\nG0 X5 Y0": (10, 5, 500),
    "TRANS X5\nAROT Z90\nG0 X5 Y0": (15, 5, 500),
    "SCALE X2\nG0 X5": (20, 0, 500),
    "MIRROR X0\nG0 X5": (5, 0, 500),
    "TRANS X5\nAMIRROR X0\nG0 X5": (10, 0, 500),
    "$P_UIFR[1,X,TR]=3\nG54 G0 X1": (4, 0, 500),
    "$P_UIFR[1]=CTRANS(X,3,Y,2)\nG54 G0 X1 Y0": (4, 2, 500),
    "G91 G0 X=AC(4)": (14, 0, 500),
    "G0 X5\nX=IC(2)": (17, 0, 500),
    "G0 X0\nG110 X5\nG0 AP=0 RP=2": (17, 0, 500),
    "G111 X5\nG0 AP=90 RP=2": (15, 2, 500),
    "G111 X5\nG112 X1\nG0 AP=0 RP=2": (18, 0, 500),
    "G0 X0\nG2 X10 Y0 CR=5": (20, 0, 500),
    "G0 X0\nG2 X10 Y0 I=AC(5) J=AC(0)": (20, 0, 500),
    "G0 X0\nCIP X10 Y0 I1=5 J1=5": (20, 0, 500),
    "G0 X0\nG1 X10\nCT X20 Y10": (30, 10, 500),
    "G0 X0\nG3 X0 Y0 Z9 I5 J0 TURN=2": (10, 0, 9),
    "G1 X5 RND=1\nY5": (15, 5, 500),
    "G1 X5 CHF=1\nY5": (15, 5, 500),
    "G1 X5 CHR=1\nY5": (15, 5, 500),
    "T1 M6\nG0 X-20 Y0\nG41 NORM G1 X0\nY20\nX20\nG40 X40": (50, 20, 500),
    "CYCLE81(10,0,2,-5)": (0, 0, 10),
    "CYCLE82(10,0,2,-5,,1)": (0, 0, 10),
    "CYCLE83(10,0,2,-20,,-5,,2,0,0,1,0)": (0, 0, 10),
    "CYCLE84(10,0,2,-20,,0,3,,1,0,500,500)": (0, 0, 10),
    "CYCLE85(10,0,2,-9,,0,9,9)": (0, 0, 10),
    "S9 M3\nCYCLE86(10,0,2,-9,,0,3,1,0,1,0)": (0, 0, 10),
    "CYCLE87(10,0,2,-9,,3)": (0, 0, 10),
    "CYCLE88(10,0,2,-9,,0,3)": (0, 0, 10),
    "CYCLE89(10,0,2,-9,,0)": (0, 0, 10),
    "S9 M3\nCYCLE840(10,0,2,-9,,0,4,3,0,,1)": (0, 0, 10),
    "CYCLE800()\nG0 X1": (11, 0, 500),
    "CYCLE832(0.01,_FINISH,1)\nG0 X1": (11, 0, 500),
    "MCALL CYCLE81(10,0,2,-5)\nHOLES1(0,0,90,5,10,3)\nMCALL": (10, 25, 10),
    "MCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,30,0,90,2)\nMCALL": (10, 30, 10),
    "MCALL CYCLE81(10,0,2,-5)\nG0 X5 Y6\nMCALL\nX7": (17, 6, 10),
    "R1=5 R2=R1*2\nG0 X=R2": (20, 0, 500),
    "DEF REAL AA=5\nG0 X=AA": (15, 0, 500),
    "IF R1==0\nG0 X1\nELSE\nG0 X2\nENDIF": (11, 0, 500),
    "FOR R1=1 TO 3\nG0 X=R1\nENDFOR": (13, 0, 500),
    "WHILE R1<3\nR1=R1+1\nENDWHILE\nG0 X=R1": (13, 0, 500),
    "REPEAT\nR1=R1+1\nUNTIL R1>3\nG0 X=R1": (14, 0, 500),
    "R1=2\nCASE R1 OF 1 GOTOF A1 2 GOTOF A2 DEFAULT GOTOF A3\nA1: G0 X1\nA2: G0 X2\nA3:": (
        12,
        0,
        500,
    ),
    "PA1(5)\nM30\nPROC PA1(REAL X1)\nG0 X=X1\nRET": (15, 0, 500),
    "L100 P2\nM30\n%_N_L100_SPF\nG91 G0 X5\nG90\nM17": (10, 0, 500),
    'EXTCALL("C:/AB.SPF")\nM30\n%_N_AB_SPF\nG0 X5\nM17': (15, 0, 500),
    'T="MILL" D1\nM6\nG0 Z0': (0, 0, 100),
    "T1 M6\nSUPA G0 D0 Z0": (0, 0, 0),
    'MSG("A")\nG0 X1': (11, 0, 500),
    "STOPRE\nG641 ADIS=0.5\nFFWON\nG0 X1": (11, 0, 500),
    "G70 G0 X1": (10 + 25.4, 0, 500),
    "G71 G0 X1": (11, 0, 500),
    "G700 G0 X1": (10 + 25.4, 0, 500),
    'GROUP_BEGIN(0,"A",0,0)\nG0 X1\nGROUP_END(0,0)': (11, 0, 500),
    "S1=1000 M1=3\nG0 X1": (11, 0, 500),
    "SPOS=90\nLIMS=900\nFGROUP(X,Y)\nG9 G1 X1": (11, 0, 500),
    "G93 G1 X1 F2": (11, 0, 500),
}
KLARTEXT = {
    "TOOL CALL 2 Z S100 F50 DL+1 DR+0.1\nL Z+0 FMAX": (0, 0, 51),
    'TOOL CALL "MILL" Z\nL Z+0 FMAX': (0, 0, 100),
    "TOOL DEF 2\nL X+5,5 FMAX": (15.5, 0, 500),
    "BLK FORM 0.1 Z X+0 Y+0 Z-9\nL X+1 FMAX": (11, 0, 500),
    "L X+5 FMAX\nCC X+0 Y+0\nC X-5 Y+0 DR+": (5, 0, 500),
    "CC X+0 Y+0\nLP PR+5 PA+90 FMAX": (10, 5, 500),
    "L X+5 FMAX\nCC X+0 Y+0\nCP PA+90 DR+": (10, 5, 500),
    "L X+0 FMAX\nCR X+10 Y+0 R+5 DR-": (20, 0, 500),
    "L X+0 FMAX\nL X+10\nCT X+20 Y+10": (30, 10, 500),
    "L X+9\nRND R2\nL Y+9": (19, 9, 500),
    "L X+9\nCHF 2\nL Y+9": (19, 9, 500),
    "L X-20 FMAX\nAPPR LT X+10 Y+0 LEN15 RL\nL X+20\nDEP LT LEN15": (45, 5, 500),
    "L X+5 F AUTO": (15, 0, 500),
    "L X+5 FMAX M91": (5, 0, 500),
    "L X+5 FMAX M92": (5, 0, 500),
    "L Z+0 FMAX\nL M140 MB50 F100": (0, 0, 150),
    "M126\nM103 F50\nL X+1 FMAX": (11, 0, 500),
    "CYCL DEF 7.0\nCYCL DEF 7.1 X+5\nL X+0 FMAX": (15, 0, 500),
    "CYCL DEF 8.0\nCYCL DEF 8.1 X\nL X+5 FMAX": (5, 0, 500),
    "CYCL DEF 10.0\nCYCL DEF 10.1 ROT+90\nL X+5 Y+0 FMAX": (10, 5, 500),
    "CYCL DEF 11.0\nCYCL DEF 11.1 SCL2\nL X+5 FMAX": (20, 0, 500),
    "CYCL DEF 19.0\nCYCL DEF 19.1 A+0 B+0 C+0\nL X+1 FMAX": (11, 0, 500),
    "CYCL DEF 247 PRESET ~\nQ339=1\nCYCL DEF 32.0 T\nCYCL DEF 32.1 T0.05\nL X+1 FMAX": (11, 0, 500),
    "TRANS DATUM AXIS X+5\nL X+0 FMAX": (15, 0, 500),
    "TRANS DATUM AXIS X+5\nTRANS DATUM RESET\nL X+1 FMAX": (11, 0, 500),
    "TRANS MIRROR AXIS X\nL X+5 FMAX": (5, 0, 500),
    "TRANS ROTATION ROT+90\nL X+5 Y+0 FMAX": (10, 5, 500),
    "TRANS SCALE SCL2\nL X+5 FMAX": (20, 0, 500),
    "LBL 1\nL IX+1 FMAX\nCALL LBL 1 REP 2": (3, 0, 500),
    'CALL LBL "A"\nM2\nLBL "A"\nL X+5 FMAX\nLBL 0': (15, 0, 500),
    "QL1=5\nQR1=2\nL X+QL1 Y+QR1 FMAX": (15, 2, 500),
    "Q1 = SIN 30 + 2 * SQRT 4 - ABS -1\nL X+Q1 FMAX": (13.5, 0, 500),
    "FN 4: Q1 = +6 DIV +3\nL X+Q1 FMAX": (12, 0, 500),
    "FN 8: Q1 = +3 LEN +4\nL X+Q1 FMAX": (15, 0, 500),
    "FN 13: Q1 = +1 ANG +1\nL X+Q1 FMAX": (55, 0, 500),
    "FN 18: SYSREAD Q1 = ID50 NR2 IDX1\nL X+Q1 FMAX": (15, 0, 500),
    "PLANE RESET STAY\nL X+1 FMAX": (11, 0, 500),
    "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\nL X+1 FMAX": (11, 0, 500),
    "CYCL DEF 200 D ~\nQ200=2 ~\nQ201=-8 ~\nQ206=FAUTO ~\n"
    "Q202=8 ~\nQ203=0 ~\nQ204=20\nL X+1 FMAX M99": (
        11,
        0,
        120,
    ),
}
MAZAK = {"T1 T2 M6\nG43 H1 G0 Z0\nM6\nG43 H2 Z0": (0, 0, 50), "G61.1 G1 X5.": (15, 0, 500)}
ENDS = [
    (dialect, body, end)
    for dialect, table in (
        ("fanuc", FANUC), ("haas", HAAS), ("mazak", MAZAK),
        ("sinumerik", SINUMERIK), ("heidenhain", KLARTEXT)
    )
    for body, end in table.items()
]  # fmt: skip


@pytest.mark.parametrize(("dialect", "body", "end"), ENDS)
def test_a_word_ends_where_it_says(dialect, body, end):
    assert run(body, dialect).moves.end_mm[-1] == pytest.approx(end)


REFUSED = {
    "fanuc": {
        "G10 L50\nN1 P1 R1\nG11": "G10 L50", "G12 I5. D1": r"G12 \(circular", "G12.1": "G12.1",
        "G28": "G28 without axes", "G39": "G39", "G43.4 H1": "G43.4", "G45 X1. D1": "G45",
        "G47 P0 X1. (A)": "the control's own", "G68.2": "G68.2", "G7.1 C5.": "G7.1",
        "G5.1 Q2 X0 Z1.": "G5.1 with X Z", "G5.1 Q1 X0": "G5.1 with X",
        "G33 Z1. F1.": "G33", "G96 S9": "G96", "U5.": "U word", "M31\nM88": "M31 M88",
        "M98 P77": "O77", "M98 <NO>": "O<NO>", "#3000=1": "alarm 1", "BIN": "unknown word",
        "IF[1EQ1]S9": "IF without GOTO and without THEN",
        "T1 T2 M6": "2 T words",
        "G0 X[BIN[10]]": r"BIN\[10\]", "#1=#3011": "#3011", "G0 X5. ,R2.": ",R or ,C between G0",
    },
    "sinumerik": {
        "TRAORI": "TRAORI", "TRANSMIT": "TRANSMIT", "TRACYL(20)": "TRACYL", "ASPLINE": "spline",
        "G41 KONTC X5": "KONTC", "OFFN=1": "OFFN", "CYCLE90(10,0,2,-5)": "CYCLE90 without",
        'CYCLE72("CON",1)': "CYCLE72 without", "SLOT2(1)": "SLOT2 without",
        "G33 Z1 K1": "G33",
        "G58 X5": "G58", "SETAL(65000)": "alarm", "ROT X10": "tilts", "MIRROR Z0": "over",
        "D2": "D0 D1", "L100": "L100.SPF", "R1=$AC_TIME": "AC_TIME", "HOLES1(0,0,0,1,1,2)": "MCALL",
        "GOTOS": "for ever", "CYCLE800(1,,0,57,0,0,0,0,30,0)": "tilts", "G96 S9": "G96",
    },
    "heidenhain": {
        "M128": "M128", "M97": "M97", "M98": "M98", "M116": "M116", "M136": "M136",
        "PLANE SPATIAL SPA+10 SPB+0 SPC+0": "tilts", "FUNCTION TCPM": "TCPM", "FL X+5": "FL",
        "TCH PROBE 0.0": "TCH", "SPL X1": "SPL", "LN X+1 NX+0": "LN", "CTP PR+5": "CTP",
        "FN 14: ERROR = 1": "stops itself", "FN 17: SYSWRITE ID5": "FN 17", 'QS1="A"': "QS",
        "CYCL DEF 19.1 A+10": "CYCL DEF 19.1.*tilts", "CYCL DEF 275 X": "CYCL DEF 275",
        "CYCL DEF 812 X": "turning programs", "L X+5 FZ0.1": "FZ.*per tooth", "L X+5 FU1": "FU",
        "L X+5 R5": "R beside L", "L X+5 PR5 PA9": "P[RA] beside L", "L X+5 DR+": "DR beside L",
        "CC X+0 Y+0\nC X+10 Y+0 R5 DR+": "R beside C",
        "CALL SELECTED PGM": "SEL PGM", "CALL PGM NO": "NO.H", "CALL LBL 9": "LBL 9",
        "TRANS DATUM TABLE 5": "TRANS DATUM TABLE", "CC Z+0": "CC with Z",
        "L X+1 FMAX M99": "no cycle", "TOOL CALL 1 Y": "TOOL CALL 1 Y", "L X+5 M130": "M130",
    },
}  # fmt: skip


@pytest.mark.parametrize(
    ("dialect", "body", "word"),
    [(d, b, w) for d, table in REFUSED.items() for b, w in table.items()],
)
def test_what_is_not_read_is_refused_by_word_and_line(dialect, body, word):
    with pytest.raises(ProgramError, match=word) as error:
        run(body, dialect)
    assert error.value.line is not None
    assert error.value.line >= (2 if dialect == "sinumerik" else 3)
