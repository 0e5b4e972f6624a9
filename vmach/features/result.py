"""What was found for each requirement of a drawing, for tables, pages and files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from vmach.features.verdict import Verdict

__all__ = ["FeatureResult", "LineShare", "Place", "SourceShare", "Value"]


@dataclass(frozen=True)
class Value:
    """A value, its standard uncertainty (None: not known) and the verdict.

    `interval_mm` is the coverage interval of 95 % where draws found it.
    """

    value_mm: float
    u_mm: float | None
    verdict: Verdict
    interval_mm: tuple[float, float] | None = None


@dataclass(frozen=True)
class SourceShare:
    """What one error adds to the predicted value's difference from nominal, mm."""

    source: str
    share_mm: float


@dataclass(frozen=True)
class LineShare:
    """An NC line and its share, 0 to 1, of the points' influence on the value."""

    line: int
    tool: int
    share: float


@dataclass(frozen=True)
class Place:
    """A point of the nominal surface and its outward normal, mm."""

    at_mm: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class FeatureResult:
    """One value that a drawing asks for.

    Attributes
    ----------
    feature, callout : str
        Name, and the requirement as written.
    characteristic : str
        ``size``, ``distance`` or a characteristic of ISO 1101.
    label : str
        ``smallest`` or ``largest`` where a size has two values.
    faces : tuple of str
    datums : tuple of str
    nominal_mm, lower_mm, upper_mm : float or None
        Limits of the value; geometrical tolerances have the upper one only, and nominal 0.
    values : mapping of str to Value
        By the name of the column: ``none``, ``abbe``, ``measured`` ...
    primary : str
        The column that shares and lines are of.
    shares : tuple of SourceShare
        Largest first. They add up to the value minus nominal, to first order.
    lines : tuple of LineShare
        NC lines that made the points which decide, most influence first.
    places : tuple of Place
        Points of the feature that a flag may point at; the one that decides most is the first.
    reason : str
        Why there is no value; empty where there is one.
    unit : str
        ``Ø`` or ``SØ`` for diameters, else empty.
    kind : str
        Of the feature, see `vmach.features.feature.Feature.kind`.
    """

    feature: str
    callout: str
    characteristic: str
    label: str = ""
    faces: tuple[str, ...] = ()
    datums: tuple[str, ...] = ()
    nominal_mm: float | None = None
    lower_mm: float | None = None
    upper_mm: float | None = None
    values: Mapping[str, Value] = field(default_factory=dict)
    primary: str = ""
    shares: tuple[SourceShare, ...] = ()
    lines: tuple[LineShare, ...] = ()
    places: tuple[Place, ...] = ()
    reason: str = ""
    unit: str = ""
    kind: str = ""

    @property
    def predicted(self) -> Value | None:
        """The value under the primary column; None where there is none."""
        return self.values.get(self.primary)

    @property
    def measured(self) -> Value | None:
        """The value of the measured part; None where it was not measured."""
        return self.values.get("measured")

    @property
    def title(self) -> str:
        """Requirement and label in one."""
        return f"{self.callout}, {self.label}" if self.label else self.callout

    @property
    def cause(self) -> str:
        """The largest shares in words: ``82 % reversal X, 9 % EC0Y``; of small values nothing."""
        total = sum(abs(share.share_mm) for share in self.shares)
        if total < _TOO_SMALL_MM:
            return ""
        parts = [f"{100 * s.share_mm / total:.0f} % {s.source}" for s in self.shares[:3]]
        return ", ".join(part for part in parts if not part.startswith(("0 %", "-0 %")))


#: below this a value consists of rounding only
_TOO_SMALL_MM = 1e-6
