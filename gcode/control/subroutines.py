"""Subroutines of RS274/NGC: O-word SUB and CALL, Fanuc's program numbers with M98 and M99."""

from __future__ import annotations

from gcode.control.flow_state import Flow, Frame, Label, SkipReason
from gcode.control.interpreter import restore_modes
from gcode.errors import ProgramError
from gcode.state.block_values import whole
from gcode.text.expressions import value_of
from gcode.text.lexer import Block

__all__ = ["SUBROUTINES"]

_LEVELS = 10  #: nesting of calls that the controller allows, the main program counted


def _sub(flow: Flow, label: Label, block: Block) -> None:
    """Go into a called subroutine, or pass over one that the main program runs into."""
    if flow.frames:
        if flow.frames[-1].keyword == "m98":
            raise ProgramError("O... sub called by M98", accepted="O... call")
        _arrive(flow, label, "sub")
        return
    if label in flow.openings:
        raise ProgramError(
            f"O<{label.name}> SUB stands where the program runs into it",
            hint="end the main program with M2 before it",
        )
    flow.open(label, "sub")
    flow.pass_over(label, SkipReason.DEFINED)


def _program(flow: Flow, label: Label, block: Block) -> None:
    if flow.frames and flow.frames[-1].keyword == "call":
        raise ProgramError("Fanuc-style O number called by O-word", accepted="M98")
    _arrive(flow, label, "program")


def _arrive(flow: Flow, label: Label, keyword: str) -> None:
    if flow.skip is not None:
        flow.open(label, keyword)
        flow.skip = None


def _call(flow: Flow, label: Label, block: Block) -> None:
    parameters = flow.controller.parameters
    values = [value_of(v, parameters) for v in block.control.values]
    _push(flow, Frame(label, "call", flow.next, parameters.arguments()))
    parameters.set_arguments(values)
    _jump(flow, label)


def _m98(flow: Flow, label: Label, block: Block) -> None:
    repeats, words = 1, block.words
    if "l" in words:
        repeats = whole(value_of(words["l"], flow.controller.parameters), "L word of M98")
    if repeats != 0:
        _push(flow, Frame(label, "m98", flow.next, [], repeats, flow.budget.executed))
        _jump(flow, label)


def _jump(flow: Flow, label: Label) -> None:
    opening = flow.openings.get(label)
    if opening is not None:
        flow.next = opening.place
    else:
        flow.pass_over(label, SkipReason.SOUGHT)


def _endsub(flow: Flow, label: Label, block: Block) -> None:
    if flow.frames:
        _return(flow, label, block)
    elif flow.skip is None:
        raise ProgramError("ENDSUB outside a subroutine")
    else:
        flow.skip = None


def _return(flow: Flow, label: Label, block: Block) -> None:
    if not flow.frames:
        raise ProgramError("RETURN outside a subroutine")
    if flow.frames[-1].keyword == "m98":
        raise ProgramError("subprogram called by M98 must end with M99")
    parameters = flow.controller.parameters
    has_value = bool(block.control.values)
    parameters.globals["_value"] = flow.value(block) if has_value else 0.0
    parameters.globals["_value_returned"] = float(has_value)
    parameters.set_arguments(_pop(flow).arguments)


def _m99(flow: Flow, label: Label, block: Block) -> None:
    """Begin the next repetition, or return."""
    frame = flow.frames[-1]
    if frame.keyword != "m98":
        raise ProgramError("M99 inside a subroutine called by O-word", accepted="O... endsub")
    frame.repeats -= 1
    if frame.repeats > 0:
        blocks, frame.begun = flow.budget.executed - frame.begun, flow.budget.executed
        flow.budget.check_rounds(frame.repeats, blocks, exact=False, line=frame.return_to[0])
        flow.controller.parameters.locals[-1] = {}
        _jump(flow, frame.label)
    else:
        _pop(flow)


def _push(flow: Flow, frame: Frame) -> None:
    if len(flow.frames) + 1 >= _LEVELS:
        raise ProgramError(f"subroutine calls nested deeper than {_LEVELS - 1}")
    flow.frames.append(frame)
    flow.controller.parameters.locals.append({})
    flow.controller.saved_modes.append(None)


def _pop(flow: Flow) -> Frame:
    controller, level = flow.controller, len(flow.controller.saved_modes)
    if level in controller.restore_on_return:
        controller.restore_on_return.discard(level)
        if controller.saved_modes[-1] is not None:
            controller.line = controller.record.line = flow.frames[-1].return_to[0]
            restore_modes(controller)
    frame = flow.frames.pop()
    controller.parameters.locals.pop()
    controller.saved_modes.pop()
    flow.next = frame.return_to
    return frame


#: keyword -> what it does
SUBROUTINES = {"sub": _sub, "program": _program, "call": _call, "m98": _m98, "m99": _m99,
               "return": _return, "endsub": _endsub}  # fmt: skip
