"""Conventional arms against Abbe-consistent ones, as a result of its own.

How far both predictions are apart and where, and which is nearer to the measured part. The
interval is that of a bootstrap over blocks of neighbouring points, since their errors are alike.

Source: Efron and Tibshirani, An Introduction to the Bootstrap, 1993 (percentile intervals); Künsch
1989 (blocks for dependent data).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.base.units import um_from_mm
from vmach.report.result import InspectedPoints, RunRecord

__all__ = ["ArmsComparison", "arms_summary", "arms_text", "compare_arms"]

#: neighbouring points of one block, draws, seed; share that the interval leaves out
_BLOCK, _DRAWS, _SEED, _OUTSIDE = 25, 2000, 1, 0.05


@dataclass(frozen=True)
class ArmsComparison:
    """HTM minus Abbe over the points that both cut, mm.

    Attributes
    ----------
    largest_mm, rms_mm : float
        Largest difference with its sign, and the RMS.
    at : int
        Index of the point where it is largest.
    remainders_mm : tuple of 2 float or None
        RMS of measured minus predicted, HTM and Abbe; None where nothing was measured.
    gain_mm, low_mm, high_mm : float or None
        HTM's RMS minus Abbe's and its 95 % interval: above zero, Abbe is nearer.
    """

    largest_mm: float
    rms_mm: float
    at: int
    remainders_mm: tuple[float, float] | None = None
    gain_mm: float | None = None
    low_mm: float | None = None
    high_mm: float | None = None

    @property
    def nearer(self) -> str | None:
        """``abbe``, ``htm``, or ``cannot be told``; None where nothing was measured."""
        if self.gain_mm is None:
            return None
        if self.low_mm > 0.0:
            return "abbe"
        return "htm" if self.high_mm < 0.0 else "cannot be told"


def compare_arms(points: InspectedPoints) -> ArmsComparison | None:
    """Compare the columns ``htm`` and ``abbe``; None where one of them is missing."""
    if not points.differences:
        return None
    column = points.differences[0]
    both = np.flatnonzero(column.is_cut)
    if not both.size:
        return None
    apart = column.deviation_mm[both]
    at = int(both[np.argmax(np.abs(apart))])
    largest, rms = float(column.deviation_mm[at]), float(np.sqrt(np.mean(apart**2)))
    left = [points[name].remainder_mm for name in ("htm", "abbe")]
    if any(one is None for one in left):
        return ArmsComparison(largest, rms, at)
    squares = np.square([one[both] for one in left])
    each = np.sqrt(squares.mean(axis=1))
    low, high = _interval(squares)
    return ArmsComparison(
        largest, rms, at, (float(each[0]), float(each[1])), float(each[0] - each[1]), low, high
    )


def _interval(squares: np.ndarray) -> tuple[float, float]:
    """Interval of the difference of two RMS from squared residuals, (2, P), in their order."""
    blocks = np.array_split(np.arange(squares.shape[1]), max(squares.shape[1] // _BLOCK, 1))
    sums = np.array([squares[:, rows].sum(axis=1) for rows in blocks])
    counts = np.array([len(rows) for rows in blocks])
    chosen = np.random.default_rng(_SEED).integers(len(blocks), size=(_DRAWS, len(blocks)))
    rms = np.sqrt(sums[chosen].sum(axis=1) / counts[chosen].sum(axis=1)[:, None])
    low, high = np.quantile(rms[:, 0] - rms[:, 1], [_OUTSIDE / 2.0, 1.0 - _OUTSIDE / 2.0])
    return float(low), float(high)


def arms_summary(points: InspectedPoints, run: RunRecord) -> dict | None:
    """The value of ``htm_against_abbe`` in summary.json."""
    found = compare_arms(points)
    if found is None:
        return None
    line = int(points.line[found.at])
    return {
        "largest_um": um_from_mm(found.largest_mm),
        "rms_um": um_from_mm(found.rms_mm),
        "feature": str(points.feature[found.at]),
        "point_mm": points.point_mm[found.at].tolist(),
        "line": line,
        "nc": run.nc_text(line),
        "remainder_rms_um": None
        if found.remainders_mm is None
        else dict(zip(("htm", "abbe"), map(um_from_mm, found.remainders_mm), strict=True)),
        "gain_um": None if found.gain_mm is None else um_from_mm(found.gain_mm),
        "gain_interval_um": None
        if found.gain_mm is None
        else (um_from_mm(found.low_mm), um_from_mm(found.high_mm)),
        "nearer": found.nearer,
    }


def arms_text(points: InspectedPoints, run: RunRecord) -> list[str]:
    """Lines for the terminal; none where only one of them was predicted."""
    told = arms_summary(points, run)
    if told is None:
        return []
    place = ", ".join(f"{x:.3f}" for x in told["point_mm"])
    lines = [
        f"HTM and Abbe differ by up to {abs(told['largest_um']):.1f} um (RMS {told['rms_um']:.1f} "
        f"um): {told['feature']} at ({place}), line {told['line']}: {told['nc']}"
    ]
    if told["nearer"] is not None:
        htm, abbe = (told["remainder_rms_um"][name] for name in ("htm", "abbe"))
        low, high = told["gain_interval_um"]
        verdict = {
            "abbe": "Abbe-consistent arms are nearer to the measured part",
            "htm": "conventional arms are nearer to the measured part",
        }.get(told["nearer"], "which is nearer to the measured part cannot be told")
        lines.append(
            f"{verdict}: RMS left {htm:.2f} um (HTM), {abbe:.2f} um (Abbe); HTM leaves "
            f"{told['gain_um']:+.2f} um more (95 %: {low:+.2f} to {high:+.2f})"
        )
    return lines
