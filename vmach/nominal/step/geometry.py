"""Curves and surfaces of a STEP file (ISO 10303-42) in the workpiece frame, mm and rad.

Source: ISO 10303-42.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from vmach.errors import InputError
from vmach.nominal.frame import Frame
from vmach.nominal.step.exchange_file import Reference, StepEntity, StepFile
from vmach.nominal.surfaces import (
    Cone,
    Cylinder,
    Extrusion,
    Offset,
    Plane,
    Revolution,
    Sphere,
    Surface,
    Torus,
)
from vmach.nominal.surfaces.bspline_surface import BSplineSurface
from vmach.nominal.surfaces.curves import BSplineCurve, Curve, Ellipse, Hyperbola, Line, Parabola

__all__ = ["GeometryReader"]


#: of a larger radius the digits of a number do not hold the micrometre
LARGEST_RADIUS_MM = 1e9


class GeometryReader:
    """Reads geometry in one context of units, placed by one frame.

    Parameters
    ----------
    step : StepFile
    length_mm : float
        The context's unit of length in mm.
    angle_rad : float
        The context's unit of plane angle in rad.
    placement : Frame
        Where the coordinates of the file lie in the workpiece frame.
    """

    def __init__(
        self, step: StepFile, length_mm: float, angle_rad: float, placement: Frame
    ) -> None:
        self._step, self._length_mm, self._angle_rad = step, length_mm, angle_rad
        self._placement = placement
        self._curves: dict[int, Curve] = {}
        self._surfaces: dict[int, Surface] = {}

    def point(self, reference: int) -> np.ndarray:
        """A CARTESIAN_POINT or VERTEX_POINT, (3,) mm."""
        return self.points([reference])[0]

    def points(self, references: list[int]) -> np.ndarray:
        """CARTESIAN_POINTs or VERTEX_POINTs, (N, 3) mm."""
        triples = [self._coordinates(reference) for reference in references]
        return self._placement.world(self._length_mm * np.array(triples).reshape(-1, 3))

    def _coordinates(self, reference: int) -> list[float]:
        entity = self._step.entity(reference)
        if entity.is_a("VERTEX_POINT"):
            return self._coordinates(entity.arguments[1])
        return self._triple(entity, "CARTESIAN_POINT")

    def frame(self, reference: int) -> Frame:
        """An AXIS2_PLACEMENT_3D or AXIS1_PLACEMENT."""
        entity = self._step.entity(reference)
        if entity.kind not in ("AXIS2_PLACEMENT_3D", "AXIS1_PLACEMENT"):
            raise self._step.error(entity, "not a placement", "AXIS2_PLACEMENT_3D")
        origin, axis, *other = entity.arguments[1:]
        z = self._placement.axes[2] if axis is None else self._direction(axis)
        x = self._direction(other[0]) if other and other[0] is not None else None
        if x is None and axis is None:
            x = self._placement.axes[0]
        return Frame.from_axis(self.point(origin), z, x)

    def curve(self, reference: int) -> Curve:
        """Any supported curve in space."""
        if reference not in self._curves:
            entity = self._step.entity(reference)
            self._curves[reference] = self._read(entity, _CURVES, "curve")
        return self._curves[reference]

    def surface(self, reference: int) -> Surface:
        """Any supported surface."""
        if reference not in self._surfaces:
            entity = self._step.entity(reference)
            self._surfaces[reference] = self._read(entity, _SURFACES, "surface")
        return self._surfaces[reference]

    def _read(self, entity: StepEntity, readers: dict, what: str):
        for name, reader in readers.items():
            if entity.is_a(name):
                try:
                    return reader(self, entity)
                except (TypeError, ValueError, IndexError, KeyError) as error:
                    if isinstance(error, InputError):
                        raise
                    raise self._step.error(entity, f"damaged {what} ({error})") from None
        raise self._step.error(entity, f"this kind of {what} is not supported", ", ".join(readers))

    def _triple(self, entity: StepEntity, kind: str) -> list[float]:
        values = entity.arguments[1] if entity.is_a(kind) and len(entity.arguments) > 1 else ()
        try:
            triple = [v if type(v) is float else _number(v) for v in values]
        except (TypeError, ValueError):
            triple = []
        if len(triple) != 3 or not all(map(math.isfinite, triple)):
            raise self._step.error(entity, "coordinates", f"a {kind} with three numbers")
        return triple

    def _direction(self, reference: int) -> np.ndarray:
        entity = self._step.entity(reference)
        vector = np.array(self._triple(entity, "DIRECTION"))
        length = math.sqrt(vector @ vector)
        if length == 0.0:
            raise self._step.error(entity, "a direction of no length")
        return self._placement.direction(vector / length)

    def _length(self, value: float) -> float:
        length = self._length_mm * _number(value)
        if not 0.0 < length <= LARGEST_RADIUS_MM:
            raise ValueError(f"a length of {length:g} mm")
        return length

    # --- curves -------------------------------------------------------------------------------

    def _line(self, entity: StepEntity) -> Line:
        vector = self._step.entity(entity.arguments[2])
        return Line(self.point(entity.arguments[1]), self._direction(vector.arguments[1]))

    def _circle(self, entity: StepEntity) -> Ellipse:
        _, frame, radius = entity.arguments
        return Ellipse(self.frame(frame), self._length(radius), self._length(radius))

    def _conic(self, entity: StepEntity) -> Ellipse | Hyperbola:
        _, frame, a, b = entity.arguments
        make = Ellipse if entity.is_a("ELLIPSE") else Hyperbola
        return make(self.frame(frame), self._length(a), self._length(b))

    def _parabola(self, entity: StepEntity) -> Parabola:
        _, frame, focal = entity.arguments
        return Parabola(self.frame(frame), self._length(focal))

    def _polyline(self, entity: StepEntity) -> BSplineCurve:
        points = self.points(entity.arguments[1])
        if len(points) < 2:
            raise ValueError(f"{len(points)} points")
        knots = np.r_[0, np.arange(len(points)), len(points) - 1].astype(np.float64)
        return BSplineCurve(points, np.ones(len(points)), knots, 1)

    def _wrapped_curve(self, entity: StepEntity) -> Curve:
        # the ends and the sense of a trimmed curve are those of the edge that lies on it
        return self.curve(entity.arguments[1])

    def _spline_curve(self, entity: StepEntity) -> BSplineCurve:
        form, named = _spline_arguments(entity, "B_SPLINE_CURVE", 5)
        degree, control = form[0], self.points(form[1])
        knots = _knots(entity, [degree], [len(control)], named)
        weights = np.ones(len(control))
        if entity.is_a("RATIONAL_B_SPLINE_CURVE"):
            weights = _numbers(entity.parts["RATIONAL_B_SPLINE_CURVE"][0])
        return BSplineCurve(control, _checked(weights, len(control)), knots[0], degree)

    # --- surfaces -----------------------------------------------------------------------------

    def _plane(self, entity: StepEntity) -> Plane:
        return Plane(self.frame(entity.arguments[1]))

    def _round(self, entity: StepEntity) -> Cylinder | Sphere:
        _, frame, radius = entity.arguments
        make = Cylinder if entity.is_a("CYLINDRICAL_SURFACE") else Sphere
        return make(self.frame(frame), self._length(radius))

    def _cone(self, entity: StepEntity) -> Cone:
        _, frame, radius, angle = entity.arguments
        half_angle = self._angle_rad * _number(angle)
        if not 0.0 < abs(half_angle) < np.pi / 2.0:
            raise ValueError(f"a semi-angle of {angle}")
        return Cone(self.frame(frame), self._length_mm * _number(radius), half_angle)

    def _torus(self, entity: StepEntity) -> Torus:
        major, minor = entity.arguments[2:4]
        return Torus(self.frame(entity.arguments[1]), self._length(major), self._length(minor))

    def _extrusion(self, entity: StepEntity) -> Extrusion:
        _, curve, vector = entity.arguments
        direction = self._direction(self._step.entity(vector).arguments[1])
        return Extrusion(self.curve(curve), direction)

    def _revolution(self, entity: StepEntity) -> Revolution:
        _, curve, axis = entity.arguments
        return Revolution(self.curve(curve), self.frame(axis))

    def _offset(self, entity: StepEntity) -> Offset:
        _, basis, distance, *_ = entity.arguments
        return Offset(self.surface(basis), self._length_mm * _number(distance))

    def _wrapped_surface(self, entity: StepEntity) -> Surface:
        return self.surface(entity.arguments[1])

    def _spline_surface(self, entity: StepEntity) -> BSplineSurface:
        form, named = _spline_arguments(entity, "B_SPLINE_SURFACE", 7)
        degrees, rows = form[:2], form[2]
        if len({len(row) for row in rows}) != 1:
            raise ValueError("rows of control points that are not equally long")
        control = np.array([self.points(row) for row in rows])
        knots = _knots(entity, degrees, control.shape[:2], named)
        weights = np.ones(control.shape[:2])
        if entity.is_a("RATIONAL_B_SPLINE_SURFACE"):
            given = [_checked(_numbers(row), control.shape[1])
                     for row in entity.parts["RATIONAL_B_SPLINE_SURFACE"][0]]  # fmt: skip
            weights = np.array(given).reshape(control.shape[:2])
        return BSplineSurface(control, weights, tuple(knots), tuple(degrees))


def _number(value: float) -> float:
    """A number of a file; a reference to an entity, which is an integer too, is none."""
    if isinstance(value, Reference):
        raise ValueError(f"a reference, #{value}, in the place of a number")
    return float(value)


def _numbers(values: Sequence[float]) -> np.ndarray:
    return np.array([_number(value) for value in values], dtype=np.float64)


def _spline_arguments(entity: StepEntity, base: str, count: int) -> tuple[list, list]:
    """Arguments of the base type, and of the subtype that says the knots.

    A complex instance holds both apart; a simple one has a name and all of them in a row.
    """
    if len(entity.parts) > 1:
        return entity.parts[base], entity.parts.get(f"{base}_WITH_KNOTS", [])
    return entity.arguments[1 : count + 1], entity.arguments[count + 1 :]


def _knots(
    entity: StepEntity, degrees: list[int], counts: list[int], named: list
) -> list[np.ndarray]:
    """Knots repeated by their multiplicity, one array for each direction."""
    directions, found = len(degrees), []
    for axis, (degree, count) in enumerate(zip(degrees, counts, strict=True)):
        if type(degree) is not int or degree < 1:
            raise ValueError(f"degree {degree}")
        if count <= degree:
            raise ValueError(f"{count} control points of degree {degree}")
        if named:
            t = _repeated(named[directions + axis], named[axis], count + degree + 1)
        else:
            t = _implied_knots(entity, degree, count)
        if not np.isfinite(t).all() or (np.diff(t) < 0.0).any() or t[degree] == t[-degree - 1]:
            raise ValueError(f"knots from {t[0]:g} to {t[-1]:g}, which do not increase")
        found.append(t)
    return found


def _repeated(knots: list, times: list, count: int) -> np.ndarray:
    """Knots, each as often as its multiplicity says, if they are as many as are needed."""
    if len(times) != len(knots) or not all(type(n) is int and n >= 0 for n in times):
        raise ValueError(f"multiplicities that are not {len(knots)} whole numbers")
    if sum(times) != count:
        raise ValueError(f"{sum(times)} knots in place of {count}")
    return np.repeat(_numbers(knots), times)


def _implied_knots(entity: StepEntity, degree: int, count: int) -> np.ndarray:
    """Knots of the subtypes that do not list them."""
    if any(name.startswith("BEZIER") for name in entity.parts):
        inner = np.repeat(np.arange(1, (count - 1) // degree), degree)
        return np.r_[[0] * (degree + 1), inner, [(count - 1) // degree] * (degree + 1)] * 1.0
    if any(name.startswith("QUASI_UNIFORM") for name in entity.parts):
        spans = count - degree
        return np.r_[[0] * degree, np.arange(spans + 1), [spans] * degree] * 1.0
    return np.arange(-degree, count + 1.0)


def _checked(weights: np.ndarray, count: int) -> np.ndarray:
    """Weights, if they are as many as the control points and positive."""
    if len(weights) != count:
        raise ValueError(f"{len(weights)} weights for {count} control points")
    if not (np.isfinite(weights) & (weights > 0.0)).all():
        raise ValueError(f"weights from {weights.min():g} on, which are not all positive")
    return weights


_CURVES = {
    "LINE": GeometryReader._line,
    "CIRCLE": GeometryReader._circle,
    "ELLIPSE": GeometryReader._conic,
    "HYPERBOLA": GeometryReader._conic,
    "PARABOLA": GeometryReader._parabola,
    "POLYLINE": GeometryReader._polyline,
    "TRIMMED_CURVE": GeometryReader._wrapped_curve,
    "SURFACE_CURVE": GeometryReader._wrapped_curve,
    "SEAM_CURVE": GeometryReader._wrapped_curve,
    "INTERSECTION_CURVE": GeometryReader._wrapped_curve,
    "B_SPLINE_CURVE": GeometryReader._spline_curve,
    "B_SPLINE_CURVE_WITH_KNOTS": GeometryReader._spline_curve,
    "BEZIER_CURVE": GeometryReader._spline_curve,
    "UNIFORM_CURVE": GeometryReader._spline_curve,
    "QUASI_UNIFORM_CURVE": GeometryReader._spline_curve,
}

_SURFACES = {
    "PLANE": GeometryReader._plane,
    "CYLINDRICAL_SURFACE": GeometryReader._round,
    "CONICAL_SURFACE": GeometryReader._cone,
    "SPHERICAL_SURFACE": GeometryReader._round,
    "TOROIDAL_SURFACE": GeometryReader._torus,
    "DEGENERATE_TOROIDAL_SURFACE": GeometryReader._torus,
    "SURFACE_OF_LINEAR_EXTRUSION": GeometryReader._extrusion,
    "SURFACE_OF_REVOLUTION": GeometryReader._revolution,
    "OFFSET_SURFACE": GeometryReader._offset,
    "RECTANGULAR_TRIMMED_SURFACE": GeometryReader._wrapped_surface,
    "B_SPLINE_SURFACE": GeometryReader._spline_surface,
    "B_SPLINE_SURFACE_WITH_KNOTS": GeometryReader._spline_surface,
    "BEZIER_SURFACE": GeometryReader._spline_surface,
    "UNIFORM_SURFACE": GeometryReader._spline_surface,
    "QUASI_UNIFORM_SURFACE": GeometryReader._spline_surface,
}
