"""Compensation tables for controls: written, read back, and applied as the control would."""

from vmach.controller_tables.make_tables import MadeTables, make_tables
from vmach.controller_tables.table_formats import FORMATS

__all__ = ["FORMATS", "MadeTables", "make_tables"]
