"""Predicted deviations of surface points."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.api.records import Rows
from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.job import Job
from vmach.machine import Variant
from vmach.machine.variant_name import variant_called
from vmach.nominal.points import SurfacePoints
from vmach.prediction.error_budget import error_budget
from vmach.prediction.prediction import Prediction
from vmach.report.result import STATUSES
from vmach.run.pipeline import predict_points
from vmach.uncertainty.first_order import prediction_u_mm

__all__ = ["PointDeviations", "predict", "surface_points"]


@dataclass(frozen=True)
class PointDeviations(Rows):
    """Predicted deviations of P surface points, in the order in which they were given.

    Attributes
    ----------
    id, feature : (P,) str
    point_mm, normal : (P, 3) float64
        Nominal point and outward unit normal, workpiece coordinates.
    deviation_um : (P,) float64
        Along the normal, positive where material is left; NaN where no tool made the surface.
    u_um : (P,) float64
        Standard uncertainty that the tables and the job's effects leave; NaN likewise.
    status : (P,) str
        ``cut``, ``uncut`` or ``gouged away``.
    line, tool : (P,) int64
        NC line (1-based) and tool that made the point; 0 where none did.
    time_s : (P,) float64
        Since the program's start; NaN where no tool made the surface.
    share_um : mapping of source to (P,) float64
        What each error adds to the deviation; the shares of a point add up to it.
    notes : tuple of Note
        What to know before trusting the numbers.
    """

    id: np.ndarray
    feature: np.ndarray
    point_mm: np.ndarray
    normal: np.ndarray
    deviation_um: np.ndarray
    u_um: np.ndarray
    status: np.ndarray
    line: np.ndarray
    tool: np.ndarray
    time_s: np.ndarray
    share_um: dict[str, np.ndarray]
    notes: tuple[Note, ...] = ()

    _PARTS = {"point_mm": ("x_mm", "y_mm", "z_mm"), "normal": ("i", "j", "k")}

    def __len__(self) -> int:
        return len(self.id)

    @property
    def is_cut(self) -> np.ndarray:
        """(P,) bool: points whose surface a tool made."""
        return self.status == STATUSES[0]


def surface_points(
    point_mm: np.ndarray, normal: np.ndarray, *, feature: str | np.ndarray = ""
) -> SurfacePoints:
    """Surface points from arrays; their ids are 1, 2, 3 ...

    Parameters
    ----------
    point_mm : (P, 3) array
        Workpiece coordinates.
    normal : (P, 3) or (3,) array
        Outward, away from the material, of any length above zero.
    feature : str or (P,) str
        Which face each point lies on.

    Raises
    ------
    ValueError
        Wrong shapes, or a normal without a length.

    Examples
    --------
    >>> import vmach
    >>> points = vmach.surface_points([[50.0, 0.0, -3.0], [0.0, 40.0, 0.0]], [[1, 0, 0], [0, 0, 1]])
    >>> points.id.tolist()
    ['1', '2']
    """
    points, normals = np.atleast_2d(np.asarray(point_mm, float)), np.asarray(normal, float)
    if (
        points.ndim != 2
        or points.shape[1] != 3
        or normals.shape not in ((3,), (1, 3), points.shape)
    ):
        raise ValueError(
            f"points of shape {points.shape} with normals of shape {normals.shape}; accepted: "
            "(P, 3) for points, (P, 3) or (3,) for normals"
        )
    normals = np.broadcast_to(normals, points.shape)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    if not (np.isfinite(points).all() and np.isfinite(length).all() and length.all()):
        wrong = ~(np.isfinite(points).all(axis=1) & np.isfinite(length[:, 0]) & (length[:, 0] > 0))
        row = int(np.argmax(wrong))
        raise ValueError(
            f"point {points[row]} with normal {normals[row]}; accepted: finite numbers, and a "
            "normal longer than zero"
        )
    return SurfacePoints(
        id=np.arange(1, len(points) + 1).astype(str),
        feature=np.broadcast_to(np.asarray(feature, dtype=str), len(points)).copy(),
        point_mm=points,
        normal=normals / length,
    )


def predict(
    job: Job | str | Path,
    points: SurfacePoints | str | Path,
    *,
    program: str | Path | None = None,
    model: str = Variant.ABBE,
) -> PointDeviations:
    """Deviation of surface points of the part that a job makes.

    Parameters
    ----------
    job : Job or path
        See `read_job`.
    points : SurfacePoints or path
        From `surface_points`, or a CSV file with ``id,feature,x,y,z,i,j,k``.
    program : path, optional
        Another NC program on the same machine with the same tools.
    model : {"abbe", "htm", "none"}
        Arms of the machine's errors.

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError

    Examples
    --------
    >>> import vmach
    >>> points = vmach.surface_points([[50.0, 0.0, -3.0]], [1.0, 0.0, 0.0], feature="circle")
    >>> found = vmach.predict("samples/iso10791_7", points)
    >>> found.deviation_um.round(2), found.line, found.status
    (array([1.08]), array([175]), array(['cut'], dtype='<U11'))
    """
    found, prediction = predict_points(
        job, points, program_path=program, variant=variant_called(model)
    )
    return _deviations(found, prediction)


def _deviations(points: SurfacePoints, prediction: Prediction) -> PointDeviations:
    cut, states = prediction.is_cut, prediction.states

    def spread(values: np.ndarray, empty: float) -> np.ndarray:
        full = np.full(len(points.id), empty, dtype=values.dtype)
        full[cut] = values
        return full

    budget = error_budget(prediction, prediction.effects)
    shares = um_from_mm(budget.share_mm).T
    return PointDeviations(
        id=points.id,
        feature=points.feature,
        point_mm=points.point_mm,
        normal=points.normal,
        deviation_um=spread(um_from_mm(prediction.deviation_mm[cut]), np.nan),
        u_um=spread(um_from_mm(prediction_u_mm(prediction)), np.nan),
        status=np.array(STATUSES)[prediction.edges.status],
        line=spread(states.line.astype(np.int64), 0),
        tool=spread(states.tool.astype(np.int64), 0),
        time_s=spread(states.time_s, np.nan),
        share_um={name: spread(s, np.nan) for name, s in zip(budget.sources, shares, strict=True)},
        notes=(*prediction.preparation.notes, *points.notes),
    )
