"""The job file: one machining job with its machine, program, stock, tools and nominal CAD."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gcode import ControlSettings, OffsetEntry
from stock import StockError, Tool, make_tool
from vmach.base.units import mm_from_um
from vmach.errors import InputError
from vmach.features.circular_test import CircularLimits
from vmach.files.toml_file import line_of_key, read_toml_and_text
from vmach.job.control import control_told
from vmach.job.drawing import JobDrawing, read_drawing
from vmach.job.probing import Probing, read_probing
from vmach.job.schema import (
    CircularTestEntry,
    InspectionEntry,
    JobSchema,
    MeasuringMachineEntry,
    ToolEntry,
)
from vmach.machine import Machine
from vmach.plausibility import admitted_machine, check_tools

if TYPE_CHECKING:
    import trimesh

__all__ = ["Blank", "Inspection", "Job", "JobTool", "free_job_name", "job_name", "read_job"]

#: keys of a tool that its cutting part is made from
_CUTTER_DIMENSIONS = {
    "diameter_mm",
    "length_mm",
    "corner_radius_mm",
    "tip_diameter_mm",
    "angle_deg",
    "flute_length_mm",
}


@dataclass(frozen=True)
class Blank:
    """The material before the first cut, in workpiece coordinates.

    Attributes
    ----------
    min_mm, max_mm : (3,) float64
        Corners of the box, or of the solid's bounding box.
    file : Path or None
        A solid, where the blank is no box.
    mesh : trimesh.Trimesh or None
        Its surface.
    """

    min_mm: np.ndarray
    max_mm: np.ndarray
    file: Path | None = None
    mesh: trimesh.Trimesh | None = None

    @property
    def solid(self) -> tuple[np.ndarray, np.ndarray] | trimesh.Trimesh:
        """The blank as the removal engine takes it: two corners, (3,) mm each, or a mesh."""
        return (self.min_mm, self.max_mm) if self.mesh is None else self.mesh

    @property
    def volume_mm3(self) -> float:
        """How much material there is."""
        box = np.prod(self.max_mm - self.min_mm)
        return float(box if self.mesh is None else self.mesh.volume)


@dataclass(frozen=True)
class JobTool:
    """A tool in its holder; lengths in mm.

    Attributes
    ----------
    number : int
        As in the program's T word.
    cutter : stock.Tool
        The cutting part, tip at the origin.
    diameter_mm, length_mm : float
        Cutting diameter; distance from spindle nose to tip.
    flutes : int or None
    shank_diameter_mm : float or None
        Above the cutting part.
    holder_mm : (K, 2) float64 or None
        Outline (r, z) of the holder, z from the tip.
    name : str
        By which a program may call it.
    """

    number: int
    cutter: Tool
    diameter_mm: float
    length_mm: float
    flutes: int | None = None
    shank_diameter_mm: float | None = None
    holder_mm: np.ndarray | None = None
    name: str = ""


@dataclass(frozen=True)
class Inspection:
    """How the part is looked at; lengths in mm."""

    spacing_mm: float
    edge_margin_mm: float
    reach_mm: float
    tolerance_mm: float
    difference_mm: float
    alignment: str
    datums: tuple[tuple[str, ...], ...]


@dataclass(frozen=True)
class Device:
    """Standard uncertainties of the scales and squareness of a coordinate measuring machine.

    Attributes
    ----------
    scale_u, squareness_u_rad : float
        Of each scale, in mm/mm, and of each squareness.
    """

    scale_u: float
    squareness_u_rad: float


@dataclass(frozen=True)
class Job:
    """A machining job, read and checked.

    Attributes
    ----------
    path : Path
        The job file; every path in it is relative to its folder.
    machine : Machine
    machine_path, program : Path
    dialect : str
        Of the program; "auto" to recognise it.
    control : ControlSettings
        Its switches.
    nominal, measured : Path or None
    nominal_unit : str or None
        Unit of nominal CAD that does not say its own: um, mm, cm, m or inch.
    workpiece_zero : str or None
        The work offset that is the origin of the nominal CAD; None for the one in use.
    touched_off : bool
        The work offsets hold for the tip of every tool, whatever G43 says.
    work_offsets_mm : mapping of "G54" ... to (3,) float64
    blank : Blank or None
    tools : mapping of tool number to JobTool
    offsets : mapping of number to OffsetEntry
        What H and D of a number mean where it is not the tool of that number.
    inspection : Inspection
    device : Device
        What is known of the machine that measured the part.
    probing : Probing or None
        How zero and tool lengths were set on the machine; None where nobody says it.
    drawing : JobDrawing
        Features, datums and tolerances.
    circular_test : CircularLimits or None
        What figures of ISO 230-4 are accepted; None where none is asked for.
    effects, measurements, history
        As in the file; read by the parts of the program that know them.
    fitted : mapping of (effect, target) to tuple of mapping
        Independent changes of an effect's parameters, one standard uncertainty each.
    """

    path: Path
    machine: Machine
    machine_path: Path
    program: Path
    dialect: str
    control: ControlSettings
    nominal: Path | None
    measured: Path | None
    nominal_unit: str | None
    workpiece_zero: str | None
    touched_off: bool
    work_offsets_mm: Mapping[str, np.ndarray]
    blank: Blank | None
    tools: Mapping[int, JobTool]
    offsets: Mapping[int, OffsetEntry]
    inspection: Inspection
    device: Device
    probing: Probing | None
    drawing: JobDrawing
    circular_test: CircularLimits | None
    effects: Mapping[str, Any]
    measurements: Sequence[Mapping[str, Any]]
    history: Sequence[Mapping[str, Any]]
    fitted: Mapping[tuple[str, str], tuple[Mapping[str, Any], ...]]

    @property
    def folder(self) -> Path:
        """Folder that the paths in the job file are relative to."""
        return self.path.parent

    def files(self) -> list[tuple[str, Path]]:
        """Role and path of every file that the prediction depends on."""
        machine, *tables = self.machine.files
        files = [("job", self.path), ("program", self.program), ("machine", machine)]
        files += [("error table", table) for table in dict.fromkeys(tables)]
        blank = self.blank.file if self.blank else None
        optional = [("nominal", self.nominal), ("measured", self.measured), ("stock", blank),
                    ("logo", self.drawing.logo)]  # fmt: skip
        return files + [(role, path) for role, path in optional if path is not None]


def job_name(path: Path) -> str:
    """What a job is called: its file's name, or its folder's where the file is ``job.toml``."""
    path = Path(os.path.realpath(path))  # a loop of links is told when the file is read
    return path.parent.name if path.name == "job.toml" else path.stem


def free_job_name(path: Path) -> Path:
    """A name for a job that goes on from another, beside it: ``job-2.toml``, ``job-3.toml`` ..."""
    number = 2
    stem = re.sub(r"-\d+$", "", path.stem)
    while (candidate := path.with_name(f"{stem}-{number}.toml")).exists():
        number += 1
    return candidate


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
    tools = {k: _tool(k, tool, at("tools", str(k))) for k, tool in data.tools.items()}
    check_tools(tools, path)
    return Job(
        path=path,
        machine=admitted_machine(machine_path),
        machine_path=machine_path,
        program=program,
        dialect=_dialect(data, at("dialect")),
        control=_control_settings(data),
        nominal=existing("nominal", data.nominal),
        measured=existing("measured", data.measured),
        nominal_unit=data.nominal_unit,
        workpiece_zero=data.workpiece_zero,
        touched_off=data.tool_offsets == "touched off",
        work_offsets_mm={k: np.array(v) for k, v in data.work_offsets_mm.items()},
        blank=_blank(data, path, at),
        tools=tools,
        offsets={k: OffsetEntry(**row.model_dump()) for k, row in data.offsets.items()},
        inspection=_inspection(data.inspection, at("inspection", "alignment")),
        device=_device(data.measuring_machine),
        probing=read_probing(data.probing, tools),
        drawing=read_drawing(data, path.parent, at),
        circular_test=_circular_limits(data.circular_test),
        effects=data.effects,
        measurements=data.measurements,
        history=[step.model_dump(exclude_none=True) for step in data.history],
        fitted={(f.effect, f.target): tuple(f.one_sigma) for f in data.fitted},
    )


def _circular_limits(data: CircularTestEntry | None) -> CircularLimits | None:
    if data is None:
        return None
    told = data.model_dump(exclude_none=True)
    return CircularLimits(**{key.removesuffix("_um"): mm_from_um(um) for key, um in told.items()})


def _device(data: MeasuringMachineEntry) -> Device:
    """The limit L/K of a length as a rectangular distribution, where nothing else is stated."""
    share = 1e-3 / data.k_mm_per_um / np.sqrt(3.0)
    scale, square = data.scale_u_ppm, data.squareness_u_urad
    return Device(
        share if scale is None else 1e-6 * scale, share if square is None else 1e-6 * square
    )


def _dialect(data: JobSchema, where: dict[str, Any]) -> str:
    """The control's name: from the command line, [control] or the older key ``dialect``."""
    told, own = control_told(), data.control.name
    if data.dialect is not None and own not in ("auto", data.dialect):
        raise InputError(f"dialect = '{data.dialect}' and [control] name = '{own}'", **where,
                         accepted="one of them")  # fmt: skip
    return told or (own if data.dialect is None else data.dialect)


def _control_settings(data: JobSchema) -> ControlSettings:
    control = data.control
    switches = control.block_delete
    return ControlSettings(
        increment=control.increment,
        block_delete=switches if isinstance(switches, bool) else frozenset(switches),
        ignore_m=frozenset(control.ignore_m),
    )


def _blank(data: JobSchema, path: Path, at: Any) -> Blank | None:
    stock = data.stock
    if stock is None:
        return None
    if stock.file is not None:
        if stock.min_mm or stock.max_mm:
            what = f"[stock] has both a box and file = {str(stock.file)!r}"
            raise InputError(what, **at("stock"), accepted="one of the two")
        return _blank_from_file(path.parent / stock.file, stock.unit, at("stock", "file"))
    if stock.min_mm is None or stock.max_mm is None:
        raise InputError(
            f"[stock] has min_mm = {stock.min_mm} and max_mm = {stock.max_mm}",
            **at("stock"),
            accepted="min_mm and max_mm, or file",
        )
    low, high = np.array(stock.min_mm), np.array(stock.max_mm)
    if not (low < high).all():
        raise InputError(
            f"[stock] min_mm {list(stock.min_mm)} is not below max_mm {list(stock.max_mm)}",
            **at("stock", "max_mm"),
            accepted="min_mm smaller than max_mm in X, Y and Z",
        )
    return Blank(low, high)


def _blank_from_file(file: Path, unit: str | None, where: dict[str, Any]) -> Blank:
    import trimesh  # late: it takes half a second, and only solids need it

    from vmach.nominal import read_nominal

    if not file.is_file():
        raise InputError(f"file = '{file.name}': no such file", **where)
    part = read_nominal(file, unit)
    low, high = part.bounds_mm
    mesh = trimesh.Trimesh(part.mesh.vertices_mm, part.mesh.triangles, process=False)
    return Blank(low, high, file, mesh)


def _tool(number: int, tool: ToolEntry, where: dict[str, Any]) -> JobTool:
    given = tool.model_dump(exclude_none=True, include=_CUTTER_DIMENSIONS)
    if tool.shape == "profile":
        given = {"points_mm": tool.profile_mm or []}
    try:
        cutter = make_tool(tool.shape, **given)
    except StockError as error:
        raise InputError(f"tool {number}: {error}", **where) from None
    holder = tool.holder_mm
    if holder is not None and (len(holder) < 2 or max(r for r, _ in holder) == 0.0):
        raise InputError(
            f"tool {number}: holder_mm = {[list(point) for point in holder]}",
            **where,
            accepted="two or more pairs of radius and height above the tip, from the lowest up",
        )
    return JobTool(
        number=number,
        cutter=cutter,
        diameter_mm=tool.diameter_mm,
        length_mm=tool.length_mm,
        flutes=tool.flutes,
        shank_diameter_mm=tool.shank_diameter_mm,
        holder_mm=None if tool.holder_mm is None else np.array(tool.holder_mm),
        name=tool.name,
    )


def _inspection(data: InspectionEntry, where: dict[str, Any]) -> Inspection:
    if data.alignment == "datum" and not data.datums:
        raise InputError(
            f'alignment = "{data.alignment}" needs datums',
            **where,
            accepted='lists of feature names: datums = [["top"], ["side *"], ["bore 1"]]',
        )
    return Inspection(
        spacing_mm=data.spacing_mm,
        edge_margin_mm=data.edge_margin_mm,
        reach_mm=data.reach_mm,
        tolerance_mm=mm_from_um(data.tolerance_um),
        difference_mm=data.difference_mm,
        alignment=data.alignment,
        datums=tuple(map(tuple, data.datums)),
    )
