"""Can an instrument have read this: signs, speeds, readings and clocks of its file?

Source: chosen bounds, each beside its number.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.measurements.columns import Columns

__all__ = [
    "SIGNS_ACCEPTED",
    "check_readings",
    "check_signs",
    "check_spindle",
    "clock_notes",
    "repeat_notes",
    "still_notes",
]

#: signs that a column of last motions holds
_SIGNS = (-1.0, 0.0, 1.0)
SIGNS_ACCEPTED = "1 after motion towards +, -1 towards -, 0 where it is not known"
#: no milling spindle is faster, air bearings included
_FASTEST_RPM = 300_000.0
#: no test warms a spindle at less; in thousands no spindle turns faster
_SLOW_RPM = 60.0
#: no deviation of a machine tool that still cuts is larger; offsets and radii of fixtures are
_FARTHEST_MM = 5.0
#: readings that are all alike are no accident from this number on
_FEWEST = 12
#: nobody reads for longer (s: 116 days); a calendar time counts more
_LONGEST_S = 1e7
#: a longer test (s: five days), or more time for one reading, is worth a question
_LONG_S, _LONG_FOR_ONE_S = 432_000.0, 1800.0


def check_signs(table: Columns, names: Sequence[str]) -> tuple[Note, ...]:
    """Refuse signs of the last motion that are none; a note where no row has one.

    Raises
    ------
    InputError
        A sign other than -1, 0, 1, with its line.
    """
    for name in names:
        value = table.numbers[name]
        wrong = ~np.isin(value, _SIGNS)
        if wrong.any():
            raise InputError(
                f"{name} is {value[wrong][0]:g}",
                file=table.path,
                line=table.line_of(wrong),
                accepted=SIGNS_ACCEPTED,
            )
    if any(table.numbers[name].any() for name in names):
        return ()
    said = (
        f"{', '.join(names)} is 0 in every row: the direction is taken from the place before, "
        "and lost motion may be missed"
    )
    return (Note.question(Kind.SIGN, said, 0.0, "1", place=" ".join(names)),)


def check_spindle(table: Columns) -> tuple[Note, ...]:
    """Refuse spindle speeds that no spindle has; a note where none is fast enough to warm one.

    Raises
    ------
    InputError
        The first negative speed, or the first beyond every spindle's, with its line.
    """
    rpm = table.numbers["spindle_rpm"]
    wrong = (rpm < 0.0) | (rpm > _FASTEST_RPM)
    if wrong.any():
        raise InputError(
            f"spindle_rpm is {rpm[wrong][0]:g}",
            file=table.path,
            line=table.line_of(wrong),
            accepted=f"0 .. {_FASTEST_RPM:g} 1/min, whichever way the spindle turns",
            hint="is the speed in 1/min?",
        )
    fastest = float(rpm.max())
    if not 0.0 < fastest <= _SLOW_RPM:
        return ()
    said = f"spindle_rpm is {fastest:g} at most: is it in 1/min, and not in thousands of them?"
    return (Note.question(Kind.UNIT, said, fastest, "1/min", place="spindle_rpm"),)


def check_readings(table: Columns, names: Sequence[str]) -> None:
    """Refuse readings, in um, that are no deviations, and columns that were never read.

    Raises
    ------
    InputError
        A reading further from zero than a machine errs, with its line; or all of them alike.
    """
    for name in names:
        value_mm = mm_from_um(table.numbers[name])
        wrong = np.abs(value_mm) > _FARTHEST_MM
        if wrong.any():
            raise InputError(
                f"{name} is {table.numbers[name][wrong][0]:g} um, "
                f"{np.count_nonzero(wrong)} of {len(wrong)} rows are that far from zero",
                file=table.path,
                line=table.line_of(wrong),
                accepted=f"deviations within {_FARTHEST_MM * 1e3:g} um",
                hint="is a radius or a position in it, or is it in nm? Take the nominal value off",
            )
    everything = np.column_stack([table.numbers[name] for name in names])
    if len(everything) >= _FEWEST and not np.ptp(everything, axis=0).any():
        said = ", ".join(f"{v:g}" for v in everything[0])
        raise InputError(
            f"{', '.join(names)} is {said} in all {len(everything)} rows",
            file=table.path,
            line=int(table.lines[0]),
            accepted="readings that vary, as those of every instrument do",
            hint="was the column exported?",
        )


def still_notes(table: Columns, names: Sequence[str]) -> tuple[Note, ...]:
    """A note for every column of readings that never changes while others do."""
    still = [n for n in names if np.ptp(table.numbers[n]) == 0.0 and len(table.lines) >= _FEWEST]
    found = []
    for name in still:
        value_um = float(table.numbers[name][0])
        said = f"{name} is {value_um:g} in every row: was it measured? It counts as a reading"
        found.append(Note.question(Kind.STILL, said, value_um, "um", place=name))
    return tuple(found)


def clock_notes(table: Columns) -> tuple[Note, ...]:
    """A note where the clock runs longer than tests do.

    Raises
    ------
    InputError
        Times that are no seconds since a cold start.
    """
    time = table.numbers["t_s"]
    late = time > _LONGEST_S
    if late.any():
        raise InputError(
            f"t_s is {time[late][0]:.10g}",
            file=table.path,
            line=table.line_of(late),
            accepted=f"seconds since the cold start of this test, up to {_LONGEST_S:g}",
            hint="is it in ms, or the time of a calendar?",
        )
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    if time[-1] <= _LONG_S and step <= _LONG_FOR_ONE_S:
        return ()
    said = (
        f"the last reading is {time[-1] / 3600.0:.4g} h after the cold start, one reading takes "
        f"{step:.4g} s (median): is t_s in seconds?"
    )
    return (Note.question(Kind.CLOCK, said, float(time[-1]), "s", place="t_s"),)


def repeat_notes(table: Columns) -> tuple[Note, ...]:
    """A note where rows repeat the row before them, time and reading and all."""
    rows = np.column_stack([*table.numbers.values()])
    again = np.concatenate([[False], (rows[1:] == rows[:-1]).all(axis=1)])
    for column in table.text.values():
        again[1:] &= column[1:] == column[:-1]
    if not again.any():
        return ()
    count, line = int(np.count_nonzero(again)), table.line_of(again)
    said = (
        f"{count} of {len(again)} rows repeat the row before, the first in line "
        f"{line}: each counts as a reading of its own"
    )
    return (Note.question(Kind.REPEAT, said, count, "1", place=f"line {line}"),)
