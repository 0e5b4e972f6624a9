"""What a fit says of the parameters of one of its effects, and how surely."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from vmach.diagnosis.component_curve import component_parameters
from vmach.fit.terms import JointFit
from vmach.fit.uncertainty import Otherwise, Spread, parameter_uncertainty

__all__ = ["FittedParameters", "alike_parameters", "fitted_parameters", "fitted_values"]

#: a change shorter than this, of the longest, is one of rounding
_STILL = 1e-9


@dataclass(frozen=True)
class FittedParameters:
    """Parameters in the units of their names; those of a component are lists.

    Attributes
    ----------
    values, u : dict
        With their standard uncertainties.
    interval_95 : dict
        Of each parameter (low, high); empty for a component.
    weakly_identified : tuple of str
        Parameters of which the readings say hardly more than was known before.
    near_u : dict
        The part of `u` that is around the values; beyond it others do the same to all readings.
    leaps : tuple of dict
        Independent changes, one standard uncertainty each, that those others make up.
    """

    values: dict
    u: dict
    interval_95: dict = field(default_factory=dict)
    weakly_identified: tuple[str, ...] = ()
    near_u: dict = field(default_factory=dict)
    leaps: tuple[dict[str, float], ...] = ()


def fitted_values(fit: JointFit, k: int) -> dict:
    """The parameters of term k of a fit alone."""
    if fit.terms[k].effect.corrects_table:
        return component_parameters(fit, k, fit.posterior.base.survey.paths[0])[0]
    return fit.parameters(k)


def fitted_parameters(
    fit: JointFit, k: int, sizes: Sequence[Otherwise], others: Sequence[Otherwise] = ()
) -> FittedParameters:
    """The parameters of term k of a fit.

    Parameters
    ----------
    fit : JointFit
    k : int
    sizes, others : sequence of Otherwise
        What it is beside members of other sizes, and beside other effects, that are possible.
    """
    if fit.terms[k].effect.corrects_table:
        path = fit.posterior.base.survey.paths[0]
        return FittedParameters(*component_parameters(fit, k, path))
    values, alike = fit.parameters(k), alike_parameters(fit, k)
    near = parameter_uncertainty(fit, k, others, sizes)
    spreads = {
        name: _over(spread, values[name], [other[name] for other in alike])
        for name, spread in near.items()
    }
    return FittedParameters(
        values=values,
        u={name: spread.u for name, spread in spreads.items()},
        interval_95={name: (spread.low, spread.high) for name, spread in spreads.items()},
        weakly_identified=tuple(name for name, spread in spreads.items() if not spread.is_shown),
        near_u={name: spread.u for name, spread in near.items()},
        leaps=_leaps(values, alike),
    )


def alike_parameters(fit: JointFit, k: int) -> tuple[dict[str, float], ...]:
    """Other parameters of term k of a fit that do the same to all readings."""
    term = fit.terms[k]
    if term.effect.corrects_table:
        return ()
    paths = fit.posterior.base.survey.paths
    return tuple(term.effect.alike(paths, term.target, fit.parameters(k)))


def _over(spread: Spread, value: float, others: Sequence[float]) -> Spread:
    """A spread over other values that are as probable as the one stated."""
    away = np.subtract(others, value)
    if not len(away) or np.allclose(away, 0.0):
        return spread
    u = float(np.sqrt(spread.u**2 + np.sum(away**2) / (1.0 + len(away))))
    return Spread(u, min(spread.low, *others), max(spread.high, *others), is_shown=False)


def _leaps(
    values: Mapping[str, float], others: Sequence[Mapping[str, float]]
) -> tuple[dict[str, float], ...]:
    """Independent changes whose squares are the variance over values as probable as those stated.

    Source: JCGM 100:2008 (GUM), eq. 13; derived here: changes along the principal axes of a
    covariance are independent.
    """
    names = list(values)
    away = np.array([[other[name] - values[name] for name in names] for other in others])
    if not away.size:
        return ()
    _, lengths, axes = np.linalg.svd(away / np.sqrt(1.0 + len(others)), full_matrices=False)
    moved = lengths > _STILL * lengths.max()
    rows = lengths[moved, None] * axes[moved]
    return tuple(dict(zip(names, row, strict=True)) for row in rows.tolist())
