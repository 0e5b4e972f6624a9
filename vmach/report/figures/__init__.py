"""Figures of a run: statistics, tables, CSV."""
