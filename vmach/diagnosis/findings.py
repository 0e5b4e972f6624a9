"""What a diagnosis says: the effects found, how the candidates did, what is left."""

from __future__ import annotations

from dataclasses import dataclass

from vmach.diagnosis.blind_spots import BlindSpot
from vmach.diagnosis.next_measurement import NextMeasurement
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.rivals import Rivals
from vmach.diagnosis.where_it_fails import Failure
from vmach.effects import Effect, label_of

__all__ = ["CandidateScore", "Diagnosis", "Finding"]


@dataclass(frozen=True)
class Finding:
    """One effect found.

    Attributes
    ----------
    effect : Effect or None
        None for something that no effect explains.
    target : str
    parameters, u : dict
        In the units of their names; a component's are lists.
    rivals : Rivals
    where : str or None
    interval_95 : dict
        Of each parameter (low, high); empty for a component.
    hardly_shown : tuple of str
        Parameters of which the readings say hardly more than was known before.
    """

    effect: Effect | None
    target: str
    parameters: dict
    u: dict
    rivals: Rivals
    where: str | None
    interval_95: dict
    hardly_shown: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the effect, or "unknown"."""
        return self.effect.name if self.effect else "unknown"

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.name, self.target)

    @property
    def teams(self) -> tuple[str, ...]:
        """Names of rivals that would have to act on all axes, or all tools, at once."""
        alone = {label.split()[0] for label in self.rivals.labels}
        return tuple(name for name in self.rivals.names if name not in alone)

    @property
    def indistinct(self) -> tuple[str, ...]:
        """What the data cannot tell this effect from, in words."""
        others = tuple(label for label in self.rivals.labels if label != self.label)
        return (*others, *(f"{name} on all axes or tools at once" for name in self.teams))


@dataclass(frozen=True)
class CandidateScore:
    """How a single effect does on its own."""

    effect: str
    target: str
    score: float
    rms_after_um: float
    status: str

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect, self.target)


@dataclass(frozen=True)
class Diagnosis:
    """What the measurements say about the model.

    Attributes
    ----------
    verdict : str
        "named", "class", "unknown" or "nothing".
    findings : tuple of Finding
    rms_um : dict
        "before", "after", "expected_noise": over all readings, alignment taken off.
    candidates : tuple of CandidateScore
    failures : tuple of Failure
        Where the model fails, before anything is added.
    blind_spots : tuple of BlindSpot
    next_measurement : NextMeasurement or None
    left : dict
        What is left beyond noise by kind of pattern; empty where the rest is noise.
    notes : tuple of str
    residuals : Residuals
        Measured minus predicted, to be looked at.
    """

    verdict: str
    findings: tuple[Finding, ...]
    rms_um: dict[str, float]
    candidates: tuple[CandidateScore, ...]
    failures: tuple[Failure, ...]
    blind_spots: tuple[BlindSpot, ...]
    next_measurement: NextMeasurement | None
    left: dict[str, float]
    notes: tuple[str, ...]
    residuals: Residuals
