"""The effects there are: those of this package, and those that others add by an entry point."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from functools import lru_cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import numpy as np

from vmach.effects import (
    ambient_drift,
    axis_expansion,
    backlash,
    component,
    cyclic_pitch,
    datum,
    gravity_sag,
    head_tilt,
    inertia,
    probe_radius,
    reflector,
    reversal,
    rotary_location,
    scale,
    servo,
    spindle_growth,
    squareness,
    thermal_bow,
    tool_chip,
    tool_deflection,
    tool_growth,
    tool_size,
    tool_slip,
    workpiece_temperature,
    workpiece_warming,
)
from vmach.effects.effect import Effect
from vmach.effects.instance import EffectInstance, check_fitted, one_sigma
from vmach.errors import InputError
from vmach.job import Job, read_job
from vmach.text_file import read_text
from vmach.toml_file import line_of_key

__all__ = [
    "ENTRY_POINT",
    "add_effect",
    "catalogue",
    "read_effects",
    "set_up_effect",
    "unknown_effect_hint",
]

#: group of entry points under which a package offers its own effects
ENTRY_POINT = "vmach.effects"

#: the commonest first: where data cannot tell, the earlier name leads
_OWN: tuple[type[Effect], ...] = (
    backlash.Backlash,
    spindle_growth.SpindleGrowth,
    squareness.Squareness,
    workpiece_temperature.WorkpieceTemperature,
    scale.Scale,
    tool_size.ToolRadius,
    tool_size.ToolLength,
    tool_deflection.ToolDeflection,
    tool_size.ToolWear,
    axis_expansion.AxisExpansion,
    cyclic_pitch.CyclicPitch,
    servo.ServoMismatch,
    servo.ServoLag,
    head_tilt.HeadTilt,
    workpiece_warming.WorkpieceWarming,
    ambient_drift.AmbientDrift,
    component.Component,
    gravity_sag.GravitySag,
    thermal_bow.ThermalBow,
    tool_growth.ToolGrowth,
    datum.Fixture,
    datum.DatumShift,
    tool_slip.ToolSlip,
    tool_chip.ToolChip,
    probe_radius.ProbeRadius,
    tool_size.Runout,
    reversal.QuadrantGlitch,
    reversal.Hysteresis,
    reversal.LateralPlay,
    servo.CornerRounding,
    inertia.Inertia,
    gravity_sag.TableLoadSag,
    reflector.Reflector,
    rotary_location.RotaryLocation,
)


#: a name is a slip of one that is there from this likeness on, 0 to 1
_CLOSE = 0.75
#: effects that were added while the program runs, by their names
_added: dict[str, Effect] = {}


def catalogue() -> dict[str, Effect]:
    """Every known effect by its name, in order of how common it is; the caller's own copy."""
    return _installed() | _added


def add_effect(effect: Effect) -> None:
    """Make an effect known for as long as the program runs, in place of one of its name."""
    _added[effect.name] = effect


@lru_cache(maxsize=1)
def _installed() -> dict[str, Effect]:
    """Effects of vmach and of packages beside it."""
    effects: dict[str, Effect] = {kind.name: kind() for kind in _OWN}
    for entry in entry_points(group=ENTRY_POINT):
        try:
            kind = entry.load()
            effects[kind.name] = kind()
        except Exception as error:
            raise InputError(
                f"entry point '{entry.name} = {entry.value}' of {ENTRY_POINT} cannot be loaded: "
                f"{error!r}",
                accepted="MODULE:CLASS of a subclass of Effect",
                hint=None if entry.dist is None else f"it belongs to the package {entry.dist.name}",
            ) from error
    return effects


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
            raise _error(f"effects.{name} = {table!r}", file, [name], accepted="a table")
        nested = {key: value for key, value in table.items() if isinstance(value, Mapping)}
        plain = {key: value for key, value in table.items() if key not in nested}
        if plain or not nested:
            found.append(set_up_effect(name, str(plain.pop("target", "")), plain, job=job))
        for target, parameters in nested.items():
            found.append(set_up_effect(name, target, parameters, job=job))
    check_fitted(job, found)
    return tuple(found)


def unknown_effect_hint(name: str) -> str:
    """What to do about a name that no effect has: a slip, or an effect of the user's own."""
    close = difflib.get_close_matches(name, catalogue(), n=1, cutoff=_CLOSE)
    if close:
        return f"did you mean '{close[0]}'?"
    return "is it an effect of your own? Say its file: vmach --effect-file FILE COMMAND ..."


def set_up_effect(
    name: str, target: str, parameters: Mapping[str, Any], *, job: Job
) -> EffectInstance:
    """An effect of a job, its target and parameters checked.

    Raises
    ------
    InputError
        Unknown effect, target or parameter, a parameter missing or outside its bounds.
    """
    file = job.path
    known = catalogue()
    if name not in known:
        hint = unknown_effect_hint(name)
        raise _error(f"unknown effect '{name}'", file, [name], ", ".join(known), hint)
    effect = known[name]
    targets = effect.possible_targets(job)
    if target not in targets:
        what = (
            f"effect '{name}' has the target '{target}'"
            if target
            else f"effect '{name}' has no target"
        )
        choice = ", ".join(targets) if targets != ("",) else "no target"
        raise _error(what, file, [name, target], choice)
    names = [p.name for p in effect.parameters]
    for key in parameters:
        if key not in names:
            close = difflib.get_close_matches(key, names, n=1)
            hint = f"did you mean '{close[0]}'?" if close else None
            keys = [name, target, key] if target else [name, key]
            raise _error(
                f"effect '{name}' has no parameter '{key}'", file, keys, ", ".join(names), hint
            )
    needed = effect.needed(target)
    checked = {}
    for parameter in effect.parameters:
        keys = [name, target, parameter.name] if target else [name, parameter.name]
        if parameter.name not in parameters:
            if parameter.optional:
                checked[parameter.name] = parameter.usual
            elif parameter.name in needed:
                raise _error(
                    f"effect '{name}': '{parameter.name}' is missing ({parameter.meaning})",
                    file,
                    keys,
                    f"{parameter.low:g} .. {parameter.high:g}",
                )
            continue
        checked[parameter.name] = _in_bounds(
            parameters[parameter.name], parameter, lambda *a, k=keys: _error(a[0], file, k, a[1])
        )
    return EffectInstance(effect, target, checked, job, one_sigma(effect, target, checked, job))


def _in_bounds(value: Any, parameter, error) -> float | list[float]:
    accepted = f"{parameter.low:g} .. {parameter.high:g}"
    values = value if isinstance(value, list) else [value]
    if not all(type(one) in (int, float) for one in values):
        raise error(f"{parameter.name} = {value!r} is no number", accepted)
    numbers = np.array(value, dtype=float)
    good = np.isfinite(numbers) & (numbers >= parameter.low) & (numbers <= parameter.high)
    if not good.all():
        raise error(f"{parameter.name} = {value!r} is out of bounds", accepted)
    return numbers.tolist()


def _error(
    what: str, file: Path, keys: list[str], accepted: str, hint: str | None = None
) -> InputError:
    text = read_text(file, what="job file")
    line = line_of_key(text, ["effects", *[key for key in keys if key]])
    return InputError(what, file=file, line=line, accepted=accepted, hint=hint)
