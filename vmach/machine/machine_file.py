"""Reading ``machine.toml`` with its error tables."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES, Chain
from vmach.machine.component_errors import (
    COMPONENT_NAMES,
    ComponentError,
    component_of,
    read_error_table,
)
from vmach.machine.machine import Axis, Machine, Motion, SignConvention
from vmach.toml_file import FileSection, line_of_key, read_text, read_toml

__all__ = ["read_machine"]

_MM_PER = {"um": 1e-3, "mm": 1.0}
_RAD_PER = {"urad": 1e-6, "rad": 1.0, "arcsec": math.pi / 648000}
_SIGN_IN_WORDS = {
    "displacement of the tool relative to the workpiece, rotations right-handed": "relative",
    "motion of the body in the frame of the bed, rotations right-handed": "body",
}
_ORIGIN = "spindle nose with every axis at home; axes as in ISO 841"

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Point = tuple[Finite, Finite, Finite]


def _sign(text: str) -> str:
    sign = _SIGN_IN_WORDS.get(text, text)
    if sign not in list(SignConvention):
        raise ValueError("accepted: 'relative' (tool relative to workpiece) or 'body'")
    return sign


def _origin(text: str) -> str:
    if text != _ORIGIN:
        raise ValueError(f"accepted: '{_ORIGIN}'")
    return text


class _Convention(FileSection):
    origin: Annotated[str, AfterValidator(_origin)] = _ORIGIN
    sign: Annotated[str, AfterValidator(_sign)]
    length: Literal["um", "mm"]
    angle: Literal["urad", "rad", "arcsec"]


class _Motion(FileSection):
    rapid_mm_min: Positive
    tool_change_s: NonNegative = 0.0
    acceleration_mm_s2: Positive | None = None


class _Axis(FileSection):
    travel_mm: tuple[Finite, Finite]


class _Table(FileSection):
    table: str
    measured_at_mm: Point | None = None


class _MachineFile(FileSection):
    schema_: Literal[1] = Field(alias="schema")
    name: str
    chain: str
    convention: _Convention
    motion: _Motion
    axes: dict[Literal["X", "Y", "Z"], _Axis]
    errors: dict[str, _Table] = {}
    squareness: dict[str, Finite] = {}


def read_machine(path: str | Path) -> Machine:
    """Read a machine file and the tables that it names.

    Raises
    ------
    InputError
        Anything wrong with the files, with file, line, key, value and what is accepted.
    """
    path = Path(path)
    data = read_toml(path, _MachineFile, what="machine file")
    text = read_text(path, what="machine file")

    def fail(keys: list[str], what: str, accepted: str) -> InputError:
        return InputError(what, file=path, line=line_of_key(text, keys), accepted=accepted)

    try:
        chain = Chain.parse(data.chain)
    except InputError as error:
        raise fail(["chain"], error.what, error.accepted or "") from None
    for axis in LINEAR_AXES:
        if axis not in data.axes:
            raise fail(["axes"], f"axis {axis} has no travel", "[axes.X], [axes.Y], [axes.Z]")
        low, high = data.axes[axis].travel_mm
        if low >= high:
            raise fail(["axes", axis, "travel_mm"], f"travel {low} .. {high} mm", "[low, high]")
    for name in data.errors:
        if name not in COMPONENT_NAMES:
            raise fail(["errors", name], f"component error '{name}'", ", ".join(COMPONENT_NAMES))
        if component_of(name)[2] and data.errors[name].measured_at_mm is not None:
            raise fail(
                ["errors", name, "measured_at_mm"],
                f"{name} is an angle, which is the same at every point of the body",
                "measured_at_mm for positioning and straightness only",
            )
    for name in data.squareness:
        if not _is_squareness(name):
            raise fail(
                ["squareness", name],
                f"squareness '{name}'",
                "E, a rotation A, B or C, 0, the axis that is out of square across it: EC0Y",
            )
    return Machine(
        name=data.name,
        chain=chain,
        axes={name: Axis(*data.axes[name].travel_mm) for name in LINEAR_AXES},
        motion=Motion(
            data.motion.rapid_mm_min, data.motion.tool_change_s, data.motion.acceleration_mm_s2
        ),
        components={name: _component(name, data, path.parent) for name in data.errors},
        squareness_rad=_squareness(data),
        sign=SignConvention(data.convention.sign),
        files=(path, *(path.parent / entry.table for entry in data.errors.values())),
    )


def _is_squareness(name: str) -> bool:
    if len(name) != 4 or name[0] != "E" or name[2] != "0":
        return False
    rotation, axis = "ABC".find(name[1]), "XYZ".find(name[3])
    return rotation >= 0 and axis >= 0 and rotation != axis


def _component(name: str, data: _MachineFile, folder: Path) -> ComponentError:
    entry = data.errors[name]
    angular = component_of(name)[2]
    scale = _RAD_PER[data.convention.angle] if angular else _MM_PER[data.convention.length]
    at = None if entry.measured_at_mm is None else np.array(entry.measured_at_mm, dtype=float)
    return ComponentError(name, *read_error_table(folder / entry.table, scale), at)


def _squareness(data: _MachineFile) -> np.ndarray:
    """Rotation vector of every axis' reference line, (3, 3), rad."""
    sigma = np.zeros((3, 3))
    for name, value in data.squareness.items():
        sigma["XYZ".index(name[3]), "ABC".index(name[1])] = value * _RAD_PER[data.convention.angle]
    return sigma
