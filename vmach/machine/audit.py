"""Does a machine file add up? Signs, units, squareness, set-ups and ranges held against each other.

Contradictions within one statement, such as a squareness in two units that disagree, are refused
on reading (`vmach.machine.squareness`); here is what only shows between statements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from vmach.base.units import um_from_mm, urad_from_rad
from vmach.machine.chain import LINEAR_AXES
from vmach.machine.component_errors import COMPONENT_NAMES, SetUp, component_of
from vmach.machine.machine import Machine
from vmach.machine.squareness import squareness_name
from vmach.machine.tables.interpolation import Extrapolation

__all__ = ["Finding", "audit"]

#: an error of a machine tool that is larger is in another unit
_LARGEST_SHIFT_MM = 1.0
_LARGEST_ANGLE_RAD = 1e-3
_SMALLEST = {False: 5e-5, True: 5e-8}  # peak to valley of a real error, mm and rad
#: a slope of less over the whole table is rounding, or the noise of the readings
_SLOPE_OVER_TABLE_MM = 1e-3
#: how far beyond the tip's places on a body, and below the nose, a reflector may be put
_REACH_BEYOND_ARMS_MM = 500.0
_LONGEST_TOOL_MM = 500.0
#: tables measured further apart may be of another state of the machine
_SAME_STATE_DAYS = 31


@dataclass(frozen=True)
class Finding:
    """Something in a machine file that does not fit, or that a reader should know.

    Attributes
    ----------
    level : str
        ``contradiction``: two statements exclude each other; ``doubt``: unlikely, look at the
        report again; ``note``: what was assumed.
    subject : str
        Components or squareness, separated by blanks.
    text : str
    """

    level: str
    subject: str
    text: str

    def __str__(self) -> str:
        return f"{self.level}: {self.subject}: {self.text}"


def audit(machine: Machine) -> tuple[Finding, ...]:
    """All findings on a machine, contradictions first; equal words come once."""
    subjects: dict[tuple[str, str], list[str]] = {}
    for finding in (finding for check in _CHECKS for finding in check(machine)):
        subjects.setdefault((finding.level, finding.text), []).append(finding.subject)
    found = [Finding(level, " ".join(who), text) for (level, text), who in subjects.items()]
    order = ("contradiction", "doubt", "note")
    return tuple(sorted(found, key=lambda finding: order.index(finding.level)))


def _right_angles_stated_twice(machine: Machine) -> Iterator[Finding]:
    sigma = machine.squareness_rad
    for rotation in range(3):
        first, second = (rotation + 1) % 3, (rotation + 2) % 3
        if sigma[first, rotation] and sigma[second, rotation]:
            one, other = squareness_name(first, rotation), squareness_name(second, rotation)
            yield Finding(
                "doubt",
                one,
                f"{one} and {other} both state the right angle between "
                f"{LINEAR_AXES[first]} and {LINEAR_AXES[second]}; their difference acts",
            )


def _reference_axes_out_of_square(machine: Machine) -> Iterator[Finding]:
    """The primary axis has no squareness, the secondary none about the primary."""
    if not machine.reference_axes:
        return
    primary, secondary = (LINEAR_AXES.index(axis) for axis in machine.reference_axes)
    wrong = [(primary, rotation) for rotation in range(3)] + [(secondary, primary)]
    for axis, rotation in wrong:
        if machine.squareness_rad[axis, rotation] and axis != rotation:
            other = 3 - axis - rotation
            role = "primary" if axis == primary else "secondary"
            yield Finding(
                "contradiction",
                squareness_name(axis, rotation),
                f"{LINEAR_AXES[axis]} is the {role} axis of the frame, so this right angle "
                f"belongs to {squareness_name(other, rotation)}, with the other sign",
            )


def _slopes(machine: Machine) -> Iterator[Finding]:
    """A straightness with a slope beside a squareness of the same two axes."""
    for name, component in machine.components.items():
        direction, axis, angular = component_of(name)
        if angular or direction == axis:
            continue
        position = component.position_mm
        slope = np.polyfit(position, component.mean, 1)[0]
        over_table_mm = abs(slope) * np.ptp(position)
        if over_table_mm < _SLOPE_OVER_TABLE_MM:
            continue
        slope_um_per_m, over_table_um = urad_from_rad(slope), um_from_mm(over_table_mm)
        amount = f"a slope of {slope_um_per_m:.3g} um/m, {over_table_um:.3g} um over the table"
        square = squareness_name(axis, 3 - direction - axis)
        if component.slope_removed:
            yield Finding("contradiction", name, f"slope_removed, but there is {amount}")
        elif machine.squareness_rad[axis, 3 - direction - axis]:
            yield Finding(
                "doubt", name, f"{amount}, beside {square}: the slope may be counted twice"
            )


def _sizes(machine: Machine) -> Iterator[Finding]:
    for name, component in machine.components.items():
        largest = float(np.abs([component.forward, component.backward]).max())
        spread = float(np.ptp([component.forward, component.backward]))
        bound = _LARGEST_ANGLE_RAD if component.is_angle else _LARGEST_SHIFT_MM
        unit = "rad" if component.is_angle else "mm"
        if largest > bound or 0.0 < spread < _SMALLEST[component.is_angle]:
            yield Finding(
                "doubt", name, f"up to {largest:.3g} {unit}, range {spread:.3g} {unit}: right unit?"
            )


def _copies(machine: Machine) -> Iterator[Finding]:
    for (name, one), (other_name, other) in combinations(machine.components.items(), 2):
        if (
            one.is_angle == other.is_angle
            and one.mean.any()
            and (np.array_equal(one.mean, other.mean) or np.array_equal(one.mean, -other.mean))
        ):
            yield Finding("doubt", name, f"the same values as {other_name}, copied by mistake?")


def _measuring_points(machine: Machine) -> Iterator[Finding]:
    """A measuring point far from any place where the tip can be on that body."""
    for name, component in machine.components.items():
        if component.is_angle or component.measured_at_mm is None:
            continue
        _, axis, _ = component_of(name)
        corners = machine.chain.arm_masks[axis] * machine.travel_mm
        if component.set_up is SetUp.INDICATOR:
            corners[:, axis] = 0.0
        low = corners.min(axis=0) - _REACH_BEYOND_ARMS_MM - [0.0, 0.0, _LONGEST_TOOL_MM]
        high = corners.max(axis=0) + _REACH_BEYOND_ARMS_MM
        at = component.measured_at_mm
        outside = (at < low) | (at > high)
        for k in np.flatnonzero(outside):
            turned = low[k] <= -at[k] <= high[k]
            yield Finding(
                "doubt",
                name,
                f"measured at {LINEAR_AXES[k]} = {at[k]:g} mm of the body, beyond "
                f"{low[k]:g} .. {high[k]:g} mm" + (": sign turned?" if turned else ""),
            )


def _provenance(machine: Machine) -> Iterator[Finding]:
    """Tables that nobody measured, and tables of one machine from different times."""
    for kind in ("reconstructed", "assumed"):
        names = [name for name, c in machine.components.items() if c.provenance == kind]
        if names:
            yield Finding("note", " ".join(names), f"{kind}, not measured")
    dated = {name: c.measured_on for name, c in machine.components.items() if c.measured_on}
    first, last = min(dated, key=dated.get, default=""), max(dated, key=dated.get, default="")
    if dated and (dated[last] - dated[first]).days > _SAME_STATE_DAYS:
        yield Finding(
            "doubt",
            f"{first} {last}",
            f"measured on {dated[first]} and on {dated[last]}: still the same machine?",
        )


def _what_is_missing(machine: Machine) -> Iterator[Finding]:
    missing = [name for name in COMPONENT_NAMES if name not in machine.components]
    if missing:
        yield Finding("note", " ".join(missing), "no table, taken as zero")
    turning = {name[2] for name, c in machine.components.items() if c.is_angle}
    unplaced = [
        name
        for name, c in machine.components.items()
        if not c.is_angle and c.measured_at_mm is None and name[2] in turning
    ]
    if unplaced:
        yield Finding(
            "note", " ".join(unplaced), "no measured_at_mm: only the conventional arms can be used"
        )


def _ranges(machine: Machine) -> Iterator[Finding]:
    low, high = machine.travel_mm
    for name, component in machine.components.items():
        axis = component_of(name)[1]
        first, last = component.range_mm
        if first > low[axis] or last < high[axis]:
            beyond = {
                Extrapolation.REFUSE: "positions beyond are refused",
                Extrapolation.HOLD: "the end values hold beyond",
                Extrapolation.LINEAR: "the tangents go on beyond",
            }[component.extrapolation]
            yield Finding(
                "note",
                name,
                f"table {first:g} .. {last:g} mm, travel {low[axis]:g} .. {high[axis]:g} mm: "
                + beyond,
            )


def _rows(machine: Machine) -> Iterator[Finding]:
    for note in machine.notes:
        subject, text = note.split(": ", 1)
        yield Finding("note", subject, text)


def _chosen_curves(machine: Machine) -> Iterator[Finding]:
    """What cross-validation chose, against the best and the linear curve."""
    for name, component in machine.components.items():
        if not component.evidence:
            continue
        unit, factor = ("urad", 1e6) if component.is_angle else ("um", 1e3)
        ranked = sorted(component.evidence, key=lambda score: score.rms)
        scores = ", ".join(f"{s.interpolation} {s.rms * factor:.3g}" for s in ranked[:4])
        yield Finding(
            "note", name,
            f"'{component.interpolation}' by cross-validation; left-out points are missed by "
            f"({unit} RMS): {scores}",
        )  # fmt: skip


_CHECKS: tuple[Callable[[Machine], Iterator[Finding]], ...] = (
    _reference_axes_out_of_square,
    _right_angles_stated_twice,
    _slopes,
    _sizes,
    _copies,
    _measuring_points,
    _provenance,
    _what_is_missing,
    _ranges,
    _rows,
    _chosen_curves,
)
