"""Reconstructed laser runs of the Mazak AJV-25/405 (mazak_ajv25).

Run from anywhere:  python samples/make_mazak_tables.py

The source prints, for every error, the figures of ISO 230-2 but shows few curves. This script
makes up five bidirectional runs at the source's own targets that have exactly the printed figures.
Fixed seed: the same numbers every time.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from make_errors import smooth_curve

FOLDER = Path(__file__).resolve().parent / "mazak_ajv25"
SEED = 405
RUNS = 5


@dataclass(frozen=True)
class Printed:
    """One column of the source's Tables 4 to 6: figures of ISO 230-2, um or urad."""

    component: str
    decimals: int
    position_mm: np.ndarray
    A: float
    R: float
    mean_reversal: float
    M: float
    B: float
    E: float

    @property
    def is_straightness(self) -> bool:
        """Straightness: the source removed the least-squares slope."""
        return self.component[1] in "XYZ" and self.component[1] != self.component[2]


def read_printed() -> list[Printed]:
    """The printed figures; reversal and E of a straightness error, not printed, are chosen."""
    with (FOLDER / "tables_4_to_6.csv").open() as file:
        return [_printed(row) for row in csv.DictReader(file)]


def _printed(row: dict[str, str]) -> Printed:
    first, last, step = (float(row[key]) for key in ("first_mm", "last_mm", "step_mm"))
    M, mean = float(row["mean_deviation_M"]), float(row["mean_reversal"])
    return Printed(
        component=row["component"],
        decimals=int(row["decimals"]),
        position_mm=np.arange(first, last + step / 2, step)[::-1],
        A=float(row["accuracy_A"]),
        R=float(row["repeatability_R"]),
        mean_reversal=mean,
        M=M,
        B=float(row["reversal_B"] or 1.6 * abs(mean) + 0.05 * M),
        E=float(row["systematic_E"] or M + abs(mean)),
    )


def reconstruct_means(figures: Printed, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Mean of both directions and reversal at the targets, with M, B, E and the mean reversal.

    E exceeds M by the mean of the absolute reversals at the highest and lowest target; B sits at a
    target half-way up, and a wave with its crest there leads to the mean reversal.
    """
    u = np.linspace(-1, 1, len(figures.position_mm))
    middle = smooth_curve(u, rng, straightness=figures.is_straightness)
    middle *= figures.M / np.ptp(middle)
    top, bottom, half_way = _landmarks(middle)
    edge = figures.E - figures.M
    sign = -1.0 if figures.mean_reversal < 0 else 1.0
    wave = np.cos(1.3 * np.pi * (u - u[half_way]))
    free = np.ones(len(u), dtype=bool)
    free[[top, bottom, half_way]] = False
    room = 2 * np.minimum(middle[top] - middle, middle - middle[bottom]) + edge
    limit = 0.97 * np.minimum(figures.B, room)
    for swing in figures.B * 0.85 ** np.arange(60):
        reversal = np.full(len(u), sign * figures.B)
        for end in (top, bottom):
            direction = np.sign(wave[end]) if figures.mean_reversal == 0 else sign
            reversal[end] = edge * direction
        rest = len(u) * figures.mean_reversal - reversal[~free].sum()
        variation = sign * swing * (wave - wave[free].mean())
        reversal[free] = rest / free.sum() + variation[free]
        if (np.abs(reversal) <= limit)[free].all():
            return middle, reversal
    # every reversal is the largest one: Z, whose printed mean reversal is out of reach
    reversal[free] = sign * figures.B
    return middle, reversal


def _landmarks(middle: np.ndarray) -> tuple[int, int, int]:
    """Targets with the highest, the lowest, and the value nearest to half-way between."""
    top, bottom = int(middle.argmax()), int(middle.argmin())
    distance = np.abs(middle - (middle[top] + middle[bottom]) / 2)
    distance[[top, bottom]] = np.inf
    return top, bottom, int(distance.argmin())


def reconstruct_spreads(
    figures: Printed, middle: np.ndarray, reversal: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Standard deviations (forward, backward) at the targets, (2, K), with A and R.

    A exceeds E by twice the deviations of the two extreme means; R is the full width at the target
    half-way up. Everything else stays inside both.
    """
    top, bottom, half_way = _landmarks(middle)
    means = np.stack([middle + reversal / 2, middle - reversal / 2])
    low, high = means.min(), means.max()
    margin = (figures.A - (high - low)) / 2
    low, high = low - margin, high + margin
    if figures.A - figures.R < 1e-9:  # one target spans the whole of A
        low, high = middle[half_way] - figures.A / 2, middle[half_way] + figures.A / 2
    inside = np.minimum(high - means, means - low) / 2
    cap = np.minimum(inside, (figures.R - np.abs(reversal)) / 4)
    spread = cap * rng.uniform(0.35, 0.75, cap.shape)
    for target, way in ((top, means[:, top].argmax()), (bottom, means[:, bottom].argmin())):
        spread[way, target] = inside[way, target]
        spread[1 - way, target] = min(0.1 * margin, cap[1 - way, target] / 2)
    spread[:, half_way] = (figures.R - np.abs(reversal[half_way])) / 4
    return spread


def draw_runs(mean: np.ndarray, spread: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Five readings a target with exactly this mean and standard deviation, (RUNS, K)."""
    z = rng.normal(size=(RUNS, len(mean)))
    z -= z.mean(axis=0)
    return mean + spread * z / z.std(axis=0, ddof=1)


def reconstruct_runs(figures: Printed, rng: np.random.Generator) -> np.ndarray:
    """Readings (2, RUNS, K), forward then backward, rounded as they are written."""
    middle, reversal = reconstruct_means(figures, rng)
    spread = reconstruct_spreads(figures, middle, reversal, rng)
    # a straight line was fitted to straightness; else the instrument read zero nearest to home
    middle = middle - (middle.mean() if figures.is_straightness else middle[-1])
    means = (middle + reversal / 2, middle - reversal / 2)
    runs = [draw_runs(mean, s, rng) for mean, s in zip(means, spread, strict=True)]
    return np.round(runs, 4)


def write_runs(path: Path, position_mm: np.ndarray, runs: np.ndarray) -> None:
    """Raw runs: one row a target, the runs of both directions beside each other."""
    heads = [f"{way}_{k}" for way in ("forward", "backward") for k in range(1, RUNS + 1)]
    rows = np.concatenate(runs).T
    lines = [
        ",".join([f"{x:g}", *(f"{v:.4f}" for v in row)])
        for x, row in zip(position_mm, rows, strict=True)
    ]
    path.write_text("\n".join([",".join(["position_mm", *heads]), *lines]) + "\n")


def main() -> None:
    """Write all runs."""
    (FOLDER / "errors").mkdir(exist_ok=True)
    for number, figures in enumerate(read_printed()):
        runs = reconstruct_runs(figures, np.random.default_rng([SEED, number]))
        write_runs(FOLDER / "errors" / f"{figures.component}.csv", figures.position_mm, runs)


if __name__ == "__main__":
    main()
