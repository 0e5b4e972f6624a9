"""Loops of RS274/NGC: DO ... WHILE, WHILE, REPEAT, BREAK and CONTINUE."""

from __future__ import annotations

from gcode.control.flow_state import Flow, Label, Opening, SkipReason
from gcode.text.lexer import Block

__all__ = ["LOOPS"]

#: Its head and its end: a round of REPEAT that has no other O-word is like all the others.
_CONTROLS = 2


def _do(flow: Flow, label: Label, block: Block) -> None:
    flow.open(label, "do")
    flow.skip = None


def _while(flow: Flow, label: Label, block: Block) -> None:
    """The head of a WHILE loop, or the end of a DO loop."""
    known = flow.openings.get(label)
    if known is not None and known.keyword == "do":
        flow.skip = None
        if flow.value(block) != 0.0 and not flow.broken:
            flow.next = known.place
        flow.broken = False
        return
    flow.open(label, "while")
    flow.skip = None
    if flow.value(block) == 0.0:
        flow.pass_over(label, SkipReason.OVER)


def _repeat(flow: Flow, label: Label, block: Block) -> None:
    """Count down; the number of rounds is read before the first one alone."""
    opening = flow.open(label, "repeat")
    if opening.repeats is None:
        value = flow.value(block)
        opening.repeats = int(value + (0.5 if value >= 0.0 else -0.5))
        opening.begun = flow.work
    if opening.repeats > 0:
        opening.repeats -= 1
    else:
        opening.repeats = None
        flow.pass_over(label, SkipReason.OVER)


def _end(flow: Flow, label: Label, block: Block) -> None:
    """ENDWHILE and ENDREPEAT."""
    opening = flow.opening(label, block.control.keyword.removeprefix("end"))
    over = flow.skip is not None and flow.skip.reason is SkipReason.OVER
    flow.skip = None
    if not over:
        flow.next = opening.place
        if opening.repeats is not None:
            _check_repeats(flow, opening)


def _check_repeats(flow: Flow, opening: Opening) -> None:
    """Refuse a REPEAT whose rounds, as far as they are known, are too many."""
    blocks, controls = (now - then for now, then in zip(flow.work, opening.begun, strict=True))
    opening.begun = flow.work
    flow.budget.check_rounds(opening.repeats, blocks, exact=controls <= _CONTROLS,
                             line=opening.place[0] + 1)  # fmt: skip


def _break(flow: Flow, label: Label, block: Block) -> None:
    """Leave the loop; a BREAK that is met while CONTINUE skips to the same end keeps that."""
    flow.opening(label, "while", "do")
    flow.pass_over(label, flow.skip.reason if flow.skip else SkipReason.OVER)
    flow.broken = True


def _continue(flow: Flow, label: Label, block: Block) -> None:
    flow.opening(label, "while", "do")
    if flow.skip is None:
        flow.pass_over(label, SkipReason.CONTINUED)


#: keyword -> what it does
LOOPS = {"do": _do, "while": _while, "repeat": _repeat, "endwhile": _end, "endrepeat": _end,
         "break": _break, "continue": _continue}  # fmt: skip
