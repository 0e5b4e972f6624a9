"""Where the model fails: does the residual depend on feature, position, direction, feed ...?

For each covariate the readings are sorted into classes, and the sum of squares that the classes'
means explain is compared with what the readings' own covariance makes of it: under it the sum
follows a chi-squared distribution, alignment and tables' uncertainty included.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from vmach.fit.survey import Survey
from vmach.fit.whitening import Whitening, orthonormal
from vmach.machine import LINEAR_AXES
from vmach.units import um_from_mm

__all__ = ["Failure", "where_it_fails"]

_ZONES = 8
_SIGNIFICANT = 0.01


@dataclass(frozen=True)
class Failure:
    """Dependence of the residual on one covariate.

    Attributes
    ----------
    by : str
        The covariate.
    p : float
        Chance that noise alone looks like this.
    text : str
        In words: the class of readings that is worst.
    """

    by: str
    p: float
    text: str


def where_it_fails(
    survey: Survey, whiten: Whitening, residual_mm: np.ndarray
) -> tuple[Failure, ...]:
    """Dependences that noise does not explain, the clearest first.

    Parameters
    ----------
    survey : Survey
    whiten : Whitening
        Of the survey.
    residual_mm : (n,) float64
        Measured minus predicted.
    """
    white = whiten(residual_mm)
    aligned = residual_mm - _nuisance_part(survey, residual_mm)
    found = []
    for by, labels, describe in _covariates(survey):
        names, number = np.unique(labels, return_inverse=True)
        if len(names) < 2:
            continue
        basis = orthonormal(whiten(np.eye(len(names))[number]), tolerance=1e-6)
        if basis.shape[1] == 0:
            continue
        p = float(chi2.sf(np.sum((basis.T @ white) ** 2), basis.shape[1]))
        means = np.array([aligned[number == k].mean() for k in range(len(names))])
        counts = np.bincount(number)
        worst = int(np.argmax(np.abs(means) * np.sqrt(counts)))
        text = (
            f"{describe(str(names[worst]))}: {um_from_mm(means[worst]):+.1f} um on average "
            f"({counts[worst]} readings)"
        )
        found.append(Failure(by, p, text))
    return tuple(sorted((f for f in found if f.p < _SIGNIFICANT), key=lambda f: f.p))


def _nuisance_part(survey: Survey, residual_mm: np.ndarray) -> np.ndarray:
    weight = 1.0 / survey.u_mm[:, None]
    solution = np.linalg.lstsq(survey.nuisance * weight, residual_mm * weight[:, 0], rcond=None)[0]
    return survey.nuisance @ solution


def _covariates(survey: Survey) -> Iterator[tuple[str, np.ndarray, object]]:
    paths, measurements = survey.paths, survey.measurements

    def gathered(one) -> np.ndarray:
        return np.concatenate(
            [np.asarray(one(p, m)) for p, m in zip(paths, measurements, strict=True)]
        )

    several = len(measurements) > 1
    names = np.concatenate(
        [np.char.add(m.group.astype(str), f" of {m.name}" if several else "") for m in measurements]
    )
    yield "feature", names, lambda name: f"feature {name}"
    sensing = np.array([_sense(s) for s in survey.sensing])
    for k, axis in enumerate(LINEAR_AXES):
        position = gathered(lambda p, m, k=k: p.nose_mm[:, k])
        zone, low, high = _zones(position)
        yield (
            "axis position",
            zone,
            lambda z, a=axis, lo=low, hi=high: f"{a} from {lo[int(z)]:.0f} to {hi[int(z)]:.0f} mm",
        )
        # what a reversal does depends on the side of the wall: sort by both
        side = gathered(lambda p, m, k=k: np.sign(np.round(p.direction[:, k])))
        both = np.char.add(np.char.mod("%+d ", side), sensing)
        yield (
            "direction",
            both,
            lambda s, a=axis: (
                f"after {a} moved {'+' if s[0] == '+' else '-'}, surfaces facing {s.split(' ')[1]}"
            ),
        )
    feed = gathered(lambda p, m: np.round(60 * np.linalg.norm(p.velocity_mm_per_s, axis=1)))
    yield "feed", feed, lambda f: f"at {float(f):.0f} mm/min"
    time = gathered(lambda p, m: p.time_s)
    zone, low, high = _zones(time)
    yield (
        "time",
        zone,
        lambda z, lo=low, hi=high: (
            f"{lo[int(z)] / 60:.1f} to {hi[int(z)] / 60:.1f} min after the start"
        ),
    )
    yield "tool", gathered(lambda p, m: p.tool), lambda t: f"tool {t}"
    yield "normal", sensing, lambda s: f"surfaces facing {s}"


def _zones(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Zone of equal counts of each value, (n,) int, and the zones' ends."""
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, _ZONES + 1)))
    zone = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, max(len(edges) - 2, 0))
    return zone, edges[:-1] if len(edges) > 1 else edges, edges[1:] if len(edges) > 1 else edges


def _sense(direction: np.ndarray) -> str:
    """The axis that a direction is nearest to: +X, -X, ... or between two: +X-Y."""
    parts = [
        f"{'+' if value > 0 else '-'}{axis}"
        for axis, value in zip(LINEAR_AXES, direction, strict=True)
        if abs(value) > 0.38
    ]
    return "".join(parts)
