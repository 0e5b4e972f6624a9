"""Coverage intervals by Monte Carlo (JCGM 101)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.api.records import Rows
from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.job import Job
from vmach.machine import Machine, Variant
from vmach.machine.variant_name import variant_called
from vmach.nominal.points import SurfacePoints
from vmach.plausibility import admitted_machine
from vmach.run.pipeline import predict_points
from vmach.uncertainty.monte_carlo import Plan
from vmach.uncertainty.point_figures import drawn_notes
from vmach.uncertainty.points import draw_points
from vmach.uncertainty.recut import recut
from vmach.uncertainty.volumetric import AccuracyDrawn, draw_accuracy
from vmach.volumetric.field import error_field, measured_volume

__all__ = ["PointIntervals", "accuracy_interval", "predict_intervals"]


@dataclass(frozen=True)
class PointIntervals(Rows):
    """Coverage intervals of P predicted deviations; NaN where no tool made the surface.

    Attributes
    ----------
    id : (P,) str
    deviation_um, u_um : (P,) float64
        Prediction and standard uncertainty of first order.
    u_drawn_um, low_um, high_um : (P,) float64
        Standard uncertainty and shortest interval of the draws.
    largest_contributor : (P,) str
    contributors : dict of label to float
        Mean share of the variance over all points, the largest first.
    draws : int
        Of the point that took most.
    notes : tuple of Note
    """

    id: np.ndarray
    deviation_um: np.ndarray
    u_um: np.ndarray
    u_drawn_um: np.ndarray
    low_um: np.ndarray
    high_um: np.ndarray
    largest_contributor: np.ndarray
    contributors: dict[str, float]
    draws: int
    notes: tuple[Note, ...] = ()

    def __len__(self) -> int:
        return len(self.id)


def predict_intervals(
    job: Job | str | Path,
    points: SurfacePoints | str | Path,
    *,
    program: str | Path | None = None,
    model: str = Variant.ABBE,
    coverage: float = 0.95,
    digits: int = 1,
    most_draws: int = 1_000_000,
    seed: int = 1,
) -> PointIntervals:
    """Coverage intervals of predicted deviations, from draws of all corrections.

    Parameters
    ----------
    job, points, program, model
        As in `predict`.
    coverage : float
        Probability of the intervals.
    digits : int
        Significant digits of the uncertainty that are to stand.
    most_draws : int
    seed : int

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError

    Examples
    --------
    >>> import vmach
    >>> points = vmach.surface_points([[50.0, 0.0, -3.0]], [1.0, 0.0, 0.0])
    >>> found = vmach.predict_intervals("samples/iso10791_7", points)
    >>> bool(found.low_um[0] < found.deviation_um[0] < found.high_um[0])
    True
    """
    plan = Plan(digits=digits, coverage=coverage, most_draws=most_draws, seed=seed)
    known, prediction = predict_points(
        job, points, program_path=program, variant=variant_called(model)
    )
    found, again = draw_points(prediction, plan), recut(known, prediction, plan)
    cut = prediction.is_cut

    def spread(values_mm: np.ndarray) -> np.ndarray:
        full = np.full(len(cut), np.nan)
        full[cut] = um_from_mm(values_mm)
        return full

    largest = np.full(len(cut), "", dtype=object)
    largest[cut] = found.largest()
    drawn = found.drawn
    return PointIntervals(
        known.id,
        spread(prediction.deviation_mm[cut]),
        spread(found.first_order_u_mm),
        spread(drawn.u),
        spread(drawn.low),
        spread(drawn.high),
        largest.astype(str),
        dict(found.ranked()),
        int(drawn.draws.max(initial=0)),
        (*prediction.preparation.notes, *known.notes, *drawn_notes(found, again, known.id)),
    )


def accuracy_interval(
    machine: Machine | str | Path,
    *,
    tool_length_mm: float = 0.0,
    model: str = Variant.ABBE,
    grid: tuple[int, int, int] = (21, 21, 21),
    coverage: float = 0.95,
    digits: int = 1,
    most_draws: int = 1_000_000,
    seed: int = 1,
) -> AccuracyDrawn:
    """Volumetric accuracy with its coverage interval, from draws of all corrections.

    Parameters
    ----------
    machine, tool_length_mm, model, grid
        As in `accuracy`.
    coverage, digits, most_draws, seed
        As in `predict_intervals`.

    Raises
    ------
    InputError

    Examples
    --------
    >>> import vmach
    >>> machine = vmach.read_machine("samples/iso10791_7/machine.toml")
    >>> found = vmach.accuracy_interval(machine, grid=(3, 3, 3))
    >>> found.candidates <= 27
    True
    """
    known = machine if isinstance(machine, Machine) else admitted_machine(machine)
    plan = Plan(digits=digits, coverage=coverage, most_draws=most_draws, seed=seed)
    tool_mm, variant = np.array([0.0, 0.0, -tool_length_mm]), variant_called(model)
    field = error_field(known, measured_volume(known, grid), tool_mm, variant)
    return draw_accuracy(known, field, tool_mm, variant, plan)
