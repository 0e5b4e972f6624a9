"""The rigid chain of a task: the machine's errors, with a job's effects in its linear errors.

Source: least squares over the errors that `vmach.controller_tables.projection` describes; the
chain is that of ISO 10791-1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import Projection, Term
from vmach.controller_tables.rigid_chain import RigidChain, chain_of
from vmach.controller_tables.table_task import TableTask

__all__ = ["fitted_chain"]


def fitted_chain(
    task: TableTask, knots: tuple[Knots, Knots, Knots], *, by_direction: bool
) -> RigidChain:
    """The machine's errors; what a job's effects add is fitted by its linear errors."""
    chain = chain_of(task.machine, knots, task.variant)
    if not task.has_effects:
        return chain
    samples = task.fit_samples(knots)
    states = (samples.nose_mm, samples.direction, samples.tool_mm)
    rest = samples.error_mm + chain.applied_correction(*states)
    terms = [Term(j, i, by_direction and task.by_direction) for i in range(3) for j in range(3)]
    tables = dict(chain.tables)
    for table in Projection(terms, knots, samples).tables(rest):
        name = f"E{'XYZ'[table.term.output_axis]}{'XYZ'[table.term.input_axis]}"
        nothing = np.zeros_like(table.position_mm)
        _, up, down = tables.get(name, (table.position_mm, nothing, nothing))
        tables[name] = (table.position_mm, up - table.forward_mm, down - table.backward_mm)
    return replace(chain, tables=tables)
