"""Units of the geometry in a STEP file, from the context of its representation.

Source: ISO 10303-41 (measures and units).
"""

from __future__ import annotations

from vmach.nominal.step.exchange_file import Reference, StepEntity, StepFile

__all__ = ["angle_unit_rad", "length_unit_mm", "unit_in_si"]

_PREFIX = {
    None: 1.0,
    "MICRO": 1e-6,
    "MILLI": 1e-3,
    "CENTI": 1e-2,
    "DECI": 1e-1,
    "KILO": 1e3,
}


#: SI units of what a shape is stated in: lengths and angles
_NAMES = ("METRE", "RADIAN", "STERADIAN")

#: no unit is so many times as large as that it is stated in
_MOST_UNITS = 1e6

#: relative difference of two units that are the same
_SAME = 1e-9


def length_unit_mm(step: StepFile, context: StepEntity) -> float:
    """Unit of length in mm: what the context says, or `step.unit_mm` where it says nothing.

    Raises
    ------
    InputError
        Neither names a unit, or both do and differ: a part 1000 times too large or too small
        would follow.
    """
    written, told_mm = _unit(step, context, "LENGTH_UNIT"), step.unit_mm
    if written is None and told_mm is None:
        raise step.error(
            context,
            "the file names no unit of length",
            'LENGTH_UNIT in the context of the shape, or nominal_unit = "mm" (um, cm, m, inch) '
            "in the job",
        )
    if written is None:
        return told_mm
    if told_mm is not None and abs(told_mm / (1e3 * written) - 1.0) > _SAME:
        raise step.error(
            context,
            f"the file's unit of length is {1e3 * written:g} mm, the job's nominal_unit "
            f"{told_mm:g} mm",
            "one unit; leave nominal_unit out",
        )
    return 1e3 * written


def angle_unit_rad(step: StepFile, context: StepEntity) -> float:
    """Unit of plane angle in rad; radians where the context names none, as the standard has it."""
    written = _unit(step, context, "PLANE_ANGLE_UNIT")
    return 1.0 if written is None else written


def _unit(step: StepFile, context: StepEntity, kind: str) -> float | None:
    for reference in context.parts.get("GLOBAL_UNIT_ASSIGNED_CONTEXT", [[]])[0]:
        unit = step.entity(reference)
        if unit.is_a(kind):
            return unit_in_si(step, unit)
    return None


def unit_in_si(step: StepFile, unit: StepEntity) -> float:
    """Size of a unit in metres or radians.

    Raises
    ------
    InputError
        A unit that is not known, or of an impossible size.
    """
    if unit.is_a("SI_UNIT"):
        prefix, name = unit.parts["SI_UNIT"]
        if name not in _NAMES:
            raise step.error(unit, f"the unit {name}", ", ".join(_NAMES))
        if prefix not in _PREFIX:
            raise step.error(unit, f"the prefix {prefix}", ", ".join(filter(None, _PREFIX)))
        return _PREFIX[prefix]
    if not unit.is_a("CONVERSION_BASED_UNIT"):
        raise step.error(unit, "this unit is not supported", "SI units and multiples of them")
    measure = step.entity(unit.parts["CONVERSION_BASED_UNIT"][1])
    value, base = next(args for args in measure.parts.values() if len(args) == 2)
    number = value[1][0] if isinstance(value, tuple) else value
    if not isinstance(number, float | int) or isinstance(number, Reference | bool):
        raise step.error(measure, f"{number!r} is no number of units", "a number above 0")
    if not 0.0 < number <= _MOST_UNITS:
        raise step.error(
            measure, f"a unit {number:g} times as large", f"above 0, up to {_MOST_UNITS:g}"
        )
    return number * unit_in_si(step, step.entity(base))
