"""Monte Carlo for predicted deviations of surface points.

Source: JCGM 101:2008, clauses 5 to 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.base.stage_clock import Progress, silent
from vmach.effects import Circumstances, EffectInstance
from vmach.effects.correlated import acting_together
from vmach.machine import Variant
from vmach.prediction import Prediction
from vmach.uncertainty.corrections import Corrections, Part
from vmach.uncertainty.monte_carlo import Drawn, Plan, propagate
from vmach.uncertainty.tables import TableUncertainty

__all__ = [
    "PointsDrawn",
    "draw_points",
    "parameters_part",
    "point_corrections",
    "point_parts",
]

#: points whose corrections are looked at together; a few hundred causes each
_BATCH = 2000


@dataclass(frozen=True)
class PointsDrawn:
    """Deviations of the C points that were cut, under all corrections.

    Attributes
    ----------
    drawn : Drawn
        mm.
    first_order_u_mm : (C,) float64
    share : mapping of label to (C,) float64
        Of the variance of first order; those of a point add up to 1.
    plan : Plan
    """

    drawn: Drawn
    first_order_u_mm: np.ndarray
    share: dict[str, np.ndarray]
    plan: Plan

    def ranked(self) -> list[tuple[str, float]]:
        """Contributors by their mean share over all points, the largest first."""
        mean = {label: float(share.mean()) for label, share in self.share.items() if len(share)}
        return sorted(mean.items(), key=lambda one: -one[1])

    def largest(self) -> np.ndarray:
        """The contributor with the largest share at each point, (C,) str."""
        labels = np.array([*self.share, ""])
        if not self.share:
            return np.full(len(self.first_order_u_mm), "")
        return labels[np.argmax(np.stack(list(self.share.values())), axis=0)]


def draw_points(prediction: Prediction, plan: Plan, *, progress: Progress = silent) -> PointsDrawn:
    """Propagate all corrections to the deviation of every point that was cut."""
    count = int(prediction.is_cut.sum())
    deviation = prediction.deviation_mm[prediction.is_cut]
    size = min(_BATCH, plan.points_at_once())
    parts, u, shares = [], [], []
    for start in range(0, count, size):
        rows = np.arange(start, min(start + size, count))
        corrections = point_corrections(prediction, rows)
        few, here = corrections.for_drawing(), deviation[rows, None]
        parts.append(
            propagate(
                lambda random, m, c=few, y=here: y + c.values_mm(c.draw(random, m)),
                plan,
                first_order=(deviation[rows], corrections.u_mm),
            )
        )
        u.append(corrections.u_mm)
        shares.append(corrections.variance_by_label())
        progress("draw", int(rows[-1]) + 1, count)
    return PointsDrawn(
        Drawn.joined(parts) if parts else _nothing(),
        np.concatenate([*u, np.zeros(0)]),
        _joined_shares(shares, [len(one) for one in u]),
        plan,
    )


def point_corrections(prediction: Prediction, rows: np.ndarray) -> Corrections:
    """Corrections of some of the points that were cut, by their index (K,) among these."""
    return Corrections.of(point_parts(prediction, rows), len(rows))


def point_parts(prediction: Prediction, rows: np.ndarray) -> list[Part]:
    """The same, part by part; every set of points has the same columns."""
    states, normals = prediction.states[rows], prediction.normals[prediction.is_cut][rows]
    job = prediction.preparation.job
    path = Circumstances(states, job, prediction.variant)
    parts: list[Part] = []
    if prediction.variant is not Variant.NONE:
        tables = TableUncertainty.of(job.machine)
        for cause, own in tables.signatures(path, normals):
            parts.append(Part(cause.label, own, cause.pool))
    for group in acting_together(prediction.effects):
        for effect in group:
            law = np.einsum("pi,pik->pk", normals, effect.unforeseen(path))
            parts.append(Part(f"{effect.label} law", law))
        parts.append(parameters_part(group, path, normals))
    return parts


def parameters_part(
    group: Sequence[EffectInstance], path: Circumstances, normals: np.ndarray
) -> Part:
    """What the corrections of parameters do along `normals` (P, 3), to second order.

    Parameters
    ----------
    group : sequence of EffectInstance
        One, or those whose parameters are correlated: their shares cannot be told apart.
    path : Circumstances
    normals : (P, 3) array
    """
    parts = [_of_parameters(effect, path, normals) for effect in group]
    straight = np.sum([straight for straight, _ in parts], axis=0)
    curved = [bent for _, bent in parts if bent is not None]
    label = ", ".join(effect.label for effect in group) + " parameters"
    return Part(label, straight, curved_mm=np.sum(curved, axis=0) if curved else None)


def _of_parameters(
    effect: EffectInstance, path: Circumstances, normals: np.ndarray
) -> tuple[np.ndarray, np.ndarray | None]:
    """What each change does, (P, K), and each two together beyond that, (P, K, K) or None."""
    count = len(effect.one_sigma)
    unit = np.eye(count)
    moving = [k for k, change in enumerate(effect.one_sigma) if change]

    def sensed(moved: np.ndarray) -> np.ndarray:
        return np.einsum("pi,pi...->p...", normals, moved)

    def at(*steps: np.ndarray) -> np.ndarray:
        return sensed(effect.at_parameters(path, sum(steps, np.zeros(count))))

    if effect.is_straight:
        return sensed(effect.of_parameters(path)), None
    here = at()
    up, down = ({k: at(sign * unit[k]) for k in moving} for sign in (1.0, -1.0))
    straight = np.zeros((len(path), count))
    curved = np.zeros((len(path), count, count))
    for i, k in enumerate(moving):
        straight[:, k] = 0.5 * (up[k] - down[k])
        curved[:, k, k] = 0.5 * (up[k] + down[k]) - here
        for other in moving[:i]:
            both = at(unit[k], unit[other])
            curved[:, k, other] = both - up[k] - up[other] + here
    if not (np.isfinite(straight).all() and np.isfinite(curved).all()):
        # one standard uncertainty leaves what the law can say: its tangents are all there is
        return sensed(effect.of_parameters(path)), None
    return straight, curved


def _joined_shares(
    variances: Sequence[dict[str, np.ndarray]], counts: Sequence[int]
) -> dict[str, np.ndarray]:
    labels = dict.fromkeys(label for one in variances for label in one)
    blank = [np.zeros(count) for count in counts]
    total = [sum(one.values(), zero) for one, zero in zip(variances, blank, strict=True)]
    return {
        label: np.concatenate([
            one.get(label, zero) / np.where(whole > 0.0, whole, 1.0)
            for one, whole, zero in zip(variances, total, blank, strict=True)
        ])
        for label in labels
    }  # fmt: skip


def _nothing() -> Drawn:
    empty = np.zeros(0)
    return Drawn(empty, empty, empty, empty, np.zeros(0, int), np.zeros(0, bool),
                 np.zeros(0, np.int8))  # fmt: skip
