"""POCKET3, POCKET4, SLOT1, SLOT2, LONGHOLE, CYCLE76 and CYCLE77 as plain moves.

Source: SINUMERIK 840D sl/828D, Programming Manual Cycles, "Milling cycles". What a cycle leaves is
stated there, not its way through the material: rings are taken here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.modes import check_milling_modes
from gcode.errors import ProgramError
from gcode.geometry.curved_slot import CurvedSlot
from gcode.geometry.outlines import Outline
from gcode.language.area_milling import Area, mill_pocket, mill_stud
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["MILLING", "mill"]

#: names of the arguments in their order
_ARGUMENTS = {
    "POCKET3": "RTP RFP SDIS DP LENG WID CRAD PA PO STA MID FAL FALD FFP1 FFD CDIR VARI MIDA AP1 "
    "AP2 AD RAD1 DP1",
    "POCKET4": "RTP RFP SDIS DP PRAD PA PO MID FAL FALD FFP1 FFD CDIR VARI MIDA AP1 AD RAD1 DP1",
    "SLOT1": "RTP RFP SDIS DP DPR NUM LENG WID CPA CPO RAD STA1 INDA FFD FFP1 MID CDIR FAL VARI "
    "MIDF FFP2 SSF FALD STA2",
    "SLOT2": "RTP RFP SDIS DP DPR NUM AFSL WID CPA CPO RAD STA1 INDA FFD FFP1 MID CDIR FAL VARI "
    "MIDF FFP2 SSF FFCP",
    "CYCLE76": "RTP RFP SDIS DP DPR LENG WID CRAD PA PO STA MID FAL FALD FFP1 FFD CDIR VARI AP1 "
    "AP2",
    "CYCLE77": "RTP RFP SDIS DP DPR PRAD PA PO MID FAL FALD FFP1 FFD CDIR VARI AP1",
    "LONGHOLE": "RTP RFP SDIS DP DPR NUM LENG CPA CPO RAD STA1 INDA FFD FFP1 MID",
}
MILLING = frozenset(_ARGUMENTS)
_SPIGOTS = frozenset(("CYCLE76", "CYCLE77"))  #: PRAD and AP1 of CYCLE77 are diameters
#: infeed across where MIDA is not said: 0.8 of the tool's diameter
_MIDA = 0.8
_MOST = 10_000


class _Cycle:
    """Arguments of a cycle."""

    def __init__(self, reader: SinumerikReader, name: str, values: list[float | None]) -> None:
        self.reader, self.name = reader, name
        names = _ARGUMENTS[name].split()
        check_milling_modes(name, values[len(names) :], reader.cycle_plane)
        self.values = dict(zip(names, values, strict=False))
        diameter = reader.tools.entry.offset_diameter_mm
        self.tool_radius = diameter / 2.0 / reader.controller.unit_mm

    def a(self, name: str, default: float | None = None) -> float:
        """An argument."""
        value = self.values.get(name)
        value = default if value is None else value
        if value is None:
            raise ProgramError(f"{self.name} without {name}")
        return value

    @property
    def out(self) -> float:
        """The retraction plane."""
        return self.a("RTP")

    def area(self, outline: Outline | CurvedSlot) -> Area:
        """What is milled within an outline."""
        surface = self.a("RFP")
        deep = self.values.get("DPR")
        bottom = self.a("DP") if deep is None else surface - abs(deep)
        if self.name == "POCKET3" or self.name == "POCKET4":
            bottom = self.a("DP")
        reader = self.reader
        feed = self.a("FFP1", reader.units.said(reader.controller.feed))
        kind, sense = int(self.a("VARI", 0.0)) % 10, int(self.a("CDIR", 0.0))
        if kind not in (0, 1, 2):
            raise ProgramError(f"{self.name} with VARI {self.a('VARI'):g}",
                               accepted="last digit 1, roughing, or 2, finishing")  # fmt: skip
        counter = (reader.controller.spindle < 0) != (self.name in _SPIGOTS)
        clockwise = {0: counter, 1: not counter, 2: True, 3: False}.get(sense)
        if clockwise is None:
            raise ProgramError(f"CDIR={sense}", accepted="0 to 3")
        return Area(
            outline=outline,
            tool_radius=self.tool_radius,
            surface=surface,
            bottom=bottom,
            clear=surface + abs(self.a("SDIS", 0.0)),
            step_down=abs(self.a("MID", 0.0)),
            step_over=min(
                self.a("MIDA", 0.0) or 2.0 * _MIDA * self.tool_radius, 2.0 * self.tool_radius
            ),
            feed=feed,
            plunge_feed=self.a("FFD", feed),
            finish_feed=self.a("FFP2", 0.0) or feed,
            side_allowance=abs(self.a("FAL", 0.0)),
            floor_allowance=abs(self.a("FALD", 0.0)),
            rough=kind in (0, 1),
            finish=kind in (0, 2),
            clockwise=clockwise,
            blank=self._blank() if self.name in _SPIGOTS else None,
        )

    def _rectangle(self) -> Iterator[Outline]:
        corner = max(self.a("CRAD", 0.0), self.tool_radius)
        length, width = abs(self.a("LENG")), abs(self.a("WID"))
        yield Outline(
            (self.a("PA"), self.a("PO")), length / 2.0, width / 2.0, corner, self.a("STA", 0.0)
        )

    def _circle(self) -> Iterator[Outline]:
        yield Outline.circle((self.a("PA"), self.a("PO")), abs(self.a("PRAD")))

    def _spigot(self) -> Iterator[Outline]:
        centre = self.a("PA"), self.a("PO")
        if self.name == "CYCLE77":
            yield Outline.circle(centre, abs(self.a("PRAD")) / 2.0)
            return
        sides = abs(self.a("LENG")) / 2.0, abs(self.a("WID")) / 2.0
        yield Outline(centre, *sides, self.a("CRAD", 0.0), self.a("STA", 0.0))

    def _blank(self) -> Outline:
        """What stands round the spigot before."""
        centre = self.a("PA"), self.a("PO")
        if self.name == "CYCLE77":
            return Outline.circle(centre, abs(self.a("AP1", self.a("PRAD"))) / 2.0)
        sides = (self.a("AP1", 0.0) or self.a("LENG"), self.a("AP2", 0.0) or self.a("WID"))
        return Outline(centre, *(abs(s) / 2.0 for s in sides), 0.0, self.a("STA", 0.0))

    def _curved_slots(self) -> Iterator[CurvedSlot]:
        """Slots along a circle of radius RAD, each over the angle AFSL."""
        count = int(self.a("NUM"))
        if not 1 <= count <= _MOST:
            raise ProgramError(f"{self.name} with {count} slots")
        step = self.a("INDA", 0.0) or 360.0 / count
        centre, length = (self.a("CPA"), self.a("CPO")), abs(self.a("AFSL"))
        if not 0.0 < length < 360.0:
            raise ProgramError(f"SLOT2 over {length:g} degrees", accepted="above 0, below 360")
        for k in range(count):
            start = self.a("STA1", 0.0) + k * step
            yield CurvedSlot(centre, self.a("RAD"), start, length, abs(self.a("WID")) / 2.0)

    def _slots(self) -> Iterator[Outline]:
        """Slots or elongated holes on a circle, along its radii from RAD on."""
        count = int(self.a("NUM"))
        if not 1 <= count <= _MOST:
            raise ProgramError(f"{self.name} with {count} slots")
        width = self.a("WID", 2.0 * self.tool_radius)
        step = self.a("INDA", 0.0) or 360.0 / count
        for k in range(count):
            angle = self.a("STA1", 0.0) + k * step
            along = self.a("RAD") + self.a("LENG") / 2.0
            centre = (
                self.a("CPA") + along * math.cos(math.radians(angle)),
                self.a("CPO") + along * math.sin(math.radians(angle)),
            )
            yield Outline.slot(centre, self.a("LENG"), width, angle)

    def outlines(self) -> Iterator[Outline | CurvedSlot]:
        """Every outline of the cycle."""
        makers: dict[str, Callable[[], Iterator[Outline | CurvedSlot]]] = {
            "POCKET3": self._rectangle,
            "POCKET4": self._circle,
            "SLOT1": self._slots,
            "LONGHOLE": self._slots,
            "SLOT2": self._curved_slots,
            "CYCLE76": self._spigot,
            "CYCLE77": self._spigot,
        }
        return makers[self.name]()


def mill(reader: SinumerikReader, name: str, values: list[float | None]) -> None:
    """Do a cycle; the tool ends on the retraction plane."""
    cycle = _Cycle(reader, name, values)
    c = reader.controller
    c.note(
        name,
        "the way through the material is the control's own; rings are taken here, walls "
        "and floor are those of the cycle",
    )
    modal, absolute, c.absolute = c.motion, c.absolute, True
    for outline in cycle.outlines():
        blocks = (mill_stud if name in _SPIGOTS else mill_pocket)(cycle.area(outline))
        reader.execute(f"g0z{number(cycle.out)}", *blocks, f"g0z{number(cycle.out)}")
    c.motion, c.absolute = modal, absolute
