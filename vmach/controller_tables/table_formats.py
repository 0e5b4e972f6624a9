"""The formats: what each can hold, how it is written and read back.

Source: the manuals that the module of each format names; ISO/TR 16907 for the kinds of
compensation.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from vmach.controller_tables import heidenhain, linuxcnc, sinumerik
from vmach.controller_tables.component_tables import read_components, write_components
from vmach.controller_tables.grid_table import fit_grid, read_grid, write_grid
from vmach.controller_tables.isg import read_isg, write_isg
from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Projection, Term
from vmach.controller_tables.rigid_chain import RigidChain, chain_of
from vmach.controller_tables.table_task import TableTask

__all__ = ["FORMATS", "AppliedTables", "TableFormat", "projected"]

#: tables whose largest entry is below this share of the tolerance are left out
_NEGLIGIBLE = 0.1
#: where no control sets a limit: of a side of the grid (25 cubed rows), and of a table
_GRID_ENTRIES = 25
_MANY_ENTRIES = 251


class AppliedTables(Protocol):
    """Tables as a control has read them."""

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What the control adds to the commanded positions, (P, 3) mm."""


Write = Callable[[Path, TableTask, tuple[Knots, Knots, Knots], Mapping[str, Any]], list[Path]]


@dataclass(frozen=True)
class TableFormat:
    """One format of compensation tables.

    Attributes
    ----------
    title : str
    holds, lacks : str
        What it can and cannot correct.
    most_entries : int
        Of one table.
    write, read : callable
        Files from a task, and tables from files; the keyword options go to both.
    terms : callable or None
        Terms that the format can hold, for a task; None where it holds the error model itself.
    """

    title: str
    holds: str
    lacks: str
    most_entries: int
    write: Write
    read: Callable[[Path, Mapping[str, Any]], AppliedTables]
    terms: Callable[[TableTask], list[Term]] | None = None


def projected(
    task: TableTask, terms: list[Term], knots: tuple[Knots, Knots, Knots]
) -> tuple[Projection, list[AxisTable]]:
    """Fit of the terms that matter, and their tables."""
    samples = task.fit_samples(knots)
    projection = Projection(terms, knots, samples)
    tables = projection.tables(samples.error_mm)
    kept = [t for t in tables if t.largest_mm > _NEGLIGIBLE * task.tolerance_mm]
    if len(kept) == len(tables):
        return projection, tables
    projection = Projection([table.term for table in kept], knots, samples)
    return projection, projection.tables(samples.error_mm)


def _own_axis(task: TableTask) -> list[Term]:
    return [Term(k, k, task.by_direction) for k in range(3)]


def _own_axis_mean(task: TableTask) -> list[Term]:
    return [Term(k, k) for k in range(3)]


def _cross_own_reversal(task: TableTask) -> list[Term]:
    return [Term(j, i, task.by_direction and i == j) for i in range(3) for j in range(3)]


def _cross(task: TableTask) -> list[Term]:
    return [Term(j, i, task.by_direction) for i in range(3) for j in range(3)]


def _cross_and_products(task: TableTask) -> list[Term]:
    products = [
        Term(j, i, factor_axis=k)
        for i in range(3)
        for j in range(3)
        for k in range(3)
        if k != j
    ]  # fmt: skip
    return _cross(task) + products


def _write_linuxcnc(folder, task, knots, options) -> list[Path]:
    tables = projected(task, _own_axis(task), knots)[1]
    return linuxcnc.write_linuxcnc(folder, tables, file_type=options.get("comp_type", 0))


def _write_enc(folder, task, knots, options) -> list[Path]:
    return sinumerik.write_enc_comp(folder, projected(task, _own_axis_mean(task), knots)[1])


def _write_cec(folder, task, knots, options) -> list[Path]:
    tables = projected(task, _cross(task), knots)[1]
    return sinumerik.write_cec(folder, tables, knots, entries=_cec_entries(options))


def _write_cec_products(folder, task, knots, options) -> list[Path]:
    tables = projected(task, _cross_and_products(task), knots)[1]
    return sinumerik.write_cec(folder, tables, knots, entries=_cec_entries(options))


def _cec_entries(options: Mapping[str, Any]) -> str:
    return options.get("cec_entries", "correction")


def _write_heidenhain(folder, task, knots, options) -> list[Path]:
    return heidenhain.write_heidenhain(folder, projected(task, _cross_own_reversal(task), knots)[1])


def _write_isg(folder, task, knots, options) -> list[Path]:
    return write_isg(folder, _fitted_chain(task, knots, by_direction=False))


def _write_components(folder, task, knots, options) -> list[Path]:
    return write_components(folder, _fitted_chain(task, knots, by_direction=True))


def _fitted_chain(
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


def _write_grid(folder, task, knots, options) -> list[Path]:
    grid = fit_grid(knots, task.grid_samples(knots))
    return write_grid(folder, grid, tool_length_mm=task.tool_length_mm)


#: by the name that the command line and the folders use
FORMATS: dict[str, TableFormat] = {
    "linuxcnc": TableFormat(
        "LinuxCNC screw compensation (COMP_FILE)",
        "positioning of each axis by its own position, with reversal",
        "straightness, squareness, angles, any other axis, tool length, tilt",
        linuxcnc.MOST_ENTRIES, _write_linuxcnc,
        lambda folder, options: linuxcnc.read_linuxcnc(folder), _own_axis,
    ),
    "sinumerik-enc": TableFormat(
        "SINUMERIK encoder (leadscrew) compensation ($AA_ENC_COMP)",
        "positioning of each axis by its own position, mean of both directions",
        "reversal, straightness, squareness, angles, any other axis, tool length, tilt",
        sinumerik.MOST_ENTRIES, _write_enc,
        lambda folder, options: sinumerik.read_enc_comp(folder), _own_axis_mean,
    ),
    "sinumerik-cec": TableFormat(
        "SINUMERIK sag and angularity compensation ($AN_CEC), plain tables",
        "positioning, straightness and squareness by the position of one axis each, with reversal",
        "angles (their mean over the other axes at one tool length is in), tool length, tilt",
        sinumerik.MOST_ENTRIES, _write_cec,
        lambda folder, options: sinumerik.read_cec(folder, entries=_cec_entries(options)), _cross,
    ),
    "sinumerik-cec-products": TableFormat(
        "SINUMERIK sag and angularity compensation ($AN_CEC) with MULT_BY_TABLE",
        "as the plain tables, and angles times the position of another axis, at one tool length",
        "reversal of angles, other tool lengths, tilt",
        sinumerik.MOST_ENTRIES, _write_cec_products,
        lambda folder, options: sinumerik.read_cec(folder, entries=_cec_entries(options)),
        _cross_and_products,
    ),
    "heidenhain": TableFormat(
        "HEIDENHAIN nonlinear axis-error compensation (.COM, .CMA)",
        "positioning with reversal, straightness and squareness by the position of one axis each",
        "reversal across, angles (their mean at one tool length is in), tool length, tilt",
        heidenhain.MOST_ENTRIES, _write_heidenhain,
        lambda folder, options: heidenhain.read_heidenhain(folder), _cross_own_reversal,
    ),
    "isg": TableFormat(
        "ISG and Beckhoff TwinCAT volumetric compensation (ISG CSV)",
        "18 component errors and squareness, any tool length",
        "reversal, tilt",
        _MANY_ENTRIES, _write_isg, lambda folder, options: read_isg(folder),
    ),
    "components": TableFormat(
        "component tables in the terms of ISO 230-1 and ISO/TR 16907 (our own form)",
        "18 component errors with reversal and squareness, any tool length",
        "tilt",
        _MANY_ENTRIES, _write_components, lambda folder, options: read_components(folder),
    ),
    "grid": TableFormat(
        "spatial grid in the terms of ISO/TR 16907 (our own form)",
        "any error that is a function of X, Y and Z, at one tool length",
        "reversal, other tool lengths, tilt, what bends between grid points",
        _GRID_ENTRIES, _write_grid, lambda folder, options: read_grid(folder),
    ),
}  # fmt: skip
