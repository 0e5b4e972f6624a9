"""The surfaces that faces lie on, after ISO 10303-42.

Parameters are arrays (N, 2) of u and v, points (N, 3) mm. The surface's own normal is
dS/du x dS/dv. Angles are measured about the z axis of the surface's frame. `parameters` is the
inverse for points on the surface; where u is not defined (pole, apex) it is NaN.

Source: ISO 10303-42.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from vmach.nominal.frame import Frame
from vmach.nominal.surfaces.curves import Curve

__all__ = [
    "Cone",
    "Cylinder",
    "Extrusion",
    "Offset",
    "Plane",
    "Revolution",
    "Sphere",
    "Surface",
    "Torus",
    "unit_normals",
]

_TURN = 2.0 * np.pi
_ENDLESS = (-np.inf, np.inf)

#: nearer than this to an axis the angle about it is not defined
_AXIS_MM = 1e-7


class Surface(Protocol):
    """What every surface can do; `v_limits` are where the surface itself ends, as at a pole."""

    kind: str
    label: str
    u_period: float
    v_period: float
    v_limits: tuple[float, float]
    #: which of u and v the lengths of dS/du and of dS/dv depend on: ("v", "") of a cone
    varies: tuple[str, str]

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points, (N, 3) mm."""
        ...

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv, (N, 3) each."""
        ...

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points on the surface, (N, 2)."""
        ...


def unit_normals(
    surface: Surface, uv: np.ndarray, slopes: tuple[np.ndarray, np.ndarray] | None = None
) -> np.ndarray:
    """The surface's own unit normals dS/du x dS/dv, (N, 3), from the two where they are known."""
    if isinstance(surface, Offset):  # parallel surfaces share their normals
        return unit_normals(surface.basis, uv)
    # three times faster than NumPy's
    (ax, ay, az), (bx, by, bz) = (slope.T for slope in slopes or surface.derivatives(uv))
    normal = np.column_stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    return normal / np.sqrt(np.einsum("ij,ij->i", normal, normal))[:, None]


def _angle(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.where(np.hypot(x, y) < _AXIS_MM, np.nan, np.arctan2(y, x))


@dataclass(frozen=True)
class Plane:
    """u x + v y."""

    frame: Frame
    kind = label = "plane"
    u_period = v_period = 0.0
    v_limits = _ENDLESS
    varies = ("", "")

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        return self.frame.origin + uv @ self.frame.axes[:2]

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv at parameters (N, 2); (N, 3) each."""
        shape = (len(uv), 3)
        return tuple(np.broadcast_to(axis, shape) for axis in self.frame.axes[:2])

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        return self.frame.local(points)[:, :2]


@dataclass(frozen=True)
class _AboutAxis:
    """Surfaces with the angle u about z: radius and height are functions of v alone."""

    frame: Frame
    u_period = _TURN
    varies = ("v", "")

    def _profile(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Radius and height at v."""
        raise NotImplementedError

    def _profile_slope(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """d radius/dv and d height/dv."""
        raise NotImplementedError

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        u, v = uv.T
        radius, height = self._profile(v)
        return self.frame.world(np.column_stack([radius * np.cos(u), radius * np.sin(u), height]))

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv at parameters (N, 2); (N, 3) each."""
        u, v = uv.T
        cos, sin = np.cos(u), np.sin(u)
        radius, _ = self._profile(v)
        outward, upward = self._profile_slope(v)
        along_u = np.column_stack([-radius * sin, radius * cos, np.zeros_like(u)])
        along_v = np.column_stack([outward * cos, outward * sin, upward])
        return self.frame.direction(along_u), self.frame.direction(along_v)


@dataclass(frozen=True)
class Cylinder(_AboutAxis):
    """v is the height."""

    radius_mm: float
    kind = "cylinder"
    varies = ("", "")
    v_period = 0.0
    v_limits = _ENDLESS

    @property
    def label(self) -> str:
        return f"cylinder R{self.radius_mm:.6g}"

    def _profile(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.full_like(v, self.radius_mm), v

    def _profile_slope(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.zeros_like(v), np.ones_like(v)

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        x, y, z = self.frame.local(points).T
        return np.column_stack([_angle(x, y), z])


@dataclass(frozen=True)
class Cone(_AboutAxis):
    """v is the height; the radius there is `radius_mm` + v tan(half_angle)."""

    radius_mm: float
    half_angle_rad: float
    kind = "cone"
    v_period = 0.0

    @property
    def label(self) -> str:
        return f"cone {2.0 * np.degrees(self.half_angle_rad):.6g} deg"

    @property
    def v_limits(self) -> tuple[float, float]:
        apex = -self.radius_mm / np.tan(self.half_angle_rad)
        return (apex, np.inf) if self.half_angle_rad > 0.0 else (-np.inf, apex)

    def _profile(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.radius_mm + v * np.tan(self.half_angle_rad), v

    def _profile_slope(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.full_like(v, np.tan(self.half_angle_rad)), np.ones_like(v)

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        x, y, z = self.frame.local(points).T
        return np.column_stack([_angle(x, y), z])

    def on_the_side_of(self, points: np.ndarray) -> Cone:
        """The cone that opens from its apex towards points (N, 3) mm (edges of a face).

        A conical surface has a second half, of negative radius, beyond its apex. The normals
        dS/du x dS/dv stay as they are.
        """
        slope = np.tan(self.half_angle_rad)
        if (
            not len(points)
            or (self.radius_mm + self.frame.local(points)[:, 2] * slope).max() > _AXIS_MM
        ):
            return self
        apex = self.frame.world(np.array([[0.0, 0.0, -self.radius_mm / slope]]))[0]
        turned = Frame.from_axis(apex, -self.frame.axes[2], self.frame.axes[0])
        return Cone(turned, 0.0, self.half_angle_rad)


@dataclass(frozen=True)
class Sphere(_AboutAxis):
    """v is the latitude."""

    radius_mm: float
    kind = "sphere"
    v_period = 0.0
    v_limits = (-np.pi / 2.0, np.pi / 2.0)

    @property
    def label(self) -> str:
        return f"sphere R{self.radius_mm:.6g}"

    def _profile(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.radius_mm * np.cos(v), self.radius_mm * np.sin(v)

    def _profile_slope(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return -self.radius_mm * np.sin(v), self.radius_mm * np.cos(v)

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        x, y, z = self.frame.local(points).T
        return np.column_stack([_angle(x, y), np.arctan2(z, np.hypot(x, y))])

    def away_from(self, points: np.ndarray) -> Sphere:
        """The same sphere, poles turned away from points (N, 3) mm (edges of a face)."""
        if not len(points):
            return self
        seen = self.frame.local(points) / self.radius_mm
        steps = np.arange(200)
        z = 1.0 - (steps + 0.5) / len(steps)  # half a sphere of directions, on a golden spiral
        turn = steps * np.pi * (3.0 - np.sqrt(5.0))
        ring = np.sqrt(1.0 - z**2)
        axes = np.column_stack([ring * np.cos(turn), ring * np.sin(turn), z])
        axis = axes[np.argmin(np.abs(axes @ seen.T).max(axis=1))]
        turned = Frame.from_axis(self.frame.origin, self.frame.direction(axis), None)
        return Sphere(turned, self.radius_mm)


@dataclass(frozen=True)
class Torus(_AboutAxis):
    """v is the angle around the tube of radius `minor_mm`.

    A tube wider than its way round crosses the axis. What lies beyond, such as a crowned roller,
    has a negative radius there.
    """

    major_mm: float
    minor_mm: float
    kind = "torus"
    v_period = _TURN
    v_limits = _ENDLESS

    @property
    def label(self) -> str:
        return f"torus R{self.major_mm:.6g} r{self.minor_mm:.6g}"

    def _profile(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.major_mm + self.minor_mm * np.cos(v), self.minor_mm * np.sin(v)

    def _profile_slope(self, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return -self.minor_mm * np.sin(v), self.minor_mm * np.cos(v)

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        x, y, z = self.frame.local(points).T
        radius = np.hypot(x, y)
        if self.major_mm < self.minor_mm:
            off = [
                np.abs(np.hypot(r - self.major_mm, z) - self.minor_mm) for r in (radius, -radius)
            ]
            side = np.where(off[1] < off[0], -1.0, 1.0)
            x, y, radius = side * x, side * y, side * radius
        return np.column_stack([_angle(x, y), np.arctan2(z, radius - self.major_mm)])


@dataclass(frozen=True)
class Extrusion:
    """A curve (u) moved along a unit vector (v)."""

    curve: Curve
    direction: np.ndarray
    kind = label = "extrusion"
    v_period = 0.0
    v_limits = _ENDLESS
    varies = ("u", "")

    @property
    def u_period(self) -> float:
        return self.curve.period

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        return self.curve.evaluate(uv[:, 0]) + uv[:, 1:] * self.direction

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv at parameters (N, 2); (N, 3) each."""
        return self.curve.derivative(uv[:, 0]), np.broadcast_to(self.direction, (len(uv), 3))

    def parameters(self, points: np.ndarray) -> np.ndarray:
        # alternate between the nearest point of the curve and the height above it
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        height = np.zeros(len(points))
        for _ in range(50):
            u = self.curve.parameter(points - height[:, None] * self.direction)
            step = (points - self.curve.evaluate(u)) @ self.direction - height
            height = height + step
            if np.abs(step).max(initial=0.0) < 1e-12:
                break
        return np.column_stack([u, height])


@dataclass(frozen=True)
class Revolution:
    """A curve (v) turned about the z axis of a frame by the angle u."""

    curve: Curve
    frame: Frame
    kind = label = "revolution"
    u_period = _TURN
    v_limits = _ENDLESS
    varies = ("v", "v")

    @property
    def v_period(self) -> float:
        return self.curve.period

    def _turned(self, local: np.ndarray, u: np.ndarray) -> np.ndarray:
        x, y, z = local.T
        cos, sin = np.cos(u), np.sin(u)
        return np.column_stack([cos * x - sin * y, sin * x + cos * y, z])

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        local = self.frame.local(self.curve.evaluate(uv[:, 1]))
        return self.frame.world(self._turned(local, uv[:, 0]))

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv at parameters (N, 2); (N, 3) each."""
        u, v = uv.T
        x, y, z = self._turned(self.frame.local(self.curve.evaluate(v)), u).T
        slope = self.curve.derivative(v) @ self.frame.axes.T
        along_u = np.column_stack([-y, x, np.zeros_like(z)])
        return self.frame.direction(along_u), self.frame.direction(self._turned(slope, u))

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        local = self.frame.local(points)
        u = np.zeros(len(points))
        for _ in range(50):
            v = self.curve.parameter(self.frame.world(self._turned(local, -u)))
            on_curve = self.frame.local(self.curve.evaluate(v))
            angle = _angle(*local.T[:2]) - _angle(*on_curve.T[:2])
            step = np.angle(np.exp(1j * (np.nan_to_num(angle) - u)))
            u = u + step
            if np.abs(step).max(initial=0.0) < 1e-12:
                break
        return np.column_stack([np.where(np.isnan(angle), np.nan, u), v])


@dataclass(frozen=True)
class Offset:
    """Another surface moved by a distance along its own normal."""

    basis: Surface
    distance_mm: float
    kind = "offset"
    v_limits = _ENDLESS
    varies = ("uv", "uv")

    @property
    def label(self) -> str:
        return f"offset of {self.basis.label}"

    @property
    def u_period(self) -> float:
        return self.basis.u_period

    @property
    def v_period(self) -> float:
        return self.basis.v_period

    def evaluate(self, uv: np.ndarray) -> np.ndarray:
        """Points at parameters (N, 2); (N, 3) mm."""
        return self.basis.evaluate(uv) + self.distance_mm * unit_normals(self.basis, uv)

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv, (N, 3) each, by central differences, good enough for lengths."""
        step = 1e-5 * np.maximum(np.ptp(uv, axis=0), 1e-3)
        across = [np.array([step[0], 0.0]), np.array([0.0, step[1]])]
        return tuple(
            (self.evaluate(uv + h) - self.evaluate(uv - h)) / (2.0 * np.linalg.norm(h))
            for h in across
        )

    def parameters(self, points: np.ndarray) -> np.ndarray:
        """u and v of points (N, 3) mm on the surface; (N, 2)."""
        return self.basis.parameters(points)
