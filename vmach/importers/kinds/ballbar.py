"""Readings of a ballbar: radius deviation against angle, of one or several circles."""

from __future__ import annotations

import numpy as np

from vmach.importers.ballbar_runs import ANGLE_WORDS, RADIUS_WORDS, side_by_side, with_senses
from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.loose_table import ANGLE, SMALL_LENGTH, SPEED, TIME, Column, LooseTable
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.importers.time_of_day import CLOCK, COUNTED_FROM_THE_FIRST
from vmach.instruments.kinds.ballbar import Ballbar

__all__ = ["BallbarReadings"]

_ANGLE = Column("angle", ANGLE_WORDS, ANGLE, "deg")
_RUN = Column("run", ("run", "lauf", "arc", "sense"), is_needed=False, is_text=True)
_FEED = Column("feed", ("feed", "feedrate", "feed rate", "vorschub", "feed mm min"), SPEED,
               "mm/min", is_needed=False)  # fmt: skip
_TIME = Column("time", ("t", "time", "zeit"), TIME, "s", is_needed=False)
#: between two circles, where the file has no times: run-out, run-up and the change of sense
_PAUSE_S = 5.0


class BallbarReadings(Importer):
    """Circles about a centre; runs by their name, or by the sense in which the angle goes."""

    name = "ballbar"
    title = "Ballbar readings (ISO 230-4)"
    reads = "CSV or text with a heading: angle and radial deviation, or a column for each sense"
    rank = 30
    keys = {
        "plane": "first axis at 0 degrees: XY, YZ, ZX",
        "centre": "of the circles: machine position of the spindle nose, mm",
        "radius": "of the circles, mm",
        "feed": "mm/min, where the file has none",
        "tool_length": "from the spindle nose to the ball, mm",
        "u_um": "standard uncertainty of a reading",
        "outward": "yes where a larger radius is positive, else no",
        "unit": "of the deviation, where the heading names none",
    }

    def recognises(self, source: SourceFile) -> bool:
        return _table(source, Questions.none_open()) is not None

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        table = _table(source, questions)
        if table is None:
            raise source.error(
                "no heading with an angle and a radial deviation",
                accepted="columns such as 'Angle (deg)' and 'Deviation (um)', or 'CCW (um)' and "
                "'CW (um)' for circles side by side, numbered 'CCW 2 (um)' where there are more",
                hint="--column angle=... and --column radius=... name other headings",
            )
        plane = questions.choice(
            "plane", "which plane? the first axis is at 0 degrees", ("XY", "YZ", "ZX"), default="XY"
        )
        centre = questions.point("centre", "machine position of the spindle nose at the centre")
        radius = questions.number("radius", "radius of the circles", unit="mm")
        length = questions.number("tool_length", "from the spindle nose to the ball", unit="mm")
        u_um = questions.number("u_um", "standard uncertainty of a reading", unit="um", default=0.5)
        if questions.choice(
            "outward", "is a deviation positive where the radius is larger?", ("yes", "no"),
            default="yes",
        ) == "no":  # fmt: skip
            table.numbers["radius"][:] *= -1.0
        table, turned = with_senses(table)
        angle = table.complete("angle")
        run = _runs(table, angle)
        feed = _feeds(table, questions)
        time, told = _clock(table, angle, feed, run, radius)
        lines = ["run,feed_mm_min,angle_deg,t_s,radius_um"]
        for row in zip(run, feed, angle, time, table.complete("radius"), strict=True):
            lines.append("{},{:.6g},{:.6f},{:.4f},{:.5g}".format(*row))
        file = f"{source.path.stem}_ballbar.csv"
        section = Section(
            "job",
            "measurements",
            {
                "kind": Ballbar.name,
                "file": file,
                "plane": plane,
                "centre_mm": centre,
                "radius_mm": radius,
                "tool_length_mm": length,
                "u_um": u_um,
            },
            is_array=True,
        )
        said = f"{source.path.name}: {len(angle)} readings, runs {', '.join(dict.fromkeys(run))}"
        return Imported({file: "\n".join(lines) + "\n"}, (section,), (said + turned + told,))


def _table(source: SourceFile, questions: Questions) -> LooseTable | None:
    radius = Column("radius", RADIUS_WORDS, SMALL_LENGTH, questions.unit())
    columns = (_ANGLE, radius, _RUN, _FEED, _TIME)
    found = LooseTable.find(source, columns, given=questions.columns)
    if found is None and not questions.columns:
        found = side_by_side(source, questions.unit(), _FEED, questions.columns)
    return found


def _runs(table: LooseTable, angle: np.ndarray) -> list[str]:
    """Name of the run of every reading; by the sense of the angle where no column tells."""
    if "run" in table.text:
        return [word.replace(",", " ") for word in table.text["run"]]
    turn = np.sign((np.diff(angle) + 180.0) % 360.0 - 180.0)
    # an angle that stands still, where circles meet or digits are few, goes on as what follows
    goes = np.flatnonzero(turn)
    if len(goes):
        turn = turn[goes[np.minimum(np.searchsorted(goes, np.arange(len(turn))), len(goes) - 1)]]
    senses = np.concatenate([turn[:1], turn]) if len(turn) else np.ones(1)
    number = np.concatenate([[0], np.cumsum(senses[1:] != senses[:-1])])
    return [f"{'CCW' if senses[k] > 0 else 'CW'}{number[k] // 2 + 1}" for k in range(len(angle))]


def _feeds(table: LooseTable, questions: Questions) -> np.ndarray:
    if "feed" in table.numbers:
        return table.complete("feed")
    feed = questions.number("feed", "feed of the circles", unit="mm/min")
    return np.full(len(table.lines), feed)


def _clock(
    table: LooseTable, angle: np.ndarray, feed: np.ndarray, run: list[str], radius_mm: float
) -> tuple[np.ndarray, str]:
    """Seconds of every reading, (P,), and what is to be said of them.

    A clock that begins anew with each run goes on behind the one before, after a pause.

    Raises
    ------
    InputError
        A time that falls within a run.
    """
    if "time" not in table.numbers:
        return _times(angle, feed, run, radius_mm), ""
    time = table.complete("time").copy()
    told = COUNTED_FROM_THE_FIRST if table.units["time"] == CLOCK else ""
    falls = np.flatnonzero(np.diff(time) < 0.0) + 1
    for k in falls:
        if run[k] == run[k - 1] and feed[k] == feed[k - 1]:
            raise table.source.error(
                f"time runs backwards within run '{run[k]}'",
                line=int(table.lines[k]),
                accepted="rows of a run in the order of time",
            )
        time[k:] += time[k - 1] + _PAUSE_S - time[k]
    if len(falls):
        told += f"; the clock begins anew with runs: {_PAUSE_S:g} s between them are taken"
    return time, told


def _times(angle: np.ndarray, feed: np.ndarray, run: list[str], radius_mm: float) -> np.ndarray:
    """Seconds at constant feed, with a pause between runs."""
    turned = np.abs((np.diff(angle) + 180.0) % 360.0 - 180.0)
    step = np.radians(turned) * radius_mm / (np.maximum(feed[1:], 1e-6) / 60.0)
    new = np.array([a != b for a, b in zip(run[1:], run[:-1], strict=True)])
    step = np.where(new, _PAUSE_S, np.maximum(step, 1e-3))
    return np.concatenate([[_PAUSE_S], _PAUSE_S + np.cumsum(step)])
