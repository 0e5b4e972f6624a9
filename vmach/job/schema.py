"""The tables and keys of ``job.toml``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from gcode import INCREMENT_SYSTEMS, WORK_OFFSETS, ProgramError, dialect_name, dialect_names
from vmach.files.toml_file import (
    FileSection,
    Finite,
    NonNegative,
    Point,
    Positive,
    Whole,
    numbers_once,
)

__all__ = [
    "FILE_KEY",
    "FILE_NAME",
    "CircularTestEntry",
    "ControlEntry",
    "DrawingEntry",
    "FeatureEntry",
    "FileName",
    "FittedEntry",
    "HistoryEntry",
    "InspectionEntry",
    "JobSchema",
    "MeasuringMachineEntry",
    "OffsetRow",
    "ProbingEntry",
    "StockEntry",
    "ToolEntry",
]

#: marks what names a file or a folder, seen from the folder of the job
FILE_NAME = "file name"
FileName = Annotated[str, FILE_NAME]
#: a table whose other keys an instrument knows; this one names a file
FILE_KEY = "file"
MeasurementTable = Annotated[dict[str, Any], FILE_KEY]

#: largest number of a tool, and of a row of the offset memory
_LARGEST_TOOL = 99_999
_Number = Annotated[int, Field(ge=1, le=_LARGEST_TOOL)]


def _in_quotes(offsets: Any) -> Any:
    """Refuse G59.1 without quotes, which TOML reads as the key 1 of a table G59."""
    for name, value in offsets.items() if isinstance(offsets, Mapping) else ():
        for key in value if isinstance(value, Mapping) else ():
            if f"{name}.{key}" in WORK_OFFSETS:
                raise ValueError(f'accepted: quotes around the point: "{name}.{key}" = [x, y, z]')
    return offsets


def _known_offsets(offsets: dict[str, Point]) -> dict[str, Point]:
    for name in offsets:
        if name not in WORK_OFFSETS:
            raise ValueError("accepted: G54 to G59, G59.1 to G59.3, G54.1 P1 to G54.1 P99")
    return offsets


def _known_dialect(name: str | None) -> str | None:
    if name is None:
        return None
    try:
        return dialect_name(name)
    except ProgramError:
        raise ValueError(f"accepted: auto, {', '.join(dialect_names())}") from None


#: sign of the last motion of an axis; 0 where it is not known
Side = Literal[-1, 0, 1]
#: units of length that CAD without a unit of its own can be told
LengthUnit = Literal["um", "mm", "cm", "m", "inch"]


def _known_increment(name: str | None) -> str | None:
    if name is not None and name not in INCREMENT_SYSTEMS:
        raise ValueError(f"accepted: {', '.join(INCREMENT_SYSTEMS)}")
    return name


class ControlEntry(FileSection):
    """[control]: which control reads the program, and its switches."""

    name: Annotated[str, AfterValidator(_known_dialect)] = "auto"
    increment: Annotated[str | None, AfterValidator(_known_increment)] = None
    block_delete: bool | list[Annotated[int, Field(ge=1, le=9)]] = False
    ignore_m: list[Annotated[int, Field(ge=0, le=99_999)]] = []
    ignore_calls: list[str] = []
    variables: dict[str, Finite] = {}
    subprograms: FileName | None = None
    options: dict[str, str] = {}


class StockEntry(FileSection):
    """[stock]: a box, or a solid in a file."""

    min_mm: Point | None = None
    max_mm: Point | None = None
    file: FileName | None = None
    unit: LengthUnit | None = None


class ToolEntry(FileSection):
    """[tools.N]; which dimensions a shape needs is the business of `stock.make_tool`."""

    name: str = ""
    shape: Literal["flat", "ball", "bull", "chamfer", "drill", "profile"]
    diameter_mm: Positive
    length_mm: Positive
    corner_radius_mm: NonNegative | None = None
    tip_diameter_mm: NonNegative | None = None
    angle_deg: Positive | None = None
    flute_length_mm: Positive | None = None
    shank_diameter_mm: Positive | None = None
    holder_mm: list[tuple[NonNegative, Finite]] | None = None
    profile_mm: list[tuple[NonNegative, Finite]] | None = None
    flutes: Whole | None = None


class OffsetRow(FileSection):
    """[offsets.N]: what H and D of a number mean on the control."""

    length_mm: Finite | None = None
    length_wear_mm: Finite = 0.0
    diameter_mm: Finite | None = None
    diameter_wear_mm: Finite = 0.0


class InspectionEntry(FileSection):
    """[inspection]."""

    spacing_mm: Positive = 2.0
    edge_margin_mm: NonNegative = 0.1
    reach_mm: Positive = 1.0
    tolerance_um: Positive = 10.0
    difference_mm: Positive = 0.1
    alignment: Literal["none", "best-fit", "datum"] = "none"
    datums: list[list[str]] = []


class MeasuringMachineEntry(FileSection):
    """[measuring_machine]: its maximum permissible errors (ISO 10360), or what is known of it."""

    k_mm_per_um: Positive = 350.0
    scale_u_ppm: NonNegative | None = None
    squareness_u_urad: NonNegative | None = None
    probing_form_um: NonNegative = 0.0
    feature_u_um: NonNegative = 0.0
    clamping_u_um: NonNegative | None = None


class ProbingEntry(FileSection):
    """[probing]: workpiece zero and tool lengths were set on this very machine."""

    zero_at_mm: Point = (0.0, 0.0, 0.0)
    x_at_mm: Point | None = None
    y_at_mm: Point | None = None
    z_at_mm: Point | None = None
    probe_length_mm: Positive | None = None
    tools: Literal["touched", "preset"] = "touched"
    tools_at_mm: Point | None = None
    approach: tuple[Side, Side, Side] = (0, 0, -1)


class FittedEntry(FileSection):
    """[[fitted]]: what ``vmach add`` left open of an effect's parameters."""

    effect: str
    target: str = ""
    one_sigma: list[dict[str, Finite | list[Finite]]]


class CorrelatedEntry(FileSection):
    """[[correlated]]: two effects that ``vmach add`` fitted together."""

    effects: Annotated[list[str], Field(min_length=2, max_length=2)]
    coefficients: list[list[Annotated[float, Field(ge=-1.0, le=1.0)]]]


class HistoryEntry(FileSection):
    """[[history]]: what ``vmach add`` notes of the job before."""

    previous: FileName
    added: list[str] = []
    rms_before_um: NonNegative | None = None
    rms_after_um: NonNegative | None = None
    #: name of an effect of a user's own, and the file that it is in
    effect_files: dict[str, FileName] = {}


class FeatureEntry(FileSection):
    """[[features]]: a name for faces of the nominal CAD, or for points of a file."""

    name: Annotated[str, Field(min_length=1)]
    faces: str | list[str] | None = None
    kind: Literal["plane", "cylinder", "sphere", "free"] | None = None


class DrawingEntry(FileSection):
    """[drawing]: how it is read, and the head of reports."""

    association: Literal["least squares", "contact"] = "least squares"
    pmi: bool = True
    part: str = ""
    serial: str = ""
    revision: str = ""
    logo: FileName | None = None


class CircularTestEntry(FileSection):
    """[circular_test]: evaluate the circles of the program; the largest figures accepted."""

    G_um: Positive | None = None
    G_b_um: Positive | None = None
    D_um: Positive | None = None
    F_um: Positive | None = None


class JobSchema(FileSection):
    """A whole job file."""

    schema_: Literal[1] = Field(alias="schema")
    machine: FileName
    program: FileName
    dialect: Annotated[str | None, AfterValidator(_known_dialect)] = None
    control: ControlEntry = ControlEntry()
    nominal: FileName | None = None
    nominal_unit: LengthUnit | None = None
    measured: FileName | None = None
    workpiece_zero: str | None = None
    tool_offsets: Literal["program", "touched off"] = "program"
    work_offsets_mm: Annotated[
        dict[str, Point], BeforeValidator(_in_quotes), AfterValidator(_known_offsets)
    ]
    stock: StockEntry | None = None
    tools: Annotated[dict[_Number, ToolEntry], numbers_once("tool")]
    offsets: Annotated[dict[_Number, OffsetRow], numbers_once("offset")] = {}
    inspection: InspectionEntry = InspectionEntry()
    measuring_machine: MeasuringMachineEntry = MeasuringMachineEntry()
    probing: ProbingEntry | None = None
    features: list[FeatureEntry] = []
    datums: dict[str, str] = {}
    tolerances: dict[str, str | list[str]] = {}
    drawing: DrawingEntry = DrawingEntry()
    circular_test: CircularTestEntry | None = None
    effects: dict[str, Any] = {}
    measurements: list[MeasurementTable] = []
    history: list[HistoryEntry] = []
    fitted: list[FittedEntry] = []
    correlated: list[CorrelatedEntry] = []
