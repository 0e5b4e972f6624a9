"""Squareness: two axes do not stand at right angles."""

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear
from vmach.machine.squareness import lean_direction

__all__ = ["Squareness"]

#: target -> (axis that moves, rotation of its reference line); Z is the usual reference, and where
#: it leans itself a part shows that by tools of different length
_PAIRS = {"C0Y": (1, 2), "B0X": (0, 1), "A0Y": (1, 0), "B0Z": (2, 1), "A0Z": (2, 0)}


class Squareness(Effect):
    """The reference line of one axis is turned against the others."""

    name = "squareness"
    title = "squareness of two axes"
    commonness = 32
    shows_as = "displacement across an axis in proportion to its position"
    law = (
        "q_j (σ × ê_j), σ the rotation of the line of axis j: dx = -C0Y y, dz = -B0X x, dz = "
        "A0Y y, dx = B0Z z, dy = -A0Z z"
    )
    source = "equation (3) of docs/laws.md; ISO 230-1, squareness of linear axes"
    parameters = (
        linear("squareness_urad", "rotation of the axis' line, right-handed", usual=30.0),
    )
    targets = tuple(_PAIRS)
    goes_before_curves = True  # ISO 230-1: a straightness error motion has no slope
    usual_size = "10 to 50 urad (um per metre); more after a collision"
    confirm = "cut or measure a square, turn it by 90 degrees, measure again; or a ballbar"
    cure = "align the guides, or set the control's squareness compensation"

    def is_unmeasured(self, machine, target):
        rotation = _PAIRS[target][1]
        return not machine.squareness_rad[:, rotation].any()

    def displacement(self, path, target, squareness_urad):
        axis, rotation = _PAIRS[target]
        lean = 1e-6 * squareness_urad * path.nose_mm[:, axis, None]
        return lean * lean_direction(axis, rotation)
