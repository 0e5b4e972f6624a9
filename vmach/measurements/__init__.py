"""Measurements of parts and machines, each with what its instrument leaves free."""

from vmach.measurements.instrument import Curves, Instrument, ModelOfTest, PlannedTest
from vmach.measurements.measurement import Contacts, Measurement
from vmach.measurements.neighbours import (
    MEDIAN_OF_NORMAL,
    apart_from_few,
    apart_from_neighbours,
)

__all__ = [
    "MEDIAN_OF_NORMAL",
    "Contacts",
    "Curves",
    "Instrument",
    "Measurement",
    "ModelOfTest",
    "PlannedTest",
    "apart_from_few",
    "apart_from_neighbours",
]
