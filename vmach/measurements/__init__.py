"""Measurements of parts and machines, each with what its instrument leaves free."""

from vmach.measurements.instruments import read_instruments
from vmach.measurements.measurement import Measurement, apart_from_neighbours, group_offsets
from vmach.measurements.part import measure_part

__all__ = [
    "Measurement",
    "apart_from_neighbours",
    "group_offsets",
    "measure_part",
    "read_instruments",
]
