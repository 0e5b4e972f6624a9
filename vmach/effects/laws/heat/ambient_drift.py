"""Ambient drift: the shop's temperature moves the tool against the workpiece."""

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear
from vmach.machine import LINEAR_AXES

__all__ = ["AmbientDrift"]

_EVERYWHERE = "XYZ"
_USUAL_UM = 10.0


def _waves(axis: str, suffix: str):
    return (
        linear(f"sine{suffix}_um", f"along {axis}: sine of 2 pi time / period", usual=_USUAL_UM),
        linear(f"cosine{suffix}_um", f"along {axis}: cosine minus one", usual=_USUAL_UM),
    )


class AmbientDrift(Effect):
    """A slow wave in time, zero at the start: along one axis, or (target XYZ) along all."""

    name = "ambient_drift"
    title = "drift with the temperature of the shop"
    commonness = 19
    shows_as = "a slow wave in time"
    law = "(sine sin φ + cosine (cos φ - 1)) ê_j, φ = 2π t/period"
    source = (
        "equation (16) of docs/laws.md; ISO 230-3, environmental temperature variation "
        "error; closed form derived here: one sine wave of time"
    )
    parameters = (
        *_waves("the target", ""),
        *(wave for axis in LINEAR_AXES for wave in _waves(axis, f"_{axis.lower()}")),
        inner(
            "period_s",
            "period of the wave",
            (2400, 3400, 4800, 6800, 9600, 14000, 20000, 40000, 86400),
            usual=86400.0,
        ),
    )
    targets = (*LINEAR_AXES, _EVERYWHERE)
    rarity = 1.0
    slack_share = 0.3
    slack_time_s = 1500.0
    usual_size = "5 to 30 um a day for a few kelvin"
    confirm = "drift test with the spindle stopped, over a working day (ISO 230-3, ETVE)"
    cure = "keep sun and draught off the machine; probe the datum again before finishing"

    def displacement(self, path, target, period_s, **amplitudes):
        angle = 2 * np.pi * path.time_s / period_s
        shift = np.zeros((len(path), 3))
        for axis in target:
            sine, cosine = self._names(target, axis)
            wave = amplitudes[sine] * np.sin(angle) + amplitudes[cosine] * (np.cos(angle) - 1)
            shift[:, LINEAR_AXES.index(axis)] = 1e-3 * wave
        return shift

    def slack_pattern(self, path, target, parameters):
        moved = self.displacement(path, target, **parameters)
        largest = moved[np.argmax(np.linalg.norm(moved, axis=1))]
        return np.tile(largest, (len(path), 1))

    def unforeseen(self, path, target, parameters):
        # another day has another phase: none of the wave can be foretold, and it comes on top
        stated = self.displacement(path, target, **parameters)
        angle = 2 * np.pi * path.time_s / parameters["period_s"]
        waves = []
        for axis in target:
            size = np.hypot(*(parameters[name] for name in self._names(target, axis)))
            for wave in (np.sin(angle), np.cos(angle) - 1):
                waves.append(along(axis, 1e-3 * np.sqrt(0.5) * size * wave))
        day = np.stack([stated, *waves], axis=2)
        return np.concatenate([day, self.slack(path, target, parameters)], axis=2)

    def needed(self, target):
        return (*self._all_names(target), "period_s")

    # a fit works with the waves of the target's axes only ------------------------------------

    def columns(self, path, target, inner_values):
        names = self._all_names(target)
        units = [{n: _USUAL_UM * float(n == one) for n in names} for one in names]
        moved = [self.displacement(path, target, **unit, **inner_values) for unit in units]
        return np.stack(moved, axis=2)

    def settle(self, coefficients, inner_values):
        names = self._all_names(_EVERYWHERE if len(coefficients) > 2 else "X")
        amounts = (_USUAL_UM * np.asarray(coefficients)).tolist()
        return {**dict(zip(names, amounts, strict=True)), **inner_values}

    def _all_names(self, target):
        return tuple(name for axis in target for name in self._names(target, axis))

    @staticmethod
    def _names(target, axis):
        suffix = f"_{axis.lower()}" if target == _EVERYWHERE else ""
        return f"sine{suffix}_um", f"cosine{suffix}_um"
