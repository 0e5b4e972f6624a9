"""Effects as terms of a joint fit, and what a fit found of them.

Source: closed form derived here: prior of an amplitude: normal, of an inner parameter: log-normal
about its usual size.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vmach.effects import Effect, Parameter, label_of
from vmach.fit.columns import Columns
from vmach.fit.marginal_likelihood import Posterior

__all__ = ["FREE", "JointFit", "Term", "pull_of_prior"]

#: prior standard deviation of amplitudes, in usual sizes; keeps twins apart
FREE = 30.0
#: step of coefficients and logarithms in a derivative
_STEP = 1e-4
#: share of the largest variance below which a direction counts as known
_KNOWN = 1e-12


@dataclass(frozen=True)
class Term:
    """One effect of a joint fit: its target, inner parameters, and the width of its prior.

    `width` is in usual sizes and only set for effects whose coefficients are a curve.
    """

    effect: Effect
    target: str
    inner: Mapping[str, float]
    width: float | None = None

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect.name, self.target)

    @property
    def place(self) -> Hashable:
        """Name, target and inner parameters: all that its signatures depend on."""
        return self.label, *self.inner.values()

    @property
    def travel_axes(self) -> frozenset[str]:
        """Axes whose travel it follows."""
        return self.effect.travel_axes(self.target)

    @property
    def prior_width(self) -> float:
        """Prior standard deviation of its coefficients, in usual sizes."""
        return self.width or FREE

    @cached_property
    def free_parameters(self) -> tuple[Parameter, ...]:
        """The inner parameters that a fit may move, by their logarithms; I of them."""
        return tuple(p for p in self.effect.inner_parameters if p.low > 0)

    @property
    def free_inner(self) -> list[str]:
        """Their names."""
        return [p.name for p in self.free_parameters]

    @property
    def spread_of_inner(self) -> np.ndarray:
        """Prior standard deviation of each of their logarithms, (I,)."""
        return np.array([p.spread for p in self.free_parameters])

    @property
    def unusual(self) -> np.ndarray:
        """How many of these each logarithm lies from its usual value, (I,)."""
        off = [np.log(self.inner[p.name] / p.usual) / p.spread for p in self.free_parameters]
        return np.array(off)

    def apart(self, name: str, value: float, stated: float) -> float:
        """How far a parameter is from a stated value, the short way round where it is an angle."""
        away, cycle = value - stated, self._cycles[name]
        return away - cycle * round(away / cycle) if np.isfinite(cycle) else away

    @cached_property
    def _cycles(self) -> dict[str, float]:
        return {p.name: p.cycle for p in self.effect.parameters}

    def inner_at(self, steps: np.ndarray) -> dict[str, float]:
        """All inner parameters, the free ones with their logarithms moved by steps (I,)."""
        moved = {
            name: self.inner[name] * float(np.exp(step))
            for name, step in zip(self.free_inner, steps, strict=True)
        }
        return {**self.inner, **moved}


@dataclass(frozen=True)
class JointFit:
    """Fitted terms.

    Attributes
    ----------
    terms : tuple of Term
        With their fitted inner parameters.
    coefficients : tuple of (K,) float64
        Of each term, in usual sizes.
    joint_covariance : (C, C) float64
        Of all terms' coefficients and the logarithms of their free inner parameters.
    places : tuple of (K + I,) int64
        Where in it each term's own stand.
    signatures : tuple of Columns
    tangents : tuple of Columns
        Change of the fitted effect with the logarithm of each free inner parameter.
    open : Columns
        All signatures, then all tangents.
    posterior : Posterior
        Of what counted as noise.
    slack_mm : (n, Q) float64 or None
        Signatures of what the laws leave open, where the fit counted it as uncertainty.
    slack_scale : float
        Their size, in what the laws state.
    """

    terms: tuple[Term, ...]
    coefficients: tuple[np.ndarray, ...]
    joint_covariance: np.ndarray
    places: tuple[np.ndarray, ...]
    signatures: tuple[Columns, ...]
    tangents: tuple[Columns, ...]
    open: Columns
    posterior: Posterior
    slack_mm: np.ndarray | None = None
    slack_scale: float = 1.0

    def first(self, count: int) -> JointFit:
        """So many of its terms, as they were fitted beside the others."""
        names = ("terms", "coefficients", "places", "signatures", "tangents")
        return replace(self, **{name: getattr(self, name)[:count] for name in names})

    @cached_property
    def covariance(self) -> tuple[np.ndarray, ...]:
        """Of each term's coefficients and inner logarithms, (K + I, K + I) each."""
        return tuple(self.cross_covariance(k, k) for k in range(len(self.terms)))

    def cross_covariance(self, k: int, other: int) -> np.ndarray:
        """Of the coefficients and inner logarithms of term k with those of another."""
        return self.joint_covariance[np.ix_(self.places[k], self.places[other])]

    def parameters(self, k: int) -> dict[str, float]:
        """Parameters of term k."""
        term = self.terms[k]
        return term.effect.settle(self.coefficients[k], term.inner)

    def uncertainty(self, k: int) -> dict[str, float]:
        """Standard uncertainty of the parameters of term k."""
        slope = self.slope(k)
        spread = np.einsum("ij,ik,kj->j", slope, self.covariance[k], slope)
        u = np.sqrt(np.maximum(spread, 0.0)).tolist()
        return dict(zip(self.parameters(k), u, strict=True))

    def directions(self, k: int) -> list[dict[str, float]]:
        """Independent changes of the parameters of term k, one standard uncertainty each."""
        squared, axes = self._axes(k)
        moved = (axes * np.sqrt(np.maximum(squared, 0.0))).T @ self.slope(k)
        return [dict(zip(self.parameters(k), row, strict=True)) for row in moved.tolist()]

    def unit_changes(self, k: int) -> np.ndarray:
        """What coefficients and inner logarithms of term k make of each direction, (D, K + I).

        The amounts of the directions, in their standard uncertainties, are independent.
        """
        squared, axes = self._axes(k)
        is_open = squared > _KNOWN * squared.max()
        return axes.T * np.where(is_open, squared, np.inf)[:, None] ** -0.5

    def _axes(self, k: int) -> tuple[np.ndarray, np.ndarray]:
        """Variances of the directions of term k, and these in columns."""
        return np.linalg.eigh(self.covariance[k])

    def slope(self, k: int) -> np.ndarray:
        """Change of the parameters of term k with coefficients and logarithms, (K + I, N)."""
        term, count = self.terms[k], len(self.coefficients[k])
        start = np.concatenate([self.coefficients[k], np.zeros(len(term.free_parameters))])

        def settled(x: np.ndarray) -> dict[str, float]:
            return term.effect.settle(x[:count], term.inner_at(x[count:]))

        centre = settled(start)
        rows = []
        for unit in np.eye(len(start)):
            near = settled(start + _STEP * unit)
            rows.append([term.apart(name, near[name], centre[name]) / _STEP for name in centre])
        return np.array(rows)

    def explained_mm(self, k: int) -> np.ndarray:
        """What term k does to the readings, (n,)."""
        return self.signatures[k].mm @ self.coefficients[k]


def pull_of_prior(fit: JointFit, k: int) -> float:
    """What an integral beside tangents about the best fit of term k is too large by, as logarithm.

    The readings pull the inner parameters there, and the prior pulls them back by as much.

    Source: derived here: g^T V g / 2 of a normal prior with slope g and a covariance V of both.
    """
    term, covariance = fit.terms[k], fit.covariance[k]
    inner = len(covariance) - len(term.unusual)
    slope = term.unusual / term.spread_of_inner
    return 0.5 * float(slope @ covariance[inner:, inner:] @ slope)
