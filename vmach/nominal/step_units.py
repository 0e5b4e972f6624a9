"""Units of the geometry in a STEP file, from the context of its representation."""

from __future__ import annotations

from vmach.nominal.step_file import StepEntity, StepFile

__all__ = ["angle_unit_rad", "length_unit_mm"]

_PREFIX = {
    None: 1.0,
    "MICRO": 1e-6,
    "MILLI": 1e-3,
    "CENTI": 1e-2,
    "DECI": 1e-1,
    "KILO": 1e3,
}


def length_unit_mm(step: StepFile, context: StepEntity) -> float:
    """Unit of length in mm; metres where the context names none, as the standard has it."""
    return 1e3 * _unit(step, context, "LENGTH_UNIT")


def angle_unit_rad(step: StepFile, context: StepEntity) -> float:
    """Unit of plane angle in rad."""
    return _unit(step, context, "PLANE_ANGLE_UNIT")


def _unit(step: StepFile, context: StepEntity, kind: str) -> float:
    for reference in context.parts.get("GLOBAL_UNIT_ASSIGNED_CONTEXT", [[]])[0]:
        unit = step.entity(reference)
        if unit.is_a(kind):
            return _in_si(step, unit)
    return 1.0


def _in_si(step: StepFile, unit: StepEntity) -> float:
    """Size of a unit in metres or radians."""
    if unit.is_a("SI_UNIT"):
        prefix = unit.parts["SI_UNIT"][0]
        if prefix not in _PREFIX:
            raise step.error(unit, f"the prefix {prefix}", ", ".join(filter(None, _PREFIX)))
        return _PREFIX[prefix]
    if not unit.is_a("CONVERSION_BASED_UNIT"):
        raise step.error(unit, "this unit is not supported", "SI units and multiples of them")
    measure = step.entity(unit.parts["CONVERSION_BASED_UNIT"][1])
    value, base = next(args for args in measure.parts.values() if len(args) == 2)
    number = value[1][0] if isinstance(value, tuple) else value
    return float(number) * _in_si(step, step.entity(base))
