"""Kinematic chains of common milling machines.

Source: ISO 10791-1 (designation of configurations): the links from the tool t over the bed b to the
workpiece w; a prime marks the axes that carry the workpiece.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["KINEMATICS", "Kinematics"]


@dataclass(frozen=True)
class Kinematics:
    """One configuration.

    Attributes
    ----------
    name, title : str
    chain : str
        As in ``chain`` of the machine file.
    picture : str
        Drawn in characters.
    """

    name: str
    title: str
    chain: str
    picture: str


KINEMATICS = {
    kind.name: kind
    for kind in (
        Kinematics(
            "vmc",
            "vertical machining centre, cross table (C-frame)",
            "t (C) Z b Y' X' w",
            """
      _______
     |  |Z|  |     the head moves in Z,
     |  |_|  |     the table in X on a saddle
     |   v   |     that moves in Y
     | =[X]= |
     |__[Y]__|""",
        ),
        Kinematics(
            "bridge",
            "gantry or bridge, fixed table",
            "t (C) Z Y X b w",
            """
     _|_Y_|Z|__    the head moves in Z and Y
    |     v    |   on a bridge that moves in X;
    X  =[w]=   X   the table stands""",
        ),
        Kinematics(
            "travelling-column",
            "travelling column, fixed table",
            "t (C) Z Y X b w",
            """
      |Z|
     [ Y ]         the column moves in X and Y,
     [ X ]  =[w]=  the head in Z; the table stands""",
        ),
        Kinematics(
            "portal-table",
            "portal, moving table",
            "t (C) Z Y b X' w",
            """
     _|_Y_|Z|__    the head moves in Z and Y on a
    |     v    |   fixed portal, the table in X
    |  =[X]=   |""",
        ),
        Kinematics(
            "router",
            "router: table in Y, head in X and Z",
            "t (C) Z X b Y' w",
            """
     _|_X_|Z|__    the head moves in Z and X on a
    |     v    |   fixed portal, the table in Y
    |  =[Y]=   |""",
        ),
    )
}
