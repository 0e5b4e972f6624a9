"""The instruments, one class a file: settings, columns, reading, meaning, picture, planned test."""

from vmach.instruments.catalogue import catalogue, planned_tests
from vmach.instruments.kinds.part_points import measure_part
from vmach.instruments.reading import read_instruments, settings_of
from vmach.measurements.instrument import Curves, Instrument, ModelOfTest, PlannedTest

__all__ = [
    "Curves",
    "Instrument",
    "ModelOfTest",
    "PlannedTest",
    "catalogue",
    "measure_part",
    "planned_tests",
    "read_instruments",
    "settings_of",
]
