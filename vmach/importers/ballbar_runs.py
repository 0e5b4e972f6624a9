"""Circles of a ballbar by their sense: side by side, one below the other, told by a word.

Source: ISO 230-4: a contour is read in both senses; counter-clockwise, angles grow.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from vmach.importers.loose_table import ANGLE, SMALL_LENGTH, Column, LooseTable
from vmach.importers.source_file import SourceFile

__all__ = ["ANGLE_WORDS", "RADIUS_WORDS", "side_by_side", "with_senses"]

ANGLE_WORDS = ("angle", "winkel", "polar angle")
RADIUS_WORDS = ("radius", "radial deviation", "deviation", "radius deviation", "radiusabweichung",
                "abweichung", "radial", "error")  # fmt: skip
#: which way angles go, and what that is called
_SENSES: Mapping[str, tuple[float, tuple[str, ...]]] = {
    "CCW": (1.0, ("ccw", "counterclockwise", "counter-clockwise", "anticlockwise", "g3", "g03",
                  "anti-clockwise", "gegenuhrzeigersinn", "gegen uhrzeigersinn")),
    "CW": (-1.0, ("cw", "clockwise", "g2", "g02", "uhrzeigersinn", "im uhrzeigersinn")),
}  # fmt: skip
#: circles of one sense that are looked for side by side
_MOST = 9
#: a run that turns by less does not tell its sense, degrees
_LEAST_DEG = 5.0


def side_by_side(
    source: SourceFile, unit: str, feed: Column, given: Mapping[str, str]
) -> LooseTable | None:
    """A table with a column of deviations for each circle, its rows put one below the other.

    Each circle may have angles of its own, else all have those of one column; cells may be empty
    where a circle has no reading. None where no heading names a sense.
    """
    columns = [Column("angle", ANGLE_WORDS, ANGLE, "deg", is_needed=False), replace(feed)]
    for name, sense, number in _circles():
        own = tuple(_called(sense, number, ANGLE_WORDS, is_alone=False))
        columns.append(Column(f"angle {name}", own, ANGLE, "deg", is_needed=False))
        own = tuple(_called(sense, number, RADIUS_WORDS, is_alone=True))
        columns.append(Column(name, own, SMALL_LENGTH, unit, is_needed=False))
    table = LooseTable.find(source, columns, given=given)
    if table is None:
        return None
    circles = [(name, _angle_of(table, name)) for name, _, _ in _circles() if name in table.numbers]
    told = [(name, angle) for name, angle in circles if angle is not None]
    return _stacked(table, told) if told else None


def _circles() -> Iterator[tuple[str, str, int]]:
    """Name, sense and number of every circle, in the order in which they are usually read."""
    for number in range(1, _MOST + 1):
        for sense in _SENSES:
            yield f"{sense}{number}", sense, number


def _called(sense: str, number: int, what: Sequence[str], *, is_alone: bool) -> Iterator[str]:
    """How headings call a column of one circle."""
    for word in _SENSES[sense][1]:
        numbered = [f"{word} {number}", f"{word}{number}", f"run {number} {word}",
                    f"{word} run {number}", f"lauf {number} {word}"]  # fmt: skip
        for own in [*numbered, *([word] if number == 1 else [])]:
            if is_alone:
                yield own
            for one in what:
                yield from (f"{one} {own}", f"{own} {one}", f"{one} ({own})")


def _angle_of(table: LooseTable, name: str) -> np.ndarray | None:
    return table.numbers.get(f"angle {name}", table.numbers.get("angle"))


def _stacked(table: LooseTable, circles: Sequence[tuple[str, np.ndarray]]) -> LooseTable:
    """One row a reading: angle, radius, run, and feed where there is one."""
    rows, run, angle, radius = [], [], [], []
    for name, its_angle in circles:
        its_radius = table.numbers[name]
        there = np.flatnonzero(np.isfinite(its_radius) | np.isfinite(its_angle))
        if "angle" in table.numbers and f"angle {name}" not in table.numbers:
            there = np.flatnonzero(np.isfinite(its_radius))
        rows.append(there)
        run += [name] * len(there)
        angle.append(its_angle[there])
        radius.append(its_radius[there])
    which = np.concatenate(rows)
    numbers = {"angle": np.concatenate(angle), "radius": np.concatenate(radius)}
    if "feed" in table.numbers:
        numbers["feed"] = table.numbers["feed"][which]
    return replace(
        table, lines=table.lines[which], numbers=numbers, text={"run": np.array(run)}, units={}
    )


def with_senses(table: LooseTable) -> tuple[LooseTable, str]:
    """The rows of each run that names its sense as they were read, and what is to be said of it.

    Programs list a clockwise circle by its angle too; without times its rows are turned round. A
    sense that comes again is another run.

    Raises
    ------
    InputError
        Angles go against the sense although there are times.
    """
    run = table.text.get("run")
    if run is None or not len(run):
        return table, ""
    ends = [*np.flatnonzero(run[1:] != run[:-1]) + 1, len(run)]
    order, names, turned = [], [], []
    seen: dict[str, int] = {}
    begin = 0
    for end in ends:
        rows, word = np.arange(begin, end), str(run[begin])
        seen[word] = seen.get(word, 0) + 1
        way = _way_of(word)
        name = word if way is None or seen[word] == 1 else f"{word} {seen[word]}"
        if way is not None and way * _turn_deg(table.complete("angle")[rows]) < -_LEAST_DEG:
            _check_no_times(table, rows, word)
            rows = rows[::-1]
            turned.append(name)
        order.append(rows)
        names += [name] * len(rows)
        begin = end
    which = np.concatenate(order)
    said = f"; {', '.join(turned)}: rows turned round, as the angles go against the sense"
    return _ordered(table, which, names), said if turned else ""


def _way_of(word: str) -> float | None:
    """+1 counter-clockwise, -1 clockwise; None where a name says nothing of it."""
    plain = word.strip().lower().rstrip("0123456789 ")
    spoken = [word.strip().lower(), plain]
    return next((way for way, words in _SENSES.values() if any(one in words for one in spoken)),
                None)  # fmt: skip


def _turn_deg(angle_deg: np.ndarray) -> float:
    """How far a run turns, counter-clockwise positive."""
    return float(((np.diff(angle_deg) + 180.0) % 360.0 - 180.0).sum())


def _check_no_times(table: LooseTable, rows: np.ndarray, word: str) -> None:
    if "time" in table.numbers:
        raise table.source.error(
            f"the angles of run '{word}' go the other way",
            line=int(table.lines[rows[0]]),
            accepted="angles that grow with time in CCW, and fall in CW",
            hint="are the senses exchanged, or is the plane another one?",
        )


def _ordered(table: LooseTable, which: np.ndarray, names: Sequence[str]) -> LooseTable:
    numbers = {name: values[which] for name, values in table.numbers.items()}
    return replace(table, lines=table.lines[which], numbers=numbers, text={"run": np.array(names)})
