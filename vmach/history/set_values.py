"""A job with other sizes of effects, or on a machine with other tables, beside the old one."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import MutableMapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import InlineTable

from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.history.following_job import history_toml, moved_text
from vmach.history.job_text import checked_job, in_tables, parsed_job, take_fits, with_tables
from vmach.history.new_job_files import write_new_job
from vmach.history.other_machine import MachineValue, other_machine_text
from vmach.job import Job, free_job_name, read_job
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
    word: str

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
    try:
        target, *machine = write_new_job(
            job.path, lambda target: _texts(job, of_effects, of_machine, target), out=out
        )
    except InputError as error:
        raise _quoting(error, of_effects) from None
    return target, machine[0] if machine else None


def _texts(
    job: Job, of_effects: Sequence[_EffectValue], of_machine: Sequence[MachineValue], target: Path
) -> dict[Path, str]:
    """The new job, and its machine file where that differs."""
    machine = free_job_name(target.parent / job.machine_path.name) if of_machine else None
    text = read_text(job.path, what="job file")
    text = moved_text(text, job.folder, target.parent, file=job.path)
    text = _with_effects(text, of_effects, machine, file=job.path)
    said = [value.words for value in of_effects] + [value.words for value in of_machine]
    more = history_toml(job, target.parent, list(dict.fromkeys(said)))
    written = {target: with_tables(text, more, file=job.path)}
    if machine is not None:
        written[machine] = other_machine_text(job.machine_path, of_machine, machine.parent)
    return written


def _quoting(error: InputError, values: Sequence[_EffectValue]) -> InputError:
    """A complaint about what was told on the command line, with the word that told it."""
    told = [(v.parameter, v.word) for v in values] + [(v.name, v.word) for v in values]
    word = next((word for said, word in told if said in error.what), None)
    if error.file is not None or word is None:
        return error
    return InputError(f"{word!r}: {error.what}", accepted=error.accepted, hint=error.hint)


def _read(words: Sequence[str]) -> tuple[list[_EffectValue], list[MachineValue]]:
    effects: list[_EffectValue] = []
    machine: list[MachineValue] = []
    _check_once(words)
    for word in words:
        if match := _PLACE.fullmatch(word):
            machine.append(MachineValue(match["component"], place_mm=_three(word, match["place"])))
        elif match := _TABLE.fullmatch(word):
            machine.append(MachineValue(match["component"], table=Path(match["file"])))
        elif match := _EFFECT.fullmatch(word):
            names = match["name"], match["target"] or "", match["parameter"]
            effects.append(_EffectValue(*names, _number(word, match["value"]), word))
        else:
            raise InputError(f"{word!r}", accepted=_ACCEPTED)
    for one in machine:
        if one.component not in COMPONENT_NAMES:
            raise InputError(
                f"component error {one.component!r}", accepted=", ".join(COMPONENT_NAMES)
            )
    return effects, machine


def _check_once(words: Sequence[str]) -> None:
    """Refuse a value that is told twice: which of the two was meant?"""
    seen: dict[str, str] = {}
    for word in words:
        what = word.partition("=")[0]
        if what in seen:
            said = f"{word!r}: {what} is told already, {seen[what]!r}"
            raise InputError(said, accepted="every value once")
        seen[what] = word


def _number(word: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or "_" in text:  # Python reads 1_0 as 10
        raise InputError(f"{word!r}: {text!r} is no number", accepted=_ACCEPTED)
    return value


def _three(word: str, text: str) -> tuple[float, ...]:
    values = tuple(_number(word, one) for one in text.split(","))
    if len(values) != 3:
        raise InputError(f"{word!r}", accepted="three numbers: X,Y,Z")
    return values


def _with_effects(
    text: str, values: Sequence[_EffectValue], machine: Path | None, *, file: Path
) -> str:
    """The job's text with other parameters; what was left open of a fitted one goes with it."""
    wanted = tomllib.loads(text)
    _change(wanted, values, machine)

    def changed(text: str) -> str:
        document = parsed_job(text, file)
        _change(document, values, machine)
        return checked_job(tomlkit.dumps(document), wanted, file=file)

    try:
        return changed(text)
    except InputError:  # as they are written, effects cannot grow
        return changed(in_tables(text, file))


def _change(
    job: MutableMapping[str, Any], values: Sequence[_EffectValue], machine: Path | None
) -> None:
    """Change the data of a job, with its comments or without."""
    if machine is not None:
        job["machine"] = machine.name
    effects = _inside(job, "effects")
    for value in values:
        _parameters_of(effects, value)[value.parameter] = value.value
    take_fits(job, {(value.name, value.target) for value in values})
    if not effects:
        del job["effects"]


def _parameters_of(effects: Any, value: _EffectValue) -> Any:
    """The table of an effect; a new one where it is not there."""
    table = _inside(effects, value.name, is_super_table=bool(value.target))
    if not isinstance(table, MutableMapping):
        raise InputError(f"effects.{value.name} = {table!r}", accepted="a table")
    if not value.target or table.get("target") == value.target:
        return table
    return _inside(table, value.target, is_super_table=False)


def _inside(table: Any, key: str, *, is_super_table: bool = True) -> Any:
    """The table of a key; a new one of the same kind where it is not there."""
    if key not in table:
        if isinstance(table, InlineTable):
            table[key] = tomlkit.inline_table()
        elif type(table) is dict:
            table[key] = {}
        else:
            table[key] = tomlkit.table(is_super_table=is_super_table)
    return table[key]
