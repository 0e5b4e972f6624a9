"""What goes wrong with measured files in a workshop, done to the file of an experiment."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

__all__ = ["SPOILERS", "spoil", "spoil_instrument"]

NUMBERS = slice(2, 12)  #: x ... u_um among the cells of a row
#: columns of instruments that hold readings
READINGS = ("radius_um", "deviation_um", "dx_um", "dy_um", "dz_um")
PLACE, MEASURED, U = slice(0, 3), slice(6, 9), 9


def spoil(folder: Path, how: str, *, seed: int = 0, share: float = 0.02) -> int:
    """Rewrite ``part_measured.csv``; returns how many rows were spoilt or added.

    Parameters
    ----------
    how : name out of `SPOILERS`
    share : of the rows, where only some are concerned
    """
    path = folder / "part_measured.csv"
    header, *lines = path.read_text().splitlines()
    cells = [line.split(",") for line in lines]
    numbers = np.array([row[NUMBERS] for row in cells], dtype=float)
    rng = np.random.default_rng(seed)
    some = np.sort(rng.permutation(len(cells))[: max(1, round(share * len(cells)))])
    names = [row[1] for row in cells]
    numbers, names = SPOILERS[how](rng, numbers, names, some)
    changed = [
        ",".join([str(k), name, *(f"{v:.9g}" for v in row)])
        for k, (name, row) in enumerate(zip(names, numbers, strict=True), 1)
    ]
    path.write_text("\n".join([header, *changed]) + "\n")
    return len(some)


def spoil_instrument(folder: Path, name: str, factor: float, *, add_um=None) -> None:
    """Multiply the readings of ``NAME.csv``, as another unit does.

    Parameters
    ----------
    add_um : function of the rows (dict of columns of text) to what is added before, optional
    """
    path = folder / f"{name}.csv"
    header, *lines = path.read_text().splitlines()
    names, cells = header.split(","), np.array([line.split(",") for line in lines], dtype=object)
    for k in (k for k, column in enumerate(names) if column in READINGS):
        seen = cells[:, k].astype(float)
        if add_um is not None:
            seen = seen + add_um(dict(zip(names, cells.T, strict=True)))
        cells[:, k] = [f"{v:.9g}" for v in factor * seen]
    path.write_text("\n".join([header, *(",".join(row) for row in cells)]) + "\n")


def chips(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """A chip under the probe: 5 to 50 um on top of the surface."""
    numbers[some, MEASURED] += rng.uniform(5e-3, 50e-3, (len(some), 1)) * numbers[some, 3:6]
    return numbers, names


def repeated(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """Rows pasted twice."""
    return np.vstack([numbers, numbers[some]]), names + [names[k] for k in some]


def never_cut(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """Points of a surface that this program does not make: beside the part, on its underside."""
    extra = numbers[some].copy()
    extra[:, [2, 8]] -= 150.0
    return np.vstack([numbers, extra]), names + ["underside"] * len(some)


def metres(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """All coordinates in m."""
    numbers[:, PLACE] *= 1e-3
    numbers[:, MEASURED] *= 1e-3
    return numbers, names


def inches(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """All coordinates in inches."""
    numbers[:, PLACE] /= 25.4
    numbers[:, MEASURED] /= 25.4
    return numbers, names


def measured_in_metres(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """The measured coordinates alone in m."""
    numbers[:, MEASURED] *= 1e-3
    return numbers, names


def uncertainty_in_metres(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """The column u_um holds metres."""
    numbers[:, U] *= 1e-6
    return numbers, names


def uncertainty_in_mm(rng, numbers: np.ndarray, names: list[str], some: np.ndarray):
    """The column u_um holds millimetres."""
    numbers[:, U] *= 1e-3
    return numbers, names


SPOILERS: dict[str, Callable] = {
    f.__name__: f
    for f in (
        chips, repeated, never_cut, metres, inches, measured_in_metres, uncertainty_in_metres,
        uncertainty_in_mm,
    )
}  # fmt: skip
