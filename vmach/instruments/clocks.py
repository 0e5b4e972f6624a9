"""Tests whose files state no times, read by a clock that is assumed.

Source: ISO 230-2, whose tables hold neither times nor which side a run began from.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.base.note import Kind, Note, in_file
from vmach.base.units import mm_per_s_from_mm_per_min
from vmach.measurements import Measurement
from vmach.measurements.clock import FORWARD, AssumedClock, Clock
from vmach.measurements.columns import Columns
from vmach.measurements.instrument import Instrument, ModelOfTest

__all__ = ["read_by_clock"]


def read_by_clock(settings: Instrument, table: Columns, model: ModelOfTest) -> Measurement:
    """The readings of a file; by an assumed clock where times are asked for and not stated."""
    if "t_s" in table.numbers or "t_s" not in settings.optional_columns:
        return settings.read(table, model)

    def read(clock: Clock) -> Measurement:
        timed = _timed(_in_order(table, clock), clock, settings, model)
        test = settings.read(timed, model).noted(*in_file((_note(timed, clock),), table.path))
        return replace(test, assumed=AssumedClock(clock, table.order_is_stated, read))

    return read(Clock())


def _in_order(table: Columns, clock: Clock) -> Columns:
    """Rows in the order of a clock; as they stand where that is the order of time."""
    if table.order_is_stated or clock.first == FORWARD:
        return table
    runs = np.unique(table.text["run"], return_index=True, return_inverse=True)
    # within a run from one side the rows are in the order of the travel
    return table.take(np.lexsort((-clock.first * table.numbers["approach"], runs[1][runs[2]])))


def _timed(table: Columns, clock: Clock, settings: Instrument, model: ModelOfTest) -> Columns:
    """A table with times: the places follow each other, in rapid motion."""
    others = (*settings.readings, *settings.signs)
    places = [n for n in settings.columns if n in table.numbers and n not in others]
    place_mm = table.vectors(places)
    way_mm = np.abs(np.diff(place_mm, axis=0, prepend=place_mm[:1])).max(axis=1)
    under_way_s = way_mm / mm_per_s_from_mm_per_min(model.rapid_mm_per_min)
    time_s = np.cumsum(clock.stop_s + under_way_s)
    return replace(table, numbers=table.numbers | {"t_s": time_s})


def _note(table: Columns, clock: Clock) -> Note:
    """What is assumed of a table, and how to state it."""
    lasts_s = float(table.numbers["t_s"][-1])
    quick, slow = (pace.stop_s for pace in clock.paces)
    side = "forward" if clock.first == FORWARD else "backward"
    order = "" if table.order_is_stated else f", each run {side} first"
    said = (
        f"no times (t_s): {clock.stop_s:g} s at each place are taken, {lasts_s / 60.0:.0f} min in "
        f"all{order}. Intervals hold for {quick:g} to {slow:g} s. State t_s, in s, in rows below "
        "each other: what warms is then known better"
    )
    return Note.plain(Kind.CLOCK, said, lasts_s, "s", place="t_s")
