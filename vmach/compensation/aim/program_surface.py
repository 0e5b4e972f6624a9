"""The surface that a program leaves without any error, as points with normals.

Source: the envelopes of `stock.exact.left_surface`.
"""

from __future__ import annotations

import numpy as np

from stock import LeftSurface, Material, find_left_surface
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import Variant
from vmach.nominal.points import SurfacePoints
from vmach.path.preparation import Preparation, prepare
from vmach.prediction import displaced_sweeps

__all__ = ["ProgramSurface"]

#: a normal this near to level or upright belongs to a wall or a floor: 1 degree
_ALIGNED_COS, _ACROSS_COS = 0.99985, 0.01745
#: a point so far below its surface tells whether there is material of the blank
_OFF_FACE_MM = 1e-3
#: pairs of points and triangles that are looked at in one go
_PAIRS = 2_000_000


class ProgramSurface:
    """Samples of the surface that the job's program cuts out of its blank on a perfect machine.

    Parameters
    ----------
    job : Job
        With a blank.
    """

    def __init__(self, job: Job) -> None:
        self.job = job
        self.preparation: Preparation = prepare(job)
        self.sweeps = displaced_sweeps(self.preparation, Variant.NONE)
        self.blank_mm = job.blank.min_mm, job.blank.max_mm
        self.material = Material(self.sweeps, self.preparation.cutters, self.blank_mm)

    def sample(self, spacing_mm: float) -> SurfacePoints:
        """About one point in a square of this side, off the edges as the job's inspection asks.

        Raises
        ------
        InputError
            No feed move cuts the blank.
        """
        job, moves = self.job, self.preparation.path.nodes.moves
        left = find_left_surface(
            self.sweeps,
            self.preparation.cutters,
            blank_mm=self.blank_mm,
            is_cutting=moves.at_feed[self.sweeps.move],
            spacing_mm=spacing_mm,
            margin_mm=job.inspection.edge_margin_mm,
            material=self.material,
        )
        left = self._in_blank(left)
        if not len(left):
            raise InputError(
                "the program cuts no surface out of the blank, "
                f"{job.blank.min_mm} to {job.blank.max_mm} mm",
                file=job.path,
                accepted="[stock] that the tools reach at feed",
                hint="is the blank in workpiece coordinates?",
            )
        feature = self._features(left)
        number = np.char.add("P", np.arange(1, len(left) + 1).astype(str))
        return SurfacePoints(number, feature, left.point_mm, left.normal)

    def _in_blank(self, left: LeftSurface) -> LeftSurface:
        """Without what lies outside of a blank that is no box."""
        mesh = self.job.blank.mesh
        if mesh is None or not len(left):
            return left
        margin_mm = max(self.job.inspection.edge_margin_mm, _OFF_FACE_MM)
        inside = _is_inside(left.point_mm - margin_mm * left.normal, np.asarray(mesh.triangles))
        return LeftSurface(left.point_mm[inside], left.normal[inside], left.sweep[inside])

    def _features(self, left: LeftSurface) -> np.ndarray:
        """Names by tool and by how the surface lies, such as ``T3 wall``."""
        up = left.normal[:, 2]
        kinds = np.select(
            [up > _ALIGNED_COS, up < -_ALIGNED_COS, np.abs(up) < _ACROSS_COS],
            ["floor", "ceiling", "wall"],
            "slope",
        )
        tool = self.preparation.path.nodes.moves.tool[self.sweeps.move[left.sweep]]
        return np.char.add(np.char.add("T", tool.astype(str)), np.char.add(" ", kinds))


def _is_inside(points_mm: np.ndarray, corners_mm: np.ndarray) -> np.ndarray:
    """Whether points lie inside a closed mesh with corners (T, 3, 3), by its winding number.

    The solid angles of the triangles add up to 4 pi inside and to nothing outside [1]_.

    .. [1] Van Oosterom, Strackee: The solid angle of a plane triangle, IEEE Transactions on
       Biomedical Engineering 30 (1983) 125, equation 8.
    """
    inside = np.zeros(len(points_mm), bool)
    for rows in np.array_split(np.arange(len(points_mm)), len(points_mm) * len(corners_mm)
                               // _PAIRS + 1):  # fmt: skip
        a, b, c = np.moveaxis(corners_mm - points_mm[rows, None, None], 2, 0)
        p, q, r = (np.linalg.norm(x, axis=2) for x in (a, b, c))
        above = np.einsum("pti,pti->pt", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("pti,pti->pt", x, y) for x, y in ((a, b), (b, c), (c, a)))
        angle = 2.0 * np.arctan2(above, p * q * r + ab * r + bc * p + ca * q)
        inside[rows] = angle.sum(axis=1) > 2.0 * np.pi
    return inside
