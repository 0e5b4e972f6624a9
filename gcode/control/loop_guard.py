"""Loops without end: the controller's state comes back, or nothing moves for too long."""

from __future__ import annotations

from copy import deepcopy

from gcode.errors import ProgramError
from gcode.state.controller import Controller

__all__ = ["BlockBudget", "LoopGuard"]

#: A loop that searches or computes for longer than this would leave the tool standing in its cut
#: on any control; reading so many blocks takes a few seconds.
_BLOCKS_WITHOUT_MOVE = 1_000_000

#: A count whose rounds may differ is refused where its cheapest round so far, repeated as often
#: as is left, exceeds the budget by this factor.
_DOUBT = 10

#: What a controller keeps and no later block depends on.
_WRITTEN_ONLY = frozenset(("record", "line", "notes", "trace"))


class BlockBudget:
    """How many blocks a program may run, and whether what it has begun can end within them.

    Attributes
    ----------
    executed : int
        Blocks obeyed so far.
    largest : int
        The budget.
    """

    def __init__(self, largest: int) -> None:
        self.executed, self.largest = 0, largest

    def check(self) -> None:
        """Raise ProgramError where the program has run more blocks than it may."""
        if self.executed > self.largest:
            raise ProgramError(
                f"program runs more than {self.largest} blocks", hint="look for a loop without end"
            )

    def check_rounds(
        self, rounds: int, blocks: int, *, exact: bool = True, line: int | None = None
    ) -> None:
        """Refuse a count of rounds that will exceed the budget, before they are run.

        Parameters
        ----------
        rounds : float
            Rounds that are left.
        blocks : int
            Fewest blocks of a round.
        exact : bool
            No round can have fewer; otherwise the next ones may.
        line : int, optional
            1-based line that asks for the rounds, where it is not the one that is obeyed.

        Raises
        ------
        ProgramError
            With the count.
        """
        wanted = rounds * blocks
        if wanted > (self.largest - self.executed) * (1 if exact else _DOUBT):
            raise ProgramError(
                f"program runs more than {self.largest} blocks: {rounds} further rounds "
                f"of {blocks} blocks",
                line=line,
                hint="is the number of repetitions right?",
            )


class LoopGuard:
    """Watches the jumps back of one program.

    A program that comes to one place twice in the same state does so for ever. One earlier state
    is kept and compared with the present one after every jump; it is replaced after 1, 2, 4, 8
    ... jumps, so that a round of any length is found (R. P. Brent, BIT 20, 1980, 176-184).

    Parameters
    ----------
    controller : Controller
        State of the program.
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        self.moves = self.moved_at = 0  #: rows of the record, and blocks obeyed when they grew
        self.jumps, self.replace_at = 0, 1
        self.kept: dict[str, object] | None = None
        self.outermost: tuple[int, int] | None = None  #: call level and line, since `kept`

    def jumped_back(self, line: int, *, level: int, executed: int, flow: object) -> None:
        """Look whether a jump back may be one of endlessly many.

        Parameters
        ----------
        line : int
            1-based line at which the program goes on.
        level : int
            Subroutine calls in progress.
        executed : int
            Blocks obeyed so far.
        flow : object
            What the reader itself remembers: calls, counts of repetitions.

        Raises
        ------
        ProgramError
            With the first line of the outermost loop.
        """
        self.outermost = min(self.outermost or (level, line), (level, line))
        if self._is_kept(line, flow):
            raise ProgramError(
                "loop without end: after a round nothing has changed",
                line=self.outermost[1],
                hint="change in the loop what its condition asks for, or leave it",
            )
        if len(self.controller.record) != self.moves:
            self.moves, self.moved_at = len(self.controller.record), executed
        elif executed - self.moved_at > _BLOCKS_WITHOUT_MOVE:
            raise ProgramError(
                f"loop runs more than {_BLOCKS_WITHOUT_MOVE} blocks without a move",
                line=self.outermost[1],
                hint="look for a loop without end",
            )
        self.jumps += 1
        if self.jumps == self.replace_at:
            self.replace_at *= 2
            self.kept, self.outermost = deepcopy(self._state(line, flow)), None

    def _is_kept(self, line: int, flow: object) -> bool:
        kept, c = self.kept, self.controller
        return (
            kept is not None
            and kept["line"] == line
            and kept["position"] == c.position  # what mostly differs comes first
            and kept["flow"] == flow
            and kept["parameters"]["numbered"] == c.parameters.numbered
            and kept == self._state(line, flow)
        )

    def _state(self, line: int, flow: object) -> dict[str, object]:
        """Everything that the blocks to come depend on."""
        c, record = self.controller, self.controller.record
        state = {name: value for name, value in vars(c).items() if name not in _WRITTEN_ONLY}
        return state | {
            "parameters": vars(c.parameters),
            "record": (record.feed_mm_per_min, record.rpm_of_feed, record.last_straight),
            "line": line,
            "flow": flow,
        }
