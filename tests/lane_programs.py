"""Random programs of plain motion in the languages that become RS274/NGC line by line.

Lines that compiled code obeys are mixed with lines that it does not, with numbers at the edge of
what it takes, and with bytes that are no word at all.
"""

from __future__ import annotations

import random
from collections.abc import Callable

__all__ = ["LANGUAGES", "Dice", "random_program"]


class Dice(random.Random):
    """Draws of one program: how wild it is, and whether an arc is in force."""

    wild = 0.0
    arc = False

    def goes_wild(self) -> bool:
        """Whether the next word is one that may be wrong."""
        return self.random() < self.wild


_ODD = ["-0", "+0.0", ".5", "-.25", "+7.", "0.00004", "-0.000001", "1234567890.12345", "00012",
        "0.1234567890123456789", "1e3", "1.2.3", "", "+ 5", "- 3",
        "99999999999999999999"]  # fmt: skip


def _number(rng: Dice) -> str:
    """A place or an odd number."""
    if rng.random() < 0.3 * rng.wild:
        return rng.choice(_ODD)
    return f"{rng.uniform(-60.0, 60.0):{rng.choice(['', '+'])}.{rng.choice([0, 1, 3, 3, 3, 6])}f}"


def _words(rng: Dice, letters: str, share: float, between: str = " ") -> str:
    return between.join(k + _number(rng) for k in letters if rng.random() < share)


def _sinumerik_move(rng: Dice) -> str:
    """G0 to G3 as posts write them; an arc in G91 is right wherever it begins."""
    gap = rng.choice([" ", " ", "", "\t"])
    head = rng.choice(["", "", f"N{rng.randrange(999)} ", f"N{rng.randrange(99)}"])
    tail = rng.choice(["", "", "", " F500", " F=250.5 S3000", " M8", " ; place (1)", "M9", "\r"])
    kind = rng.randrange(8)
    was_arc, rng.arc = rng.arc, kind <= 1
    if kind == 0:
        a, b = round(rng.uniform(1, 9), 3), round(rng.uniform(-9, 9), 3)
        z = rng.choice(["", " Z-0.5"])
        return f"{head}G91 G{rng.choice('23')} X{2 * a} Y{2 * b} I{a} J{b}{z}{tail}"
    if kind == 1:
        radius = rng.choice(["CR=280", "CR = -275.5", "cr=999.", "CR=270+5"])
        radius = rng.choice(["CR=3", "CR 5", "CR="]) if rng.goes_wild() else radius
        return (
            f"{head}G90 G{rng.choice(['2', '03'])} X{_number(rng)} Y{_number(rng)} {radius}{tail}"
        )
    if kind == 2 and rng.goes_wild():
        return f"{head}{_words(rng, 'XYIJ', 0.7, gap)}{tail}"
    said = ["G0 ", "G1 ", "G01", "g1 ", "G0 G90 "]
    code = rng.choice(said if was_arc else ["", "", "", *said, "G90 ", "G91 "])
    words = _words(rng, rng.choice(["XYZ", "XYZ", "XYZ", "xyz", "ZXYA", "XYZC"]), 0.7, gap)
    if rng.random() < 0.2:
        words = words.replace("X", rng.choice(["X=", "X =", "X= "]))
    return f"{head}{code}{words}{tail}"


_SINUMERIK_OTHER = [
    "G90", "G91", "G90", "G17", "G18", "G19", "G17", "G54", "G55", "G500", "G505", "G64", "G641",
    "G60", "G9 X1 Y1", "TRANS X10 Y5", "ATRANS Z1", "TRANS", "ROT Z30", "AROT RPL=15", "ROT",
    "MIRROR X0", "SCALE X2 Y2 Z2", "SCALE X2 Y2", "SCALE", "G41 D1", "G41", "G42", "G40", "G40",
    "G41 X20 Y20", "R1=5.5", "X=R1 Y=R1*2", "X=IC(2) Y=AC(3)", "X=2*3", "G1 X=-(2)", "G70", "G71",
    "G700", "G710", "MCALL CYCLE81(10,0,2,-5)", "MCALL", "CYCLE81(10,0,2,-5)", "G110 X1 Y1",
    "AP=30 RP=10", "RP=5 AP=IC(10)", "G1 X5 Y5 RND=1", "X9 Y9 CHF=1", "RNDM=0.5", "RNDM=0",
    "G2 X5 Y5 AR=90", "G3 X1 Y1 I0.5 J0.5 TURN=1", "CIP X10 Y10 I1=5 J1=8", "CT X4 Y4", "T1 D1 M6",
    "T2 M6", "D0", "D1", "M3 S1000", "M5", "M3 M4", "M8 M9", "M0", "M1", "M19", "S1=1000 M1=3",
    "/X5", "/2 N5 Y3", "LAB1:", "LAB1: X5", "N10 G1 X5 Y5 F300", "GOTOF LAB1", "IF R1<3 GOTOF LAB1",
    "REPEAT LAB1 P=2", "FOR R2=1 TO 3", "ENDFOR", "G4 F1", "G94", "G95 F0.1", "G93 F5", "G74 Z1=0",
    "G75 X1=0", "G53 Z0", "SUPA G0 Z50", "MSG(\"a ; b\")", "; only a comment", "", "  ", "%", "(x)",
    "FFWON", "SOFT", "G0 X1 FFWON", "DIAMON", "CYCLE800()", "G2 X1", "G1 X1 I2", "X1 X2",
    "G1 G0 X1",
    "G1.0 X1", "F0", "F-5", "S-1", "H5", "G1 X1 H5", "STOPRE", "G147 G41 DISR=3 DISCL=1 X5 Y5",
    "G247 G41 DISR=3 X5 Y5 Z-1", "G148 G40 DISR=3 X20 Y20", "N10 N20 X1", "N10.5 X1", "X1;Y2",
    "ROT X5", "G1 F100", "G0", "G3", "I1 J1", "M17", "G33 Z5 K1", "UP1", "L100", "X1 Y2 U3", "Q1=1",
]  # fmt: skip


def _klartext_move(rng: Dice) -> str:
    """L, C, CR and CC as posts write them; a half circle is right wherever it begins."""
    head = rng.choice(["", "", f"{rng.randrange(999)} ", f"{rng.randrange(99)}\t"])
    feed = rng.choice(["", "", "", " F500", " F AUTO", " FAUTO", " F250,5", " FMAX", " F MAX"])
    tail = feed + rng.choice(["", "", "", " R0", " M8", " M13", " M3 M9", " ; place", "R0", "\r"])
    gap = rng.choice([" ", " ", " ", "", "  "])
    kind = rng.randrange(8)
    if kind == 0:
        a, b = round(rng.uniform(1, 9), 3), round(rng.uniform(-9, 9), 3)
        z = rng.choice(["", "", " IZ-0.5", " Z+1"])
        return f"{head}CC IX{a:+} IY{b:+}\nC IX{2 * a:+} IY{2 * b:+}{z} DR{rng.choice('+-')}{tail}"
    if kind == 1:
        radius = rng.choice(["R+280", "R-275.5", "R999", "R 270"])
        radius = rng.choice(["R+3", "", "R0", "R05"]) if rng.goes_wild() else radius
        words = f"X{_number(rng)}{gap}Y{_number(rng)}"
        return f"{head}CR {words} {radius} DR{rng.choice('+-')}{tail}"
    if kind == 2:
        word = "C" if rng.goes_wild() else "CC"
        return f"{head}{word} {_words(rng, 'XY', 0.8, gap)}"
    if kind == 3:
        letters = rng.choice([("IX", "Y", "Z"), ("IX", "IY"), ("X", "IZ")])
        words = gap.join(k + _number(rng) for k in letters if rng.random() < 0.9)
        return f"{head}L {words}{tail}"
    words = _words(rng, rng.choice(["XYZ", "XYZ", "XYZ", "xyz", "ZXY", "XYC"]), 0.7, gap)
    if rng.random() < 0.2:
        words = words.replace(".", ",")
    return f"{head}{rng.choice(['L', 'L', 'L', 'l'])} {words}{tail}"


_KLARTEXT_OTHER = [
    "L RL X+20 Y+20", "L RR X+5 Y+5 F100", "L R0 X+9", "RND R1", "CHF 0.5", "12 RND R0.5 F50",
    "L X+5 Y+5 RND", "CT X+5 Y+5", "LP PR+10 PA+30", "CP IPA+90 DR+", "CP PA+10 IZ-1 DR-",
    "CC X+0 Y+0", "CC", "CC Z+1 X+0", "CC PR+5 PA+10", "C X+5 Z+1 DR+", "TOOL CALL 1 Z S1000 F300",
    "TOOL CALL 2 Z S500", "TOOL CALL S700", "TOOL CALL 1 Z DL+0.5", "Q1 = 5", "L X+Q1", "L IX+Q1",
    "FN 0: Q2 = +3", "LBL 1", "CALL LBL 1 REP 2", "LBL 0", "CALL LBL 1", "LBL 2", "M99", "M89",
    "L X+1 M99", "CYCL DEF 200 Q200=2 Q201=-5 Q206=100 Q202=2 Q210=0 Q203=0 Q204=20 Q211=0",
    "CYCL DEF 7.0 DATUM SHIFT", "CYCL DEF 7.1 X+5 Y+5", "CYCL DEF 10.1 ROT+30", "CYCL DEF 8.1 X",
    "CYCL DEF 11.1 SCL 2", "CYCL DEF 11.1 SCL 1", "CYCL DEF 9.1 DWELL 1", "M8", "M9", "M3", "M5",
    "M13", "M30", "L M30", "L X+5 M91", "L Z+0 R0 FMAX M92", "M103 F50", "L Z-5 M103 F40",
    "L X+1 M140 MB 10", "L X+1 ~", " Y+2", "CYCL DEF 200 ~", "Q200=2 ~", "; comment ~",
    "* - head",
    "/ L X+5", "/12 L X+5", "", "   ", "12", "12 ;", "L", "L F500", "L R0", "L FMAX M3",
    "L X+1 X+2",
    "L S500", "L B+5", "L X+1 IX+2", "C X+1 Y+1 R+2 DR+", "CR X+1 Y+1 DR+", "C X+1 Y+1", "STOP",
    "L X+5 F-5", "L X+5 F0", "L X MAX", "L FZ0.1", "L FU2 X+1", "L DR+ X+1", "LX+1", "L X+1*",
    "APPR LN X+1 Y+1 LEN2 R0 F100", "DEP LN LEN3", "DEP LT LEN4 F100", "DEP CT CCA90 R+2",
    "APPR LT X+10 Y+10 LEN5 RL F100", "BLK FORM 0.1 Z X+0 Y+0 Z-10", "BEGIN PGM B INCH",
    "BEGIN PGM B MM", "END PGM A MM", "PLANE RESET", "N5 L X+1", "L X+1 M118 X1", "M120 LA 5",
    "L X1,5,5", "L X+,5", "L X5, Y3", "L Z-1 F9999 M7 M4", "L X+1 M14 M5 M9 M3 M8",
    "TRANS DATUM X+1",
    "12L X+1", "L X+1 F 100", "L X+1 F", "L X+1 M", "L X+1 R", "L X+0,00001", "L IX+0,00001",
]  # fmt: skip


def _iso_move(rng: Dice) -> str:
    """G00 to G03 of DIN/ISO."""
    head = rng.choice(["", f"N{rng.randrange(999)} ", f"N{rng.randrange(99)} "])
    tail = rng.choice(["", "", " F500", " F250.5", " M8", " M13", " ; place"])
    tail += rng.choice([" *", "*", "", "\r"])
    kind = rng.randrange(6)
    was_arc, rng.arc = rng.arc, kind <= 1
    if kind == 0:
        a, b = round(rng.uniform(1, 9), 3), round(rng.uniform(-9, 9), 3)
        return f"{head}G91 I{a:+} J{b:+} G0{rng.choice('23')} X{2 * a:+} Y{2 * b:+}{tail}"
    if kind == 1:
        radius = rng.choice(["", " R3"]) if rng.goes_wild() else rng.choice([" R+280", " R-275.5"])
        words = f"X{_number(rng)} Y{_number(rng)}"
        return f"{head}G90 G0{rng.choice('23')} {words}{radius}{tail}"
    if kind == 2 and rng.goes_wild():
        return f"{head}{_words(rng, 'IJ', 0.8)}{tail}"
    said = ["G00 ", "G01 ", "G1 G90 ", "G40 G01 "]
    code = rng.choice(said if was_arc else ["", "", *said, "G90 ", "G91 "])
    return f"{head}{code}{_words(rng, rng.choice(['XYZ', 'XYZ', 'XYC']), 0.7)}{tail}"


_ISO_OTHER = [
    "G90", "G91", "G41 G01 X+20 Y+20", "G40 X+5", "G25 R1", "G24 R0.5", "G26 R2", "G10 R+5 H+30",
    "G11 R+5 H+10", "G12 H+90", "G06 X+5 Y+5", "G98 L1", "L1,2", "G98 L0", "L1,0", "T2 G17 S500",
    "M3", "M9", "M30", "D00 Q1 P01 +5", "G01 X+Q1", "G54 X+5", "G73 H+20", "G72 F1.5", "G28 X",
    "G83 P01 2 P02 -5 P03 2 P04 0 P05 100", "G79", "G04 F1", "S700", "F300", "G38", "/G01 X+5", "",
    "G29", "M99", "M89", "G01 X+1 M99", "G53", "G00 Z+5 M91", "G01 X+1 R+2", "*", ";", "N5 *",
    "G03 X+1", "N9 %B G71 *", "G01 X+1 X+2", "M140 MB 5", "G18", "G05 X+5 Y+5 R+9", "G07 X+1",
]  # fmt: skip

#: language -> lines before, a line of plain motion, other lines, a line behind
LANGUAGES: dict[str, tuple[str, Callable[[Dice], str], list[str], str]] = {
    "sinumerik": ("T1 D1 M6\nG71 G17 G90 G54\nG0 X0 Y0 Z50\nG1 Z0 F400\n", _sinumerik_move,
                  _SINUMERIK_OTHER, "M30\n"),
    "heidenhain": ("BEGIN PGM A MM\nTOOL CALL 1 Z S1000 F100\nL X+0 Y+0 Z+50 R0 FMAX M3\n"
                   "L Z+0 F400\n",
                   _klartext_move, _KLARTEXT_OTHER, "END PGM A MM\n"),
    "tnciso": ("%A G71 *\nN1 T1 G17 S1000 F100 *\nN2 G90 G00 G40 X+0 Y+0 Z+50 M3 *\n"
               "G01 Z+0 F400*\n",
               _iso_move, _ISO_OTHER, "N999 %A G71 *\n"),
}  # fmt: skip


def _spoilt(line: str, rng: Dice) -> str:
    """The line with a letter too many, or one less."""
    at = rng.randrange(len(line) + 1)
    letter = rng.choice('XYZIJFRCLMN0123456789.,+-=;/~*()"\xa0\xff\xb5\xdf\x0b\t \r')
    return line[:at] + rng.choice(["", letter]) + line[at + rng.randrange(2) :]


def random_program(language: str, rng: Dice, *, sound: bool = False) -> bytes:
    """Up to 30 lines of a language below a sound head; `sound` lines are all plain motion."""
    head, move, others, end = LANGUAGES[language]
    odd, spoilt = rng.choice([0.0, 0.0, 0.03, 0.2]), rng.choice([0.0, 0.0, 0.0, 0.05])
    rng.wild, rng.arc = rng.choice([0.0, 0.0, 0.1, 0.3]), False
    if sound:
        odd = spoilt = rng.wild = 0.0
    lines = []
    for _ in range(rng.randint(2, 30)):
        line = rng.choice(others) if rng.random() < odd else move(rng)
        lines.append(_spoilt(line, rng) if rng.random() < spoilt else line)
    if rng.random() < 0.1:
        head = head.replace("MM", "INCH").replace("G71", rng.choice(["G70", "G700", "G71"]))
    newline = rng.choice(["\n", "\n", "\r\n"])
    text = head + "\n".join(lines) + "\n" + (end if rng.random() < 0.9 else move(rng))
    return text.replace("\n", newline).encode("latin-1")
