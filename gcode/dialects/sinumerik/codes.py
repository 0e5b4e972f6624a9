"""G and M codes of SINUMERIK, and what they are in RS274/NGC."""

from __future__ import annotations

__all__ = [
    "ACCEPTED_G",
    "CODES",
    "ISO_G",
    "M_CODES",
    "NO_MOTION",
    "OWN_ASSIGNED",
    "REFUSED",
    "SAME",
    "STOPS",
    "TURNING_G",
]

#: codes of this control -> RS274/NGC; nothing for those that move nothing here
CODES = {60: "g61.1", 64: "g64", 153: "g53"}
CODES |= dict.fromkeys((641, 642, 643, 644, 645), "g64")
CODES |= dict.fromkeys((601, 602, 603, 450, 451, 97, 460, 461, 462, 290, 500, 62, 621), "")
#: how a soft approach would go, which G147 and its like begin
CODES |= dict.fromkeys((140, 141, 142, 143, 340, 341), "")
#: codes that keep their meaning
SAME = frozenset((0, 1, 2, 3, 17, 18, 19, 53, 54, 55, 56, 57, 90, 91, 93, 94, 95))
#: M codes that stop or end
STOPS = frozenset((0, 1, 2, 30, 17))
#: all that the control itself knows; 40 to 45 are gear stages, 70 makes the spindle an axis
M_CODES = frozenset((*STOPS, 3, 4, 5, 6, 7, 8, 9, 19, 40, 41, 42, 43, 44, 45, 70))
ACCEPTED_G = (
    "G0-G4 G9 G17-G19 G40-G42 G53-G57 G60 G64 G70 G71 G74 G75 G90 G91 G93-G95 G110-G112 G147 G148 "
    "G247 G248 G331 G332 G340 G341 G347 G348 G450 G451 G500 G505-G599"
)
#: codes of FANUC that this control has in its ISO dialect alone
ISO_G = frozenset(
    (20, 21, 28, 30, 43, 44, 49, 50, 51, 52, 68, 69, 73, 76, *range(80, 90), 92, 98, 99)
)
#: codes of turning programs: threads, and a constant cutting speed
TURNING_G = frozenset((33, 34, 35, 96, 961, 962))
#: words that change the path in a way that is not read, and what they are
REFUSED = {
    "TRAORI": "five-axis transformation", "TRANSMIT": "milling on the face of a turned part",
    "TRACYL": "milling on a cylinder", "TRAANG": "inclined axis", "ASPLINE": "spline",
    "BSPLINE": "spline", "CSPLINE": "spline", "POLY": "polynomials", "INVCW": "involute",
    "INVCCW": "involute", "KONTC": "approach with continuous curvature",
    "KONTT": "tangential approach", "OFFN": "offset of the contour", "TOROT": "tilted plane",
    "CUT3DC": "3D radius compensation", "DO": "synchronised action", "QU": "quick output",
    "TOFRAME": "frame along the tool", "PAROT": "frame along the part", "ROTS": "solid angles",
    "DIAMON": "diameters: a turning program", "DIAM90": "diameters: a turning program",
    "PRESETON": "another place for the axis", "PRESETONS": "another place for the axis",
    "AROTS": "solid angles", "GEOAX": "other axes of the path", "DEFINE": "macro",
}  # fmt: skip
#: the control's own words that stand with ``=``, and what they are: no variables of the builder
OWN_ASSIGNED = {
    "POS": "positioning axis", "POSA": "positioning axis", "POSP": "positioning axis",
    "TOFF": "tool offset of the program", "TOFFL": "tool offset of the program",
    "TOFFR": "tool offset of the program", "DL": "additive tool offset",
    "TCARR": "tool carrier", "CUTMOD": "tool of a tool carrier", "ANG": "angle of a line",
    "MEAS": "measuring", "MEAW": "measuring", "MEASA": "measuring", "MEAWA": "measuring",
    "FZ": "feed per tooth", "SVC": "cutting speed", "OVR": "override", "OVRA": "override",
    "LEAD": "direction of the tool", "TILT": "direction of the tool", "FP": "fixed point",
    "DISRP": "retraction plane of a soft approach", "FXS": "travel to a fixed stop",
}  # fmt: skip
#: words on how the path is followed, of the preprocessing, and for the screen; the G groups are
#: those of the Programming Manual Fundamentals, "G commands"
NO_MOTION = (
    "STOPRE", "FFWON", "FFWOF", "SOFTA", "SOFT", "BRISKA", "BRISK", "DRIVEA", "DRIVE",
    "COMPOF", "COMPON", "COMPCURV", "COMPCAD", "COMPSURF", "CFTCP", "CFC", "CFIN", "NORM", "KONT",
    "CUT2DF", "CUT2D", "TRAFOOF", "DIAMOF", "CDOF", "CDON", "ORIWKS", "ORIMKS",
    "FIFOCTRL", "STARTFIFO", "STOPFIFO", "SPOS", "FNORM", "FLIN", "FCUB", "SBLOF", "SBLON",
    "DYNNORM", "DYNPOS", "DYNROUGH", "DYNSEMIFIN", "DYNFINISH", "DYNPREC",
    "RTLION", "RTLIOF", "WALIMON", "WALIMOF", "CUTCONOF", "SPATH", "UPATH", "FENDNORM", "TOWSTD",
    "PAROTOF", "ORIEULER", "ORIAXES", "ORIVECT", "LFOF", "PTPG0", "CP", "SPIF1", "TOFFOF", "SPCON",
    "SPCOF", "CPRECON", "CPRECOF", "COMPPATH", "CDOF2", "TCOABS", "TCOFR", "TOROTOF", "BLSYNC",
    "CLGOF",
)  # fmt: skip
