"""A job looked through from its file to its program: every fault, not the first."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from gcode import ProgramError
from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.checkup.finding import Finding, Weight
from vmach.checkup.machine_statements import machine_statements, reached_positions
from vmach.checkup.program_needs import program_findings
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import complaints, line_of_key
from vmach.instruments import measure_part, read_instruments, settings_of
from vmach.job import Job, read_job
from vmach.job.schema import JobSchema
from vmach.machine.files.machine_schema import MachineSchema
from vmach.nominal import NominalPart, read_nominal
from vmach.nominal.points import read_points_csv
from vmach.path.preparation import Preparation, prepare
from vmach.plausibility import admitted_machine
from vmach.prediction import ActingEffect
from vmach.run.drawing_check import drawing_faults
from vmach.run.inspection import surface_points

__all__ = ["OPEN_MARK", "check_job"]

#: what stands behind a line that `vmach init` or `vmach import` guessed
OPEN_MARK = "# mend"
#: keys of a job that name a file
_FILES = ("machine", "program", "nominal", "measured")

_Reader = Callable[[Path, str | None], NominalPart]


def check_job(path: str | Path) -> tuple[Finding, ...]:
    """Everything that a job lacks, has wrong, leaves doubtful or lets the program assume.

    Parameters
    ----------
    path : path
        The job file, or the folder that holds a ``job.toml``.

    Returns
    -------
    tuple of Finding
        What has to be mended first; then what is doubtful; then what was assumed.
    """
    path = Path(path)
    path = path / "job.toml" if path.is_dir() else path
    part_of = lru_cache(maxsize=1)(read_nominal)  # by itself, and again with the job
    found = [*_job_file(path, part_of)]
    if all(finding.weight is not Weight.MEND for finding in found):
        found += _whole_job(path, part_of)
    found += _machine_statements(path)
    order = list(Weight)
    once = dict.fromkeys(found)
    return tuple(sorted(once, key=lambda finding: order.index(finding.weight)))


def _refusal(ask: Callable[[], object]) -> Iterator[Finding]:
    try:
        ask()
    except (InputError, ProgramError) as error:
        yield Finding.of_error(error)


def _job_file(path: Path, part_of: _Reader) -> Iterator[Finding]:
    """The job file by itself, and every file that it names."""
    errors = complaints(path, JobSchema, what="job file")
    yield from map(Finding.of_error, errors)
    try:
        text = read_text(path, what="job file")
        said = tomllib.loads(text)
    except (InputError, ValueError, RecursionError):
        return  # said above
    yield from _open_lines(path, text)
    there: dict[str, Path] = {}
    for key in _FILES:
        name = said.get(key)
        if not isinstance(name, str):
            continue
        file = path.parent / name
        if file.is_file():
            there[key] = file
        else:
            line = line_of_key(text, [key])
            yield Finding(Weight.MEND, f"{key} = '{name}': no such file", path, line)
    if "machine" in there:
        yield from _machine(there["machine"])
    if "nominal" in there:
        unit = said.get("nominal_unit")
        yield from _refusal(lambda: part_of(there["nominal"], unit))
    if "measured" in there:
        yield from _refusal(lambda: read_points_csv(there["measured"]))
    if "program" in there and not errors:
        yield from program_findings(there["program"], JobSchema.model_validate(said), path)


def _machine(file: Path) -> Iterator[Finding]:
    """The machine file, and every table that it names."""
    errors = complaints(file, MachineSchema, what="machine file")
    yield from map(Finding.of_error, errors)
    if errors:
        return
    text = read_text(file, what="machine file")
    yield from _open_lines(file, text)
    said: dict[str, Any] = tomllib.loads(text).get("errors", {})
    missing = False
    for name, entry in said.items():
        table = entry.get("table") if isinstance(entry, dict) else None
        if table and not (file.parent / table).is_file():
            missing = True
            line = line_of_key(text, ["errors", name, "table"])
            yield Finding(Weight.MEND, f"errors.{name}.table = '{table}': no such file", file, line)
    if not missing:
        yield from _refusal(lambda: admitted_machine(file))


def _machine_statements(path: Path) -> Iterator[Finding]:
    """What the machine file of a job leaves out, whatever else is wrong with the job."""
    try:
        name = tomllib.loads(read_text(path, what="job file")).get("machine")
    except (InputError, ValueError, RecursionError):
        return  # said above
    if isinstance(name, str) and (path.parent / name).is_file():
        yield from machine_statements(path.parent / name)


def _open_lines(file: Path, text: str) -> Iterator[Finding]:
    """Lines that `init` or `import` guessed, and that nobody has mended since."""
    for number, line in enumerate(text.splitlines(), 1):
        said, mark, what = line.partition(OPEN_MARK)
        if mark:
            words = what.strip(" :")
            guess = f"{said.strip() or 'the lines below'}: a guess of vmach"
            guess += f" ({words})" if words else ""
            hint = f"mend it, and take '{OPEN_MARK}' away"
            yield Finding(Weight.LOOK, guess, file, number, hint=hint)


def _whole_job(path: Path, part_of: _Reader) -> Iterator[Finding]:
    """What shows only when all files are read together."""
    try:
        job = read_job(path)
        preparation = prepare(job)
    except (InputError, ProgramError) as error:
        yield Finding.of_error(error)
        return
    yield from map(Finding.of_note, preparation.notes)
    yield from reached_positions(preparation)
    yield from _part(job, part_of)
    try:
        effects = read_effects(job.effects, file=path, job=job)
        yield from _tests(job, effects)
    except (InputError, ProgramError) as error:
        yield Finding.of_error(error)
    else:
        yield from _measured(job, preparation, effects)
    yield from _assumed(path, job)


def _tests(job: Job, effects: Sequence[ActingEffect]) -> Iterator[Finding]:
    """What is doubtful in the files of instruments.

    Raises
    ------
    InputError
        One of them cannot be read.
    """
    for number, test in enumerate(read_instruments(job, effects=effects)):
        file = job.folder / settings_of(job, number).file
        yield from _of_notes(test.notes, file)


def _measured(
    job: Job, preparation: Preparation, effects: Sequence[ActingEffect]
) -> Iterator[Finding]:
    """Measured points against what the program cuts."""
    if job.measured is None:
        return
    try:
        points = read_points_csv(job.measured)
        if points.measured_mm is None:
            return  # points to inspect
        part, _ = measure_part(preparation, job.measured, effects=effects)
    except (InputError, ProgramError) as error:
        refused = Finding.of_error(error)  # by `vmach diagnose`; the part can be predicted
        yield replace(refused, weight=Weight.LOOK)
        return
    yield from _of_notes(part.notes, job.measured)


def _of_notes(notes: Sequence[Note], file: Path) -> Iterator[Finding]:
    """Notes that name a measured file, with its path."""
    for note in notes:
        if note.file == file.name:
            yield Finding.of_note(replace(note, file=str(file)))
        elif not note.file:
            yield Finding.of_note(note)


def _part(job: Job, part_of: _Reader) -> Iterator[Finding]:
    """The part against its blank, and what is asked of it against its CAD."""
    if job.nominal is None and job.measured is None:
        return
    try:
        nominal = None if job.nominal is None else part_of(job.nominal, job.nominal_unit)
        points = surface_points(job, nominal)
        if job.drawing.tolerances or job.drawing.datums:
            yield from map(Finding.of_error, drawing_faults(job, nominal, points))
    except InputError as error:
        yield Finding.of_error(error)


def _assumed(path: Path, job: Any) -> Iterator[Finding]:
    """What the job does not say, and what it is taken for."""
    said = tomllib.loads(read_text(path, what="job file"))

    def assumed(what: str, hint: str) -> Finding:
        return Finding(Weight.ASSUMED, what, path, hint=hint)

    if "tool_offsets" not in said:
        yield assumed(
            "tool offsets are those of the program (G43 and the tools' lengths)",
            'tool_offsets = "touched off" where every tool was set on this machine at the part',
        )
    if job.probing is None and job.machine.components:
        yield assumed(
            "the workpiece zero is where the machine believes: its error there shows in the part",
            "[probing] where zero and tool lengths were set on this machine, by edge finder, probe "
            "or touch",
        )
    elif job.probing is not None and "probe_length_mm" not in said["probing"]:
        yield assumed(
            f"the probe or edge finder is {job.probing.probe_length_mm:g} mm long, as the first "
            "tool",
            "probe_length_mm in [probing], from the spindle nose to its tip",
        )
    if job.nominal is None:
        what = "'vmach run' has nothing to inspect, 'vmach path' has the error of the tool"
        what = what if job.measured is None else "deviations are those of the measured points"
        yield assumed(f"there is no nominal CAD: {what}", "nominal = a STEP or STL file")
    if job.blank is None:
        yield assumed(
            "there is no [stock]: 'vmach run' needs '--no-solid' without it",
            "[stock] with min_mm and max_mm, or file",
        )
    if not job.machine.components:
        yield assumed(
            "the machine has no error table: its axes are exact",
            "tables in [errors] of the machine file",
        )
    inspection = said.get("inspection", {})
    if "tolerance_um" not in inspection and not said.get("tolerances"):
        yield assumed(
            f"every face has the tolerance {um_from_mm(job.inspection.tolerance_mm):g} um",
            "[tolerances], or tolerance_um in [inspection]",
        )
