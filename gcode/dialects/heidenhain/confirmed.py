"""Words of Klartext that an independent truth has confirmed."""

from __future__ import annotations

__all__ = ["CONFIRMED"]

#: truth -> words, see `gcode.language.confirmation`
CONFIRMED = {
    "manual": (
        "C; CC; CHF; CP; CR; CT; CYCL CALL; CYCL CALL POS; CYCL DEF 2; CYCL DEF 3; CYCL DEF "
        "4; CYCL DEF 5; CYCL DEF 7; CYCL DEF 11; CYCL DEF 17; CYCL DEF 26; CYCL DEF 200; CYCL "
        "DEF 201; CYCL DEF 202; CYCL DEF 203; CYCL DEF 206; CYCL DEF 207; CYCL DEF 209; CYCL "
        "DEF 240; CYCL DEF 241; FN 0; FN 1; FN 2; FN 3; FN 4; FN 5; FN 6; FN 7; FN 8; FN 9; "
        "FN 10; FN 11; FN 12; FN 13; FN 18; L; LBL; LP; M89; M91; M99; M140; PLANE AXIAL; "
        "PLANE EULER; PLANE PROJECTED; PLANE SPATIAL; PLANE VECTOR; Q; QL; QR; RL; RND; RR; "
        "TOOL CALL"
    ),
    "closed form": (
        "APPR CT; APPR LCT; APPR LN; APPR LT; CALL LBL; CALL PGM; CYCL CALL; CYCL CALL PAT; "
        "CYCL DEF 1; CYCL DEF 8; CYCL DEF 10; CYCL DEF 205; CYCL DEF 208; CYCL DEF 220; CYCL "
        "DEF 221; CYCL DEF 251; CYCL DEF 252; CYCL DEF 253; CYCL DEF 256; CYCL DEF 257; DEP "
        "CT; DEP LCT; DEP LN; DEP LT; PATTERN DEF"
    ),
    "posts": ("C; CC; CP; CYCL CALL; CYCL DEF 1; L; TOOL CALL"),
    "one part": ("CALL LBL; CR; CYCL DEF 7; CYCL DEF 10; L; LBL; Q; RL; RND; TOOL CALL"),
    "no motion": (
        "*; BEGIN PGM; BLK FORM; CYCL DEF 9; CYCL DEF 13; CYCL DEF 32; CYCL DEF 247; CYCL DEF "
        "332; CYCL DEF 392; END PGM; FUNCTION; M0; M1; M2; M3; M4; M5; M6; M7; M8; M9; M13; "
        "M14; M30; M90; M94; M103; M107; M108; M109; M110; M111; M112; M113; M117; M118; "
        "M120; M124; M126; M127; M129; M134; M135; M137; M138; M141; M142; M143; M145; M148; "
        "M149; M150; M197; PLANE RESET; R0; STOP; TOOL DEF"
    ),
}
