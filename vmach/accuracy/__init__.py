"""Volumetric accuracy of a machine: what its errors can do between any two points."""

from vmach.accuracy.comparison import Comparison, compare_variants
from vmach.accuracy.diagonals import Diagonal, diagonals
from vmach.accuracy.farthest_pair import farthest_pair
from vmach.accuracy.field import ErrorField, Volume, error_field, measured_volume
from vmach.accuracy.grouping import Grouping, group_vectors
from vmach.accuracy.volumetric import (
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
