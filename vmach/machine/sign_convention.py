"""What a positive error means: three conventions in use, and their way to the one used inside.

Inside, every error is the displacement of the tool relative to the workpiece, rotations
right-handed. A positive reading then always adds to the tool's displacement.

Source: ISO 230-1 (tool relative to workpiece); Huddersfield paper, figure 2, for `huddersfield`.
"""

from __future__ import annotations

from enum import StrEnum

from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import component_of

__all__ = ["SignConvention", "sign_to_relative"]


class SignConvention(StrEnum):
    """What an error of an axis that carries the workpiece is the motion of."""

    #: of the tool relative to the workpiece: every term adds
    RELATIVE = "relative"
    #: of the body itself in the bed's frame: terms of work-side axes subtract
    BODY = "body"
    #: relative, and an angle is positive when its first effect (in X, Y, Z) grows positive with
    #: a positive amplifying axis; the moving axis itself amplifies nothing
    HUDDERSFIELD = "huddersfield"


def sign_to_relative(convention: SignConvention, chain: Chain, name: str) -> float:
    """Factor +1 or -1 from a recorded component error to the relative right-handed one.

    Parameters
    ----------
    convention : SignConvention
    chain : Chain
    name : str
        ISO 230-1 symbol.
    """
    if convention is SignConvention.BODY:
        return 1.0 if chain.carries_tool(name[2]) else -1.0
    linear = name[2] in LINEAR_AXES  # the rule says nothing of rotary axes
    if convention is SignConvention.HUDDERSFIELD and linear and component_of(name)[2]:
        return _sign_of_first_effect(chain, name)
    return 1.0


def _sign_of_first_effect(chain: Chain, name: str) -> float:
    rotation, axis, _ = component_of(name)
    amplifies = chain.arm_masks[axis].copy()
    amplifies[axis] = 0.0
    for direction in range(len(LINEAR_AXES)):
        # a turn about a moves b by - angle x arm_c and c by + angle x arm_b, (a, b, c) cyclic
        if direction == (rotation + 1) % 3 and amplifies[(rotation + 2) % 3]:
            return -1.0
        if direction == (rotation + 2) % 3 and amplifies[(rotation + 1) % 3]:
            return 1.0
    return 1.0
