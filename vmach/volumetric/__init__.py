"""Volumetric accuracy of a machine: what its errors can do between any two points."""

from vmach.volumetric.comparison import Comparison, compare_variants
from vmach.volumetric.diagonals import Diagonal, diagonals
from vmach.volumetric.farthest_pair import farthest_pair
from vmach.volumetric.field import ErrorField, Volume, error_field, measured_volume
from vmach.volumetric.grouping import Grouping, group_vectors
from vmach.volumetric.volumetric import (
    Contribution,
    VolumetricAccuracy,
    assess,
    contributions_between,
)

__all__ = [
    "Comparison",
    "Contribution",
    "Diagonal",
    "ErrorField",
    "Grouping",
    "Volume",
    "VolumetricAccuracy",
    "assess",
    "compare_variants",
    "contributions_between",
    "diagonals",
    "error_field",
    "farthest_pair",
    "group_vectors",
    "measured_volume",
]
