"""Cycles of SINUMERIK."""
