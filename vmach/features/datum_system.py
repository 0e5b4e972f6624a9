"""Datum systems: the frame that a part's datum features give, one after the other.

Source: ISO 5459: each datum only locks what those before it left free.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vmach.errors import InputError
from vmach.features.association.associate import RANK, associate
from vmach.features.association.pose import Pose, motion_rows
from vmach.features.feature import Feature, Points

__all__ = ["ASSOCIATIONS", "DatumSystem", "datum_system"]

#: how datums are laid through their features
ASSOCIATIONS = ("least squares", "contact")


@dataclass(frozen=True)
class DatumSystem:
    """The frame of a list of datums.

    Attributes
    ----------
    labels : tuple of str
    pose : Pose
        Carries the nominal part to where the datum features lie.
    free : (6, F) float64
        Motions about `about_mm` that the datums leave free.
    about_mm : (3,) float64
    rows : (N,) int
        Points of the datum features.
    gain : (6, N) float64
        Motion of the frame with the deviation of each.
    """

    labels: tuple[str, ...] = ()
    pose: Pose = field(default_factory=Pose)
    free: np.ndarray = field(default_factory=lambda: np.eye(6))
    about_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    rows: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    gain: np.ndarray = field(default_factory=lambda: np.empty((6, 0)))

    @property
    def turned_only(self) -> np.ndarray:
        """Motions that leave the orientation of a zone: the free ones and all shifts, (6, F)."""
        shifts = np.vstack([np.eye(3), np.zeros((3, 3))])
        turns = np.vstack([np.zeros((3, self.free.shape[1])), self.free[3:]])
        left, size, _ = np.linalg.svd(turns, full_matrices=False)
        return np.hstack([shifts, left[:, size > RANK]])


def datum_system(
    labels: Sequence[str],
    features: Mapping[str, Feature],
    points: Points,
    association: str = "least squares",
) -> DatumSystem:
    """Build the frame of some datums.

    Parameters
    ----------
    labels : sequence of str
        In their order: primary, secondary, tertiary. ``A-B`` is a common datum.
    features : mapping of str to Feature
        By the letter of the datum.
    points : Points
    association : str
        ``least squares``, or ``contact``: planes touch from outside the material with the least
        largest distance, holes are inscribed, shafts circumscribed.

    Raises
    ------
    InputError
        An unknown letter, a datum without points, or one that locks nothing.
    """
    if not labels:
        return DatumSystem()
    stages = [_common(label, features) for label in labels]
    about = points.nominal_mm[stages[0].pooled(points).rows].mean(axis=0)
    pose, free = Pose(), np.eye(6)
    rows, gain = np.empty(0, dtype=int), np.empty((6, 0))
    for label, feature in zip(labels, stages, strict=True):
        member = feature.pooled(points)
        actual = points.actual_mm[member.rows]
        locked, left = _locked(label, member.surface, pose.undo(actual), about, free)
        criterion = _criterion(association, member.surface)
        try:
            found = associate(
                member.surface, actual, criterion=criterion, pose=pose, basis=locked, about_mm=about
            )
        except InputError as error:
            said = f"datum {label}: {error.what}"
            raise InputError(said, accepted=error.accepted, hint=error.hint) from None
        step = found.gain[:6]
        # what the frame so far moved is taken from the distances of this datum
        gain = np.hstack([gain - step @ (found.rows[:, :6] @ gain), step])
        rows = np.concatenate([rows, member.rows])
        pose, free = found.pose, left
    return DatumSystem(tuple(labels), pose, free, about, rows, gain)


def _common(label: str, features: Mapping[str, Feature]) -> Feature:
    """The feature of a datum, or of a common one such as ``A-B``."""
    parts = []
    for letter in label.split("-"):
        if letter not in features:
            raise InputError(
                f"datum {letter} is not defined", accepted=", ".join(sorted(features)) or "none is",
                hint=f'[datums] {letter} = "name of a feature"',
            )  # fmt: skip
        parts.append(features[letter])
    members = tuple(member for part in parts for member in part.members)
    return Feature(label, members)


def _locked(label: str, surface, seen: np.ndarray, about: np.ndarray, free: np.ndarray):
    """Motions that the datum locks, and those that it leaves, (6, F) each.

    A size that changes along, as that of a bore does, must not pass for a motion.
    """
    _, normals, own = surface.rows(seen)
    rows = motion_rows(seen, normals, about)
    length = np.sqrt(((seen - about) ** 2).sum(axis=1).mean()) or 1.0
    scale = np.array([1.0, 1.0, 1.0, length, length, length])
    rows = rows / scale
    if own.shape[1]:
        rows = rows - own @ np.linalg.lstsq(own, rows, rcond=None)[0]
    basis = free * scale[:, None]
    basis = np.linalg.qr(basis)[0] if basis.shape[1] else basis
    table = rows @ basis
    if not basis.shape[1]:
        raise _locks_nothing(label)
    # all of `right` is wanted; all of the left side only where there are fewer points than motions
    is_short = len(table) < table.shape[1]
    _, size, right = np.linalg.svd(table, full_matrices=is_short)
    size = np.append(size, np.zeros(len(right) - len(size)))
    # deviations of the points tilt the rows a little; a motion is locked where it matters
    is_locked = size > _MATTERS * np.linalg.norm(rows)
    if not is_locked.any():
        raise _locks_nothing(label)
    kept, left = basis @ right[is_locked].T, basis @ right[~is_locked].T
    return kept / scale[:, None], left / scale[:, None]


#: a motion that moves the points less than this share of what others do is not locked by them
_MATTERS = 1e-4


def _locks_nothing(label: str) -> InputError:
    return InputError(
        f"datum {label} locks nothing that the datums before it left free",
        accepted="a datum feature that locks a further shift or turn",
        hint="is it parallel to, or the same as, an earlier datum?",
    )


def _criterion(association: str, surface) -> str:
    if association not in ASSOCIATIONS:
        raise InputError(f"association {association!r}", accepted=", ".join(ASSOCIATIONS))
    if association == "least squares" or surface.kind in ("compound", "free"):
        return "least squares"
    if surface.kind in ("cylinder", "sphere"):
        return "inscribed" if surface.sign < 0.0 else "circumscribed"
    return "tangent" if surface.kind == "plane" else "least squares"
