"""Machines of known truth, measured with known noise: how often an interval holds the truth.

The truth is drawn, a laser with noise, a wrong scale and misplaced reflectors measures it, and
the part is predicted from what was measured.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tests.small_job import POCKET_MM, write_job
from vmach.job import read_job
from vmach.machine import Machine, Variant
from vmach.machine.from_arrays import machine_from_arrays
from vmach.machine.measuring_uncertainty import MeasuringUncertainty
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.path.preparation import Preparation, prepare
from vmach.prediction import Prediction, displacement_of, predict_surface

TRAVEL_MM = {"X": (-400.0, 0.0), "Y": (-300.0, 0.0), "Z": (-300.0, 0.0)}
#: standard deviations: of one reading in one direction, of what the surveyor and the square do
READING_UM, READING_URAD, PLACE_MM, SCALE_UM_PER_M, SQUARE_URAD = 0.8, 0.8, 3.0, 2.0, 2.0
STATED = MeasuringUncertainty(
    squareness_rad=1e-6 * SQUARE_URAD,
    positioning_share=1e-6 * SCALE_UM_PER_M,
    measured_at_mm=PLACE_MM,
)
COMPONENTS = [f"E{kind}{axis}" for axis in "XYZ" for kind in "XYZABC"]
SQUARES = ("EC0Y", "EB0X", "EA0Y")


@dataclass(frozen=True)
class Trial:
    """One simulated machine: what was predicted from its measurement, and what is true, mm."""

    predicted: Prediction
    true_mm: np.ndarray


@dataclass(frozen=True)
class Workshop:
    """A small job, the points to look at, and where the tables have their positions."""

    preparation: Preparation
    points: SurfacePoints
    knots: dict[str, np.ndarray]
    perfect: Prediction


def workshop(folder: Path, *, at_positions: bool) -> Workshop:
    """Points of the small job; every tool position there is one of the tables, if asked for."""
    job = read_job(write_job(folder))
    preparation = prepare(job)
    points = read_points_csv(folder / "points.csv")
    rows = np.arange(0, len(points), 7)
    flat = np.abs(points.normal[rows]).max(axis=1) == 1.0  # the pocket, where X or Y stands
    rows = rows[flat & (np.abs(points.point_mm[rows, 0]) <= POCKET_MM[0] / 2)]
    points = replace(
        points, id=points.id[rows], feature=points.feature[rows], measured_mm=None,
        point_mm=points.point_mm[rows], normal=points.normal[rows], u_mm=None, line=None,
    )  # fmt: skip
    perfect = predict_surface(preparation, points, Variant.NONE)
    assert perfect.is_cut.all()
    nose = perfect.states.nose_mm
    knots = {axis: np.arange(low, high + 1.0, 25.0) for axis, (low, high) in TRAVEL_MM.items()}
    if at_positions:
        for k, axis in enumerate("XYZ"):
            both = np.unique(np.round(np.append(knots[axis], nose[:, k]), 9))
            knots[axis] = both[np.append(True, np.diff(both) > 1e-6)]
    return Workshop(preparation, points, knots, perfect)


def trials(
    place: Workshop, count: int, seed: int, *, smooth: bool = False, by_engine: bool = True
) -> Iterator[Trial]:
    """Simulated machines, one after the other.

    `smooth` makes true curves that bend between the positions of the tables; otherwise they are
    straight there. The removal engine cuts every machine's part; without it the contacts of the
    perfect part are moved, which is the same but for the second order of some um.
    """
    for number in range(count):
        random = np.random.Generator(np.random.Philox(np.random.SeedSequence([seed, number])))
        true, measured = _machines(place, random, smooth=smooth)
        if by_engine:
            made, predicted = (
                predict_surface(_on(place, m), place.points, Variant.ABBE) for m in (true, measured)
            )
        else:
            made, predicted = (_moved(place, m) for m in (true, measured))
        yield Trial(predicted, made.deviation_mm[made.is_cut])


def _moved(place: Workshop, machine: Machine) -> Prediction:
    """The perfect part's points, moved by what the machine does at their contacts."""
    perfect = place.perfect
    moved = displacement_of(_on(place, machine), perfect.states, Variant.ABBE, ())
    along = np.einsum("ij,ij->i", moved.at(perfect.states.contact_mm), perfect.normals)
    return replace(
        perfect, variant=Variant.ABBE, preparation=_on(place, machine),
        deviation_mm=perfect.deviation_mm + along,
    )  # fmt: skip


def _on(place: Workshop, machine: Machine) -> Preparation:
    return replace(place.preparation, job=replace(place.preparation.job, machine=machine))


def _machines(
    place: Workshop, random: np.random.Generator, *, smooth: bool
) -> tuple[Machine, Machine]:
    scale = SCALE_UM_PER_M * random.standard_normal()
    true, measured, true_at, said_at = {}, {}, {}, {}
    for name in COMPONENTS:
        knots = place.knots[name[2]]
        angle = name[1] in "ABC"
        dense = np.unique(np.append(knots, np.arange(knots[0], knots[-1], 2.0)))
        wave = _curve(dense if smooth else knots, random)
        value = np.interp(knots, dense if smooth else knots, wave)
        true[name] = (dense if smooth else knots, wave)
        noise = READING_URAD if angle else READING_UM
        both = value + noise * random.standard_normal((2, len(knots)))
        if name[1] == name[2]:  # the laser's millimetre is wrong
            both = both - 1e-3 * scale * (knots - knots[0])
        measured[name] = (knots, both[0] + 1.0, both[1] - 1.0)
        if not angle:
            said_at[name] = np.array([20.0, -30.0, -150.0])
            true_at[name] = said_at[name] + PLACE_MM * random.standard_normal(3)
    square = {name: 10.0 * random.standard_normal() for name in SQUARES}
    said = {name: value + SQUARE_URAD * random.standard_normal() for name, value in square.items()}
    make = {"travel_mm": TRAVEL_MM}
    return (
        machine_from_arrays("true", errors=true, measured_at_mm=true_at, squareness_urad=square,
                            **make),
        replace(machine_from_arrays("measured", errors=measured, measured_at_mm=said_at,
                                    squareness_urad=said, **make), uncertainty=STATED),
    )  # fmt: skip


def _curve(position: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A wave of some um or urad over the travel."""
    amplitude, phase = random.normal(0.0, 4.0, 3), random.uniform(0.0, 2 * np.pi, 3)
    angle = np.multiply.outer(position / 400.0, 2 * np.pi * np.arange(1, 4)) + phase
    return np.sin(angle) @ amplitude
