"""Squareness: its size, and whether the right angles fit each other and the frame."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.base.note import Kind, Level, Note
from vmach.base.units import urad_from_rad
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.machine import Machine
from vmach.machine.squareness import squareness_name

__all__ = ["squareness_notes"]

#: 5 mm/m: the slides of such a machine would not run
_MOST_RAD = 5e-3
#: ISO 10791-1 accepts 0.02 mm in 500 mm; two and a half times that is worth a word
_USUAL_RAD = 1e-4
#: square, ballbar and laser are uncertain by more: a smaller number is another unit, or a zero
_LEAST_RAD = 1e-6
#: between a value and one in inches lies the root of 25.4; so far above the other right angles one
#: is odd. Far below is not: right angles lie about zero
_ODD_FACTOR = 5.04


def squareness_notes(machine: Machine) -> Iterator[Note]:
    """What cannot be, or is unlikely, of a machine's right angles."""
    yield from _sizes(machine)
    yield from _odd_one_out(machine)
    yield from _reference_axes_out_of_square(machine)
    yield from _right_angles_stated_twice(machine)


def _sizes(machine: Machine) -> Iterator[Note]:
    for axis, rotation in np.argwhere(machine.squareness_rad).tolist():
        angle = float(machine.squareness_rad[axis, rotation])
        if _LEAST_RAD <= abs(angle) <= _USUAL_RAD:
            continue
        is_possible = abs(angle) <= _MOST_RAD
        most = _USUAL_RAD if is_possible else _MOST_RAD
        yield Note(
            Level.DOUBT if is_possible else Level.REFUSED,
            Kind.SQUARENESS,
            squareness_name(axis, rotation),
            f"a squareness of {urad_from_rad(angle):.4g} urad",
            size=urad_from_rad(angle),
            unit="urad",
            accepted=f"{urad_from_rad(_LEAST_RAD):g} .. {urad_from_rad(most):g} urad, or 0",
            hint="is it in the unit that [convention] angle says?",
        )


def _odd_one_out(machine: Machine) -> Iterator[Note]:
    """A right angle far larger than both others."""
    stated = np.argwhere(machine.squareness_rad).tolist()
    if len(stated) < 3:
        return
    largest, second = sorted((abs(machine.squareness_rad[a, r]), (a, r)) for a, r in stated)[:-3:-1]
    angle, (axis, rotation) = largest
    if _LEAST_RAD <= second[0] < angle / _ODD_FACTOR and angle <= _USUAL_RAD:
        yield Note(
            Level.DOUBT,
            Kind.SQUARENESS,
            squareness_name(axis, rotation),
            f"{urad_from_rad(angle):.4g} urad; no other right angle exceeds "
            f"{urad_from_rad(second[0]):.4g} urad",
            size=urad_from_rad(angle),
            unit="urad",
            hint="is it in the unit that [convention] angle says?",
        )


def _reference_axes_out_of_square(machine: Machine) -> Iterator[Note]:
    """The primary axis has no squareness, the secondary none about the primary."""
    if not machine.reference_axes:
        return
    primary, secondary = (LINEAR_AXES.index(axis) for axis in machine.reference_axes)
    wrong = [(primary, rotation) for rotation in range(3)] + [(secondary, primary)]
    for axis, rotation in wrong:
        if machine.squareness_rad[axis, rotation] and axis != rotation:
            other = 3 - axis - rotation
            role = "primary" if axis == primary else "secondary"
            yield Note(
                Level.CONTRADICTION,
                Kind.SQUARENESS,
                squareness_name(axis, rotation),
                f"{LINEAR_AXES[axis]} is the {role} axis of the frame, so this right angle "
                f"belongs to {squareness_name(other, rotation)}, with the other sign",
            )


def _right_angles_stated_twice(machine: Machine) -> Iterator[Note]:
    sigma = machine.squareness_rad
    for rotation in range(3):
        first, second = (rotation + 1) % 3, (rotation + 2) % 3
        if sigma[first, rotation] and sigma[second, rotation]:
            one, other = squareness_name(first, rotation), squareness_name(second, rotation)
            yield Note(
                Level.DOUBT,
                Kind.SQUARENESS,
                one,
                f"{one} and {other} both state the right angle between "
                f"{LINEAR_AXES[first]} and {LINEAR_AXES[second]}; their difference acts",
            )
