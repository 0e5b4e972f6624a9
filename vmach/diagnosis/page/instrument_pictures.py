"""Readings of instruments the way each is usually drawn: measured, predicted before and after."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from vmach.base.units import um_from_mm
from vmach.diagnosis.residuals import Residuals
from vmach.measurements import Curves

__all__ = ["InstrumentPicture", "instrument_pictures"]


@dataclass(frozen=True)
class InstrumentPicture:
    """Diagrams of one measurement, each with a title."""

    title: str
    note: str
    plots: tuple[tuple[str, Markup], ...]
    abreast: int


def instrument_pictures(residuals: Residuals) -> list[InstrumentPicture]:
    """A picture for every measurement whose instrument draws one.

    Of each curve the zero, centre or pose that the instrument leaves free is taken off.
    """
    found = []
    for curves in _curves(residuals):
        measurement, instrument = curves.measurement, curves.measurement.instrument
        if plots := tuple(instrument.plots(curves)):
            title = f"{instrument.title}: {measurement.name}"
            found.append(InstrumentPicture(title, _note(curves), plots, instrument.abreast))
    return found


def _curves(residuals: Residuals) -> Iterator[Curves]:
    survey = residuals.survey
    measured = residuals.aligned(np.concatenate([m.measured_mm for m in survey.measurements]))
    for measurement, path, own in zip(survey.measurements, survey.paths, survey.rows, strict=True):
        predicted = {
            state: um_from_mm(measured[own] - residuals.of(state)[own])
            for state in residuals.states
        }
        open_law = um_from_mm(residuals.open_mm[own])
        yield Curves(measurement, path, um_from_mm(measured[own]), predicted, open_law)


def _note(curves: Curves) -> str:
    """What is taken off each curve, and what a band is."""
    instrument = curves.measurement.instrument
    fitted = f"{instrument.left_free_by(curves.measurement)} of each curve fitted"
    has_band = instrument.shows_law_band and curves.open_law.max() > 0.0
    return f"{fitted}; band: 95 % of what the effects' laws leave open" if has_band else fitted
