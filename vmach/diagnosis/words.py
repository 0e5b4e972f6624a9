"""The findings in words that a machinist understands."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from vmach.diagnosis.inference.rules import SHOWN
from vmach.diagnosis.inference.verdicts import Reason, Weak
from vmach.diagnosis.residuals import Residuals
from vmach.effects import Effect
from vmach.machine import LINEAR_AXES
from vmach.machine.component_errors import component_of

__all__ = [
    "RELATIVE",
    "counted_as_of_measurement",
    "describe",
    "expected",
    "rounded",
    "title_of",
    "weak_words",
    "where_component",
    "with_unit",
]

#: said of a curve that points of a part alone show
RELATIVE = "up to a level and a slope, which the alignment of the part leaves open"
#: units at the ends of names, as people write them
_UNITS = {unit: unit for unit in ("um", "mm", "ppm", "urad", "rad", "s", "ms")} | {"ms2": "ms²"}
#: a correction counts as there where it exceeds this many standard uncertainties
_CLEAR = 3.0


def describe(effect: Effect) -> dict[str, str]:
    """What an effect is, its usual size, how to confirm and how to cure it."""
    return {
        "what": effect.title,
        "usual_size": effect.usual_size,
        "confirm": effect.confirm,
        "cure": effect.cure,
    }


def title_of(effect: Effect, target: str) -> str:
    """What an effect is at its target, in the words of ISO 230-1 where that has them."""
    if effect.corrects_table:
        return f"error table {target} ({_component(target)}), missing or no longer true"
    if effect.name == "squareness":
        own = target[2]
        (other,) = set(LINEAR_AXES) - {own, LINEAR_AXES["ABC".index(target[0])]}
        return f"squareness of {own} to {other}"
    return effect.title


def _component(name: str) -> str:
    """What is wrong along an axis, of a name as EYX."""
    direction, axis, is_angle = component_of(name)
    if is_angle:
        return f"angle of {LINEAR_AXES[axis]} about {LINEAR_AXES[direction]}"
    if direction == axis:
        return f"positioning of {LINEAR_AXES[axis]}"
    return f"straightness of {LINEAR_AXES[axis]} in {LINEAR_AXES[direction]}"


def weak_words(weak: Weak) -> str:
    """Why an effect that the readings speak for is not shown, with the number that decides."""
    support = weak.support
    if weak.why is not Reason.DOUBTFUL:
        return str(weak.why)
    if support.odds < SHOWN:
        return f"log odds {max(support.odds, 0.0):.1f}, less than {SHOWN:g}"
    imitation = 100.0 * (1.0 - support.probability)
    return f"log odds {support.odds:.1f}, but to {imitation:.0f} % an imitation of something else"


def counted_as_of_measurement(sizes_um: Mapping[str, float]) -> str:
    """A sentence on what the readings hold that a verdict counts as of the measurement."""
    each = ", ".join(f"{name} {size:.2g} um" for name, size in sizes_um.items())
    return f"Counted as of the measurement: {each}."


def with_unit(parameter: str, value: float) -> str:
    """A value of a parameter with the unit that stands at the end of its name."""
    unit = parameter.rsplit("_", 1)[-1]
    return f"{value:g} {_UNITS[unit]}" if unit in _UNITS else f"{parameter} = {value:g}"


def rounded(value: float, interval: tuple[float, float]) -> tuple[str, str, str]:
    """A value and the ends of its interval; two digits of the interval's half width count.

    And of a value that is far less still one or two: parameters that are uncertain together make
    one effect.
    """
    half = max(0.5 * (interval[1] - interval[0]), 1e-3 * abs(value), 1e-12)
    half = min(half, 3.0 * abs(value) or half)
    digits = 1 - math.floor(math.log10(half))
    own, low, high = (f"{round(x, digits):.{max(digits, 0)}f}" for x in (value, *interval))
    return own, low, high


def expected(residuals: Residuals) -> str:
    """What is counted as noise."""
    if residuals.survey.effects:
        return "noise, the tables' uncertainty and what the job's effects leave open"
    return "noise and the tables' uncertainty"


def where_component(
    parameters: dict[str, list[float]], u: dict[str, list[float]], target: str
) -> str:
    """Where on the axis a component's correction is clearly not zero."""
    key = next(iter(u))
    unit = key.rsplit("_", 1)[1]
    position = np.array(parameters["position_mm"])
    value, spread = np.array(parameters[key]), np.array(u[key])
    # the alignment leaves the level open: what counts is the difference from the middle
    shape = value - np.median(value)
    peak = int(np.argmax(np.abs(shape)))
    clear = (np.abs(shape) > _CLEAR * spread) & (np.abs(shape) > 0.3 * np.abs(shape[peak]))
    axis = target[2]
    if not clear[peak]:
        return f"{axis} {position[0]:.0f} .. {position[-1]:.0f} mm"
    first = last = peak
    while first > 0 and clear[first - 1]:
        first -= 1
    while last < len(clear) - 1 and clear[last + 1]:
        last += 1
    if first == last:
        return f"{axis} {position[peak]:.0f} mm ({shape[peak]:+.1f} {unit})"
    return (
        f"{axis} {position[first]:.0f} .. {position[last]:.0f} mm, "
        f"most at {position[peak]:.0f} mm ({shape[peak]:+.1f} {unit})"
    )
