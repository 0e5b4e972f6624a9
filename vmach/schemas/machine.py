"""Schemas of a machine's figures: ``accuracy.json``, ``iso230.json`` and ``tables.json``."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from vmach.schemas.base import DrawnFigures, Interval, NoteRecord, Output, Vector

__all__ = ["Accuracy", "Iso230", "Tables"]


class _Volume(Output):
    low_mm: Vector
    """Of the spindle nose, machine coordinates."""
    high_mm: Vector
    grid: tuple[int, int, int]
    """Number of places along X, Y and Z."""


class _End(Output):
    nose_mm: Vector
    error_um: Vector


class _Volumetric(Output):
    largest_difference_um: float
    """Volumetric accuracy: the largest difference of the errors at two places."""
    between: tuple[_End, _End]
    pairs: int
    points: int
    largest_error_um: float
    mean_error_um: float
    rms_error_um: float
    p95_error_um: float
    range_xyz_um: Vector


class _Grouping(Output):
    angular_tolerance: float
    """Sum of the absolute differences of two unit vectors below which they count as one."""
    records: int
    comparisons: int
    largest_difference_um: float


class _Diagonal(Output):
    diagonal: str
    kind: Literal["body", "face"]
    length_mm: float
    E_um: float
    M_um: float
    B_um: float


class _Variants(Output):
    mean_htm_um: float
    mean_abbe_um: float
    abbe_smaller_percent: float
    in_words: str
    note: str


class _DoubleCounting(Output):
    component: str
    reading_um: float
    """Range of the table."""
    angular_share_um: float
    """Range of angle times arm in it; may be the larger, as it and the rest of a reading cancel."""
    correlation: float = Field(ge=-1.0, le=1.0)
    """Of the two along the axis, without unit."""


class _Profile(Output):
    file: str
    points: int
    length_mm: float
    largest_error_um: float
    range_xyz_um: Vector
    largest_difference_um: float


class _DrawnFigure(Output):
    stated_um: float
    """Without corrections."""
    mean_um: float
    u_um: float
    low_um: float
    high_um: float


class _AccuracyUncertainty(DrawnFigures):
    """Of volumetric figures; ``accuracy --uncertainty monte-carlo``."""

    figures: dict[str, _DrawnFigure]
    candidates: int
    """Points of the grid that were looked at in every draw."""
    missed_um: float
    """By how much these fell short of the whole grid in draws that checked it."""


class Accuracy(Output):
    """``accuracy.json``: volumetric accuracy of a machine."""

    machine: str
    chain: str
    model: str
    tool_length_mm: float
    volume: _Volume
    volumetric: _Volumetric
    contributions_percent: dict[str, float]
    """Share of each component in the largest difference."""
    grouping: list[_Grouping]
    diagonals: list[_Diagonal]
    variants: _Variants | None
    """Conventional arms beside Abbe-consistent ones; null where places are missing."""
    double_counting: list[_DoubleCounting]
    findings: list[str]
    finding_records: list[NoteRecord]
    """The findings as records."""
    profile: _Profile | None = None
    """Only where a profile was asked for."""
    uncertainty: _AccuracyUncertainty | None = None
    """Only where draws were asked for."""


class _Budget(Output):
    """Standard uncertainties of a positioning test."""

    source: str
    u_device: float
    """um, like all numbers here."""
    u_setup: float
    u_eve: float
    u_misalignment_per_m: float


class _OfRun(Output):
    """One run in one direction, beside the mean of all runs there."""

    run: int
    """Its number in the file."""
    direction: Literal["forward", "backward", "both"]
    readings: int
    mean: float
    """Mean difference from the mean of all runs at the same targets, in the unit of the figures."""
    largest: float
    """The difference that is largest in magnitude."""
    at: float
    """Target of `largest`, mm or degrees."""


class _Outlier(Output):
    """A reading far from those of the other runs."""

    run: int
    """Its number in the file."""
    direction: Literal["forward", "backward", "both"]
    at: float
    """Target, mm or degrees."""
    deviation: float
    """The reading, in the unit of the figures."""
    from_others: float
    """Its difference from the mean of the other runs, in the unit of the figures."""


class _Iso230Table(Output):
    unit: Literal["um", "urad"]
    """Of `figures` and `U_k2`."""
    runs: int
    targets: int
    length_mm: float | None
    """From the first target to the last; null for a rotary axis."""
    range_deg: float | None
    """The same of a rotary axis; null for a linear one."""
    figures: dict[str, float | None]
    """Parameters of the standard by their letters, in `unit`; null where runs are missing."""
    by_run: list[_OfRun]
    outliers: list[_Outlier]
    notes: list[str]
    note_records: list[NoteRecord]
    U_k2: dict[str, float] | None = None
    """Expanded uncertainty, coverage factor 2, in `unit`; of positioning with runs alone."""


class Iso230(Output):
    """``iso230.json``: evaluation of error tables after ISO 230-2."""

    data: str
    standard: str
    budget_um: _Budget
    tables: dict[str, _Iso230Table]


class _Residual(Output):
    """Error of the tool tip, um."""

    mean: float
    rms: float
    largest: float
    largest_abs_xyz: Vector


class _BeforeAfter(Output):
    before: _Residual
    after: _Residual


class _Left(Output):
    """RMS that one component leaves, um."""

    before_rms: float
    after_rms: float


class _Format(Output):
    title: str
    holds: str
    does_not_hold: str
    files: list[str]
    entries_xyz: tuple[int, int, int]
    before_um: _Residual
    after_um: _Residual
    share_left_percent: float
    tool_100_mm_longer_um: _BeforeAfter | None
    """The same with a tool that is 100 mm longer; null for a job, whose tools are given."""
    left_by_component_um: dict[str, _Left] | None


class _VolumeOfTables(Output):
    X: Interval
    Y: Interval
    Z: Interval


class Tables(Output):
    """``tables.json``: compensation tables for controls, and what they leave."""

    format: Literal[1] = Field(alias="schema")
    machine: str
    model: str
    judged: Literal["volume", "program"]
    tool_length_mm: float
    volume_mm: _VolumeOfTables
    notes: list[str]
    note_records: list[NoteRecord]
    formats: dict[str, _Format]
