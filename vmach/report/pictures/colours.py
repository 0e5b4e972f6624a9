"""Deviations to colours, and the ends of their scale."""

from __future__ import annotations

import math

import numpy as np

from vmach.base.colour_ramp import COLOUR_STOPS, UNKNOWN_COLOUR

__all__ = ["colour_range", "colours_of", "nice_ceiling"]

_LEAST_RANGE_MM = 1e-6  #: end of the scale where nothing deviates


def _rgb(colour: str) -> list[int]:
    return [int(colour[i : i + 2], 16) for i in (1, 3, 5)]


def colours_of(value_mm: np.ndarray, known: np.ndarray, range_mm: float) -> np.ndarray:
    """(V, 3) float64 sRGB, 0 to 1, of (V,) deviations on a scale from -range to +range."""
    stops = np.array([_rgb(colour) for colour in COLOUR_STOPS]) / 255
    at = np.linspace(-range_mm, range_mm, len(stops))
    colours = np.stack([np.interp(value_mm, at, channel) for channel in stops.T], axis=1)
    colours[~known] = np.array(_rgb(UNKNOWN_COLOUR)) / 255
    return colours


def nice_ceiling(value: float) -> float:
    """Return the smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten not below `value`."""
    decade = 10.0 ** math.floor(math.log10(value))
    steps = (1, 1.5, 2, 3, 4, 5, 6, 8, 10)
    return next(step * decade for step in steps if step * decade >= value * (1 - 1e-9))


def colour_range(values_mm: list[np.ndarray]) -> float:
    """Return the end of a common colour scale: 99 % of all values, (P,) mm each, are within.

    A few gross points must not wash out the rest; they keep the colour of the end.
    """
    quantiles = [np.quantile(np.abs(values), 0.99) for values in values_mm if values.size]
    return nice_ceiling(max([_LEAST_RANGE_MM, *quantiles]))
