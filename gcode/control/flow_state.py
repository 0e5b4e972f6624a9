"""Where a program of RS274/NGC stands: the line, the calls, and what is being skipped."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple

from gcode.control.loop_guard import BlockBudget
from gcode.errors import ProgramError
from gcode.state.controller import Controller
from gcode.text.expressions import value_of
from gcode.text.lexer import Block

__all__ = ["Flow", "Frame", "Label", "Opening", "Place", "Skip", "SkipReason"]

#: 0-based line and byte offset of its first byte.
Place = tuple[int, int]


class Label(NamedTuple):
    """Name of an O-word; loops and IFs are known inside their subroutine alone."""

    name: str
    scope: str | None = None  #: subroutine, "" for the main program; None for a subroutine's name


class SkipReason(Enum):
    """Why lines are passed over, and so which O-word of the label ends it.

    Attributes
    ----------
    DEFINED
        Body of a SUB that the main program runs into; ends at ENDSUB.
    SOUGHT
        A call of what stands further down; ends at its SUB or program number.
    OVER
        A loop whose condition is false or that BREAK leaves; ends at the loop's end.
    CONTINUED
        A round that CONTINUE gives up; ends at the loop's end, which begins the next round.
    UNDECIDED
        An IF with no true condition so far; ends at a true ELSEIF, at ELSE or at ENDIF.
    DECIDED
        An IF with its branch behind it; ends at ENDIF.
    """

    DEFINED = "defined"
    SOUGHT = "sought"
    OVER = "over"
    CONTINUED = "continued"
    UNDECIDED = "undecided"
    DECIDED = "decided"


@dataclass(frozen=True, slots=True)
class Skip:
    """Lines that are passed over, up to an O-word."""

    label: Label
    since: Place
    reason: SkipReason


@dataclass
class Opening:
    """Where a subroutine, a loop or an IF begins."""

    keyword: str
    place: Place
    repeats: int | None = None  #: rounds that a REPEAT still has to go; None outside it
    begun: tuple[int, int] = field(default=(0, 0), compare=False)  #: `Flow.work` at its round


@dataclass
class Frame:
    """One call in progress."""

    label: Label
    keyword: str  #: call or m98
    return_to: Place
    arguments: list[float]
    repeats: int = 1
    begun: int = field(default=0, compare=False)  #: blocks obeyed when its repetition began


class Flow:
    """What decides which line comes next, beside the controller.

    Attributes
    ----------
    here, next : Place
        The line that is obeyed, and the one after it.
    skip : Skip or None
        None where lines are obeyed.
    frames : list of Frame
        Calls, the innermost last.
    openings : dict of Label to Opening
        Subroutines, loops and IFs that have been met.
    budget : BlockBudget
        Blocks obeyed, and how many may be.
    controls : int
        O-words, M98 and M99 that have been met.
    broken : bool
        A BREAK has been met since a DO ended; the next DO, whichever it is, has no second round.
        That this outlives a WHILE loop is LinuxCNC's way.
    """

    def __init__(self, controller: Controller, start: Place, budget: BlockBudget) -> None:
        self.controller, self.budget = controller, budget
        self.here = self.next = start
        self.skip: Skip | None = None
        self.frames: list[Frame] = []
        self.openings: dict[Label, Opening] = {}
        self.broken = False
        self.controls = 0

    @property
    def work(self) -> tuple[int, int]:
        """Blocks that have been obeyed, and how many of them steer the flow."""
        return self.budget.executed, self.controls

    def memory(self) -> tuple:
        """All that a jump back leaves to tell one round from another; nothing is skipped then."""
        return self.frames, self.openings, self.broken

    def value(self, block: Block) -> float:
        """Value of a block's condition, count or result."""
        return value_of(block.control.values[0], self.controller.parameters)

    def pass_over(self, label: Label, reason: SkipReason) -> None:
        """Skip the lines after this one."""
        self.skip = Skip(label, self.here, reason)

    def open(self, label: Label, keyword: str) -> Opening:
        """Begin a subroutine, a loop or an IF in this line.

        Raises
        ------
        ProgramError
            Where another line has the label.
        """
        known = self.openings.get(label)
        if known is None:
            known = self.openings[label] = Opening(keyword, self.here)
        elif (known.keyword, known.place) != (keyword, self.here):
            raise ProgramError(
                f"O<{label.name}> is already used in line {known.place[0] + 1}",
                hint="give each O-word its own number",
            )
        return known

    def opening(self, label: Label, *keywords: str) -> Opening:
        """Look up what a label began; raises ProgramError for anything but `keywords`."""
        known = self.openings.get(label)
        if known is None or known.keyword not in keywords:
            wanted = " or ".join(keywords).upper()
            raise ProgramError(f"O<{label.name}> has no {wanted}")
        return known
