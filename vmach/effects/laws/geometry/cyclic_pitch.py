"""Cyclic pitch error: the screw or its encoder errs once a turn."""

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear
from vmach.machine import LINEAR_AXES

__all__ = ["CyclicPitch", "even_step_mm"]

#: ends of the range of pitches, and the coarsest steps between them
_SHORTEST_MM, _LONGEST_MM = 3.0, 50.0
_FEWEST_STEPS = 40
#: a wave of any length goes through fewer places than this
_PLACES = 12
#: places that are even up to this are; a wave of the shortest pitch moves by 4 % of its amplitude
_EVEN_MM = 0.02


class CyclicPitch(Effect):
    """A sine of the axis position: amplitude x sin(2 pi position / pitch + phase)."""

    name = "cyclic_pitch"
    title = "cyclic error of the screw's pitch or of the encoder"
    commonness = 24
    shows_as = "a sine of the axis position"
    law = "amplitude sin(2π q_j/pitch + phase) ê_j"
    source = (
        "equation (11) of docs/laws.md; ISO 230-2 on periodic errors; closed form derived "
        "here: e = a sin(2 pi q / p + phi)"
    )
    parameters = (
        linear("amplitude_um", "amplitude", usual=3.0),
        inner("pitch_mm", "period along the axis", (_SHORTEST_MM, _LONGEST_MM), usual=10.0),
        inner(
            "phase_rad",
            "phase at the axis' home",
            (-np.pi, np.pi),
            usual=1.0,
            cycle=2 * np.pi,
        ),
    )
    rarity = 0.5
    slack_share = 0.3
    usual_size = "1 to 5 um; the period is the pitch, 5 to 20 mm, or a fraction of it"
    confirm = "laser line in steps of a tenth of the pitch over three pitches"
    cure = "mend the coupling or the encoder's mounting, or set interpolated compensation"

    def displacement(self, path, target, amplitude_um, pitch_mm, phase_rad):
        angle = 2 * np.pi * path.nose_mm[:, LINEAR_AXES.index(target)] / pitch_mm
        return along(target, 1e-3 * amplitude_um * np.sin(angle + phase_rad))

    def not_testable(self, path, target):
        axis = LINEAR_AXES.index(target)
        seen = np.ones(len(path), dtype=bool)
        if path.states.normal is not None:
            seen = np.abs(path.normal[:, axis]) > 0.3
        places = len(np.unique(np.round(path.nose_mm[seen, axis], 1)))
        return None if places >= _PLACES else f"{target} was seen at {places} places only"

    def slack(self, path, target, parameters):
        # the wave of a real screw or encoder is no pure sine: a harmonic at half the period
        size_mm = 1e-3 * self.slack_share * parameters["amplitude_um"]
        angle = 4 * np.pi * path.nose_mm[:, LINEAR_AXES.index(target)] / parameters["pitch_mm"]
        waves = [along(target, size_mm * wave(angle)) for wave in (np.sin, np.cos)]
        return np.stack(waves, axis=2)

    def alike(self, paths, target, parameters):
        axis = LINEAR_AXES.index(target)
        own = [p.nose_mm[:, axis] for p in paths if np.ptp(p.nose_mm[:, axis]) > 0.0]
        places = np.concatenate(own) if own else np.zeros(0)
        step = even_step_mm(places)
        if step is None:
            return ()
        # with q = q_0 + n step, a frequency k/step more turns every place by whole waves
        begin, reach = float(places.min()), float(np.ptp(places))
        frequency, phase = 1.0 / parameters["pitch_mm"], parameters["phase_rad"]
        found = []
        for way in (1.0, -1.0):
            most = int(np.ceil(step * (1.0 / _SHORTEST_MM + frequency)))
            for k in range(-most, most + 1):
                other = way * frequency + k / step
                if not 1.0 / _LONGEST_MM <= other <= 1.0 / _SHORTEST_MM:
                    continue
                if abs(other - frequency) * reach < 1.0:
                    continue  # the same pitch, as far as these places tell
                turned = phase - way * 2.0 * np.pi * k * begin / step
                turned = turned if way > 0.0 else np.pi - turned
                turned = (turned + np.pi) % (2.0 * np.pi) - np.pi
                found.append({**parameters, "pitch_mm": 1.0 / other, "phase_rad": turned})
        return tuple(found)

    # a fit works with the amplitudes of sine and cosine, which enter in proportion

    @property
    def inner_parameters(self):
        return (self.parameters[1],)

    def inner_grid(self, path, target):
        # waves that differ by half a turn over the range seen look different
        longest_mm = float(np.ptp(path.nose_mm, axis=0).max())
        low, high = 1.0 / _LONGEST_MM, 1.0 / _SHORTEST_MM
        steps = max(int(np.ceil(2.0 * longest_mm * (high - low))), _FEWEST_STEPS)
        for frequency in np.linspace(low, high, steps + 1):
            yield {"pitch_mm": float(1.0 / frequency)}

    def columns(self, path, target, inner_values):
        usual = self.parameters[0].usual
        quarters = (0.0, 0.5 * np.pi)
        return np.stack(
            [
                self.displacement(path, target, usual, phase_rad=phase, **inner_values)
                for phase in quarters
            ],
            axis=2,
        )

    def settle(self, coefficients, inner_values):
        sine, cosine = self.parameters[0].usual * coefficients
        amplitude, phase = np.hypot(sine, cosine), np.arctan2(cosine, sine)
        return {"amplitude_um": float(amplitude), "phase_rad": float(phase), **inner_values}


def even_step_mm(places_mm: np.ndarray) -> float | None:
    """The step of which all distances of some places, (P,), are multiples; None where none is.

    Source: C. E. Shannon, Communication in the presence of noise (1949): samples a step apart
    cannot tell frequencies that differ by 1/step.
    """
    places = np.unique(np.round(places_mm, 3))
    if len(places) < _PLACES:
        return None
    places = places[np.diff(places, prepend=places[0] - 1.0) > 2.0 * _EVEN_MM]
    away = np.diff(places)
    number = np.concatenate([[0.0], np.cumsum(np.round(away / away.min()))])
    step, begin = np.polyfit(number, places, 1)
    off = np.abs(places - begin - step * number).max()
    return float(step) if off <= _EVEN_MM else None
