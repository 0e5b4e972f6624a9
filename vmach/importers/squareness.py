"""Squareness as a report states it: the size of an angle, and which way it leans.

Source: ISO 230-1 (squareness of two axes as the angle between their lines); closed form derived
here: EC0Y turns the direction of Y by dx = -EC0Y y, so the angle between +X and +Y grows by it.
Of four calliper lengths: Marlin, ``Configuration.h``, "Bed Skew Compensation" (XY_SKEW_FACTOR).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from vmach.base.units import rad_from_urad, urad_from_rad
from vmach.errors import InputError
from vmach.importers.convention import Convention
from vmach.importers.importer import Imported, Section
from vmach.importers.questions import Questions

__all__ = ["NAMES", "skew_of_square", "skew_u", "square_sections", "squareness_sections"]

#: standard uncertainty of a length between two corners by callipers, mm
_CALLIPER_U_MM = 0.02
#: a machine tool leans less, urad
_DOUBTFUL_URAD = 1000.0
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
    if not 0.0 <= size_urad < 1e5:
        raise InputError(f"{what}: {size_urad:g} um/m", accepted="0 to 100,000 um/m")
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
    return Imported(sections=(Section("machine", "squareness", {name: value}),), told=(said,))


def skew_of_square(ac_mm: float, bd_mm: float, ad_mm: float) -> float:
    """Cotangent of the angle at corner A of a parallelogram, as printers' firmware has it.

    Parameters
    ----------
    ac_mm, bd_mm : float
        Diagonals; A is the corner at the axes' lowest positions, AC goes up along both.
    ad_mm : float
        The side along the first axis; AB is worked out from the three.

    Raises
    ------
    InputError
        No parallelogram has these lengths.

    Examples
    --------
    >>> round(skew_of_square(140.4, 142.8, 99.8), 5)
    -0.01695
    """
    ab_squared = 0.5 * (ac_mm**2 + bd_mm**2) - ad_mm**2
    cosine = (ac_mm**2 - ab_squared - ad_mm**2) / (2.0 * ad_mm * math.sqrt(max(ab_squared, 1e-12)))
    if ab_squared <= 0.0 or not abs(cosine) < 0.1:
        raise InputError(
            f"a square with diagonals of {ac_mm:g} and {bd_mm:g} mm and a side of {ad_mm:g} mm",
            accepted="AC, BD, AD of a square that leans by less than 6 degrees",
            hint="AC and BD are the diagonals, AD is the side along the first axis",
        )
    return cosine / math.sqrt(1.0 - cosine**2)


def skew_u(ac_mm: float, bd_mm: float, ad_mm: float, *, u_mm: float) -> float:
    """Standard uncertainty of `skew_of_square`, rad, where each diagonal has `u_mm`.

    Source: closed form derived here, with sides a, b and the angle at A:
    AC^2 - BD^2 = 4 a b cos, so u(cos) = u sqrt(AC^2 + BD^2) / (2 a b); u / a for a square. The
    side counts in second order only.

    Examples
    --------
    >>> round(1e6 * skew_u(424.18, 424.35, 300.0, u_mm=0.02), 1)
    66.7
    """
    diagonals_squared = ac_mm**2 + bd_mm**2
    ab_mm = math.sqrt(0.5 * diagonals_squared - ad_mm**2)
    return u_mm * math.sqrt(diagonals_squared) / (2.0 * ad_mm * ab_mm)


def square_sections(
    plane: str, lengths_mm: tuple[float, float, float], told: Questions
) -> Imported:
    """The line of ``[squareness]`` for the diagonals AC, BD and the side AD of a square.

    Raises
    ------
    InputError
        Lengths of no square, or an uncertainty that is none.
    """
    size_urad = urad_from_rad(skew_of_square(*lengths_mm))
    leans = Questions(
        {"angle": "less" if size_urad > 0 else "more"}, machine_file=told.machine_file
    )
    found = squareness_sections(plane, round(abs(size_urad), 1), leans, what="--square")
    other = "more" if size_urad > 0 else "less"
    exchanged = (
        f"--square: AC = {lengths_mm[0]:g} mm is taken to go up along both {plane[0]} and "
        f"{plane[1]}; with AC and BD exchanged the angle is {other} than 90 degrees by as much"
    )
    return replace(found, told=(*found.told, exchanged, *_how_sure(lengths_mm, size_urad, told)))


def _how_sure(
    lengths_mm: tuple[float, float, float], size_urad: float, told: Questions
) -> Iterator[str]:
    """What the callipers leave of it, and whether it can be."""
    u_mm = told.number(
        "u_mm", "standard uncertainty of each diagonal", unit="mm", default=_CALLIPER_U_MM
    )
    if not 0.0 < u_mm < min(lengths_mm):
        raise InputError(f"u_mm = {u_mm:g}", accepted="a standard uncertainty above 0 mm")
    u_urad = urad_from_rad(skew_u(*lengths_mm, u_mm=u_mm))
    yield (
        f"--square: standard uncertainty {u_urad:.0f} urad, as each length has {u_mm:g} mm "
        "(--set u_mm=... says otherwise)"
    )
    if abs(size_urad) > _DOUBTFUL_URAD:
        yield (
            f"--square: {abs(size_urad):.0f} urad are more than 1 mm per metre, which a printer "
            "may have and no machine tool: is a length misread?"
        )
