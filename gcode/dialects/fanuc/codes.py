"""G codes of Fanuc's language that move nothing here, and those that are refused."""

from __future__ import annotations

__all__ = ["NOTED", "REFUSED"]

#: G codes that move nothing here, with the words that are theirs
NOTED = {5.0: ("high-speed cycle machining", "pq"), 5.1: ("AI contour control", "qr"),
          8.0: ("look-ahead control", "p"), 22.0: ("stored stroke check on", "xyzijk"),
          23.0: ("stored stroke check off", ""), 25.0: ("spindle speed detection off", ""),
          26.0: ("spindle speed detection on", "pqr"), 50.2: ("polygon turning off", ""),
          64.0: ("cutting mode", ""), 97.0: ("constant spindle speed", ""),
          103.0: ("block look-ahead limit", "p"), 113.0: ("polar interpolation off", ""),
          160.0: ("in-feed control off", ""), 187.0: ("smoothness", "pe"),
          13.1: ("polar interpolation off", ""),
          40.1: ("normal direction control off", "")}  # fmt: skip
#: G codes that are refused
REFUSED = {
    7.1: "cylindrical interpolation",
    12.1: "polar interpolation",
    43.4: "tool centre point",
    43.5: "tool centre point",
    68.2: "tilted plane",
    68.3: "tilted plane",
    6.2: "NURBS interpolation",
    2.2: "involute",
    3.2: "involute",
    254.0: "dynamic offset",
    234.0: "tool centre point",
    10.6: "retraction",
    33.0: "threading",
    96.0: "constant surface speed",
    107.0: "cylindrical mapping",
    143.0: "five-axis compensation",
    150.0: "pocket cycle",
    36.0: "automatic offset",
    37.0: "automatic offset",
    70.0: "bolt pattern",
    71.0: "bolt pattern",
    72.0: "bolt pattern",
    12.0: "circular pocket",
    13.0: "circular pocket",
    100.0: "mirror image of Haas",
    101.0: "mirror image of Haas",
    35.0: "automatic offset",
    39.0: "corner of the tool's radius",
    45.0: "tool offset",
    46.0: "tool offset",
    47.0: "engraving: the shapes of its letters are the control's own",
    48.0: "tool offset",
    54.4: "workpiece setting error",
    136.0: "probing",
    141.0: "3D cutter compensation",
}
