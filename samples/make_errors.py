"""Invented error tables of the sample machines: plausible smooth curves from a fixed seed.

Run from anywhere:  python samples/make_errors.py

It writes ``errors/*.csv`` of iso10791_7 and spline_slot anew; the same numbers every time.
Every curve is a low polynomial plus a few waves, scaled to a stated half range, zero at the
middle of the travel, where such a machine's owner would zero the instrument. Straightness has its
least-squares slope removed: that slope is squareness, which the machine file holds.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

SAMPLES = Path(__file__).resolve().parent
#: longest wave, then shorter ones: fraction of the travel that one period takes
WAVE_PERIODS = (0.9, 0.45, 0.21)
WAVE_SIZES = (0.5, 0.25, 0.08)


@dataclass(frozen=True)
class AxisTables:
    """One axis: travel, spacing of the targets, half range and reversal of its six errors.

    `half_range` and `reversal` are in the order X Y Z A B C; um, then urad.
    """

    travel_mm: tuple[float, float]
    step_mm: float
    half_range: tuple[float, ...]
    reversal: tuple[float, ...]


@dataclass(frozen=True)
class MachineTables:
    """The tables of one machine and the seed that they grow from."""

    seed: int
    axes: dict[str, AxisTables]


MACHINES = {
    "iso10791_7": MachineTables(
        seed=10791,
        axes={
            "X": AxisTables(
                (-760, 0), 40, (7.0, 2.5, 2.0, 9.0, 11.0, 8.0), (1.2, 0.3, 0.2, 0.5, 0.8, 0.6)
            ),
            "Y": AxisTables(
                (-460, 0), 20, (2.0, 5.5, 2.5, 10.0, 7.0, 9.0), (0.2, 1.5, 0.3, 0.7, 0.4, 0.6)
            ),
            "Z": AxisTables(
                (-510, 0), 30, (2.5, 1.8, 6.0, 8.0, 9.0, 6.0), (0.3, 0.2, 0.8, 0.5, 0.6, 0.3)
            ),
        },
    ),
    "spline_slot": MachineTables(
        seed=2017,
        axes={
            "X": AxisTables(
                (-3000, 0), 100, (24.0, 9.0, 10.0, 9.0, 12.0, 10.0), (3.0, 1.0, 1.0, 1.0, 1.5, 1.2)
            ),
            "Y": AxisTables(
                (-1800, 0), 75, (8.0, 16.0, 8.0, 12.0, 10.0, 11.0), (0.8, 2.5, 0.8, 1.2, 1.0, 1.2)
            ),
            "Z": AxisTables(
                (-800, 0), 40, (6.0, 7.0, 10.0, 10.0, 12.0, 6.0), (0.5, 0.6, 1.5, 1.0, 1.0, 0.5)
            ),
        },
    ),
}


def smooth_curve(u: np.ndarray, rng: np.random.Generator, *, straightness: bool) -> np.ndarray:
    """A smooth curve over u in [-1, 1] of half range 1, zero at u = 0."""
    slope, bow, twist = rng.normal(0.0, (0.6, 0.6, 0.3))
    value = slope * u + bow * u**2 + twist * u**3
    for period, size in zip(WAVE_PERIODS, WAVE_SIZES, strict=True):
        value += size * np.sin(np.pi * u / period + rng.uniform(0, 2 * np.pi))
    if straightness:
        value -= np.polynomial.Polynomial.fit(u, value, 1)(u)
    value *= 2.0 / np.ptp(value)
    return value - np.interp(0.0, u, value)


def error_table(
    tables: AxisTables, kind: int, rng: np.random.Generator, *, own: bool
) -> np.ndarray:
    """Rows ``position, forward, backward`` of one error; `kind` 0..5 is X Y Z A B C."""
    low, high = tables.travel_mm
    position_mm = np.append(np.arange(low, high, tables.step_mm), high)
    u = 2 * (position_mm - low) / (high - low) - 1
    mean = tables.half_range[kind] * smooth_curve(u, rng, straightness=kind < 3 and not own)
    reversal = tables.reversal[kind] * (1 + 0.3 * np.sin(2.2 * u + rng.uniform(0, 6)))
    return np.column_stack([position_mm, mean + reversal / 2, mean - reversal / 2])


def write_table(path: Path, rows: np.ndarray) -> None:
    """Write an error table with the digits that an instrument gives."""
    lines = [f"{x:g},{f:.3f},{b:.3f}" for x, f, b in rows]
    path.write_text("\n".join(["position_mm,forward,backward", *lines]) + "\n")


def main() -> None:
    """Write all tables."""
    for name, machine in MACHINES.items():
        folder = SAMPLES / name / "errors"
        folder.mkdir(parents=True, exist_ok=True)
        rng = np.random.default_rng(machine.seed)
        for axis, tables in machine.axes.items():
            for kind, letter in enumerate("XYZABC"):
                rows = error_table(tables, kind, rng, own=letter == axis)
                write_table(folder / f"E{letter}{axis}.csv", rows)


if __name__ == "__main__":
    main()
