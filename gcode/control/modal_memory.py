"""M70-M73: save the modal state and restore it by the words that would set it."""

from __future__ import annotations

from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.state.controller import WORK_OFFSETS, XY, XZ, YZ, Controller

__all__ = ["ModalMemory", "restoring_lines"]


@dataclass(frozen=True)
class ModalMemory:
    """Words of the modal state that was saved.

    Attributes
    ----------
    unit : str
        G20 or G21.
    feed, speed : float
        F and S.
    g_codes, m_codes : tuple of str
        One a modal group, always in the same order.
    """

    unit: str
    feed: float
    speed: float
    g_codes: tuple[str, ...]
    m_codes: tuple[str, ...]

    @classmethod
    def of(cls, c: Controller) -> ModalMemory:
        """Save the present state."""
        system = WORK_OFFSETS[c.system - 1]
        g_codes = (
            {XY: "G17", XZ: "G18", YZ: "G19"}[c.plane],
            {0: "G40", 1: "G41", -1: "G42"}[c.side],
            "G90" if c.absolute else "G91",
            {"inverse": "G93", "minute": "G94", "revolution": "G95"}[c.feed_mode],
            system,
            "G43" if any(c.tool_offset) else "G49",
            "G98" if c.retract_to_initial else "G99",
            "G97" if not c.css else "G96",
            "G90.1" if c.arc_absolute else "G91.1",
            "G7" if c.diameter_mode else "G8",
            c.path_control,
        )
        m_codes = ({0: "M5", 1: "M3", -1: "M4"}[c.spindle],
                   "M8" if c.flood else "M7" if c.mist else "M9")  # fmt: skip
        return cls("G20" if c.unit_mm != 1.0 else "G21", c.feed, c.speed, g_codes, m_codes)


def restoring_lines(controller: Controller, saved: ModalMemory | None) -> list[str]:
    """Lines of RS274/NGC that bring the saved state back.

    F is restored with one decimal and S as a whole number, as the control does.

    Raises
    ------
    ProgramError
        Where nothing was saved.
    """
    if saved is None:
        raise ProgramError("M72 without M70", hint="save the state with M70 first")
    now = ModalMemory.of(controller)
    lines = [saved.unit.lower()] if saved.unit != now.unit else []
    changed = [s for s, n in zip(saved.g_codes, now.g_codes, strict=True) if s != n]
    if saved.speed != now.speed:
        changed.insert(0, f"s{saved.speed:.0f}")
    if saved.feed != now.feed:
        changed.insert(0, f"f{saved.feed:.1f}")
    lines.append("".join(changed).lower())
    lines += [s.lower() for s, n in zip(saved.m_codes, now.m_codes, strict=True) if s != n]
    return lines
