"""The tables and keys of ``machine.toml``."""

from __future__ import annotations

from datetime import date
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from vmach.files.toml_file import FileSection, Finite, Flag, NonNegative, Point, Positive, Whole
from vmach.machine.component_errors import SetUp
from vmach.machine.sign_convention import SignConvention
from vmach.machine.tables.interpolation import Extrapolation, Method

__all__ = ["CROSS_VALIDATION", "MachineSchema", "TableEntry"]

CROSS_VALIDATION = "cross-validation"
_SIGN_IN_WORDS = {
    "displacement of the tool relative to the workpiece, rotations right-handed": "relative",
    "motion of the body in the frame of the bed, rotations right-handed": "body",
    "positive where the first effect is, with a positive amplifying axis": "huddersfield",
}
_ORIGIN = "spindle nose with every axis at home; axes as in ISO 841"

Provenance = Literal["measured", "reconstructed", "assumed"]


def _sign(text: str) -> str:
    sign = _SIGN_IN_WORDS.get(text, text)
    if sign not in list(SignConvention):
        raise ValueError(
            "accepted: 'relative' (tool relative to workpiece), 'body' or 'huddersfield'"
        )
    return sign


def _origin(text: str) -> str:
    if text != _ORIGIN:
        raise ValueError(f"accepted: '{_ORIGIN}'")
    return text


class _Convention(FileSection):
    origin: Annotated[str, AfterValidator(_origin)] = _ORIGIN
    sign: Annotated[
        str,
        AfterValidator(_sign),
        Field(json_schema_extra={"enum": [*SignConvention, *_SIGN_IN_WORDS]}),
    ]
    length: Literal["um", "mm", "m", "inch", "uin"]
    angle: Literal["urad", "rad", "mrad", "arcsec", "deg", "um/m", "um/mm"]
    set_up: SetUp = SetUp.REFLECTOR
    reference_axes: Annotated[str, Field(pattern="^[XYZ]{2}$")] | None = None


class _Motion(FileSection):
    rapid_mm_min: Positive
    tool_change_s: NonNegative = 0.0
    acceleration_mm_s2: Positive | None = None


class _Axis(FileSection):
    travel_mm: tuple[Finite, Finite] | None = None
    travel_deg: tuple[Finite, Finite] | None = None
    centre_mm: Point | None = None


class _Curve(FileSection):
    """Keys that hold for all tables in [tables], or for one in [errors.NAME]."""

    interpolation: Method | Literal["cross-validation"] | None = None
    order: Whole | None = None
    period_mm: Positive | None = None
    extrapolation: Extrapolation | None = None


class _Tables(_Curve):
    directions: Literal["mean", "separate"] = "mean"
    provenance: Provenance | None = None
    measured_on: date | None = None


class TableEntry(_Curve):
    """One component error."""

    table: str | None = None
    unit: str | None = None
    position_zero_mm: Finite | None = None
    reverse: Flag | None = None
    reverse_deviations: Flag | None = None
    measured_at_mm: Point | None = None
    nose_at_mm: Point | None = None
    stick_out_mm: NonNegative | None = None
    set_up: SetUp | None = None
    slope_removed: bool | None = None
    provenance: Provenance | None = None
    measured_on: date | None = None


class _Volumetric(FileSection):
    file: str
    format: Literal["isg-csv", "etalon"]
    measured_at_mm: Point
    without: list[str] = Field(default_factory=list)


class SquarenessEntry(FileSection):
    """A squareness stated in more than one unit, as reports do."""

    um_per_m: Finite | None = None
    arcsec: Finite | None = None
    use: Literal["um_per_m", "arcsec"] | None = None


class _Uncertainty(FileSection):
    """Standard uncertainties of the measurement of the machine."""

    reading_um: Positive | None = None
    reading_urad: Positive | None = None
    squareness_urad: NonNegative | None = None
    positioning_um_per_m: NonNegative = 0.0
    measured_at_mm: NonNegative = 0.0


class MachineSchema(FileSection):
    """A whole machine file."""

    schema_: Literal[1] = Field(alias="schema")
    name: str
    chain: str
    convention: _Convention
    motion: _Motion
    axes: dict[Literal["X", "Y", "Z", "A", "B", "C"], _Axis]
    tables: _Tables = _Tables()
    errors: dict[str, TableEntry] = Field(default_factory=dict)
    volumetric: _Volumetric | None = None
    location: dict[str, Finite] = Field(default_factory=dict)
    squareness: dict[str, Finite | SquarenessEntry] = Field(default_factory=dict)
    uncertainty: _Uncertainty = _Uncertainty()
