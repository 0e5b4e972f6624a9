"""Schemas of predicted parts: ``summary.json``, ``predict --json`` and ``path --json``."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from vmach.schemas.base import DrawnFigures, NoteRecord, Output, Vector

__all__ = ["PathErrors", "PointPrediction", "Summary"]


class _Figures(Output):
    """Statistics of deviations; null where no point has one."""

    status: dict[str, int]
    """Number of points by status: cut, uncut, gouged away."""
    mean_um: float | None
    rms_um: float | None
    min_um: float | None
    max_um: float | None
    peak_to_valley_um: float | None
    outside_tolerance: int
    """Number of points."""
    outside_tolerance_share: float | None = Field(ge=0.0, le=1.0)


class _Worst(Output):
    """One of the points that deviate most, and the move that made it."""

    id: str
    feature: str
    deviation_um: float | None
    point_mm: Vector
    """Nominal point, workpiece coordinates."""
    normal: Vector
    """Outward unit normal."""
    line: int
    """1-based NC line; 0 where no move made the point."""
    nc: str
    """Text of that line."""
    tool: int
    move: int
    """0-based number of the move; -1 where none made the point."""
    time_s: float
    """Since the start of the program."""
    cause: str | None = None
    """Largest shares of the deviation, um, in words; of the last predicted variant."""


class _Variant(_Figures):
    """One error model, or the measurement."""

    label: str
    remainder_rms_um: float | None
    """Measured minus predicted after a best fit; null without a measurement."""
    features: dict[str, _Figures]
    worst: list[_Worst]


class _Place(Output):
    """A place where the virtual part and the nominal CAD differ."""

    kind: str
    depth_um: float
    point_mm: Vector
    size_mm: Vector
    """Extent along X, Y and Z."""
    area_mm2: float
    volume_mm3: float | None
    feature: str
    line: int
    nc: str
    tool: int


class _Differences(Output):
    threshold_um: float
    count: int
    """Places beyond the threshold; the deepest of them are listed."""
    places: list[_Place]


class _CircularTest(Output):
    """A pair of circles, ISO 230-4."""

    plane: Literal["XY", "YZ", "ZX"]
    centre_mm: Vector
    """Machine coordinates of the spindle nose."""
    radius_mm: float
    feed_mm_min: float
    line_ccw: int
    line_cw: int
    G_ccw_um: float
    G_cw_um: float
    G_b_um: float
    """Of both ways together."""
    D_um: float
    F_min_um: float
    F_max_um: float
    u_um: dict[str, float] | None
    """Standard uncertainty of each figure, to first order."""
    too_large: list[str]
    """Figures beyond what the job accepts."""


class _FeatureValue(Output):
    value_mm: float
    u_um: float | None
    """Standard uncertainty; null where it is not known."""
    verdict: Literal["conforms", "does not conform", "cannot be told"]
    """After ISO 14253-1."""
    interval_mm: list[float] | None
    """Ends of the coverage interval of 95 %; null where nothing was drawn."""


class _FeatureLine(Output):
    line: int
    nc: str
    tool: int
    share: float
    """Of the influence that the feature's points have on the value, 0 to 1."""


class _Feature(Output):
    """One value that the drawing asks for."""

    feature: str
    requirement: str
    """As the drawing says it."""
    characteristic: str
    label: str
    """`smallest` or `largest` where a size has two values."""
    faces: list[str]
    datums: list[str]
    nominal_mm: float | None
    lower_mm: float | None
    """null where there is an upper limit only."""
    upper_mm: float | None
    values: dict[str, _FeatureValue]
    """By variant, and `measured`."""
    primary: str
    """The variant that shares and lines are of."""
    shares_um: dict[str, float]
    """What each error adds to the value; together its difference from nominal."""
    cause: str
    """The largest shares in words."""
    lines: list[_FeatureLine]
    point_mm: Vector | None
    """The point that decides most."""
    reason: str
    """Why there is no value; empty where there is one."""


class _Remainders(Output):
    htm: float
    """RMS, um."""
    abbe: float
    """RMS, um."""


class _Arms(Output):
    """Conventional arms minus Abbe-consistent ones, over the points that both cut."""

    largest_um: float
    rms_um: float
    feature: str
    """Where the difference is largest."""
    point_mm: Vector
    line: int
    nc: str
    remainder_rms_um: _Remainders | None
    """Measured minus predicted; null without a measurement, like the three below."""
    gain_um: float | None
    """RMS left by HTM minus that left by Abbe."""
    gain_interval_um: tuple[float, float] | None
    """95 %, by a bootstrap over blocks of points."""
    nearer: Literal["abbe", "htm", "cannot be told"] | None


class _InputFile(Output):
    role: str
    path: str
    sha256: str
    size_bytes: int


class _Run(Output):
    command: str
    started_at: str
    """ISO 8601."""
    files: list[_InputFile]
    versions: dict[str, str]
    stages_s: dict[str, float]
    facts: dict[str, str]
    warnings: list[str]
    warning_records: list[NoteRecord]
    """The warnings of the run as records."""


class Summary(Output):
    """``summary.json``: the figures of ``vmach run`` and ``vmach compare``."""

    format: Literal["vmach-summary-1"] = Field(alias="schema")
    title: str
    model: str
    """Error model that the solid was cut with."""
    sign_convention: str
    tolerance_um: float
    points: int
    worst_apart_mm: float
    """Least distance between two points of `worst`."""
    variants: dict[str, _Variant]
    differences: _Differences | None
    """The virtual part against the nominal CAD; null without one."""
    features: list[_Feature]
    circular_tests: list[_CircularTest]
    """What the drawing asks for; empty where the job has no tolerances."""
    htm_against_abbe: _Arms | None
    """null where only one of them was predicted."""
    run: _Run


class _CutAnew(Output):
    """A few draws that went through the removal engine."""

    draws: int
    points_that_changed_state: int
    largest_difference_to_straight_um: float


class _PointUncertainty(DrawnFigures):
    """Of predicted points; ``predict --uncertainty monte-carlo``."""

    cut_anew: _CutAnew | None
    """Null for programs that are too long, and without an error model."""


class PointPrediction(Output):
    """``predict --json``: figures of predicted deviations."""

    points: int
    model: str
    status: dict[str, int]
    """Number of points by status: cut, uncut, gouged away."""
    mean_um: float | None = None
    """Of the points that are cut; absent where there are none, like the three below."""
    rms_um: float | None = None
    min_um: float | None = None
    max_um: float | None = None
    measured_minus_predicted_rms_um: float | None = None
    """After a best fit; absent where the points were not measured."""
    uncertainty: _PointUncertainty | None = None
    """Only where draws were asked for."""


class PathErrors(Output):
    """``path --json``: the error of the tool tip along the program, machine axes."""

    nodes: int
    """Points of the path at which the error was computed."""
    largest_abs_xyz_um: Vector
    range_xyz_um: Vector
    largest_error_um: float
    """Length of the longest error vector."""
    at_line: int
    """NC line of that node."""
    at_nose_mm: Vector
    """Spindle nose there, machine coordinates."""
