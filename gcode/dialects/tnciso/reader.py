"""Runs a TNC program in DIN/ISO as the Klartext that it stands for."""

from __future__ import annotations

from gcode.dialects.heidenhain.reader import KlartextReader
from gcode.dialects.tnciso.klartext_of_iso import klartext_of_iso
from gcode.language.options import RunOptions
from gcode.state.controller import Controller
from gcode.text.source import Source

__all__ = ["TncIsoReader"]


class TncIsoReader(KlartextReader):
    """Runs a program in DIN/ISO; an error of the translation is raised where its block runs."""

    ending = ".i"

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        self.translation = klartext_of_iso(lines)
        super().__init__(controller, [text for text, _ in self.translation.lines], options)

    def use_fast_lane(self, source: Source) -> None:
        """Give stretches of lines to compiled code."""
        from gcode.dialects.tnciso.lane import TncIsoLane  # loads the compiler

        self.lane = TncIsoLane(self)

    def own_line(self, index: int) -> int:
        """Line of the file for one of Klartext."""
        return self.translation.lines[index][1] + 1

    def obey(self, text: str) -> None:
        """Obey one line."""
        error = self.translation.errors.get(self.next - 1)
        if error is not None:
            raise error
        super().obey(text)
