"""Alignment of measured or predicted deviations to the nominal part, as a CMM does it.

Let a part lie on the CMM shifted by d and turned by w (small) about p0. A surface point p with
outward normal n then shows the deviation n.(d + w x (p - p0)) on top of its own. Alignment finds
d and w and takes that away.

Source: ISO 5459 (datums); Gaussian best fit by least squares; closed form derived here: n . (w x
r) = w . (r x n).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from vmach.base.note import Kind, Note
from vmach.errors import InputError
from vmach.nominal.points import SurfacePoints

__all__ = ["ALIGNMENT_MODES", "Alignment", "align", "fit_alignment"]

ALIGNMENT_MODES = ("none", "best-fit", "datum")

#: singular values below this share of the largest count as "not determined by the points"
RANK_TOLERANCE = 1e-6

_MOTIONS = ("shift X", "shift Y", "shift Z", "turn about X", "turn about Y", "turn about Z")


@dataclass(frozen=True)
class Alignment:
    """The small rigid motion that an alignment removes, in workpiece coordinates.

    Attributes
    ----------
    mode : str
        One of `ALIGNMENT_MODES`.
    shift_mm : (3,) float64
        Shift d of the part at `about_mm`.
    rotation_rad : (3,) float64
        Rotation vector w of the part, right-handed.
    about_mm : (3,) float64
        The point p0 that the part is turned about.
    rank : int
        How many of the six numbers the points determine; the others are zero.
    covariance : (6, 6) float64
        Of (d, w), mm^2, mm rad and rad^2; zero for what is not determined.
    notes : tuple of Note
        What is not determined, in words.
    """

    mode: str
    shift_mm: np.ndarray
    rotation_rad: np.ndarray
    about_mm: np.ndarray
    rank: int
    covariance: np.ndarray
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        for name, shape in (
            ("shift_mm", (3,)),
            ("rotation_rad", (3,)),
            ("about_mm", (3,)),
            ("covariance", (6, 6)),
        ):
            array = np.array(getattr(self, name), dtype=np.float64)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"Alignment.{name} has to be a finite array of shape {shape}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def deviation_mm(self, points_mm: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """Deviation that the motion alone causes, n.(d + w x (p - p0)), (P,) mm."""
        arm = np.asarray(points_mm, dtype=np.float64) - self.about_mm
        motion = self.shift_mm + np.cross(self.rotation_rad, arm)
        return np.einsum("ij,ij->i", motion, np.asarray(normals, dtype=np.float64))

    def apply(
        self, points_mm: np.ndarray, normals: np.ndarray, deviation_mm: np.ndarray
    ) -> np.ndarray:
        """Deviations after alignment, (P,) mm: those given minus what the motion causes."""
        return np.asarray(deviation_mm) - self.deviation_mm(points_mm, normals)


def align(
    points: SurfacePoints,
    deviation_mm: np.ndarray,
    *,
    mode: str = "best-fit",
    datums: Sequence[Sequence[str]] = (),
    weights: np.ndarray | None = None,
) -> Alignment:
    """Find the alignment of deviations at surface points.

    Parameters
    ----------
    points : SurfacePoints
        Where the deviations are; P of them.
    deviation_mm : (P,) array
        Deviations, finite; leave out points that were not cut.
    mode : {"none", "best-fit", "datum"}
        No alignment; all points, least squares; or the datum features one after the other.
    datums : sequence of sequences of str
        Names (or patterns such as ``"hole *"``) of the features of datum A, B, C ... Datum A is
        fitted by least squares first, each further datum only moves what those before it left
        free: three planes give 3-2-1, a plane and two bores give plane, axis and direction.
    weights : (P,) array, optional
        Weight of each squared residual, 1/u^2; equal where left out.

    Raises
    ------
    InputError
        Unknown mode, no datum, a datum without points, deviations that are not finite.
    """
    if mode not in ALIGNMENT_MODES:
        raise InputError(f"alignment {mode!r} is unknown", accepted=", ".join(ALIGNMENT_MODES))
    if mode == "best-fit":
        return fit_alignment(points.point_mm, points.normal, deviation_mm, weights)
    if mode == "none":
        return Alignment(mode, np.zeros(3), np.zeros(3), np.zeros(3), 0, np.zeros((6, 6)))
    if not datums:
        raise InputError(
            f"alignment {mode!r} needs datum features",
            accepted='lists of feature names, for example [["top"], ["side A"], ["bore 1"]]',
        )
    stages = [_matching(points.feature, names) for names in datums]
    return _sequential_fit(points, deviation_mm, weights, stages=stages)


def fit_alignment(
    points_mm: np.ndarray,
    normals: np.ndarray,
    deviation_mm: np.ndarray,
    weights: np.ndarray | None = None,
) -> Alignment:
    """Best fit: the motion that leaves the least weighted sum of squared deviations.

    Points may not determine all six numbers; a single plane leaves three free. Then the motion
    of least length is taken, with rotations counted at the points' RMS distance from their
    centroid. `notes` says what is free.

    Parameters
    ----------
    points_mm, normals : (P, 3) array
        Nominal points and outward unit normals.
    deviation_mm : (P,) array
        Deviations, positive where material is left.
    weights : (P,) array, optional
        1/u^2 in mm^-2. Without them the covariance comes from the residuals' scatter.
    """
    points = SurfacePoints(
        np.arange(len(points_mm)), np.full(len(points_mm), ""), points_mm, normals
    )
    everything = np.ones(len(points), dtype=bool)
    return _sequential_fit(points, deviation_mm, weights, stages=[everything], mode="best-fit")


def _matching(features: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Mask of the points whose feature has one of the names or fits one of the patterns."""
    known = np.unique(features)
    wanted = []
    for name in [names] if isinstance(names, str) else names:
        hits = [k for k in known if k == name or fnmatchcase(k, name)]
        if not hits:
            some = ", ".join(repr(str(k)) for k in known[:10])
            raise InputError(f"no point lies on the datum feature {name!r}", accepted=some)
        wanted += hits
    return np.isin(features, wanted)


def _sequential_fit(
    points: SurfacePoints,
    deviation_mm: np.ndarray,
    weights: np.ndarray | None,
    *,
    stages: Sequence[np.ndarray],
    mode: str = "datum",
) -> Alignment:
    """Fit each stage's points within the motions that the stages before left free."""
    deviation_mm, root_weight = _checked(points, deviation_mm, weights)
    used = np.any(stages, axis=0)
    about_mm = np.average(points.point_mm[used], axis=0, weights=root_weight[used] ** 2)
    length_mm = np.sqrt(((points.point_mm[used] - about_mm) ** 2).sum(axis=1).mean()) or 1.0
    scale = np.array([1.0, 1.0, 1.0, length_mm, length_mm, length_mm])
    design = _design(points, about_mm) / scale

    solution, covariance, free = np.zeros(6), np.zeros((6, 6)), np.eye(6)
    for stage in stages:
        rows = design[stage] * root_weight[stage, None]
        target = deviation_mm[stage] * root_weight[stage] - rows @ solution
        step, step_covariance, free = _solve_within(rows, target, free)
        solution = solution + step
        covariance = covariance + step_covariance
    if weights is None:
        residual = (deviation_mm - design @ solution)[used]
        degrees = max(int(used.sum()) - (6 - free.shape[1]), 1)
        covariance = covariance * (residual @ residual) / degrees
    return Alignment(
        mode,
        solution[:3],
        solution[3:] / length_mm,
        about_mm,
        rank=6 - free.shape[1],
        covariance=covariance / np.outer(scale, scale),
        notes=_notes_on_free(free),
    )


def _checked(
    points: SurfacePoints, deviation_mm: np.ndarray, weights: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    deviation_mm = np.asarray(deviation_mm, dtype=np.float64)
    weights = np.ones(len(points)) if weights is None else np.asarray(weights, dtype=np.float64)
    for name, array in (("deviations", deviation_mm), ("weights", weights)):
        if array.shape != (len(points),):
            raise InputError(f"{array.shape} {name} for {len(points)} points to align")
        if not np.isfinite(array).all():
            count = int((~np.isfinite(array)).sum())
            raise InputError(
                f"{count} of the {name} to align are not finite",
                hint="leave out points that were not cut",
            )
    if not len(points):
        raise InputError("no points to align")
    if (weights < 0.0).any() or not weights.any():
        what = f"weights of an alignment from {weights.min():g} to {weights.max():g}"
        raise InputError(what, accepted="numbers of 0 and above, not all 0")
    return deviation_mm, np.sqrt(weights)


def _design(points: SurfacePoints, about_mm: np.ndarray) -> np.ndarray:
    """Rows (n, (p - p0) x n), since n.(w x r) = w.(r x n); (P, 6)."""
    arm = points.point_mm - about_mm
    return np.hstack([points.normal, np.cross(arm, points.normal)])


def _solve_within(
    rows: np.ndarray, target: np.ndarray, free: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Least squares in the span of `free` (6, F): step, its covariance, what is still free."""
    if free.shape[1] == 0:
        return np.zeros(6), np.zeros((6, 6)), free
    normal_matrix = free.T @ (rows.T @ rows) @ free
    # squared singular values; the scale is that of the whole stage, not of what is left of it
    values, vectors = np.linalg.eigh(normal_matrix)
    floor = np.trace(rows.T @ rows) * RANK_TOLERANCE**2
    known = values > floor
    basis = free @ vectors[:, known]
    left, size, right = np.linalg.svd(rows @ basis, full_matrices=False)
    step = basis @ (right.T @ ((left.T @ target) / size))
    spread = basis @ (right.T / size)
    return step, spread @ spread.T, free @ vectors[:, ~known]


def _notes_on_free(free: np.ndarray) -> tuple[Note, ...]:
    if free.shape[1] == 0:
        return ()
    share = (free**2).sum(axis=1)
    names = [name for name, part in zip(_MOTIONS, share, strict=True) if part > 0.5]
    words = ", ".join(names) if len(names) == free.shape[1] else "combined motions"
    said = f"the points leave {free.shape[1]} of 6 motions free ({words}); these are taken as zero"
    return (Note.plain(Kind.ALIGNMENT, said, free.shape[1], "1"),)
