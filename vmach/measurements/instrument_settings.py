"""What a job says about each of its tests: place, axis, tool length, uncertainty."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from vmach.errors import InputError
from vmach.job import Job
from vmach.toml_file import FileSection, line_of_key, read_text

__all__ = [
    "Ballbar",
    "Diagonal",
    "Drift",
    "InstrumentSettings",
    "Laser",
    "Tip",
    "settings_of",
]

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Point = tuple[Finite, Finite, Finite]


class InstrumentSettings(FileSection):
    """Keys of every ``[[measurements]]``."""

    file: str
    tool_length_mm: Positive
    u_um: Positive


class Ballbar(InstrumentSettings):
    """Circles about a centre, both ways round."""

    kind: Literal["ballbar"]
    plane: Literal["XY", "YZ", "ZX", "XZ", "YX", "ZY"] = "XY"
    centre_mm: Point
    radius_mm: Positive


class Laser(InstrumentSettings):
    """Positions of one axis, from both sides."""

    kind: Literal["laser"]
    axis: Literal["X", "Y", "Z"]
    at_mm: Point


class Diagonal(InstrumentSettings):
    """Distances along a line that several axes make together."""

    kind: Literal["diagonal"]
    from_mm: Point
    to_mm: Point


class Drift(InstrumentSettings):
    """The tool tip at one place against time."""

    kind: Literal["drift"]
    at_mm: Point


class Tip(InstrumentSettings):
    """The tool tip at places all over the volume."""

    kind: Literal["tip"]
    frame: Literal["offset", "rigid"] = "offset"


_KINDS = ("ballbar", "laser", "diagonal", "drift", "tip")
_INSTRUMENT: TypeAdapter[InstrumentSettings] = TypeAdapter(
    Annotated[Ballbar | Laser | Diagonal | Drift | Tip, Field(discriminator="kind")]
)


def settings_of(job: Job, entry: Mapping[str, Any]) -> InstrumentSettings:
    """One ``[[measurements]]`` of a job, checked.

    Raises
    ------
    InputError
        Unknown kind or key, a key missing, a value that is not accepted.
    """
    try:
        return _INSTRUMENT.validate_python(dict(entry))
    except ValidationError as error:
        first = error.errors()[0]
        keys = [str(part) for part in first["loc"] if part not in _KINDS]
        text = read_text(job.path, what="job file")
        raise InputError(
            f"[[measurements]] of {entry.get('file', 'no file')}: "
            f"{'.'.join(keys) or 'kind'}: {first['msg']}",
            file=job.path,
            line=line_of_key(text, ["measurements"]),
            accepted=f"kind = {', '.join(_KINDS)}, with the keys of that kind",
        ) from None
