"""Nominal CAD: exact surfaces from STEP, facets from STL, and points sampled on them."""

from vmach.nominal.part import Face, Mesh, NominalPart
from vmach.nominal.reading import LENGTH_UNITS_MM, read_nominal

__all__ = ["LENGTH_UNITS_MM", "Face", "Mesh", "NominalPart", "read_nominal"]
