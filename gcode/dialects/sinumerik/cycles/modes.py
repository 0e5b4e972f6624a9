"""GMODE, DMODE and AMODE at the end of a cycle's arguments: what the other arguments count.

Autodesk's public post for the SINUMERIK 840D names them. It writes 0 for drilling to the tip, 0 for
the plane that is active, and 10 or 1001110 for dwells in seconds and depths as DP or DPR say. Their
other digits, and those of milling cycles, are from memory of the manual "G code programming".
"""

from __future__ import annotations

from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.state.controller import XY, XZ, YZ

__all__ = ["Modes", "check_milling_modes"]

Arguments = list[float | None]

#: cycle -> which argument is GMODE; DMODE and AMODE follow
_FIRST = {"CYCLE81": 6, "CYCLE82": 6, "CYCLE83": 17, "CYCLE85": 8, "CYCLE86": 11, "CYCLE89": 6}
_PLANES = {1: XY, 2: XZ, 3: YZ}
_BY_TIP = ("CYCLE81", "CYCLE82", "CYCLE83")


def _digit(value: float, place: int) -> int:
    return int(abs(value)) // 10**place % 10


def _check_plane(name: str, mode: float, plane: int) -> None:
    if _PLANES.get(_digit(mode, 0), plane) != plane:
        raise ProgramError(f"{name} with DMODE {mode:g} is for another plane than the active one",
                           accepted="G17, G18 or G19 before it as DMODE says")  # fmt: skip


@dataclass(frozen=True)
class Modes:
    """Those of a drilling cycle.

    Attributes
    ----------
    depth : int
        0 as DP or DPR stand, 1 DPR, 2 DP.
    in_turns : bool
        The dwell at the depth counts turns of the spindle.
    in_percent : bool
        DAM of CYCLE83 is a percentage of the last step.
    least_in_percent : bool
        MDEP of CYCLE83 is a percentage of the first step.
    """

    depth: int = 0
    in_turns: bool = False
    in_percent: bool = False
    least_in_percent: bool = False

    @classmethod
    def of(cls, name: str, arguments: Arguments, plane: int) -> Modes:
        """Read them.

        Raises
        ------
        ProgramError
            The depth is not that of the tip, or the plane is another one.
        """
        first = _FIRST.get(name)
        said = [v or 0.0 for v in arguments[first : first + 3]] if first is not None else []
        geometry, display, alternative = [*said, 0.0, 0.0, 0.0][:3]
        if name in _BY_TIP and _digit(geometry, 1):
            what = "a diameter" if name == "CYCLE81" else "the shank"
            raise ProgramError(f"{name} with GMODE {geometry:g} drills to {what}, and the point of "
                               "the tool is not known", accepted="GMODE 0")  # fmt: skip
        _check_plane(name, display, plane)
        return cls(
            depth=_digit(alternative, 0),
            in_turns=_digit(alternative, 1) == 2,
            in_percent=name == "CYCLE83" and _digit(alternative, 5) == 2,
            least_in_percent=name == "CYCLE83" and _digit(alternative, 6) == 2,
        )


def check_milling_modes(name: str, further: Arguments, plane: int) -> None:
    """Refuse modes of a milling cycle that change what its arguments count.

    Parameters
    ----------
    name : str
    further : list of float or None
        What stands behind the arguments that are read; the last three are the modes.
    plane : int
    """
    if len(further) < 3:
        if any(further):
            raise ProgramError(f"{name} with {len(further)} arguments too many")
        return
    geometry, display, alternative = (value or 0.0 for value in further[-3:])
    _check_plane(name, display, plane)
    if geometry not in (0.0, 100.0) or alternative not in (0.0, 1.0, 2.0):
        raise ProgramError(
            f"{name} with GMODE {geometry:g} and AMODE {alternative:g}: what its arguments then "
            "count is not read", accepted="GMODE 0 or 100, AMODE 0 to 2"
        )  # fmt: skip
