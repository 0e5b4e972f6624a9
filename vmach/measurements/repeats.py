"""Readings that were taken several times at the same place: their mean counts.

What a place has of its own, such as the form of the surface there, all of its readings share. They
are no independent evidence of what the machine did.

Source: JCGM 100:2008 (GUM), 4.2.3, mean and experimental variance of repeated observations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.base.alike_rows import alike_rows
from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.measurements.measurement import Measurement

__all__ = ["check_degrees", "clampings_differ", "mean_of_repeats"]

#: readings of one place that differ by so many times u_um are of several parts or clampings; as
#: far as stated uncertainties are taken to be right
_DOUBTFUL = 2.0
#: fewer readings of places that were read before say little of their scatter: of 20 it is
#: uncertain by a third (GUM, table E.1)
_FEWEST = 20
_SEVERAL = "each part of a batch needs a job of its own"


def mean_of_repeats(measurement: Measurement, alike: Sequence[np.ndarray]) -> Measurement:
    """One reading for each place; as given where none was measured twice.

    A mean keeps the uncertainty of a reading: its repeatability becomes less, what the place has of
    its own does not. How much it is in all, what the readings leave unexplained tells.

    Parameters
    ----------
    measurement : Measurement
        P readings.
    alike : sequence of (P, ...) array
        What readings of one place have in common; clampings do not mix.
    """
    clamping = [] if measurement.clamping is None else [measurement.clamping]
    first, of = alike_rows([*alike, *clamping])
    if len(first) == len(of):
        return measurement
    times = np.bincount(of)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(of, values) / times

    read = mean(measurement.measured_mm)
    scatter = np.sum((measurement.measured_mm - read[of]) ** 2) / (len(of) - len(first))
    said = (
        f"{np.count_nonzero(times > 1)} places were measured up to {times.max()} times, their "
        f"means count; readings repeat to {um_from_mm(np.sqrt(scatter)):.2g} um"
    )
    u_mm = float(np.median(measurement.u_mm))
    if is_doubtful := bool(np.sqrt(scatter) > _DOUBTFUL * u_mm):
        said += f" where u_um says {um_from_mm(u_mm):.2g} um: are these several parts, or "
        said += f"clampings? A column clamping tells clampings apart; {_SEVERAL}"
    note = (Note.question if is_doubtful else Note.plain)(
        Kind.REPEAT, said, int(times.max()), "1", file=measurement.name
    )
    told = tuple(note for note in measurement.notes if note.kind is not Kind.REPEAT)
    at = None if measurement.measured_at is None else mean(measurement.measured_at)
    one = replace(measurement, notes=told).keep(first, note)
    found = replace(one, measured_mm=read, measured_at=at)
    return found if at is None else found.keep(np.argsort(at, kind="stable"))


def clampings_differ(
    measurement: Measurement, alike: Sequence[np.ndarray], residual_mm: np.ndarray
) -> tuple[Note, ...]:
    """A question where one clamping shows another part than the next.

    Parameters
    ----------
    measurement : Measurement
        P readings.
    alike : sequence of (P, ...) array
        What readings of one place have in common.
    residual_mm : (P,) float64
        Readings without the pose of the part in each clamping.
    """
    first, of = alike_rows([*alike])
    again = len(of) - len(first)
    if measurement.clamping is None or again < _FEWEST:
        return ()
    mean = np.bincount(of, residual_mm) / np.bincount(of)
    scatter = float(np.sqrt(np.sum((residual_mm - mean[of]) ** 2) / again))
    u_mm = float(np.median(measurement.u_mm))
    if scatter <= _DOUBTFUL * u_mm:
        return ()
    said = (
        f"readings of one place differ by {um_from_mm(scatter):.2g} um from clamping to clamping, "
        f"the pose of each taken off, where u_um says {um_from_mm(u_mm):.2g} um: are these several "
        f"parts? {_SEVERAL[0].upper()}{_SEVERAL[1:]}"
    )
    size_um = float(um_from_mm(scatter))
    return (Note.question(Kind.REPEAT, said, size_um, "um", file=measurement.name),)


def check_degrees(measurement: Measurement, path: Path) -> None:
    """Refuse readings of so few places that what is left free takes up all of them.

    Raises
    ------
    InputError
        With how many places there are.
    """
    if measurement.degrees > 0:
        return
    raise InputError(
        f"{len(measurement)} readings of different places: the "
        f"{measurement.instrument.left_free} takes up all of them",
        file=path,
        accepted="more places; readings of the same place count once",
    )
