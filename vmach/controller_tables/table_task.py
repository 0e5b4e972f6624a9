"""What tables are made for: a machine's whole volume, or one job's program."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.base.note import Note, in_file
from vmach.controller_tables.knots import Knots, choose_intervals
from vmach.controller_tables.samples import (
    ErrorSamples,
    job_samples,
    joined,
    lattice_samples,
    volume_samples,
)
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import LINEAR_AXES, Machine, Variant
from vmach.path.preparation import prepare
from vmach.plausibility import doubts, machine_notes
from vmach.volumetric.field import Volume, measured_volume

__all__ = ["TableTask", "task_of_job", "task_of_machine"]

#: weight of the volume beside a program: it decides only where the program never goes
_VOLUME_SHARE = 1e-6
#: entries of the other axes that samples over the volume stand on
_ACROSS, _ACROSS_BESIDE_PROGRAM = 32, 8
_CHECK_COUNTS = (23, 23, 23)
#: node spacing along a program for the fit and, another one, for the check
_FIT_SPACING_MM, _CHECK_SPACING_MM = 1.0, 1.3


@dataclass(frozen=True)
class TableTask:
    """A machine, where its error counts, and how well it is to be met.

    Attributes
    ----------
    machine : Machine
    variant : Variant
    volume : Volume
        Measured part of the travel; the tables span it.
    tool_mm : (3,) float64
        Vector from nose to tip over the volume; for a job the longest of its tools.
    tolerance_mm : float
        Of straight lines between entries.
    check : ErrorSamples
        Where the result is judged, not where it is fitted.
    program : ErrorSamples or None
        The job's program, to fit to.
    has_effects : bool
        Whether the job has effects beside the error tables.
    notes : tuple of Note
        What the user should know of machine and job before loading the tables.
    inputs : tuple of Path
        Files that it was made from; no table may replace one.
    """

    machine: Machine
    variant: Variant
    volume: Volume
    tool_mm: np.ndarray
    tolerance_mm: float
    check: ErrorSamples
    program: ErrorSamples | None = None
    has_effects: bool = False
    notes: tuple[Note, ...] = ()
    inputs: tuple[Path, ...] = ()

    @property
    def by_direction(self) -> bool:
        """Whether the error may depend on the direction of motion."""
        return self.machine.separate_directions or self.has_effects

    @property
    def tool_length_mm(self) -> float:
        """Length of the tool that the volume is looked at with."""
        return -float(self.tool_mm[2])

    def knots(self, most_entries: int, finer: int = 1) -> tuple[Knots, Knots, Knots]:
        """Positions of entries along X, Y, Z: within tolerance if the limit allows, and `finer`
        times as many."""
        low, high = self.volume.low_mm, self.volume.high_mm
        found = []
        for axis in range(3):
            ends = (float(low[axis]), float(high[axis]))
            intervals = choose_intervals(
                self.machine, axis, ends, limit=most_entries - 1, tolerance_mm=self.tolerance_mm
            )
            found.append(Knots.over(*ends, min(finer * intervals, most_entries - 1)))
        return tuple(found)

    def fit_samples(self, knots: tuple[Knots, Knots, Knots]) -> ErrorSamples:
        """Samples dense enough for tables with these entries."""
        across = _ACROSS if self.program is None else _ACROSS_BESIDE_PROGRAM
        volume = volume_samples(
            self.machine, self.volume, self.tool_mm, self.variant, knots=knots, most_across=across
        )
        return self._with_program(volume)

    def grid_samples(self, knots: tuple[Knots, Knots, Knots]) -> ErrorSamples:
        """Samples dense enough for a grid with these positions."""
        counts = tuple(2 * one.intervals + 1 for one in knots)
        return self._with_program(
            lattice_samples(
                self.machine, replace(self.volume, counts=counts), self.tool_mm, self.variant,
                both_ways=False,
            )
        )  # fmt: skip

    def longer_tool(self, by_mm: float) -> ErrorSamples | None:
        """The check over the volume with a longer tool; None for a job, whose tools are given."""
        if self.program is not None:
            return None
        tool = self.tool_mm - [0.0, 0.0, by_mm]
        return _check(self.machine, self.volume, tool, self.variant)

    def _with_program(self, volume: ErrorSamples) -> ErrorSamples:
        return volume if self.program is None else joined(self.program, volume, _VOLUME_SHARE)


def task_of_machine(
    machine: Machine, variant: Variant, *, tool_length_mm: float, tolerance_mm: float
) -> TableTask:
    """Tables for the whole measured volume, the mean error of every place counting the same."""
    _check_machine(machine)
    volume = measured_volume(machine, _CHECK_COUNTS)
    tool = np.array([0.0, 0.0, -tool_length_mm])
    check = _check(machine, volume, tool, variant)
    doubtful = doubts(machine_notes(machine))
    notes = in_file(doubtful, machine.files[0]) if machine.files else ()
    return TableTask(
        machine, variant, volume, tool, tolerance_mm, check, notes=notes, inputs=machine.files
    )


def task_of_job(job: Job, variant: Variant, *, tolerance_mm: float) -> TableTask:
    """Tables for one program, its tools and the effects of its job."""
    _check_machine(job.machine)
    preparation = prepare(job, spacing_mm=_FIT_SPACING_MM)
    program = job_samples(preparation, variant)
    return TableTask(
        machine=job.machine,
        variant=variant,
        volume=measured_volume(job.machine, _CHECK_COUNTS),
        tool_mm=program.tool_mm[np.argmin(program.tool_mm[:, 2])],
        tolerance_mm=tolerance_mm,
        check=job_samples(prepare(job, spacing_mm=_CHECK_SPACING_MM), variant),
        program=program,
        has_effects=bool(job.effects),
        notes=preparation.notes,
        inputs=tuple(path for _, path in job.files()),
    )


def _check(machine: Machine, volume: Volume, tool_mm: np.ndarray, variant: Variant) -> ErrorSamples:
    return lattice_samples(machine, replace(volume, counts=_CHECK_COUNTS), tool_mm, variant)


def _check_machine(machine: Machine) -> None:
    if machine.rotary:
        raise InputError(
            f"machine '{machine.name}' has the rotary axes {' '.join(machine.rotary)}",
            accepted=f"a chain of {', '.join(LINEAR_AXES)} alone",
            hint="the tables know nothing of rotary axes; leave them out of a copy of the file",
        )
