"""The effects that a job adds to its machine's errors, checked, and how well they are known."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.effects.catalogue import catalogue, unknown_effect_hint
from vmach.effects.correlated import with_correlations
from vmach.effects.effect import Effect, label_of
from vmach.effects.instance import EffectInstance
from vmach.effects.parameter import Parameter
from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.job import Job, read_job

__all__ = ["read_effects", "set_up_effect"]


@dataclass(frozen=True)
class _Entry:
    """An effect's table in a job file, for messages."""

    file: Path
    name: str
    target: str = ""

    def error(
        self, what: str, *, key: str = "", accepted: str, hint: str | None = None
    ) -> InputError:
        """What is wrong with it, or with one of its keys."""
        path = ["effects", *filter(None, (self.name, self.target, key))]
        line = line_of_key(read_text(self.file, what="job file"), path)
        return InputError(what, file=self.file, line=line, accepted=accepted, hint=hint)


def read_effects(
    effects: Mapping[str, Any], *, file: Path, job: Job | None = None
) -> tuple[EffectInstance, ...]:
    """The effects that a job adds to its machine's errors.

    Parameters
    ----------
    effects : mapping
        The table ``[effects]`` of the job file. ``[effects.NAME]`` holds the parameters of an
        effect without a target, or with the key ``target``; ``[effects.NAME.TARGET]`` holds
        those for one of several targets.
    file : Path
        The job file, for messages.
    job : Job, optional
        The job itself; read from `file` where left out.

    Raises
    ------
    InputError
        Unknown effect, target or parameter, a parameter missing or outside its bounds.
    """
    if not effects and (job is None or not job.fitted):
        return ()
    job = job or read_job(file)
    found = []
    for name, table in effects.items():
        if not isinstance(table, Mapping):
            raise _Entry(file, name).error(f"effects.{name} = {table!r}", accepted="a table")
        nested = {key: value for key, value in table.items() if isinstance(value, Mapping)}
        plain = {key: value for key, value in table.items() if key not in nested}
        plain_target = str(plain.pop("target", ""))
        if plain or plain_target or not nested:
            found.append(set_up_effect(name, plain_target, plain, job=job))
        for target, parameters in nested.items():
            if plain_target == target:
                raise _Entry(file, name, target).error(
                    f"effect '{name}' has the target '{target}' twice",
                    accepted=f"one of [effects.{name}] and [effects.{name}.{target}]",
                )
            found.append(set_up_effect(name, target, parameters, job=job))
    _check_fitted(job, found)
    return _correlated(found, job)


def set_up_effect(
    name: str, target: str, parameters: Mapping[str, Any], *, job: Job
) -> EffectInstance:
    """An effect of a job, its target and parameters checked.

    Raises
    ------
    InputError
        Unknown effect, target or parameter, a parameter missing or outside its bounds.
    """
    known = catalogue()
    if name not in known:
        raise _Entry(job.path, name).error(
            f"unknown effect '{name}'",
            accepted=", ".join(known),
            hint=unknown_effect_hint(name, job),
        )
    effect, entry = known[name], _Entry(job.path, name, target)
    targets = effect.possible_targets(job)
    if not targets:
        raise _without_targets(entry, effect, job)
    _check_target(entry, targets)
    _check_names(entry, parameters, [p.name for p in effect.parameters])
    values = _values(entry, effect, parameters)
    if (wrong := effect.complaint(target, values)) is not None:
        key, what, accepted = wrong
        raise entry.error(f"effect '{name}': {what}", key=key, accepted=accepted)
    return EffectInstance(effect, target, values, job, _one_sigma(effect, target, values, job))


def _check_target(entry: _Entry, targets: Sequence[str]) -> None:
    if entry.target in targets:
        return
    has = f"the target '{entry.target}'" if entry.target else "no target"
    choice = ", ".join(targets) if targets != ("",) else "no target"
    raise entry.error(f"effect '{entry.name}' has {has}", accepted=choice)


def _without_targets(entry: _Entry, effect: Effect, job: Job) -> InputError:
    """What to say of an effect that needs more than the job has, as a second work offset."""
    has = [*job.work_offsets_mm, *(f"T{number}" for number in job.tools)]
    return entry.error(
        f"effect '{entry.name}' has nothing that it could act on: {effect.title}",
        accepted="a job with what it acts on",
        hint=f"the job has {', '.join(has)}; add what is missing, or take the effect out",
    )


def _check_names(entry: _Entry, parameters: Mapping[str, Any], names: Sequence[str]) -> None:
    for key in parameters:
        if key not in names:
            close = difflib.get_close_matches(key, names, n=1)
            raise entry.error(
                f"effect '{entry.name}' has no parameter '{key}'",
                key=key,
                accepted=", ".join(names),
                hint=f"did you mean '{close[0]}'?" if close else None,
            )


def _values(
    entry: _Entry, effect: Effect, parameters: Mapping[str, Any]
) -> dict[str, float | list[float]]:
    """All parameters; those that may be left out have their usual value."""
    needed = effect.needed(entry.target)
    values: dict[str, float | list[float]] = {}
    for parameter in effect.parameters:
        name = parameter.name
        if name in parameters:
            values[name] = _value(entry, parameter, parameters[name])
            _check_form(entry, name, values[name], is_list=effect.corrects_table)
        elif parameter.optional:
            values[name] = parameter.usual
        elif name in needed:
            raise entry.error(
                f"effect '{entry.name}': '{name}' is missing ({parameter.meaning})",
                key=name,
                accepted=f"{parameter.low:g} .. {parameter.high:g}",
            )
    return values


def _value(entry: _Entry, parameter: Parameter, given: Any) -> float | list[float]:
    """A number or a list of numbers, within the parameter's bounds."""
    what, key = f"{parameter.name} = {given!r}", parameter.name
    accepted = f"{parameter.low:g} .. {parameter.high:g}"
    values = given if isinstance(given, list) else [given]
    if not all(type(one) in (int, float) for one in values):
        raise entry.error(f"{what} is no number", key=key, accepted=accepted)
    numbers = np.array(given, dtype=float)
    good = np.isfinite(numbers) & (numbers >= parameter.low) & (numbers <= parameter.high)
    if not good.all():
        raise entry.error(f"{what} is out of bounds", key=key, accepted=accepted)
    return numbers.tolist()


def _check_form(entry: _Entry, key: str, value: float | list[float], *, is_list: bool) -> None:
    """Whether a curve has its list, and everything else its one number."""
    if isinstance(value, list) == is_list and value != []:
        return
    accepted = "a list of one or more numbers" if is_list else "one number"
    raise entry.error(f"effect '{entry.name}': {key} = {value!r}", key=key, accepted=accepted)


def _one_sigma(
    effect: Effect, target: str, parameters: Mapping[str, Any], job: Job
) -> tuple[Mapping[str, Any], ...]:
    """What the job says of the uncertainty of an effect's parameters, checked against them.

    Raises
    ------
    InputError
        It is of parameters that the effect has not, or of more values.
    """
    changes = job.fitted.get((effect.name, target), ())
    for change in changes:
        for name, value in change.items():
            if np.shape(value) != np.shape(parameters.get(name, "")) or name not in parameters:
                raise InputError(
                    f"[[fitted]] of {effect.name} {target}: {name} does not match the effect",
                    file=job.path,
                    line=line_of_key(read_text(job.path, what="job file"), ["fitted"]),
                    accepted="parameters of the effect, as many values as it has",
                    hint="leave [[fitted]] as `vmach add` wrote it, or take it out",
                )
    return changes


def _correlated(found: Sequence[EffectInstance], job: Job) -> tuple[EffectInstance, ...]:
    """The effects with what is correlated of their parameters.

    Raises
    ------
    InputError
        [[correlated]] is of an effect without [[fitted]], or no quantities are correlated so.
    """

    def error(what: str, accepted: str) -> InputError:
        line = line_of_key(read_text(job.path, what="job file"), ["correlated"])
        hint = "leave [[correlated]] as `vmach add` wrote it, or take it out"
        return InputError(what, file=job.path, line=line, accepted=accepted, hint=hint)

    for both in job.correlated:
        for name, target in both:
            if (name, target) not in job.fitted:
                raise error(
                    f"[[correlated]] is of {label_of(name, target)}, which has no [[fitted]]",
                    ", ".join(label_of(*key) for key in job.fitted) or "no [[correlated]]",
                )
    try:
        return with_correlations(found, job.correlated)
    except ValueError as problem:
        raise error("[[correlated]] does not match [[fitted]]", str(problem)) from None


def _check_fitted(job: Job, found: Sequence[EffectInstance]) -> None:
    """Whether every [[fitted]] of a job belongs to one of its effects.

    Raises
    ------
    InputError
        It belongs to none.
    """
    for name, target in job.fitted.keys() - {(e.effect.name, e.target) for e in found}:
        raise InputError(
            f"[[fitted]] is of {label_of(name, target)}, an effect that the job has not",
            file=job.path,
            line=line_of_key(read_text(job.path, what="job file"), ["fitted"]),
            accepted=", ".join(e.label for e in found) or "no [[fitted]]",
            hint="take this [[fitted]] out with the effect that it belongs to",
        )
