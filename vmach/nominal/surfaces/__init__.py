"""The surfaces that faces lie on, after ISO 10303-42."""

from vmach.nominal.surfaces.elementary import (
    Cone,
    Cylinder,
    Extrusion,
    Offset,
    Plane,
    Revolution,
    Sphere,
    Surface,
    Torus,
    unit_normals,
)

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
