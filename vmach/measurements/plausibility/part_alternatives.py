"""Predictions of a part under alternative assumptions: lengths, zeros, directions.

The tool goes where it went; only the errors there are asked for again, to first order.

Source: the equations of `vmach.machine.displacement`, to first order.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from gcode import WORK_OFFSETS
from vmach.errors import InputError
from vmach.machine import LINEAR_AXES, Machine, Variant, displacement
from vmach.measurements.measurement import Measurement
from vmach.measurements.plausibility.alternatives import Alternative, other_sign
from vmach.measurements.plausibility.table_mistakes import exchanged_directions, mistaken_tables
from vmach.path.preparation import Preparation
from vmach.plausibility import lengths_meant_mm

__all__ = ["part_alternatives"]


def part_alternatives(part: Measurement, preparation: Preparation) -> Iterator[Alternative]:
    """Predictions of measured points with one number of the job, or its tables, changed.

    Parameters
    ----------
    part : Measurement
        Points that the program cuts.
    preparation : Preparation
    """
    job, states = preparation.job, part.states
    nose_mm, tool_mm = states.nose_mm, states.tool_mm
    low, high = job.machine.travel_mm

    def errors_mm(machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray) -> np.ndarray:
        moved = displacement(machine, nose_mm, tool_mm, Variant.ABBE, direction=states.direction)
        return np.einsum("ij,ij->i", part.sensing, moved.at(states.contact_mm))

    here_mm = part.predicted_mm - errors_mm(job.machine, nose_mm, tool_mm)

    def elsewhere(
        what: str, question: str, shift_mm: np.ndarray, longer_mm: np.ndarray
    ) -> Iterator[Alternative]:
        nose = nose_mm + shift_mm + longer_mm
        if np.all((nose >= low) & (nose <= high)):
            with suppress(InputError):  # beyond a table
                yield Alternative(
                    what, question, here_mm + errors_mm(job.machine, nose, tool_mm - longer_mm)
                )

    still = np.zeros((len(part), 3))
    for number, tool in job.tools.items():
        for length_mm in lengths_meant_mm(tool.length_mm):
            longer = still.copy()
            longer[states.tool == number, 2] = length_mm - tool.length_mm
            question = f"is length_mm = {tool.length_mm:g} in the job right?"
            yield from elsewhere(f"tool {number} {length_mm:g} mm long", question, still, longer)
    for name, zero_mm in job.work_offsets_mm.items():
        own = states.moves.work_offset[states.move] == 1 + WORK_OFFSETS.index(name)
        for k, axis in enumerate(LINEAR_AXES):
            shift = still.copy()
            shift[own, k] = -2.0 * zero_mm[k]
            question = f"is the sign of {name} right in {axis}?"
            yield from elsewhere(f"{name} at {axis}{-zero_mm[k]:g}", question, shift, still)
    for mistake in exchanged_directions(job.machine):
        moved_mm = errors_mm(mistake.machine, nose_mm, tool_mm)
        yield Alternative(mistake.what, mistake.question, here_mm + moved_mm)
    yield other_sign(part)
    for mistake in mistaken_tables(job.machine):
        with suppress(InputError):  # a table of a shorter axis
            moved_mm = errors_mm(mistake.machine, nose_mm, tool_mm)
            yield Alternative(mistake.what, mistake.question, here_mm + moved_mm)
    if part.variation_mm(here_mm) > float(np.median(part.u_mm)):
        # the nominal points do not lie where the program cuts: what was read may
        yield Alternative(
            "the nominal and the measured places exchanged",
            "are x, y, z the nominal places, and mx, my, mz those that were measured?",
            here_mm - part.predicted_mm,
        )
