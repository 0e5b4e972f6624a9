"""Every run beside the mean of all runs, and the readings that are outliers.

A reading's residual is its difference from the mean at its target and in its direction. The
scatter is pooled over all targets and both directions. The readings with the largest studentised
residuals are taken away one by one, and the number of outliers is the largest at which the test
is beyond its bound. One group of readings gives Rosner's own test.

Source: B. Rosner, Percentage points for a generalized ESD many-outlier procedure, Technometrics 25
(1983); R. D. Cook and S. Weisberg, Residuals and influence in regression (1982), 2.2 (externally
studentised residuals, here of one mean a group).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.machine.tables.runs import Runs

__all__ = ["Outlier", "RunFigures", "outliers", "run_figures"]

#: probability that a set of readings without an outlier has one told; chosen
_LEVEL = 0.01
#: largest share of readings that can be outliers; chosen
_MOST = 0.05
#: and their largest number, as each is sought among all readings; chosen
_MOST_TOLD = 100
#: fewest readings of a target from one side that tell which of them is odd
_FEWEST = 3
#: an outlier is further away than so many steps of the display; chosen
_STEPS = 1.5


@dataclass(frozen=True)
class RunFigures:
    """One run in one direction.

    Attributes
    ----------
    run : int
    direction : str
        ``forward``, ``backward``, or ``both`` where the readings of both are the same.
    readings : int
    mean, largest : float
        Difference from the mean of all runs at the same targets: its mean, and its largest.
    position : float
        Target of `largest`, in the unit of the runs.
    """

    run: int
    direction: str
    readings: int
    mean: float
    largest: float
    position: float

    def record(self, factor: float) -> dict[str, Any]:
        """As it stands in JSON, lengths and angles times `factor`."""
        return {
            "run": self.run, "direction": self.direction, "readings": self.readings,
            "mean": round(factor * self.mean, 4), "largest": round(factor * self.largest, 4),
            "at": self.position,
        }  # fmt: skip


@dataclass(frozen=True)
class Outlier:
    """A reading that is too far from those of the other runs.

    Attributes
    ----------
    run : int
    direction : str
        As of `RunFigures`.
    position : float
        Target, in the unit of the runs.
    deviation, from_others : float
        The reading, and its difference from the mean of the other runs there.
    studentised : float
        Externally studentised residual; infinite where all others agree.
    """

    run: int
    direction: str
    position: float
    deviation: float
    from_others: float
    studentised: float

    def record(self, factor: float) -> dict[str, Any]:
        """As it stands in JSON, lengths and angles times `factor`."""
        return {
            "run": self.run, "direction": self.direction, "at": self.position,
            "deviation": round(factor * self.deviation, 4),
            "from_others": round(factor * self.from_others, 4),
        }  # fmt: skip


def _sides(runs: Runs) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Direction, readings (n, K) and numbers (n,)."""
    same = runs.forward.shape == runs.backward.shape
    if same and np.array_equal(runs.forward, runs.backward, equal_nan=True):
        yield "both", runs.forward, runs.forward_number
        return
    yield "forward", runs.forward, runs.forward_number
    yield "backward", runs.backward, runs.backward_number


def run_figures(runs: Runs) -> tuple[RunFigures, ...]:
    """Figures of every run that has readings, in the order of the file's numbers."""
    found = []
    for direction, side, numbers in _sides(runs):
        residual = side - np.nanmean(side, axis=0)
        for number, row in zip(numbers.tolist(), residual, strict=True):
            known = np.flatnonzero(np.isfinite(row))
            if known.size:
                worst = known[np.argmax(np.abs(row[known]))]
                found.append(
                    RunFigures(
                        number,
                        direction,
                        len(known),
                        float(row[known].mean()),
                        float(row[worst]),
                        float(runs.position_mm[worst]),
                    )
                )
    return tuple(sorted(found, key=lambda own: own.run))


def outliers(runs: Runs, *, level: float = _LEVEL, most: int | None = None) -> tuple[Outlier, ...]:
    """Readings that are too far from those of the other runs, the furthest first.

    Parameters
    ----------
    runs : Runs
    level : float
        Probability of an error of the first kind, of the whole set.
    most : int or None
        Largest number of outliers; without it a share of the readings, 100 at most.

    Returns
    -------
    tuple of Outlier
        Empty where no target has three readings from one side.
    """
    from scipy.stats import t as student  # late: slow to import

    group, value, where = _readings(runs)
    most = max(1, min(int(_MOST * len(value)), _MOST_TOLD)) if most is None else most
    step = _STEPS * _display_step(value)
    left = np.ones(len(value), bool)
    taken: list[Outlier] = []
    count = 0
    for _ in range(most):
        found = _furthest(group, value, left)
        if found is None:
            break
        k, from_others, size, free = found
        if abs(from_others) <= step:
            break
        run, direction, position = where[k]
        taken.append(Outlier(run, direction, position, float(value[k]), from_others, size))
        if abs(size) > student.ppf(1.0 - 0.5 * level / left.sum(), free):
            count = len(taken)
        left[k] = False
    return tuple(taken[:count])


def _readings(runs: Runs) -> tuple[np.ndarray, np.ndarray, list[tuple[int, str, float]]]:
    """Group (P,), value (P,), and run, direction and target of every reading."""
    groups, values, where = [], [], []
    for side, (direction, readings, numbers) in enumerate(_sides(runs)):
        for row, k in np.argwhere(np.isfinite(readings)):
            groups.append(2 * k + side)
            values.append(readings[row, k])
            where.append((int(numbers[row]), direction, float(runs.position_mm[k])))
    return np.array(groups, np.int64), np.array(values, float), where


def _display_step(value: np.ndarray) -> float:
    """Smallest difference between two different readings."""
    steps = np.diff(np.unique(value))
    steps = steps[steps > 1e-9 * np.abs(value).max(initial=0.0)]
    return float(steps.min(initial=np.inf)) if steps.size else 0.0


def _furthest(
    group: np.ndarray, value: np.ndarray, left: np.ndarray
) -> tuple[int, float, float, int] | None:
    """The reading with the largest externally studentised residual.

    Returns
    -------
    index, difference from the mean of the others, studentised residual, degrees of freedom
        None where no group is large enough.
    """
    own, x = group[left], value[left]
    count = np.bincount(own)[own]
    residual = x - (np.bincount(own, x)[own] / count)
    free = len(x) - len(np.unique(own)) - 1
    is_open = count >= _FEWEST
    if free < 1 or not is_open.any():
        return None
    share = 1.0 - 1.0 / np.maximum(count, 2)
    alone = residual**2 / share  # what the reading adds to the sum of squares
    rest = float(residual @ residual) - alone
    tiny = 1e-12 * float(residual @ residual)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.where(rest > tiny, np.sqrt(alone * free / np.maximum(rest, 0.0)), np.inf)
    size = np.where(is_open & (residual != 0.0), size, 0.0)
    k = int(np.argmax(size))
    if size[k] == 0.0:
        return None
    from_others = float(residual[k] / share[k])
    return int(np.flatnonzero(left)[k]), from_others, float(np.copysign(size[k], residual[k])), free
