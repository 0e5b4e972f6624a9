"""Words of SINUMERIK that an independent truth has confirmed."""

from __future__ import annotations

__all__ = ["CONFIRMED"]

#: truth -> words, see `gcode.language.confirmation`
CONFIRMED = {
    "manual": (
        "AP; ATRANS; CR; CYCLE81; CYCLE82; CYCLE83; CYCLE84; CYCLE85; CYCLE87; CYCLE88; "
        "CYCLE89; CYCLE840; ELSE; ENDFOR; ENDIF; ENDLOOP; ENDWHILE; FOR; G0; G1; G2; G3; G40; "
        "G41; G42; G53; G54; G56; G57; G70; G71; G9; G90; G91; G93; G95; G110; G111; G112; G153; "
        "G500; G505; G700; "
        "G710; GOTOB; GOTOF; HOLES1; HOLES2; G247; G341; DISR; DISCL; FAD; "
        "IF; LOOP; REPEAT; RP; SUPA; TRANS; UNTIL; WHILE"
    ),
    "closed form": (
        "AMIRROR; AR; AROT; ASCALE; G451; SCALE; CASE; "
        "CHF; CHR; CIP; CT; CYCLE86; CYCLE90; CYCLE801; G54; G55; G74; G75; G331; "
        "G332; I1; J1; MIRROR; POCKET3; POCKET4; REPEATB; RND; RNDM; ROT; SLOT1; SLOT2; "
        "CYCLE71; CYCLE76; CYCLE77; KONT; NORM; "
        "G147; G148; G248; G340; G347; G348"
    ),
    "public programs": "CYCLE71; CYCLE76; CYCLE77; CYCLE90; SLOT2; TURN",
    "one part": ("AROT; CR; ENDFOR; FOR; G0; G1; G2; G17; G40; G41; G54; G71; G90; RND; TRANS"),
    "no motion": (
        "G4; G60; G62; G64; G94; G97; G140; G141; G142; G143; G290; G450; G460; G461; "
        "G462; G601; G602; G603; G621; G641; G642; G643; G644; G645; M0; M1; M2; M3; M4; M5; M6; "
        "M7; M8; M9; M17; M19; M30; M40; M41; M42; M43; M44; M45; M70"
    ),
}
