"""Schemas of what is missing and what is mended: ``diagnose --json``, ``compensate --json``."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from vmach.schemas.base import NoteRecord, Output

__all__ = ["CompensationFigures", "DiagnosisFigures"]


class _OtherSet(Output):
    """A set of effects that is nearly as probable as the one that was found."""

    without: list[str]
    """Effects and targets that are not in it."""
    instead: list[str] = Field(alias="with")
    """Those that are in it instead."""
    log_odds: float
    """Natural logarithm, for it against what was found."""


class _Finding(Output):
    """An effect that is missing in the model, or something unknown."""

    effect: str | None
    target: str | None
    """Axis, component or feature that it acts on."""
    status: Literal["shown", "class"]
    """"shown" where it is told from all others, "class" where it is not."""
    share: float
    """Of what the model misses, in squares; without unit."""
    size_um: float
    log_odds: float
    """Natural logarithm, for it against without it."""
    probability: float = Field(ge=0.0, le=1.0)
    """That it is no imitation of something else."""
    parameters: dict[str, Any]
    """Numbers, or lists of a correction curve; the unit ends each name."""
    u: dict[str, Any]
    """Standard uncertainties, in the unit of the parameter."""
    interval_95: dict[str, Any]
    """Lower and upper end, in the unit of the parameter."""
    weakly_identified: list[str]
    """Parameters of which the readings say little more than was known before."""
    members: list[str] = Field(alias="class")
    """Effects that these measurements do not tell from it."""
    where: str | None
    """Place on the axis, of a correction curve."""
    rivals: list[str] = []
    """Those that each stand in its place, with targets; missing, as all below, where no effect
    explains it."""
    other_sets: list[_OtherSet] = []
    """Where several members stand in its place, or one in its place and that of others."""
    what: str = ""
    usual_size: str = ""
    """In words, as are the next two."""
    confirm: str = ""
    cure: str = ""
    title: str = ""
    """Effect and target, for people."""
    remark: str | None = None
    """What a curve of points on a part is relative to; null for all else."""


class _Candidate(Output):
    """How a single effect does on its own."""

    effect: str
    target: str
    score: float
    """Natural logarithm of the odds for it."""
    rms_after_um: float
    status: str
    """For people: "tested", or why it could not be."""
    is_tested: bool
    why_not: str


class _BlindSpot(Output):
    """An effect that could be there unseen."""

    effect: str
    target: str
    parameter: str
    unit: str
    """Of the two sizes; it ends the parameter's name."""
    from_size: float | None
    """Smallest amplitude that would be found; null where none would."""
    from_size_alone: float | None
    """The same if nothing else had been found."""
    text: str


class _Failure(Output):
    """A pattern that the model leaves."""

    by: str
    p: float = Field(ge=0.0, le=1.0)
    """How often chance alone would look like this."""
    text: str


class _NextMeasurement(Output):
    separates: list[str]
    text: str
    program: str | None
    """File of the test's program; null where none was written, or no test without cutting tells."""


class _Weak(Output):
    """An effect that may be there; it is not counted."""

    effect: str
    target: str | None
    status: Literal["weak"]
    log_odds: float
    """Natural logarithm, for it against without it."""
    probability: float = Field(ge=0.0, le=1.0)
    """That it is no imitation of something else."""
    why: str


class _HeldOut(Output):
    """RMS on features that were not fitted, um."""

    without: float
    with_it: float = Field(alias="with")


class _Amount(Output):
    """One of several amounts of a form."""

    of: str
    """What it is the amount of, as ``along Y per 100 mm in X``."""
    amount_um: float
    u_um: float


class _Proposal(Output):
    """A form for what no effect explains."""

    formula: str
    states: list[str]
    direction: str
    amount_um: float
    u_um: float
    """Standard uncertainty of the amount."""
    amounts: int
    """How many amounts the form has; of several `amount_um` is the root of the sum of squares."""
    each: list[_Amount]
    """Every one of several; empty where there is one."""
    size_um: float
    """RMS of what it does to the readings."""
    evidence: float
    """Natural logarithm of the odds for it."""
    remains_um: float
    held_out_um: _HeldOut
    refuted_by: str
    """The test that would refute it."""


class _MeasurementRms(Output):
    """One file of readings."""

    name: str
    rms_um: dict[str, float]
    """As of all readings."""


class DiagnosisFigures(Output):
    """``diagnose --json``: what the model lacks."""

    verdict: Literal["nothing", "named", "class", "partly", "unknown"]
    effects: list[_Finding]
    weak_effects: list[_Weak]
    remains_um: float
    """RMS of what remains beside noise."""
    of_measurement_um: dict[str, float]
    """RMS of what is counted as of the measurement, where it is notable."""
    remains_by_um: dict[str, float]
    """RMS of its main parts, by what they look like; empty where nothing notable remains."""
    proposals: list[_Proposal]
    rms_um: dict[str, float]
    """Of measured minus predicted: before, after, expected noise."""
    measurements: list[_MeasurementRms]
    candidates: list[_Candidate]
    where_it_fails: list[_Failure]
    next_measurement: _NextMeasurement | None
    blind_spots: list[_BlindSpot]
    notes: list[str]
    note_records: list[NoteRecord]
    """The notes as records."""


class _Surface(Output):
    """Points of the part, in the model."""

    points: int
    of: str
    before_largest_um: float
    before_mean_um: float
    after_largest_um: float
    after_mean_um: float
    after_rms_um: float
    u_largest_um: float
    """Standard uncertainty that tables and effects leave."""
    u_mean_um: float
    u_rms_um: float
    expected_rms_um: float
    mean_before_over_after: float | None
    """Ratio of the means."""
    points_lost: int


class _AimedAt(Output):
    points: int
    tool_largest_um: float
    """With the tool in its nominal place."""
    tool_mean_um: float
    part_largest_um: float
    """With the part in its nominal place."""
    part_mean_um: float
    largest_shift_um: float
    rounds: int


class _UncorrectedLine(Output):
    um: float
    why: str


class _Uncorrected(Output):
    """What a path cannot correct."""

    what: str
    urad: float | None = None
    """Of a tilt."""
    surface_um: float | None = None
    """What it makes on the part."""


class CompensationFigures(Output):
    """``compensate --json``: what the compensated program leaves."""

    before_largest_um: float
    """Error of the tool tip along the program, like the five below."""
    before_mean_um: float
    before_rounding_largest_um: float
    before_rounding_mean_um: float
    after_largest_um: float
    after_mean_um: float
    worst_line_after: int | None
    surface: _Surface | None
    aimed_at: _AimedAt | None
    largest_correction_um: float
    growth: float
    """Blocks written over blocks read."""
    steps: int
    arcs: int
    arcs_kept: int
    expanded_lines: dict[str, str]
    """Why each of these lines was written out."""
    left_lines: list[int]
    swallowed_words: int
    uncorrected_lines: dict[str, _UncorrectedLine]
    uncorrected: list[_Uncorrected]
    notes: list[str]
    note_records: list[NoteRecord]
    """The notes as records."""
