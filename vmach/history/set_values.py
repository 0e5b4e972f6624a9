"""A job with other sizes of effects, or on a machine with other tables, beside the old one."""

from __future__ import annotations

import re
from collections.abc import Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.text_file import read_text
from vmach.files.together import together
from vmach.history.following_job import history_toml, moved_text
from vmach.history.other_machine import MachineValue, other_machine_text
from vmach.job import Job, free_job_name, read_job
from vmach.machine import read_machine
from vmach.machine.component_errors import COMPONENT_NAMES

__all__ = ["set_values"]

_EFFECT = re.compile(r"(?P<name>[a-z]\w*)(:(?P<target>\w+))?\.(?P<parameter>\w+)=(?P<value>.+)")
_TABLE = re.compile(r"(?P<component>E[A-CX-Z]{2})=(?P<file>.+)")
_PLACE = re.compile(r"(?P<component>E[A-CX-Z]{2})\.measured_at_mm=(?P<place>.+)")
_ACCEPTED = "EFFECT:TARGET.PARAMETER=NUMBER, EXX=TABLE.csv or EXX.measured_at_mm=X,Y,Z"


@dataclass(frozen=True)
class _EffectValue:
    """One parameter of an effect."""

    name: str
    target: str
    parameter: str
    value: float

    @property
    def words(self) -> str:
        """For people."""
        place = " ".join(filter(None, (self.name, self.target)))
        return f"{place} {self.parameter} {self.value:g}"


def set_values(
    job_path: str | Path, words: Sequence[str], *, out: Path | None = None
) -> tuple[Path, Path | None]:
    """Write a job with other values, and its machine file where that differs; the old ones stay.

    Parameters
    ----------
    job_path : path
    words : sequence of str
        ``backlash:Y.reversal_um=5``: a parameter of an effect, whether the job has it or not.
        ``EXX=table.csv``: a table over machine coordinates, in place of the machine's.
        ``EXX.measured_at_mm=0,-150,-200``: where its reflector stood.
    out : Path, optional
        The job file to write; a new name beside the old one where left out.

    Returns
    -------
    path of the new job, and of its machine file or None

    Raises
    ------
    InputError
        A word of another form, an unknown effect or parameter, a value out of bounds, a table
        that cannot be read, a file that is there already.
    """
    job = read_job(job_path)
    if not words:
        raise InputError("nothing to set", accepted=_ACCEPTED)
    of_effects, of_machine = _read(words)
    target = out or free_job_name(job.path)
    machine = free_job_name(target.parent / job.machine_path.name) if of_machine else None
    for path in filter(None, (target, machine)):
        if path.exists():
            raise InputError("file is there already", file=path, hint="choose another with -o")
    text = moved_text(read_text(job.path, what="job file"), job.folder, target.parent)
    text = _with_effects(text, of_effects, machine)
    said = [value.words for value in of_effects] + [value.words for value in of_machine]
    text = text.rstrip() + "\n" + history_toml(job, target.parent, list(dict.fromkeys(said)))
    written: dict[Path, str] = {target: text}
    if machine is not None:
        written[machine] = other_machine_text(job.machine_path, of_machine, machine.parent)
    _write_and_read(written, target)
    return target, machine


def _read(words: Sequence[str]) -> tuple[list[_EffectValue], list[MachineValue]]:
    effects: list[_EffectValue] = []
    machine: list[MachineValue] = []
    for word in words:
        if match := _PLACE.fullmatch(word):
            machine.append(MachineValue(match["component"], place_mm=_three(word, match["place"])))
        elif match := _TABLE.fullmatch(word):
            machine.append(MachineValue(match["component"], table=Path(match["file"])))
        elif match := _EFFECT.fullmatch(word):
            value = _number(word, match["value"])
            effects.append(_EffectValue(match["name"], match["target"] or "", match["parameter"],
                                        value))  # fmt: skip
        else:
            raise InputError(f"{word!r}", accepted=_ACCEPTED)
    for one in machine:
        if one.component not in COMPONENT_NAMES:
            raise InputError(
                f"component error {one.component!r}", accepted=", ".join(COMPONENT_NAMES)
            )
    return effects, machine


def _number(word: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{word!r}: {text!r} is no number", accepted=_ACCEPTED) from None


def _three(word: str, text: str) -> tuple[float, ...]:
    values = tuple(_number(word, one) for one in text.split(","))
    if len(values) != 3:
        raise InputError(f"{word!r}", accepted="three numbers: X,Y,Z")
    return values


def _with_effects(text: str, values: Sequence[_EffectValue], machine: Path | None) -> str:
    """The job's text with other parameters; what was left open of a fitted one goes with it."""
    document = tomlkit.parse(text)
    if machine is not None:
        document["machine"] = machine.name
    effects = document.setdefault("effects", tomlkit.table(is_super_table=True))
    for value in values:
        _parameters_of(effects, value)[value.parameter] = value.value
    changed = {(value.name, value.target) for value in values}
    fitted: Any = document.get("fitted", [])
    for k in reversed(range(len(fitted))):
        if (fitted[k].get("effect"), fitted[k].get("target", "")) in changed:
            del fitted[k]
    if "fitted" in document and not len(fitted):
        del document["fitted"]
    if not effects:
        del document["effects"]
    return tomlkit.dumps(document)


def _parameters_of(effects: Any, value: _EffectValue) -> Any:
    """The table of an effect; a new one where it is not there."""
    table = effects.setdefault(value.name, tomlkit.table(is_super_table=bool(value.target)))
    if not isinstance(table, MutableMapping):
        raise InputError(f"effects.{value.name} = {table!r}", accepted="a table")
    if not value.target or table.get("target") == value.target:
        return table
    return table.setdefault(value.target, tomlkit.table())


def _write_and_read(written: Mapping[Path, str], job_path: Path) -> None:
    """Write all files, and take them away where they make no job."""
    with together():
        for path, text in written.items():
            with atomic_file(path) as temporary:
                temporary.write_text(text, encoding="utf-8")
    try:
        job: Job = read_job(job_path)
        read_machine(job.machine_path)
        read_effects(job.effects, file=job.path, job=job)
    except BaseException as error:
        for path in written:
            path.unlink(missing_ok=True)
        if isinstance(error, InputError) and error.file in written:  # there is no such file
            raise InputError(error.what, accepted=error.accepted, hint=error.hint) from None
        raise
