"""A machining job: one part with its machine, program, blank, tools and nominal CAD."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gcode import ControlSettings, OffsetEntry
from vmach.features.circular_test import CircularLimits
from vmach.job.blank import Blank
from vmach.job.drawing import JobDrawing
from vmach.job.inspection import Device, Inspection
from vmach.job.probing import Probing
from vmach.job.tool import JobTool
from vmach.machine import Machine

__all__ = ["Job"]


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
    correlated : mapping of two (effect, target) to (D, E) float64
        Correlation coefficients of the D changes of the first with the E of the second.
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
    correlated: Mapping[tuple[tuple[str, str], tuple[str, str]], np.ndarray]

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
