"""The fitted correction of a component as a curve over its axis, and what is open about it."""

from __future__ import annotations

import numpy as np

from vmach.effects import Circumstances
from vmach.fit.terms import JointFit, Term
from vmach.machine.component_errors import component_of

__all__ = ["component_directions", "component_parameters"]

#: changes of a curve with less than this share of the largest variance are not worth a line
_NOTABLE = 0.003


def component_parameters(
    fit: JointFit, k: int, path: Circumstances
) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """Correction curve of a component, and its standard uncertainty, at positions in use."""
    term, target = fit.terms[k], fit.terms[k].target
    root, position = _curve_in_use(term, path)
    value = root @ fit.coefficients[k]
    u = np.sqrt(np.einsum("ij,jk,ik->i", root, fit.covariance[k], root))
    key = _correction(target)
    rounded = {
        "position_mm": np.round(position, 3).tolist(),
        key: np.round(value, 4).tolist(),
    }
    return rounded, {key: np.round(u, 4).tolist()}


def component_directions(
    fit: JointFit, k: int, path: Circumstances
) -> tuple[list[dict], np.ndarray]:
    """Independent changes of a component's correction, one standard uncertainty each.

    Returns
    -------
    list of dict
        The D changes.
    (D, K) float64
        What the fitted coefficients make of each of them, in its standard uncertainty.
    """
    root, _ = _curve_in_use(fit.terms[k], path)
    squared, axes = np.linalg.eigh(root @ fit.covariance[k] @ root.T)
    notable = squared > _NOTABLE * squared.max()
    u, axes = np.sqrt(squared[notable]), axes[:, notable].T
    changes = [
        {_correction(fit.terms[k].target): np.round(c, 4).tolist()} for c in axes * u[:, None]
    ]
    return changes, axes @ root / u[:, None]


def _curve_in_use(term: Term, path: Circumstances) -> tuple[np.ndarray, np.ndarray]:
    """From coefficients of a component to its correction, (N, K), at positions in use (N,)."""
    effect, target = term.effect, term.target
    assert effect.corrects_table
    root = effect.curve(path, target, **term.inner)
    knots = effect.knots_mm(path, target)
    position = path.nose_mm[:, component_of(target)[1]]
    step = knots[1] - knots[0]
    used = (knots > position.min() - step) & (knots < position.max() + step)
    return root[used], knots[used]


def _correction(target: str) -> str:
    return "correction_urad" if component_of(target)[2] else "correction_um"
