"""What was obeyed, line by line: values of the words and the modes that were in force."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gcode.text.comments import expand_comment
from gcode.text.expressions import value_of

if TYPE_CHECKING:
    from gcode.state.controller import Controller
    from gcode.text.lexer import Block

__all__ = ["Modes", "PlainLines", "Step", "Trace"]

_PLAIN = {"G0": 0, "G1": 1, "G2": 2, "G3": 3}
_SHOWN = re.compile(r"\s*(?:msg|debug|print|log)\s*,[^#]*#", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Modes:
    """Modes in force while a line moved the axes.

    Attributes
    ----------
    unit_mm : float
    absolute, arc_absolute : bool
        G90, G90.1.
    feed_mode : str
        ``inverse``, ``minute`` or ``revolution``.
    plane : int
        1 XY, 2 YZ, 3 XZ.
    motion : str or None
        Code of the motion, as ``G1``.
    side : int
        Cutter compensation: 1 left, -1 right, 0 off.
    path_control : str
        ``G61``, ``G61.1`` or ``G64``.
    spindle : int
        1 clockwise, -1 counter-clockwise, 0 standing.
    diameter : bool
        G7.
    """

    unit_mm: float
    absolute: bool
    arc_absolute: bool
    feed_mode: str
    plane: int
    motion: str | None
    side: int
    path_control: str
    spindle: int
    diameter: bool

    @classmethod
    def of(cls, controller: Controller) -> Modes:
        """Modes of a controller now."""
        c = controller
        return cls(c.unit_mm, c.absolute, c.arc_absolute, c.feed_mode, c.plane, c.motion, c.side,
                   c.path_control, c.spindle, c.diameter_mode)  # fmt: skip


@dataclass(slots=True)
class Step:
    """One line that was obeyed once.

    Attributes
    ----------
    line : int
        1-based.
    words : dict
        Upper-case letter -> number; G and M apart.
    g_codes, m_codes : list of float
        In the order of the text.
    comment : str or None
        Comment with parameters in it, as the control would show it.
    blocks : int
        Blocks of RS274/NGC that the line became; 0 for control flow and empty lines.
    before, modes : Modes
        Before the line and after it.
    unwritable : str
        Why the dialect cannot write other ends into the line; empty where it can.
    assignment : str
        What a line of the flow sets, as a line of its own would say it: the counter of FOR.
    is_flow : bool
        It says nothing but what runs next, so that it goes where lines are written as they run.
    """

    line: int
    before: Modes
    words: dict[str, float] = field(default_factory=dict)
    g_codes: list[float] = field(default_factory=list)
    m_codes: list[float] = field(default_factory=list)
    comment: str | None = None
    blocks: int = 0
    modes: Modes | None = None
    unwritable: str = ""
    assignment: str = ""
    is_flow: bool = False

    @property
    def g_names(self) -> set[str]:
        """G codes as ``G38.2``."""
        return {f"G{round(code, 1):g}" for code in self.g_codes}


@dataclass(frozen=True, slots=True)
class PlainLines:
    """Lines, one behind the other, of plain motion and nothing else, each obeyed once.

    They hold G0 to G3, X Y Z, I J K R, F, S, N and comments without parameters, or what other
    languages have for these, and switch spindle and coolant there; some are empty.

    Attributes
    ----------
    first, last : int
        1-based.
    before, modes : Modes
        Before the first line and after the last.
    motion : (L,) int8
        G code in force in every line, 0 to 3; -1 where none is yet.
    says_motion : (L,) bool
        Lines with a G code; in other languages those that move.
    """

    first: int
    last: int
    before: Modes
    modes: Modes
    motion: np.ndarray
    says_motion: np.ndarray


class Trace:
    """Steps of one run in the order in which they were made."""

    def __init__(self, controller: Controller, steps: list[Step | PlainLines]) -> None:
        self.controller, self.steps = controller, steps

    def begin(self, line: int) -> None:
        """Begin a line."""
        self.end()
        before = self.steps[-1].modes if self.steps else Modes.of(self.controller)
        self.steps.append(Step(line, before))

    def keep(self, why: str) -> None:
        """The line cannot get other ends."""
        if self.steps:
            self.steps[-1].unwritable = why

    def assign(self, text: str) -> None:
        """The line, one of the flow, sets something."""
        if self.steps:
            self.steps[-1].assignment = text

    def flow(self) -> None:
        """The line says nothing but what runs next."""
        if self.steps:
            self.steps[-1].is_flow = True

    def take(self, block: Block) -> None:
        """Note the values of a block that is about to be obeyed."""
        step, parameters = self.steps[-1] if self.steps else None, self.controller.parameters
        if not isinstance(step, Step):  # what a control does before the first line
            return
        step.blocks += 1
        step.words |= {k.upper(): value_of(v, parameters) for k, v in block.words.items()}
        step.g_codes += [value_of(v, parameters) for v in block.g_codes]
        step.m_codes += [value_of(v, parameters) for v in block.m_codes]
        if block.comment is not None and _SHOWN.match(block.comment):
            step.comment = expand_comment(block.comment, parameters)

    def plain_lines(self, first: int, says: np.ndarray, before: Modes) -> None:
        """Note lines of plain motion that have been obeyed.

        Parameters
        ----------
        first : int
            1-based.
        says : (L,) int8
            G code that each says; negative for none.
        before : Modes
            Before the first of them.
        """
        rows = np.maximum.accumulate(np.where(says >= 0, np.arange(len(says)), -1))
        motion = np.where(rows >= 0, says[rows], _PLAIN.get(before.motion, -1)).astype(np.int8)
        after = Modes.of(self.controller)
        self.steps.append(PlainLines(first, first + len(says) - 1, before, after, motion,
                                     says >= 0))  # fmt: skip

    def end(self) -> None:
        """Note the modes that the last line leaves."""
        if self.steps and isinstance(self.steps[-1], Step):
            self.steps[-1].modes = Modes.of(self.controller)
