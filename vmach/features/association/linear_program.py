"""Small linear programs with very many rows, solved by a growing set of them.

Source: cutting planes (row generation) over the dual simplex method of HiGHS; the duals are the
sensitivities of the optimum to the right hand sides (LP duality).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Optimum", "least_width", "solve"]

#: rows taken into the program in one round
_ROWS = 60
#: rounds; every round adds rows, and a few suffice
_ROUNDS = 200


@dataclass(frozen=True)
class Optimum:
    """A solution: `x` (V,), and `weight` (M,), the change of cost with each right hand side."""

    x: np.ndarray
    weight: np.ndarray


def solve(
    cost: np.ndarray, rows: np.ndarray, right: np.ndarray, bound: np.ndarray | None = None
) -> Optimum:
    """Minimise ``cost . x`` with ``rows x >= right``.

    Parameters
    ----------
    cost : (V,) array
    rows : (M, V) array
    right : (M,) array
    bound : (V,) array, optional
        Largest absolute value of every variable; infinite where left out.

    Raises
    ------
    ArithmeticError
        The program is unbounded or has no solution.
    """
    from scipy.optimize import linprog  # late: commands without features do not wait for it

    # all numbers of order one, since the solver's tolerances are absolute
    unit = float(np.abs(right).max(initial=0.0)) or 1.0
    right = right / unit
    limits = [(None, None)] * len(cost) if bound is None else [(-b / unit, b / unit) for b in bound]
    chosen = _first_rows(rows, right)
    options = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    for _ in range(_ROUNDS):
        found = linprog(
            cost, A_ub=-rows[chosen], b_ub=-right[chosen], bounds=limits, method="highs-ds",
            options=options,
        )  # fmt: skip
        if found.status != 0:
            if len(chosen) == len(rows):
                raise ArithmeticError(found.message)
            chosen = np.union1d(chosen, np.arange(0, len(rows), max(len(rows) // 500, 1)))
            if found.status != 3 and len(chosen) > 400:
                chosen = np.arange(len(rows))
            continue
        missing = right - rows @ found.x
        missing[chosen] = -np.inf
        broken = np.flatnonzero(missing > 1e-11)
        if broken.size == 0:
            break
        worst = broken[np.argsort(-missing[broken], kind="stable")[:_ROWS]]
        chosen = np.union1d(chosen, worst)
    weight = np.zeros(len(rows))
    weight[chosen] = -found.ineqlin.marginals
    return Optimum(found.x * unit, weight)


def _first_rows(rows: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Rows that matter most likely: extreme in every column, and the largest right hand sides."""
    if len(rows) <= 4 * _ROWS:
        return np.arange(len(rows))
    extreme = [f(rows[:, k]) for k in range(rows.shape[1]) for f in (np.argmin, np.argmax)]
    spread = np.linspace(0, len(rows) - 1, _ROWS).astype(int)
    return np.unique(np.r_[extreme, spread, np.argsort(-right, kind="stable")[:_ROWS]])


def least_width(value: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """Coefficients that make ``value - rows c`` as narrow as can be, the width, its weights.

    Parameters
    ----------
    value : (N,) array
    rows : (N, K) array
        A constant is always allowed too.
    """
    ones = np.ones((len(value), 1))
    table = np.hstack([rows, ones, ones])
    other = np.hstack([-rows, -ones, ones])
    cost = np.r_[np.zeros(rows.shape[1] + 1), 1.0]
    found = solve(cost, np.vstack([table, other]), np.r_[value, -value])
    above, below = np.split(found.weight, 2)
    return found.x[: rows.shape[1]], 2.0 * float(found.x[-1]), 2.0 * (above - below)
