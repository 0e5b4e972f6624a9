"""Measurements of parts and machines, each with what its instrument leaves free."""

from vmach.measurements.instruments import read_instruments
from vmach.measurements.measurement import Measurement
from vmach.measurements.neighbours import apart_from_neighbours
from vmach.measurements.part import measure_part

__all__ = [
    "Measurement",
    "apart_from_neighbours",
    "measure_part",
    "read_instruments",
]
