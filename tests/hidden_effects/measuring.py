"""How a coordinate measuring machine scatters in a shop: the noise of measured points.

Every kind has the same standard deviation, but for `u_half`, of which the file says half, and its
peer `loud`: the same readings, of which the file says the truth.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["FROM_POINT_TO_POINT", "NOISES", "PEERS", "measuring_error_um", "stated_um"]

#: share of the variance that all points of a feature have in common
_COMMON = 0.36
FROM_POINT_TO_POINT = 0.7
_TAIL_DEGREES = 3.0
#: error of the measuring machine itself, within a + L/b = 1.5 um + L/350
_SCALE_UM_PER_M, _SQUARENESS_URAD = 2.0, 2.0


def measuring_error_um(
    kind: str,
    rng: np.random.Generator,
    *,
    feature: np.ndarray,
    place_mm: np.ndarray,
    normal: np.ndarray,
) -> np.ndarray:
    """Error of every point, (P,), for a standard uncertainty of one micrometre."""
    return (NOISES | PEERS)[kind](rng, np.asarray(feature), place_mm, normal)


def white(rng, feature, place_mm, normal):
    """Independent and normal."""
    return rng.normal(size=len(feature))


def common(rng, feature, place_mm, normal):
    """A part of it is common to all points of a feature: stylus, clamping, form of the wall."""
    names, number = np.unique(feature, return_inverse=True)
    shared = rng.normal(size=len(names))[number]
    return np.sqrt(_COMMON) * shared + np.sqrt(1.0 - _COMMON) * rng.normal(size=len(feature))


def correlated(rng, feature, place_mm, normal):
    """From point to point along a feature, as a first-order autoregression."""
    error = rng.normal(size=len(feature))
    for k in range(1, len(error)):
        if feature[k] == feature[k - 1]:
            error[k] = FROM_POINT_TO_POINT * error[k - 1] + error[k] * np.sqrt(
                1.0 - FROM_POINT_TO_POINT**2
            )
    return error


def heavy_tails(rng, feature, place_mm, normal):
    """Student's t."""
    scale = np.sqrt((_TAIL_DEGREES - 2.0) / _TAIL_DEGREES)
    return scale * rng.standard_t(_TAIL_DEGREES, size=len(feature))


def u_half(rng, feature, place_mm, normal):
    """Twice what the file says."""
    return 2.0 * rng.normal(size=len(feature))


def device_scale(rng, feature, place_mm, normal):
    """White, and a device that is out of scale and square by what its specification allows.

    For 0.8 um of white noise.
    """
    arm = (place_mm - place_mm.mean(axis=0)) * 1e-3
    first, second = rng.permutation(2)
    scale = _SCALE_UM_PER_M * (np.eye(3)[first] - np.eye(3)[second])
    seen = (normal * arm) @ scale + _SQUARENESS_URAD * normal[:, 0] * arm[:, 1]
    return rng.normal(size=len(feature)) + seen / 0.8


def loud(rng, feature, place_mm, normal):
    """Twice as loud as with the other kinds, and the file says so."""
    return u_half(rng, feature, place_mm, normal)


def stated_um(kind: str, noise_um: float) -> float:
    """Standard uncertainty that the file states."""
    return 2.0 * noise_um if kind == "loud" else noise_um


NOISES: dict[str, Callable] = {
    f.__name__: f for f in (white, common, correlated, heavy_tails, u_half, device_scale)
}
#: kinds that are counted on the very readings of another one
PEERS: dict[str, Callable] = {"loud": loud}
