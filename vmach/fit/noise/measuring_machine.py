"""What the machine that measured a part adds to the readings, as columns of unit variance.

Its scales and squareness, the form of its probing, what the points of a feature or of a clamping
have in common: of known size where the job states it. Its drift is known by its clock alone. Other
instruments have a scale of their own.

Source: ISO 10360-2 and ISO 10360-5, maximum permissible errors; closed forms derived here.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import block_diag

from vmach.effects.wandering import wandering
from vmach.fit.survey import Survey
from vmach.job.inspection import Device
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement

__all__ = [
    "CLAMPINGS",
    "DRIFT",
    "WARMING",
    "clampings",
    "drift_of_device",
    "stated_of_device",
    "steady_drifts_of_device",
    "warming_of_instruments",
]

#: names of what is known of it, or told by the readings
CLAMPINGS, DRIFT = "clampings", "drift of the measuring machine"
WARMING = "length of the instrument as it warms"
SCALES = "scales and squareness of the measuring machine"
FORM, FEATURES = "form of the probing", "offsets of features"
INSTRUMENT = "scale of the instrument"

#: lobes that the form of a probing has; one is a shift, and none the radius of the stylus tip
_LOBES = (2, 3)
#: bends that a drift makes in the time of a measurement
_WAVES = 6.0
#: half the length of the smallest part that turns, mm: points on one place tell no turn
_LEAST_HALF_MM = 25.0


def stated_of_device(survey: Survey) -> dict[str, np.ndarray]:
    """What the job states of it, or an ordinary one has, by name: (n, K) mm of unit variance.

    An instrument of which nothing is stated is the reference for its scale where it is alone, and
    an ordinary one beside others that tell a scale.
    """
    is_beside = any(map(_tells_scale, survey.measurements))
    parts = [
        _stated(m, path.on_part_mm, survey.job.device, counts=m.scale_is_stated or is_beside)
        for m, path in zip(survey.measurements, survey.paths, strict=True)
    ]
    return {name: block_diag(*(part[name] for part in parts)) for name in parts[0]}


def clampings(survey: Survey) -> np.ndarray:
    """Shifts and turns of unit size of the part in each of several clampings, (n, K).

    A turn moves the end of the part by one. None where the job states their size.
    """
    if survey.job.device.clamping_u_mm is not None:
        return np.zeros((len(survey), 0))
    pairs = zip(survey.measurements, survey.paths, strict=True)
    return block_diag(*(_moved_by_clamping(m, path.on_part_mm) for m, path in pairs))


def drift_of_device(survey: Survey) -> np.ndarray:
    """Wandering along X, Y and Z while a part was measured, of unit variance, (n, K).

    None where the readings do not tell their order or the clock.
    """
    blocks = []
    for m in survey.measurements:
        if m.measured_at is None:
            blocks.append(np.zeros((len(m), 0)))
            continue
        span = max(float(np.ptp(m.measured_at)), 1e-9)
        waves = wandering(m.measured_at, span / _WAVES)
        blocks.append((m.sensing[:, :, None] * waves[:, None, :]).reshape(len(m), -1))
    return block_diag(*blocks)


def steady_drifts_of_device(survey: Survey) -> dict[str, np.ndarray]:
    """A drift at one speed along X, Y or Z while a part was measured, by name, (n, K) each.

    Of unit variance. What drifts has a direction, so that each axis has a size of its own.
    """
    found = {}
    for axis, name in enumerate(LINEAR_AXES):
        blocks = []
        for m in survey.measurements:
            at = np.zeros(len(m)) if m.measured_at is None else m.measured_at
            half = max(0.5 * float(np.ptp(at)), 1e-9)
            # a straight line from -sqrt(3) to sqrt(3) has the variance of one
            line = np.sqrt(3.0) * (at - 0.5 * (at.min() + at.max())) / half
            blocks.append((m.sensing[:, axis] * line)[:, None])
        found[f"steady {DRIFT} along {name}"] = block_diag(*blocks)
    return found


def warming_of_instruments(survey: Survey) -> np.ndarray:
    """How the length of instruments that turn wanders with their clock, of unit variance, (n, K).

    Of those that do not turn, the tool that wanders along the axis reads the same.
    """
    blocks = []
    for path, m in zip(survey.paths, survey.measurements, strict=True):
        span = max(float(np.ptp(path.time_s)), 1e-9)
        waves = wandering(path.time_s, span / _WAVES)
        blocks.append(waves if m.instrument.turns else np.zeros((len(m), 0)))
    return block_diag(*blocks)


def _tells_scale(m: Measurement) -> bool:
    """Whether it reads displacements at several places, without a scale of its own."""
    moves = bool(np.ptp(m.states.nose_mm, axis=0).any())
    return m.scale_u_mm is None and m.states.arm_mm is None and moves


def _stated(
    m: Measurement, place_mm: np.ndarray, device: Device, *, counts: bool
) -> dict[str, np.ndarray]:
    """Of one measurement, at places (P, 3); no columns where no part was measured.

    Its own scale where that counts.
    """
    away, n = place_mm - place_mm.mean(axis=0), m.sensing
    stretched = device.scale_u * n * away
    sheared = np.transpose([n[:, 0] * away[:, 1], n[:, 0] * away[:, 2], n[:, 1] * away[:, 2]])
    found = {
        SCALES: np.hstack([stretched, device.squareness_u_rad * sheared]),
        CLAMPINGS: (device.clamping_u_mm or 0.0) * _moved_by_clamping(m, place_mm),
        FORM: device.probing_form_mm * _lobes(n),
        FEATURES: device.feature_u_mm * _inside(m.group),
    }
    # a reading over several contacts is of a whole feature already
    none = {FORM, FEATURES} if m.contacts is not None else set()
    none = none if m.on_part else set(found)
    kept = {name: v[:, :0] if name in none else v for name, v in found.items()}
    scale = m.scale_u_mm if counts else None
    own = np.zeros((len(m), 0)) if scale is None else scale[:, None]
    return kept | {INSTRUMENT: own}


def _moved_by_clamping(m: Measurement, place_mm: np.ndarray) -> np.ndarray:
    """Shifts of unit size, and turns that move the end of the part by one, (P, 6 C)."""
    if m.clamping is None or not m.on_part or len(np.unique(m.clamping)) < 2:
        return np.zeros((len(m), 0))
    half = max(0.5 * float(np.ptp(place_mm, axis=0).max()), _LEAST_HALF_MM)
    arm = (place_mm - place_mm.mean(axis=0)) / half
    moved = np.hstack([m.sensing, np.cross(arm, m.sensing)])
    return (_inside(m.clamping)[:, :, None] * moved[:, None, :]).reshape(len(m), -1)


def _lobes(normal: np.ndarray) -> np.ndarray:
    """Lobed errors of a probing about the stylus along Z, (P, 4), of a form of one.

    A wave whose range is P has the variance P²/8, which the lobes share.
    """
    turn, across = np.arctan2(normal[:, 1], normal[:, 0]), np.hypot(*normal[:, :2].T)
    waves = [wave(count * turn) for count in _LOBES for wave in (np.cos, np.sin)]
    return across[:, None] * np.transpose(waves) / np.sqrt(8.0 * len(_LOBES))


def _inside(group: np.ndarray) -> np.ndarray:
    """Which reading belongs to which group, (P, G) of 0 and 1."""
    names, number = np.unique(group, return_inverse=True)
    return np.eye(len(names))[number]
