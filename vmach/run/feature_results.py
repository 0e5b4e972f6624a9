"""What a drawing asks for, found on the predicted and on the measured part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vmach.base.note import Kind, Note
from vmach.base.units import um_from_mm
from vmach.errors import InputError
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Points
from vmach.features.measure import Measure
from vmach.features.result import FeatureResult, LineShare, Place, SourceShare, Value
from vmach.features.verdict import verdict, verdict_of
from vmach.job import Job
from vmach.nominal import NominalPart
from vmach.nominal.points import SurfacePoints
from vmach.prediction import Prediction
from vmach.prediction.error_budget import ErrorBudget
from vmach.report import InspectedPoints
from vmach.run.drawing import drawing_error, job_drawing
from vmach.uncertainty.first_order import combined_u_mm

if TYPE_CHECKING:
    from vmach.uncertainty.features import Evaluation, FeaturesDrawn
    from vmach.uncertainty.monte_carlo import Plan

__all__ = ["feature_results"]

#: NC lines that are named for each value
_LINES = 3
#: points of a feature that a flag may point at
_PLACES = 12


def feature_results(
    job: Job,
    nominal: NominalPart | None,
    points: SurfacePoints,
    inspected: InspectedPoints,
    prediction: Prediction,
    budget: ErrorBudget,
    plan: Plan | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[tuple[FeatureResult, ...], tuple[Note, ...]]:
    """Values of all requirements of the job's drawing, none where it has none, and notes.

    Parameters
    ----------
    inspected : InspectedPoints
        Deviations under every variant, and as measured.
    prediction : Prediction
        The primary one; uncertainty, shares and lines are its own.
    budget : ErrorBudget
        Of its cut points.
    plan : Plan, optional
        Draw the corrections of the prediction; to first order where left out.
    progress : callable, optional
        Told how many of how many draws were evaluated as a whole.

    Raises
    ------
    InputError
        A requirement that contradicts the CAD or its datums, or a feature without points.
    """
    drawing = job_drawing(job, nominal, points)
    if drawing is None:
        return (), ()
    judge = _Judge(drawing, inspected, prediction, budget)
    found = []
    for requirement in drawing.requirements:
        try:
            found += judge.results(requirement)
        except InputError as error:
            if requirement.source:
                found.append(judge.refused(requirement, error.what))
                continue
            said = f"tolerance {requirement.callout.text!r} of {requirement.feature!r}"
            raise drawing_error(job, error, "tolerances", requirement.feature, said) from None
    known = judge.with_uncertainty(found)
    return (tuple(known), ()) if plan is None else judge.with_draws(known, plan, progress)


class _Judge:
    """Evaluates requirements under every column."""

    def __init__(
        self,
        drawing: Drawing,
        inspected: InspectedPoints,
        prediction: Prediction,
        budget: ErrorBudget,
    ) -> None:
        self._drawing, self._inspected = drawing, inspected
        self._prediction, self._budget = prediction, budget
        self._parts = {
            column.name: Points(
                inspected.point_mm,
                inspected.normal,
                np.where(column.is_cut, column.deviation_mm, 0.0),
                column.is_cut,
            )
            for column in inspected.columns
        }
        self._nominal = Points.nominal(inspected.point_mm, inspected.normal)
        self._primary = inspected.primary.name
        # of every result: its weights, and which value of which requirement it is
        self._weights: list[np.ndarray] = []
        self._asked: list[tuple[Requirement, int]] = []

    def results(self, requirement: Requirement) -> list[FeatureResult]:
        """One result a value; uncertainty is added later, for all at once."""
        feature = self._drawing.feature(requirement.feature)
        if requirement.refused:
            return [self.refused(requirement, requirement.refused)]
        known = self._parts[self._primary].is_known
        rows = np.concatenate([member.rows for member in feature.members])
        if not known[rows].any():
            # a callout that contradicts the CAD is told although there is nothing to evaluate
            evaluate(self._drawing, requirement, self._nominal)
            return [self.refused(requirement, "no tool of the program makes it")]
        by_column = {
            name: evaluate(self._drawing, requirement, part) for name, part in self._parts.items()
        }
        return [
            self._one(requirement, k, measure, by_column)
            for k, measure in enumerate(by_column[self._primary])
        ]

    def refused(self, requirement: Requirement, reason: str) -> FeatureResult:
        """A result without a value."""
        self._asked.append((requirement, 0))
        self._weights.append(np.zeros(len(self._inspected)))
        return self._bare(requirement, reason)

    def _bare(self, requirement: Requirement, reason: str = "", **more) -> FeatureResult:
        callout = requirement.callout
        lower, upper = requirement.limits_mm
        return FeatureResult(
            feature=requirement.feature,
            callout=callout.text,
            characteristic=callout.characteristic,
            faces=self._drawing.feature(requirement.feature).faces,
            datums=callout.datums,
            nominal_mm=callout.nominal_mm if callout.is_size else 0.0,
            lower_mm=lower if callout.is_size else None,
            upper_mm=upper,
            primary=self._primary,
            reason=reason,
            unit=callout.zone,
            kind=self._drawing.feature(requirement.feature).kind,
            **more,
        )

    def _one(
        self,
        requirement: Requirement,
        number: int,
        measure: Measure,
        by_column: dict[str, list[Measure]],
    ) -> FeatureResult:
        weight = measure.spread(len(self._inspected))
        self._asked.append((requirement, number))
        self._weights.append(weight)
        values = {}
        for name, measures in by_column.items():
            one = measures[min(number, len(measures) - 1)]
            u = self._measured_u_mm(one) if name == "measured" else None
            limits = requirement.limits_mm
            values[name] = Value(one.value_mm, u, verdict(one.value_mm, u or 0.0, *limits))
        own = np.isin(np.arange(len(weight)), self._rows_of(requirement))
        return self._bare(
            requirement,
            label=measure.label,
            values=values,
            shares=self._shares(weight),
            lines=self._lines(weight * own),
            places=self._places(weight * own, np.flatnonzero(own & self._prediction.is_cut)),
        )

    def _places(self, weight: np.ndarray, rows: np.ndarray) -> tuple[Place, ...]:
        """The point that decides most, and some that are spread over the feature."""
        spread = rows[np.linspace(0, len(rows) - 1, _PLACES).astype(int)]
        chosen = dict.fromkeys([int(np.argmax(np.abs(weight))), *spread.tolist()])
        points, normals = self._inspected.point_mm, self._inspected.normal
        return tuple(Place(tuple(points[k].tolist()), tuple(normals[k].tolist())) for k in chosen)

    def _rows_of(self, requirement: Requirement) -> np.ndarray:
        feature = self._drawing.feature(requirement.feature)
        return np.concatenate([member.rows for member in feature.members])

    def _measured_u_mm(self, measure: Measure) -> float | None:
        """Uncertainty by that of the points, taken as independent; None where they state none."""
        if self._inspected.u_mm is None:
            return None
        weight = measure.spread(len(self._inspected))
        return float(np.linalg.norm(weight * self._inspected.u_mm))

    def _shares(self, weight: np.ndarray) -> tuple[SourceShare, ...]:
        share = weight[self._prediction.is_cut] @ self._budget.share_mm
        order = np.argsort(-np.abs(share), kind="stable")
        return tuple(SourceShare(self._budget.sources[k], float(share[k])) for k in order)

    def _lines(self, weight: np.ndarray) -> tuple[LineShare, ...]:
        chosen = np.flatnonzero(weight)
        if not chosen.size:
            return ()
        line = self._inspected.line[chosen]
        share = np.bincount(line, np.abs(weight[chosen]))
        total = share.sum()
        found = []
        for number in np.argsort(-share, kind="stable")[:_LINES].tolist():
            if share[number] > 0.0 and number > 0:
                tool = int(self._inspected.tool[chosen[line == number][0]])
                found.append(LineShare(number, tool, float(share[number] / total)))
        return tuple(found)

    def with_uncertainty(self, found: list[FeatureResult]) -> list[FeatureResult]:
        """The results with the uncertainty of the primary prediction, and its verdicts."""
        weights = np.array(self._weights)[:, self._prediction.is_cut]
        u_mm = combined_u_mm(self._prediction, weights)
        done = []
        for result, u in zip(found, u_mm.tolist(), strict=True):
            if not result.values:
                done.append(result)
                continue
            value = result.values[self._primary].value_mm
            lower = float("-inf") if result.lower_mm is None else result.lower_mm
            judged = Value(value, u, verdict(value, u, lower, result.upper_mm))
            done.append(replace(result, values={**result.values, self._primary: judged}))
        return done

    def with_draws(
        self,
        found: list[FeatureResult],
        plan: Plan,
        progress: Callable[[int, int], None] | None,
    ) -> tuple[tuple[FeatureResult, ...], tuple[Note, ...]]:
        """The results with intervals and verdicts of draws in place of first order."""
        from vmach.uncertainty.features import draw_features, prediction_parts

        shown = [k for k, result in enumerate(found) if result.values]
        if not shown:
            return tuple(found), ()
        limits = [
            (-np.inf if found[k].lower_mm is None else found[k].lower_mm, found[k].upper_mm)
            for k in shown
        ]
        drawn = draw_features(
            prediction_parts(self._prediction),
            self._inspected.primary.deviation_mm[self._prediction.is_cut],
            self._evaluation(shown),
            np.array(limits, float),
            plan,
            progress=progress,
        )
        done, told = list(found), drawn.drawn
        for place, k in enumerate(shown):
            value = found[k].values[self._primary]
            judged = Value(
                value.value_mm,
                float(told.u[place]),
                verdict_of(float(drawn.inside[place])),
                (float(told.low[place]), float(told.high[place])),
            )
            done[k] = replace(found[k], values={**found[k].values, self._primary: judged})
        doubtful = [found[k] for k, doubt in zip(shown, drawn.doubtful, strict=True) if doubt]
        return tuple(done), tuple(_doubts(doubtful, drawn))

    def _evaluation(self, shown: list[int]) -> Evaluation:
        """Values and weights of some results from the deviations of the points that were cut."""
        cut, count = self._prediction.is_cut, len(self._inspected)
        asked = [self._asked[k] for k in shown]
        requirements = list(dict.fromkeys(requirement for requirement, _ in asked))

        def evaluation(deviation_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            spread = np.zeros(count)
            spread[cut] = deviation_mm
            part = replace(self._parts[self._primary], deviation_mm=spread)
            found = {r: evaluate(self._drawing, r, part) for r in requirements}
            measures = [found[r][min(number, len(found[r]) - 1)] for r, number in asked]
            values = np.array([m.value_mm for m in measures])
            return values, np.array([m.spread(count)[cut] for m in measures])

        return evaluation


def _doubts(doubtful: list[FeatureResult], drawn: FeaturesDrawn) -> list[Note]:
    """What to know before trusting the intervals."""
    said = []
    if doubtful:
        which = "; ".join(f"{r.feature}: {r.title}" for r in doubtful[:_LINES])
        missed_um = um_from_mm(drawn.missed_mm.max())
        said.append(f"the intervals of {len(doubtful)} values may be off by up to {missed_um:.3g} "
                    f"um ({which})")  # fmt: skip
    open_ = int((~drawn.drawn.stands).sum())
    if open_:
        said.append(f"{open_} intervals of the drawing do not stand after "
                    f"{int(drawn.drawn.draws.max())} draws; --draws allows more")  # fmt: skip
    return [Note.plain(Kind.UNCERTAINTY, text) for text in said]
