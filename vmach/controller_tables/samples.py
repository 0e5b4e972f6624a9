"""Where the error of the tool tip is looked at: over the volume, or along a job's program.

Source: the trapezoidal rule; the equations of `vmach.machine.displacement`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode import MoveKind
from vmach.controller_tables.knots import Knots
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.machine import Machine, Variant, contributions, displacement
from vmach.path.preparation import Preparation
from vmach.prediction import of_machine
from vmach.volumetric.field import Volume

__all__ = ["ErrorSamples", "job_samples", "joined", "lattice_samples", "volume_samples"]


@dataclass(frozen=True)
class ErrorSamples:
    """States of the machine, and the error of the tool tip in each.

    Attributes
    ----------
    nose_mm : (P, 3) float64
        Axis positions q.
    direction : (P, 3) float64
        Sign of the last motion of every axis, 0 where not known.
    tool_mm : (P, 3) float64
        Vector from nose to tip.
    error_mm : (P, 3) float64
        Actual minus nominal, in machine axes.
    weight : (P,) float64
        Of the squared error in a fit and in a mean; adds up to 1.
    """

    nose_mm: np.ndarray
    direction: np.ndarray
    tool_mm: np.ndarray
    error_mm: np.ndarray
    weight: np.ndarray

    def __len__(self) -> int:
        return len(self.nose_mm)

    def of_components(self, machine: Machine, variant: Variant) -> dict[str, np.ndarray]:
        """Share of each component error and of the job's effects in `error_mm`, (P, 3) mm each."""
        shares = {
            name: part.shift_mm
            for name, part in contributions(
                machine, self.nose_mm, self.tool_mm, variant, direction=self.direction
            )
        }
        rest = self.error_mm - sum(shares.values(), np.zeros_like(self.error_mm))
        if np.abs(rest).max(initial=0.0) > 1e-9:
            shares["effects of the job"] = rest
        return shares


def volume_samples(
    machine: Machine,
    volume: Volume,
    tool_mm: np.ndarray,
    variant: Variant,
    *,
    knots: tuple[Knots, Knots, Knots],
    most_across: int,
) -> ErrorSamples:
    """Samples to fit tables to: twice as dense as the entries along each axis in turn, on the
    entries of the other two.

    Weights are those of the trapezoidal rule: means over an axis are exact where its curves are
    straight between the entries, so that no set of samples contradicts another. Of an axis with
    many entries only some count across.

    Parameters
    ----------
    machine : Machine
    volume : Volume
        Only its ends count; entries a rounding beyond them count there.
    tool_mm : (3,) float64
    variant : Variant
    knots : (Knots, Knots, Knots)
    most_across : int
        Entries of an axis that samples stand on while another axis is looked along.
    """
    across = [one.thinned(most_across).position_mm for one in knots]
    ways = (1.0, -1.0) if machine.separate_directions else (0.0,)
    nose, direction, weight = [], [], []
    for axis, one in enumerate(knots):
        lines = list(across)
        lines[axis] = np.linspace(*one.position_mm[[0, -1]], 2 * one.intervals + 1)
        place = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
        shares = np.meshgrid(*map(_trapezoidal, lines), indexing="ij")
        for way in ways:
            nose.append(np.clip(place, volume.low_mm, volume.high_mm))
            direction.append(np.where(np.arange(3) == axis, way, np.zeros_like(place)))
            weight.append(np.prod(shares, axis=0).ravel())
    return _samples_of(
        machine, np.vstack(nose), np.vstack(direction), np.concatenate(weight),
        tool_mm=tool_mm, variant=variant,
    )  # fmt: skip


def _trapezoidal(line_mm: np.ndarray) -> np.ndarray:
    """Weights of evenly spaced places, the ends half; they add up to 1."""
    weight = np.ones(len(line_mm))
    weight[[0, -1]] = 0.5
    return weight / weight.sum()


def lattice_samples(
    machine: Machine,
    volume: Volume,
    tool_mm: np.ndarray,
    variant: Variant,
    *,
    both_ways: bool = True,
) -> ErrorSamples:
    """Samples on the regular grid of a volume; `tool_mm` (3,) leads from nose to tip.

    With `both_ways`, and where the machine's tables keep the directions apart, every grid point
    counts in all eight combinations of directions; else directions are not known.
    """
    nose = np.stack(np.meshgrid(*volume.coordinates_mm, indexing="ij"), axis=-1).reshape(-1, 3)
    signs = np.zeros((1, 3))
    if both_ways and machine.separate_directions:
        signs = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    direction = np.repeat(signs, len(nose), axis=0)
    nose = np.tile(nose, (len(signs), 1))
    return _samples_of(
        machine, nose, direction, np.ones(len(nose)), tool_mm=tool_mm, variant=variant
    )


def job_samples(preparation: Preparation, variant: Variant) -> ErrorSamples:
    """Samples along a job's program while it feeds, by the length of path that each stands for;
    errors of the machine and effects of the job.

    Raises
    ------
    InputError, gcode.ProgramError
        The job cannot be run, or never feeds with a tool.
    """
    job = preparation.job
    effects = read_effects(job.effects, file=job.path, job=job)
    path = preparation.path
    first = path.first_node[path.nodes.moves.kind[path.piece_move] != MoveKind.RAPID]
    length = np.linalg.norm(path.nodes.nose_mm[first + 1] - path.nodes.nose_mm[first], axis=1)
    weight = np.zeros(len(path.nodes))
    np.add.at(weight, first, 0.5 * length)
    np.add.at(weight, first + 1, 0.5 * length)
    used = np.flatnonzero((weight > 0) & np.isfinite(path.nodes.tool_mm).all(axis=1))
    if len(used) == 0:
        raise InputError("the program never feeds with a tool", file=job.program)
    states = path.nodes[used]
    # a control's tables act while the zero is touched too: they take back the machine's own error
    error = of_machine(job.machine, states, variant, effects).shift_mm
    weight = weight[used] / weight[used].sum()
    return ErrorSamples(
        states.nose_mm, states.direction.astype(float), states.tool_mm, error, weight
    )


def joined(first: ErrorSamples, second: ErrorSamples, share: float) -> ErrorSamples:
    """Both sets, the second one with a `share` of the first one's weight."""
    columns = {
        name: np.concatenate([getattr(first, name), getattr(second, name)])
        for name in ("nose_mm", "direction", "tool_mm", "error_mm")
    }
    weight = np.concatenate([first.weight, share * second.weight]) / (1.0 + share)
    return ErrorSamples(**columns, weight=weight)


def _samples_of(
    machine: Machine,
    nose_mm: np.ndarray,
    direction: np.ndarray,
    weight: np.ndarray,
    *,
    tool_mm: np.ndarray,
    variant: Variant,
) -> ErrorSamples:
    tool = np.tile(tool_mm, (len(nose_mm), 1))
    way = direction if machine.separate_directions else None
    error = displacement(machine, nose_mm, tool, variant, direction=way).shift_mm
    return ErrorSamples(nose_mm, direction, tool, error, weight / weight.sum())
