"""Cycles of SINUMERIK: where they are done, and what MCALL repeats."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.cycles.contour import mill_along
from gcode.dialects.sinumerik.cycles.drilling import CYCLES, PATTERNS, drill, pattern_points
from gcode.dialects.sinumerik.cycles.face import mill_face_cycle
from gcode.dialects.sinumerik.cycles.milling import MILLING, mill
from gcode.dialects.sinumerik.cycles.thread_milling import mill_thread
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["CycleCalls"]

#: cycle -> how many of its arguments a second public source has in the same order; the others of
#: these cycles rest on memory. d-creations/ncplot7py on GitHub, siemens_mill_cnc/cycles_handler.py
_ORDER_CONFIRMED = {"CYCLE76": 11, "CYCLE77": 8, "SLOT2": 13}
_TURNS = re.compile(r"CYCLE(?:9[2-9]|930|940|95[0-2])")
_MEASURES = re.compile(r"CYCLE9[6-9]\d")
#: cycles that cut in a way that is the control's own, or that no source confirmed
_UNREAD = {
    "CYCLE60": "engraving: the shapes of its letters are the control's own",
    "CYCLE61": "face milling of ShopMill",
    "CYCLE62": "contour call: CYCLE72 takes the contour's name itself",
    "CYCLE63": "pocket or stud with islands",
    "CYCLE64": "drilling before a pocket with islands",
    "CYCLE70": "thread milling",
    "CYCLE78": "drilling and thread milling",
    "CYCLE79": "polygon",
    "CYCLE802": "a list of places",
    "CYCLE899": "open slot",
}
_KNOWN = CYCLES | PATTERNS | MILLING | {"CYCLE71", "CYCLE72", "CYCLE90"}


class CycleCalls:
    """Cycles of a program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.modal: tuple[str, list[float | None]] | None = None  #: MCALL

    def call(self, name: str, text: str, *, modal: bool) -> None:
        """A cycle or a pattern of holes."""
        self.reader.controller.use(name)
        if name == "CYCLE72":
            self.reader.only_in_xy(name)
        with self.reader.plane_of_cycles():
            self._call(name, text, modal=modal)

    def _call(self, name: str, text: str, *, modal: bool) -> None:
        reader = self.reader
        if _MEASURES.fullmatch(name):
            raise reader.unknown(call=name)
        if _TURNS.fullmatch(name):
            raise ProgramError(f"{name} is a cycle of turning programs", accepted="milling")
        if name in _UNREAD:
            raise ProgramError(f"{name} ({_UNREAD[name]}) is not read",
                               hint="post the program without this cycle")  # fmt: skip
        if name not in _KNOWN or (modal and name in ("CYCLE71", "CYCLE72", "CYCLE90")):
            known = (*sorted(CYCLES), "CYCLE71", "CYCLE72", "CYCLE90", *sorted(MILLING))
            raise ProgramError(f"{name} is not read", accepted=", ".join(known))
        if name == "CYCLE72":
            mill_along(reader, text)
            return
        arguments = reader.arguments(text)
        sure = _ORDER_CONFIRMED.get(name, len(arguments))
        if any(value is not None for value in arguments[sure:]):
            reader.controller.use(f"order of the arguments of {name} behind number {sure}")
        if name in PATTERNS:
            if self.modal is None:
                raise ProgramError(
                    f"{name} without a cycle", accepted="MCALL CYCLE81(...) before it"
                )
            self._at_each(pattern_points(name, arguments))
        elif name == "CYCLE90":
            mill_thread(reader, arguments)
        elif name == "CYCLE71":
            mill_face_cycle(reader, arguments)
        elif name in MILLING:
            mill(reader, name, arguments)
        elif modal:
            self.modal = (name, arguments)
        else:
            drill(reader, name, arguments)

    def _at_each(self, places: Sequence[Point]) -> None:
        """The cycle or subprogram of MCALL at some places; modes stay as they were."""
        reader, c = self.reader, self.reader.controller
        modal, absolute = c.motion, c.absolute
        if self.modal[0] not in CYCLES:  # its lines run behind each of these
            back = f"G{90 if absolute else 91} {modal if modal in ('G0', 'G1') else ''}"
            lines = [f"G90 G0 X{number(x)} Y{number(y)}" for x, y in places]
            reader.subprograms.run([*lines, back])
            return
        for x, y in places:
            reader.execute(f"g90g0{xy_words(x, y)}")
            self.do_modal()
        c.motion, c.absolute = modal, absolute

    def do_modal(self) -> None:
        """The cycle or subprogram of MCALL at the present place."""
        name, arguments = self.modal
        if name in CYCLES:
            with self.reader.plane_of_cycles():
                drill(self.reader, name, arguments)
        else:
            texts = ["" if value is None else number(value) for value in arguments]
            self.reader.subprograms.call(name, texts, is_modal=True)
