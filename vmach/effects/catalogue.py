"""The effects there are: those of this package, and those that others add by an entry point."""

from __future__ import annotations

import difflib
from functools import lru_cache
from importlib.metadata import entry_points

from vmach.effects.declaration import check_declaration
from vmach.effects.effect import Effect
from vmach.effects.laws.geometry import (
    component,
    cyclic_pitch,
    gravity_sag,
    head_tilt,
    reflector,
    rotary_location,
    scale,
    squareness,
)
from vmach.effects.laws.heat import (
    ambient_drift,
    axis_expansion,
    spindle_growth,
    thermal_bow,
    tool_growth,
)
from vmach.effects.laws.servo import backlash, inertia, reversal, servo
from vmach.effects.laws.tool import tool_chip, tool_deflection, tool_size, tool_slip
from vmach.effects.laws.workpiece import (
    datum,
    probe_radius,
    workpiece_temperature,
    workpiece_warming,
)
from vmach.errors import InputError
from vmach.job import Job

__all__ = [
    "ENTRY_POINT",
    "add_effect",
    "catalogue",
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
            check_declaration(kind)
            effects[kind.name] = kind()
        except Exception as error:
            raise InputError(
                f"entry point '{entry.name} = {entry.value}' of {ENTRY_POINT} cannot be loaded: "
                f"{error!r}",
                accepted="MODULE:CLASS of a subclass of Effect",
                hint=None if entry.dist is None else f"it belongs to the package {entry.dist.name}",
            ) from error
    return effects


def unknown_effect_hint(name: str, job: Job | None = None) -> str:
    """What to do about a name that no effect has: a slip, or an effect of the user's own.

    A job's history says in which file an effect of the user's own was when it was added.
    """
    if job is not None:
        last = job.history[-1] if job.history else {}
        kept = last.get("effect_files", {}).get(name)
        file = job.folder / (kept or f"{name}.py")
        if file.is_file():
            return f"it is in {file}: vmach --effect-file {file} COMMAND ..."
        if kept:
            return (
                f"it was in {file}, which is not there: where is the file now? Say it with "
                "vmach --effect-file FILE COMMAND ..."
            )
    close = difflib.get_close_matches(name, catalogue(), n=1, cutoff=_CLOSE)
    if close:
        return f"did you mean '{close[0]}'?"
    return "is it an effect of your own? Say its file: vmach --effect-file FILE COMMAND ..."
