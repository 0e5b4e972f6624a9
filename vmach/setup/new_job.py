"""Write a job file and a machine file that ask for what only the user can know."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.checkup.program_needs import Needs
from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.together import together
from vmach.files.toml_text import quoted, quoted_path
from vmach.nominal import NominalPart, read_nominal
from vmach.setup.editor_schemas import EDITED_FILES, editor_schema
from vmach.setup.kinematics import Kinematics
from vmach.setup.said_tools import SaidTool, said_tools

__all__ = ["Answers", "new_job"]

#: what stands over the part in a blank that nobody has said, mm
_ALLOWANCE_MM = 1.0
#: of a tool that nobody has said, mm
_DIAMETER_MM, _LENGTH_MM = 10.0, 100.0
#: above the table, as a share of the travel, at which a workpiece zero is put that nobody has said
_ZERO_ABOVE = 0.2
#: folder of the schemas that editors look into, beside the files
_SCHEMAS = ".vmach"


@dataclass(frozen=True)
class Answers:
    """What is known of a job to be.

    Attributes
    ----------
    program : Path
    nominal : Path or None
        STEP or STL.
    kinematics : Kinematics
    travel_mm : tuple of float
        Of X, Y and Z; the axes are taken to go from minus that to 0.
    control : str
    """

    program: Path
    nominal: Path | None
    kinematics: Kinematics
    travel_mm: tuple[float, float, float]
    control: str = "auto"


def new_job(folder: Path, answers: Answers) -> tuple[Path, ...]:
    """Write ``job.toml`` and ``machine.toml`` into a folder.

    Returns
    -------
    tuple of Path
        What was written.

    Raises
    ------
    InputError
        A file is there already, or the nominal CAD cannot be read.
    gcode.ProgramError
        The program cannot be read.
    """
    job, machine = folder / "job.toml", folder / "machine.toml"
    for path in (job, machine):
        if path.exists():
            raise InputError(
                "the file is there already",
                file=path,
                hint="init writes nothing over it; 'vmach check' looks through it",
            )
    needs = Needs(answers.program, control=answers.control)
    part = None if answers.nominal is None else read_nominal(answers.nominal)
    texts = {
        machine: "\n".join(_machine_lines(answers)) + "\n",
        job: "\n".join(_job_lines(folder, answers, needs, part)) + "\n",
    }
    (folder / _SCHEMAS).mkdir(parents=True, exist_ok=True)
    schemas = {folder / _SCHEMAS / f"{n}.json": json.dumps(editor_schema(n)) for n in EDITED_FILES}
    texts |= {path: text + "\n" for path, text in schemas.items()}
    with together():
        for path, text in texts.items():
            with atomic_file(path, is_new=path in (job, machine)) as file:
                file.write_text(text, encoding="utf-8")
    return machine, job


def _relative(path: Path, folder: Path) -> str:
    """The path as a job file in the folder names it, in quotes."""
    try:
        return quoted_path(path.resolve().relative_to(folder.resolve()))
    except ValueError:
        return quoted_path(path.resolve())


def _machine_lines(answers: Answers) -> Iterator[str]:
    yield f"#:schema ./{_SCHEMAS}/machine.json"
    yield "schema = 1"
    yield 'name = "my machine"  # mend: what it is called in reports'
    yield f'chain = "{answers.kinematics.chain}"  # {answers.kinematics.title}'
    yield ""
    yield "[convention]"
    yield 'sign = "relative"  # mend: what a positive reading means, see docs/files.md'
    yield 'length = "um"'
    yield 'angle = "urad"'
    yield ""
    yield "[motion]"
    yield "rapid_mm_min = 20000  # mend"
    yield "tool_change_s = 6  # mend"
    for axis, travel in zip("XYZ", answers.travel_mm, strict=True):
        yield ""
        yield f"[axes.{axis}]"
        yield f"travel_mm = [{-travel:g}, 0]  # machine coordinates"
    yield ""
    yield "# A table a measured error. Its first line: position_mm,forward_um,backward_um"
    yield "# or, with one value for both directions: position_mm,error_um"
    yield "# [errors.EXX]"
    yield '# table = "errors/EXX.csv"'
    yield "# position_zero_mm = 0  # where the axis is at position 0 of the table"
    yield "# nose_at_mm = [-380, -230, -300]  # machine coordinates at one of the readings"
    yield "# stick_out_mm = 120  # how far the reflector was below the spindle nose"
    yield ""
    yield "# Squareness, for example from a ballbar, in urad."
    yield "# [squareness]"
    yield "# EC0Y = 0.0"


def _job_lines(
    folder: Path, answers: Answers, needs: Needs, part: NominalPart | None
) -> Iterator[str]:
    yield f"#:schema ./{_SCHEMAS}/job.json"
    yield "schema = 1"
    yield 'machine = "machine.toml"'
    yield f"program = {_relative(answers.program, folder)}"
    if answers.nominal is not None:
        yield f"nominal = {_relative(answers.nominal, folder)}"
    else:
        yield '# nominal = "part.step"'
    if answers.control != "auto":
        yield ""
        yield "[control]"
        yield f"name = {quoted(answers.control)}"
    yield ""
    yield "[work_offsets_mm]  # mend: the workpiece zero in machine coordinates"
    for name in needs.work_offsets or {"G54": 0}:
        place = ", ".join(f"{v:g}" for v in _zero(answers))
        key = name if name.isalnum() else f'"{name}"'
        yield f"{key} = [{place}]"
    yield ""
    yield "# mend: were zero and tool lengths set on this machine, by edge finder, probe or touch?"
    yield "# [probing]"
    yield f"# probe_length_mm = {_LENGTH_MM:g}  # of the edge finder or probe, from nose to tip"
    yield ""
    low, high = _blank(needs, part)
    yield "[stock]  # mend: the blank, in the coordinates of the workpiece zero"
    yield f"min_mm = [{', '.join(f'{v:g}' for v in low)}]"
    yield f"max_mm = [{', '.join(f'{v:g}' for v in high)}]"
    unit_mm = needs.program.record.unit_mm
    said = said_tools("\n".join(needs.program.source.lines))
    for number in sorted(needs.tools) or [1]:
        yield ""
        yield from _tool_lines(max(number, 1), said.get(number), unit_mm)


def _tool_lines(number: int, said: SaidTool | None, unit_mm: float) -> Iterator[str]:
    yield f"[tools.{number}]  # mend: " + ("shape and size" if said is None else "length")
    yield f'shape = "{"flat" if said is None else said.shape}"'
    unit_mm = 1.0 if said is not None and said.is_mm else unit_mm
    diameter = _DIAMETER_MM if said is None else said.diameter * unit_mm
    yield f"diameter_mm = {diameter:g}"
    yield f"length_mm = {_LENGTH_MM:g}  # from the spindle nose to the tip"
    if said is not None and said.shape == "bull":
        yield f"corner_radius_mm = {said.corner_radius * unit_mm:g}"
    if said is not None and said.shape == "drill":
        yield "angle_deg = 118"


def _zero(answers: Answers) -> np.ndarray:
    """A workpiece zero in the middle of the travel, low over the table."""
    travel = np.array(answers.travel_mm)
    return np.round(-travel * [0.5, 0.5, 1.0 - _ZERO_ABOVE])


def _blank(needs: Needs, part: NominalPart | None) -> tuple[np.ndarray, np.ndarray]:
    """The nominal part with an allowance above it and round it, or what the program cuts."""
    if part is not None:
        low, high = part.bounds_mm
    else:
        low, high = needs.extent_mm()
    around = np.array([_ALLOWANCE_MM, _ALLOWANCE_MM, 0.0])
    above = np.array([_ALLOWANCE_MM, _ALLOWANCE_MM, _ALLOWANCE_MM])
    return np.floor(np.asarray(low) - around), np.ceil(np.asarray(high) + above)
