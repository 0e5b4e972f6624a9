"""Component: one of the 18 error tables is missing or no longer true."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import Parameter
from vmach.machine import COMPONENT_NAMES, RigidDisplacement
from vmach.machine.component_errors import component_of

__all__ = ["Component"]

_KNOT_SPACING_MM = 20.0
#: correlation lengths of the correction: a local dent, a change of the whole curve
_LENGTHS_MM = (30.0, 120.0)
#: places of a mean line for each knot; with them it is that of all places to 2 %
_FINER = 8
#: half of a stretch that is but a place; it has no slope
_POINT_MM = 1e-6


class Component(Effect):
    """A smooth correction of one component error against the position of its axis.

    Linear between the positions given; the end values hold beyond them.
    """

    name = "component"
    title = "error table of one component, missing or no longer true"
    commonness = 18
    shows_as = "one table, missing or no longer true"
    law = "correction(q_j) times the lever of the component ([machine-model.md](machine-model.md))"
    source = (
        "equation (17) of docs/laws.md; ISO 230-1, error motions of a linear axis; closed "
        "form derived here: a change of a table acts through the arm of that table"
    )
    parameters = (
        Parameter("position_mm", "axis positions, increasing", -1e6, 1e6, 100.0),
        Parameter(
            "correction_um",
            "to be added to a positioning or straightness table there",
            -1e4,
            1e4,
            5.0,
        ),
        Parameter("correction_urad", "to be added to an angular table there", -1e5, 1e5, 15.0),
    )
    targets = COMPONENT_NAMES
    rarity = 1.5
    corrects_table = turns_tool = True
    usual_size = "5 to 20 um, 10 to 60 urad; locally more after a collision or with worn guides"
    confirm = "measure this component again over the range where it differs"
    cure = "enter the new table; mend the guide where the damage is local"

    def is_unmeasured(self, machine, target):
        return target not in machine.components

    def displacement(self, path, target, position_mm, correction_um=None, correction_urad=None):
        _, axis, angular = component_of(target)
        values = 1e-6 * np.array(correction_urad) if angular else 1e-3 * np.array(correction_um)
        value = np.interp(path.nose_mm[:, axis], position_mm, values)
        lever = path.lever(target)
        return RigidDisplacement(value[:, None] * lever.shift_mm, value[:, None] * lever.tilt_rad)

    def needed(self, target):
        return ("position_mm", "correction_urad" if component_of(target)[2] else "correction_um")

    def complaint(self, target, parameters):
        position, key = parameters["position_mm"], self.needed(target)[1]
        if (beside := len(parameters[key])) != len(position):
            what = f"{key} has {beside} values and position_mm {len(position)}"
            return key, what, "one value for each position"
        for before, here in pairwise(position):
            if not before < here:
                what = f"position_mm has {here:g} behind {before:g}"
                return "position_mm", what, "positions that increase, each once"
        return None

    # a fit works with independent unit coefficients of a smooth curve ------------------------

    @property
    def amplitudes(self):
        return ()

    @property
    def inner_parameters(self):
        return ()

    def inner_grid(self, path, target):
        for length in _LENGTHS_MM:
            yield {"length_mm": length}

    def columns(self, path, target, inner_values):
        _, axis, angular = component_of(target)
        knots = self.knots_mm(path, target)
        position = path.nose_mm[:, axis]
        hats = np.stack([np.interp(position, knots, unit) for unit in np.eye(len(knots))], axis=1)
        size = 15e-6 if angular else 5e-3
        lever = path.states.seen_mm(path.lever(target))
        return size * lever[:, :, None] * (hats @ _root(knots, **inner_values))[:, None, :]

    def knots_mm(self, path, target) -> np.ndarray:
        """Positions of the correction's values, (K,) mm: equal steps over the axis' travel."""
        low, high = path.job.machine.travel_mm[:, component_of(target)[1]]
        return np.linspace(low, high, 1 + int(np.ceil((high - low) / _KNOT_SPACING_MM)))

    def curve(self, path, target, **inner_values) -> np.ndarray:
        """Matrix from coefficients to the correction at the knots, um or urad, (K, K)."""
        size = 15.0 if component_of(target)[2] else 5.0
        return size * _root(self.knots_mm(path, target), **inner_values)

    def beyond_slope(self, inner_values, target, nose_mm):
        position = nose_mm[:, component_of(target)[1]]
        return {**inner_values, "from_mm": position.min(), "to_mm": position.max()}


def _root(
    knots_mm: np.ndarray,
    length_mm: float,
    from_mm: float | None = None,
    to_mm: float | None = None,
) -> np.ndarray:
    """Square root of a squared-exponential covariance between the knots, (K, K).

    With a stretch given, what lies beyond the mean line over it, which goes on as it ends there.
    """
    apart = np.subtract.outer(knots_mm, knots_mm) / length_mm
    values, vectors = np.linalg.eigh(np.exp(-0.5 * apart**2))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    if from_mm is None or to_mm is None:
        return root
    middle, half = 0.5 * (from_mm + to_mm), max(0.5 * (to_mm - from_mm), _POINT_MM)
    share = np.linspace(-1.0, 1.0, _FINER * len(knots_mm))
    hats = [np.interp(middle + half * share, knots_mm, unit) for unit in np.eye(len(root))]
    there = np.stack(hats, axis=1) @ root
    slope = share @ there / (share @ share)
    # up to the knots around the stretch, so that it is straight all over it
    first = knots_mm[knots_mm <= from_mm].max(initial=knots_mm[0])
    last = knots_mm[knots_mm >= to_mm].min(initial=knots_mm[-1])
    everywhere = (np.clip(knots_mm, first, last) - middle) / half
    return root - there.mean(axis=0) - everywhere[:, None] * slope
