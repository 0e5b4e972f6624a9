"""Squareness as a report states it: the size of an angle, and which way it leans.

Source: ISO 230-1 (squareness of two axes as the angle between their lines); closed form derived
here: EC0Y turns the direction of Y by dx = -EC0Y y, so the angle between +X and +Y grows by it.
"""

from __future__ import annotations

from vmach.base.units import rad_from_urad
from vmach.errors import InputError
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported, Section
from vmach.importers.questions import Questions

__all__ = ["NAMES", "squareness_sections"]

#: by plane: the squareness that carries it, and its sign where the angle between the + axes grows
NAMES = {"XY": ("EC0Y", 1.0), "ZX": ("EB0X", 1.0), "YZ": ("EA0Y", -1.0)}


def squareness_sections(
    plane: str, size_urad: float, questions: Questions, *, what: str
) -> Imported:
    """The line of ``[squareness]`` for the angle between two axes.

    Parameters
    ----------
    plane : str
        XY, YZ or ZX, in any order.
    size_urad : float
        By how much the angle is not 90 degrees, without sign; um/m is the same.
    questions : Questions
    what : str
        What it comes from, for messages.

    Raises
    ------
    InputError
        Another plane, or an angle that no machine has.
    """
    known = NAMES | {name[::-1]: of for name, of in NAMES.items()}
    if plane not in known:
        raise InputError(f"{what}: plane '{plane}'", accepted=", ".join(NAMES))
    if not 0.0 <= size_urad < 1e4:
        raise InputError(f"{what}: {size_urad:g} um/m", accepted="0 to 10,000 um/m")
    name, sign = known[plane]
    answer = questions.choice(
        "angle",
        f"is the angle between +{plane[0]} and +{plane[1]} more or less than 90 degrees?",
        ("more", "less"),
    )
    convention = Convention.of(questions.machine_file)
    leans = sign * (1.0 if answer == "more" else -1.0)
    value = convention.in_angle_unit(rad_from_urad(leans * size_urad))
    said = (
        f"{what}: +{plane[0]} and +{plane[1]} enclose {answer} than 90 degrees by "
        f"{size_urad:g} um/m: {name} = {value:g} {convention.angle}"
    )
    return Imported(sections=(Section("machine", "squareness", {name: value}),), notes=(said,))
