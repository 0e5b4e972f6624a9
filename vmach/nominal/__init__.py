"""Nominal CAD: exact surfaces from STEP, facets from STL, and points sampled on them."""

from vmach.nominal.part import Face, Mesh, NominalPart
from vmach.nominal.reading import read_nominal

__all__ = ["Face", "Mesh", "NominalPart", "read_nominal"]
