"""Reading of a job file, with its machine and its tools."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from gcode import ControlSettings, OffsetEntry
from vmach.errors import InputError
from vmach.files.toml_file import line_of_key, read_toml_and_text
from vmach.job.blank import read_blank
from vmach.job.control import control_told
from vmach.job.drawing import read_drawing
from vmach.job.inspection import read_circular_limits, read_device, read_inspection
from vmach.job.job import Job
from vmach.job.probing import read_probing
from vmach.job.schema import JobSchema
from vmach.job.tool import read_tool
from vmach.plausibility import admitted_machine, check_tools

__all__ = ["read_job"]


def read_job(path: Job | str | Path) -> Job:
    """Read a job file, its machine and its tools.

    Parameters
    ----------
    path : path or Job
        The job file, or the folder that holds a ``job.toml``. A job that was read is given back,
        so that programs may change one in between.

    Raises
    ------
    InputError
        Anything wrong with the files, with file, line, key, value and what is accepted.

    Examples
    --------
    >>> import vmach
    >>> job = vmach.read_job("samples/freecad_pocket/job.toml")
    >>> job.machine.chain, sorted(job.tools)
    (Chain(tool_side=('Z',), work_side=('Y', 'X')), [1, 2])
    """
    if isinstance(path, Job):
        return path
    path = Path(path)
    path = path / "job.toml" if path.is_dir() else path
    data, text = read_toml_and_text(path, JobSchema, what="job file")

    def at(*keys: str) -> dict[str, Any]:
        return {"file": path, "line": line_of_key(text, list(keys))}

    def existing(key: str, name: str | None) -> Path | None:
        if name is None:
            return None
        target = path.parent / name
        if not target.is_file():
            why = "is a folder, not a file" if target.is_dir() else "no such file"
            raise InputError(f"{key} = '{name}': {why}", **at(key))
        return target

    if data.workpiece_zero is not None and data.workpiece_zero not in data.work_offsets_mm:
        raise InputError(
            f"workpiece_zero = '{data.workpiece_zero}'",
            **at("workpiece_zero"),
            accepted=", ".join(data.work_offsets_mm),
        )
    machine_path = existing("machine", data.machine)
    program = existing("program", data.program)
    assert machine_path and program
    tools = {k: read_tool(k, tool, at("tools", str(k))) for k, tool in data.tools.items()}
    check_tools(tools, path)
    return Job(
        path=path,
        machine=admitted_machine(machine_path),
        machine_path=machine_path,
        program=program,
        dialect=_dialect(data, at("dialect")),
        control=_control_settings(data, path.parent, at("control", "subprograms")),
        nominal=existing("nominal", data.nominal),
        measured=existing("measured", data.measured),
        nominal_unit=data.nominal_unit,
        workpiece_zero=data.workpiece_zero,
        touched_off=data.tool_offsets == "touched off",
        work_offsets_mm={k: np.array(v) for k, v in data.work_offsets_mm.items()},
        blank=read_blank(data, path.parent, at),
        tools=tools,
        offsets={k: OffsetEntry(**row.model_dump()) for k, row in data.offsets.items()},
        inspection=read_inspection(data.inspection, at("inspection", "alignment")),
        device=read_device(data.measuring_machine),
        probing=read_probing(data.probing, tools),
        drawing=read_drawing(data, path.parent, at),
        circular_test=read_circular_limits(data.circular_test),
        effects=data.effects,
        measurements=data.measurements,
        history=[step.model_dump(exclude_none=True) for step in data.history],
        fitted=_fitted(data, at),
        correlated=_correlated(data, at),
    )


def _fitted(
    data: JobSchema, at: Callable[..., dict[str, Any]]
) -> dict[tuple[str, str], tuple[dict[str, Any], ...]]:
    """What is left open of each effect."""
    found: dict[tuple[str, str], tuple[dict[str, Any], ...]] = {}
    for number, one in enumerate(data.fitted):
        if (one.effect, one.target) in found:
            raise InputError(
                f"[[fitted]] of {one.effect} {one.target}".rstrip() + " is there twice",
                **at("fitted", str(number)),
                accepted="one for each effect and target",
            )
        found[one.effect, one.target] = tuple(one.one_sigma)
    return found


def _correlated(
    data: JobSchema, at: Callable[..., dict[str, Any]]
) -> dict[tuple[tuple[str, str], tuple[str, str]], np.ndarray]:
    """Correlation coefficients of what is left open of two effects each."""
    found: dict[tuple[tuple[str, str], tuple[str, str]], np.ndarray] = {}
    for number, one in enumerate(data.correlated):
        where = at("correlated", str(number))
        first, second = map(_key_of, one.effects)
        if first == second or (first, second) in found or (second, first) in found:
            raise InputError(
                f"[[correlated]] of {' and '.join(one.effects)}",
                **where,
                accepted="two effects, as NAME:TARGET, each two once",
            )
        if len({len(row) for row in one.coefficients}) != 1:
            raise InputError(
                f"[[correlated]] of {' and '.join(one.effects)}: coefficients",
                **where,
                accepted="a list of rows of the same length",
            )
        found[first, second] = np.array(one.coefficients)
    return found


def _key_of(word: str) -> tuple[str, str]:
    """Name and target of an effect, from NAME or NAME:TARGET."""
    name, _, target = word.partition(":")
    return name, target


def _dialect(data: JobSchema, where: dict[str, Any]) -> str:
    """The control's name: from the command line, [control] or the older key ``dialect``."""
    told, own = control_told(), data.control.name
    if data.dialect is not None and own not in ("auto", data.dialect):
        raise InputError(f"dialect = '{data.dialect}' and [control] name = '{own}'", **where,
                         accepted="one of them")  # fmt: skip
    return told or (own if data.dialect is None else data.dialect)


def _control_settings(data: JobSchema, folder: Path, where: dict[str, Any]) -> ControlSettings:
    control = data.control
    switches = control.block_delete
    subprograms = None if control.subprograms is None else folder / control.subprograms
    if subprograms is not None and not subprograms.is_dir():
        raise InputError(
            f"[control] subprograms = '{control.subprograms}': no such folder", **where
        )
    return ControlSettings(
        increment=control.increment,
        block_delete=switches if isinstance(switches, bool) else frozenset(switches),
        ignore_m=frozenset(control.ignore_m),
        ignore_calls=frozenset(control.ignore_calls),
        variables=dict(control.variables),
        subprograms=subprograms,
        options=dict(control.options),
    )
