"""Where programs and labels stand in a text of SINUMERIK, looked for once.

Source: SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Subprogram technique".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property

__all__ = ["PROCEDURE", "SECTION", "TextPlaces"]

#: begins a program in an archive: ``%_N_NAME_SPF``
SECTION = re.compile(r"\s*%_N_(\w+?)_(MPF|SPF)\b", re.IGNORECASE)
#: ``PROC NAME(REAL A)``
PROCEDURE = re.compile(r"\s*(?:N\d+\s*)?PROC\s+(\w+)\s*(?:\((.*)\))?", re.IGNORECASE)


class TextPlaces:
    """Places that calls and repeats ask for, however often.

    Parameters
    ----------
    lines : sequence of str
        They stay as they are.
    label_of : callable
        Label at the head of a line, None where there is none.
    """

    def __init__(self, lines: Sequence[str], label_of: Callable[[str], str | None]) -> None:
        self.lines, self._label_of = lines, label_of

    def program(self, name: str) -> tuple[int, int] | None:
        """First line of a program and the line behind its last; None where it is not."""
        return self._programs.get(name.upper())

    def label(self, name: str, behind: range, ahead: range) -> int | None:
        """The last line of `behind` with a label, else the first of `ahead`; None without it."""
        lines = self._labels.get(name.upper(), [])
        before = (k for k in reversed(lines) if k in behind)
        return next(before, next((k for k in lines if k in ahead), None))

    @cached_property
    def _programs(self) -> dict[str, tuple[int, int]]:
        heads = [(index, *said) for index, line in enumerate(self.lines) if (said := _head(line))]
        begins = next((k for k, line in enumerate(self.lines) if line.split(";")[0].strip()), 0)
        found: dict[str, tuple[int, int]] = {}
        stop_of_part = stop_of_section = len(self.lines)
        for index, name, is_section in reversed(heads):
            if is_section:
                found[name] = index + 1, stop_of_section
                stop_of_section = index
            elif index > begins:  # the first block with PROC names the program itself
                found[name] = index, stop_of_part
            stop_of_part = index
        return found

    @cached_property
    def _labels(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for index, line in enumerate(self.lines):
            label = self._label_of(line) if ":" in line else None
            if label is not None:
                found.setdefault(label.upper(), []).append(index)
        return found


def _head(line: str) -> tuple[str, bool] | None:
    """Name of the program that a line begins, and whether it begins a section."""
    section = SECTION.match(line)
    head = section or PROCEDURE.match(line)
    return None if head is None else (head[1].upper(), section is not None)
