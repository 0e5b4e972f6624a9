"""How well a model foretells features that it was not fitted to.

Source: M. Stone, J. R. Stat. Soc. B 36 (1974) 111, cross-validation: every part of the readings is
foretold from a fit to the others.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vmach.base.units import um_from_mm
from vmach.effects import EffectInstance
from vmach.fit.survey import Survey

__all__ = ["held_out_rms_um"]

#: parts that the features are dealt into; one of them at a time is foretold
_FOLDS = 5


def held_out_rms_um(survey: Survey) -> float:
    """RMS of measured minus predicted on features that were not fitted, um.

    The amplitudes of the effects that a fit has put into the job are fitted anew without every
    fifth feature, which is then foretold, and so on with each fifth. Inner parameters stay as the
    job has them; alignment and zeros are fitted to all readings. Without such effects it is the
    RMS of all.
    """
    fitted = [e for e in survey.effects if (e.effect.name, e.target) in survey.job.fitted]
    residual = survey.residual_mm + sum((_explained_mm(survey, e) for e in fitted), start=0.0)
    columns = [_columns_mm(survey, effect) for effect in fitted]
    weight = 1.0 / survey.u_mm[:, None]
    target = (residual - survey.aligned(residual[:, None])[:, 0])[:, None]
    design = np.hstack([np.zeros((len(survey), 0)), *(c - survey.aligned(c) for c in columns)])
    groups, number = np.unique(survey.group, return_inverse=True)
    fold = np.random.default_rng(0).permutation(len(groups))[number] % _FOLDS
    left = target.copy()
    for part in np.unique(fold):
        train, test = fold != part, fold == part
        amounts = np.linalg.lstsq((design * weight)[train], (target * weight)[train], rcond=None)[0]
        left[test] -= design[test] @ amounts
    return float(um_from_mm(np.sqrt(np.mean(left**2))))


def _explained_mm(survey: Survey, effect: EffectInstance) -> np.ndarray:
    """What the effect, as it is in the job, does to the readings, (n,) mm."""
    return _of_readings(survey, effect, effect.parameters)[:, 0]


def _columns_mm(survey: Survey, effect: EffectInstance) -> np.ndarray:
    """What the usual size of each amplitude does to the readings, (n, K) mm.

    Of an effect whose amplitudes hide, as those of a correction curve, the whole in one column.
    """
    kind = effect.effect
    amplitudes, inner = kind.amplitudes, kind.inner_parameters
    if not amplitudes or len(amplitudes) + len(inner) < len(kind.parameters):
        return _of_readings(survey, effect, effect.parameters)
    kept = {p.name: effect.parameters[p.name] for p in inner}
    return np.hstack([
        _of_readings(survey, effect, kept | {p.name: p.usual * (p is one) for p in amplitudes})
        for one in amplitudes
    ])  # fmt: skip


def _of_readings(
    survey: Survey, effect: EffectInstance, parameters: Mapping[str, float]
) -> np.ndarray:
    rows = []
    for measurement, path in zip(survey.measurements, survey.paths, strict=True):
        if not effect.effect.shows_on(measurement.states):
            rows.append(np.zeros((len(measurement), 1)))
            continue
        rows.append(measurement.sensed(effect.at(path, parameters)[:, :, None]))
    return np.vstack(rows)
