"""Branches of RS274/NGC: IF, ELSEIF, ELSE, ENDIF."""

from __future__ import annotations

from gcode.control.flow_state import Flow, Label, SkipReason
from gcode.text.lexer import Block

__all__ = ["BRANCHES"]


def _if(flow: Flow, label: Label, block: Block) -> None:
    flow.open(label, "if")
    if flow.value(block) != 0.0:
        flow.skip = None
    else:
        flow.pass_over(label, SkipReason.UNDECIDED)


def _elseif(flow: Flow, label: Label, block: Block) -> None:
    flow.opening(label, "if")
    if not _is_undecided(flow):
        flow.pass_over(label, SkipReason.DECIDED)
    elif flow.value(block) != 0.0:
        flow.skip = None


def _else(flow: Flow, label: Label, block: Block) -> None:
    flow.opening(label, "if")
    if _is_undecided(flow):
        flow.skip = None
    else:
        flow.pass_over(label, SkipReason.DECIDED)


def _endif(flow: Flow, label: Label, block: Block) -> None:
    flow.opening(label, "if")
    flow.skip = None


def _is_undecided(flow: Flow) -> bool:
    return flow.skip is not None and flow.skip.reason is SkipReason.UNDECIDED


#: keyword -> what it does
BRANCHES = {"if": _if, "elseif": _elseif, "else": _else, "endif": _endif}
