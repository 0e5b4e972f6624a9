"""Fitting effects to measurements: uncertainty, evidence, joint fits."""
