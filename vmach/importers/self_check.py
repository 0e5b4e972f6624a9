"""What an imported instrument would read on the machine as described, beside what it read.

The files are written to a folder of their own and read back as any command reads them. So a sign,
a zero or a direction that the description has wrong shows as a difference.
"""

from __future__ import annotations

import tempfile
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gcode import ProgramError
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.importers.component_table import unit_of
from vmach.importers.convention import Convention
from vmach.importers.importer import Section
from vmach.importers.toml_text import section_text
from vmach.instruments import read_instruments
from vmach.job import read_job
from vmach.machine import LINEAR_AXES, RigidDisplacement, Variant, displacement
from vmach.machine.component_errors import component_of
from vmach.machine.files.machine_file import read_machine

__all__ = ["LaserReadings", "check_laser", "check_readings", "difference", "missing_places"]

_HEAD = """schema = 1
name = "self-check"
chain = "{chain}"
[convention]
sign = "{sign}"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 10000
[tables]
directions = "separate"
extrapolation = "hold"
"""


@dataclass(frozen=True)
class LaserReadings:
    """Readings as the file has them.

    Attributes
    ----------
    error : str
        ISO 230-1 symbol.
    position_mm : (P,) float64
        As the file counts them.
    value : (P,) float64
        Measured minus target, um or urad.
    approach : (P,) float64
        Sign of the motion along the file's positions.
    """

    error: str
    position_mm: np.ndarray
    value: np.ndarray
    approach: np.ndarray


def difference(what: str, predicted: np.ndarray, read: np.ndarray, unit: str) -> str:
    """A line with the size of readings, and how far the prediction is from them."""
    apart = predicted - read
    return (
        f"self-check of {what}: it would read {predicted.min():.2f} .. {predicted.max():.2f} "
        f"{unit}, it read {read.min():.2f} .. {read.max():.2f} {unit}; "
        f"difference RMS {np.sqrt(np.mean(apart**2)):.2f}, largest {np.abs(apart).max():.2f} {unit}"
    )


def check_laser(
    readings: LaserReadings,
    files: Mapping[str, str],
    sections: Iterable[Section],
    *,
    convention: Convention,
    zero_mm: float,
    is_down: bool,
) -> str:
    """What the laser would read on a machine with this table, and what it read: two lines.

    Parameters
    ----------
    readings : LaserReadings
    files : mapping of str to str
        The table as it will be written, by its name.
    sections : iterable of Section
        As the machine file will have them.
    convention : Convention
        Chain and signs of the machine file.
    zero_mm : float
        Machine position of the axis at the file's position 0.
    is_down : bool
        The laser counts against the axis.
    """
    direction, axis, angular = component_of(readings.error)
    way = -1.0 if is_down else 1.0
    nose = np.zeros((len(readings.value), 3))
    nose[:, axis] = zero_mm + way * readings.position_mm
    side = np.zeros_like(nose)
    side[:, axis] = way * readings.approach
    with tempfile.TemporaryDirectory() as room:
        machine = _machine_text(nose, axis, convention) + "".join(map(section_text, sections))
        for name, text in {**files, "machine.toml": machine}.items():
            (Path(room) / name).parent.mkdir(exist_ok=True)
            (Path(room) / name).write_text(text, encoding="utf-8")
        try:
            described = read_machine(Path(room) / "machine.toml")
        except InputError as error:  # of the user's file, which the caller names
            raise InputError(error.what, accepted=error.accepted, hint=error.hint) from None
    moved = displacement(described, nose, np.zeros(3), Variant.HTM, direction=side)
    if angular:
        predicted = urad_from_rad(moved.tilt_rad[:, direction])
    else:
        predicted = um_from_mm(moved.shift_mm[:, direction])
        predicted = predicted * (way if direction == axis else 1.0)
    line = difference(readings.error, predicted, readings.value, unit_of(readings.error))
    return f"{line}\n{_in_words(readings, nose[:, axis], side[:, axis], moved)}"


def _in_words(
    readings: LaserReadings, at_mm: np.ndarray, side: np.ndarray, moved: RigidDisplacement
) -> str:
    """The largest error as a person sees it, to be compared with what is known of the machine."""
    direction, axis, angular = component_of(readings.error)
    sizes = (moved.tilt_rad if angular else moved.shift_mm)[:, direction]
    k = int(np.argmax(np.abs(sizes)))
    where = f"at {LINEAR_AXES[axis]} = {at_mm[k]:g} mm, reached in {'+' if side[k] > 0 else '-'}"
    way = f"{'+' if sizes[k] > 0 else '-'}{LINEAR_AXES[direction]}"
    size, unit = abs(sizes[k]), unit_of(readings.error)
    amount = f"{urad_from_rad(size) if angular else um_from_mm(size):.2f} {unit}"
    if angular:
        return f"that means: {where}, the tool is turned about {way} by {amount}"
    return f"that means: {where}, the tool is {amount} further to {way} than told"


def missing_places(machine_file: Path) -> list[str]:
    """A line where a machine file lacks measuring points that its angles ask for."""
    try:
        unplaced = read_machine(machine_file).unplaced
    except InputError:
        return []  # vmach check says what is wrong with it
    if not unplaced:
        return []
    return [
        f"{machine_file}: {' '.join(unplaced)} without measured_at_mm: vmach run refuses the "
        "machine until it says where the reflector stood"
    ]


def _machine_text(nose: np.ndarray, axis: int, convention: Convention) -> str:
    low, high = nose[:, axis].min() - 1.0, nose[:, axis].max() + 1.0
    travels = {name: (-1.0, 1.0) for name in LINEAR_AXES} | {LINEAR_AXES[axis]: (low, high)}
    tables = (f"[axes.{n}]\ntravel_mm = [{a:.6f}, {b:.6f}]\n" for n, (a, b) in travels.items())
    return _HEAD.format(chain=convention.chain, sign=convention.sign) + "".join(tables)


def check_readings(job_file: Path, names: Collection[str]) -> list[str]:
    """What instruments of a job would read on its machine, and what they read: a line for each.

    Parameters
    ----------
    job_file : Path
    names : collection of str
        Names of the files that are looked at.
    """
    try:
        job = read_job(job_file)
        effects = read_effects(job.effects, file=job.path, job=job)
        tests = read_instruments(job, effects=effects)
    except (InputError, ProgramError) as error:
        return [f"no self-check: {error}"]
    found = []
    for test in tests:
        if test.name in names:
            free = [test.nuisance @ np.linalg.lstsq(test.nuisance, v, rcond=None)[0]
                    for v in (test.predicted_mm, test.measured_mm)]  # fmt: skip
            predicted, read = test.predicted_mm - free[0], test.measured_mm - free[1]
            what = f"{test.name}, {test.instrument.left_free_by(test)} left free"
            found.append(difference(what, um_from_mm(predicted), um_from_mm(read), "um"))
    return found
