"""Numbers of runs as a file has them: readings put into rows by them, and what is odd about them.

Source: ISO 230-2 (runs numbered 1 to n in each direction of approach).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.base.note import Kind, Note

__all__ = ["LARGEST_RUN", "NumberedReadings", "doubled_notes", "numbering_notes"]

#: largest number of a run that is read; chosen
LARGEST_RUN = 999_999
#: numbers that a message lists
_LISTED = 12


@dataclass(frozen=True)
class NumberedReadings:
    """Single readings from one side, in the order of the file.

    Attributes
    ----------
    target : (P,) int64
        Index of the target.
    value : (P,) float64
        In the unit of the table.
    run : (P,) int64 or None
        Number of the run; None where the file has no numbers.
    line : (P,) int64
        Of the file, 1-based.
    """

    target: np.ndarray
    value: np.ndarray
    run: np.ndarray | None
    line: np.ndarray

    def occurrence(self) -> np.ndarray:
        """How many readings of the same run and target stand before each, (P,) int64."""
        seen: dict[tuple[int, int], int] = {}
        before = np.zeros(len(self.target), np.int64)
        runs = np.zeros_like(self.target) if self.run is None else self.run
        for k, key in enumerate(zip(runs.tolist(), self.target.tolist(), strict=True)):
            before[k] = seen.get(key, 0)
            seen[key] = before[k] + 1
        return before

    def in_rows(self, targets: int) -> tuple[np.ndarray, np.ndarray]:
        """One row a run, and the numbers of the runs.

        A run that holds a target twice has a second row under the same number.

        Parameters
        ----------
        targets : int
            K, number of targets.

        Returns
        -------
        rows : (n, K) float64
            NaN where a reading is missing; one empty row without readings.
        numbers : (n,) int64
        """
        again = self.occurrence()
        keys = list(zip(np.zeros_like(again) if self.run is None else self.run, again, strict=True))
        order = {key: k for k, key in enumerate(sorted(set(keys)))}
        rows = np.full((max(1, len(order)), targets), np.nan)
        for key, target, value in zip(keys, self.target, self.value, strict=True):
            rows[order[key], target] = value
        if self.run is None or not order:
            return rows, np.arange(1, len(rows) + 1)
        return rows, np.array([run for run, _ in order], np.int64)


def doubled_notes(
    readings: NumberedReadings, places: Sequence[str], *, approach: int
) -> Iterator[Note]:
    """A question for every run that holds a target twice.

    Parameters
    ----------
    readings : NumberedReadings
    places : sequence of str
        The targets as the file has them, with their unit.
    approach : int
        1 or -1, as in the file.
    """
    if readings.run is None:
        return
    again = readings.occurrence() > 0
    for run in np.unique(readings.run[again]).tolist():
        rows = np.flatnonzero(again & (readings.run == run))
        k = rows[0]
        same = (readings.run == run) & (readings.target == readings.target[k])
        first = int(readings.line[np.flatnonzero(same)[0]])
        more = f", and so {len(rows) - 1} readings more" if len(rows) > 1 else ""
        said = (
            f"run {run}, approach {approach}, has been at {places[readings.target[k]]} already in "
            f"line {first}{more}: both readings count. Is the number of one of them wrong?"
        )
        line = int(readings.line[k])
        yield Note.question(Kind.REPEAT, said, len(rows), "1", place=f"run {run}", line=line)


def numbering_notes(forward: Sequence[int], backward: Sequence[int]) -> Iterator[Note]:
    """Questions about numbers that do not begin at 1, that are missing, or of one direction only.

    Files that number every way by itself, forward 1, 3, 5 and backward 2, 4, 6, are in order.

    Parameters
    ----------
    forward, backward : sequence of int
        Numbers of the runs in either direction.
    """
    sides = set(forward), set(backward)
    every = sorted(sides[0] | sides[1])
    if not every:
        return
    # beyond 0 too: some count from there
    if every[0] > 1:
        said = (
            f"the runs are numbered {_words(every)}, not from 1: does the file hold all runs that "
            "were measured?"
        )
        yield Note.question(Kind.RUNS, said, every[0], "1")
    missing = sorted(set(range(every[0], every[-1] + 1)) - set(every))
    if missing:
        verb = "run {} is missing" if len(missing) == 1 else "runs {} are missing"
        said = f"{verb.format(_words(missing))} between run {every[0]} and run {every[-1]}: why?"
        yield Note.question(Kind.RUNS, said, len(missing), "1")
    if not sides[0] & sides[1]:
        return
    for way, own, other in (("forward", *sides), ("backward", *sides[::-1])):
        alone = sorted(own - other)
        if alone:
            verb = "run {} was" if len(alone) == 1 else "runs {} were"
            said = f"{verb.format(_words(alone))} measured {way} only: where is the other way?"
            yield Note.question(Kind.RUNS, said, len(alone), "1", place=way)


def _words(numbers: Sequence[int]) -> str:
    """Numbers in a row; of many the first ones and how many more."""
    shown = ", ".join(map(str, numbers[:_LISTED]))
    rest = len(numbers) - _LISTED
    return f"{shown} and {rest} more" if rest > 0 else shown
