"""Words of FANUC that an independent truth has confirmed."""

from __future__ import annotations

__all__ = ["CONFIRMED"]

#: truth -> words, see `gcode.language.confirmation`
CONFIRMED = {
    "manual": (
        ",C; ,R; DO; END; G0; G1; G2; G3; G9; G10; G15; G16; G17; G18; G19; G20; G21; G28; "
        "G30; G31; G40; G41; G42; G43; G44; G50; G50.1; G51; G51.1; G53; G54; G54.1; G55; "
        "G56; G57; G58; G59; G60; G65; G66; G67; G68; G69; G73; G74; G76; G80; G81; G82; G83; G84; "
        "G84.2; G84.3; G85; "
        "G86; G87; G88; G89; G90; G91; G92; G93; G95; G98; G99; GOTO; IF; IF THEN; M97; "
        "M98; M99; WHILE"
    ),
    "posts": ("G0; G1; G2; G3; G17; G21; G40; G43; G49; G54; G80; G81; G82; G83; G90; G98"),
    "one part": (",R; END; G0; G1; G2; G17; G21; G40; G41; G52; G54; G68; G69; G80; G90; WHILE"),
    "no motion": (
        "G4; G5; G5.1; G8; G22; G23; G25; G26; G61; G62; G63; G64; G94; G97; G103; G187; M0; "
        "M1; M2; M3; M4; M5; M6; M7; M8; M9; M13; M14; M19; M29; M30; M48; M49"
    ),
}
