"""Diagnosis: what the model lacks, named, or a class, or something unknown, or nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.base.note import Kind, Level, Note
from vmach.diagnosis.alike_waves import alike_waves
from vmach.diagnosis.candidate_scores import CandidateScore, candidate_scores
from vmach.diagnosis.doubtful_uncertainty import TOO_LOUD, doubtful_uncertainty
from vmach.diagnosis.findings import Finding, findings_of, something_unknown
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.remains import is_structure, rms_um
from vmach.diagnosis.inference.rules import TRUST
from vmach.diagnosis.inference.verdicts import Inference, Weak, infer
from vmach.diagnosis.inference.weighing import Weighing
from vmach.diagnosis.like_drift import like_drift
from vmach.diagnosis.next_test.blind_spots import BlindSpot, blind_spots
from vmach.diagnosis.next_test.next_measurement import NextMeasurement, next_measurement
from vmach.diagnosis.parts_of_rest import clamped_by_work_offset, of_device_mm, remains_by_um
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.residuals.where_it_fails import Failure, where_it_fails
from vmach.fit.noise.measuring_machine import CLAMPINGS
from vmach.fit.survey import Survey

__all__ = ["Diagnosis", "diagnose", "not_followed"]

#: weight of a reading that counts for little
_LITTLE = 0.1

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Diagnosis:
    """What the measurements say about the model.

    Attributes
    ----------
    verdict : str
        "nothing", "named", "class", "partly" (effects are shown, something else remains) or
        "unknown".
    findings : tuple of Finding
        Those that are shown.
    weak : tuple of Weak
        Effects that the readings speak for, though not clearly.
    remains_um : float
        Root mean square of what neither effects nor noise explain.
    remains_by_um : dict
        Its main parts, in words, with the root mean square of each; empty where no structure is.
    of_device_um : dict
        What was counted as of the measurement, by name, where it is notable.
    proposals : tuple of Proposal
        Forms for what remains, the most probable first.
    rms_um : dict
        "before", "after", "expected_noise": over all readings, alignment taken off.
    candidates : tuple of CandidateScore
    failures : tuple of Failure
        Where the model fails, before anything is added.
    blind_spots : tuple of BlindSpot
    next_measurement : NextMeasurement or None
    notes : tuple of Note
    residuals : Residuals
        Measured minus predicted, to be looked at.
    """

    verdict: str
    findings: tuple[Finding, ...]
    weak: tuple[Weak, ...]
    remains_um: float
    remains_by_um: dict[str, float]
    of_device_um: dict[str, float]
    proposals: tuple[Proposal, ...]
    rms_um: dict[str, float]
    candidates: tuple[CandidateScore, ...]
    failures: tuple[Failure, ...]
    blind_spots: tuple[BlindSpot, ...]
    next_measurement: NextMeasurement | None
    notes: tuple[Note, ...]
    residuals: Residuals

    @property
    def next_program(self) -> str | None:
        """The next measurement as an NC program, where one is called for."""
        return None if self.next_measurement is None else self.next_measurement.program


@threadpool_limits.wrap(limits=1, user_api="blas")
def diagnose(
    survey: Survey, *, like: Weighing | None = None, progress: Progress | None = None
) -> Diagnosis:
    """Compare measurements with the model and say what is missing.

    Parameters
    ----------
    survey : Survey
    like : Weighing, optional
        Of other readings of the same design, whose signatures are used again; made by
        `prepare_weighing`.
    progress : callable, optional
        Told what is being done.
    """
    tell = progress or (lambda text: None)
    tell("signatures of all effects")
    weighing = like.on(survey) if like else prepare_weighing(survey)
    tell("search")
    found = infer(weighing)
    weighing, explanation = found.weighing, found.explanation
    weighing.forget_columns()
    survey = weighing.survey
    findings = findings_of(found)
    verdict = _verdict(found, findings)
    residuals = Residuals(survey, found.noise, found.fit_of_effects)
    failures = where_it_fails(survey, residuals.noise.whiten, survey.residual_mm)
    if verdict == "unknown":
        findings = (something_unknown(failures),)
    of_device = of_device_mm(weighing, explanation)
    sizes_um = {name: rms_um(taken) for name, taken in of_device.items()}
    notable = {name: size for name, size in sizes_um.items() if is_structure(weighing, size)}
    tell("what to measure next")
    return Diagnosis(
        verdict=verdict,
        findings=findings,
        weak=found.weak,
        remains_um=found.remains_um,
        remains_by_um=remains_by_um(found) if found.is_structure else {},
        of_device_um=notable,
        proposals=found.proposals,
        rms_um=residuals.rms_um,
        candidates=candidate_scores(weighing, residuals.rms_um["before"]),
        failures=failures,
        blind_spots=blind_spots(
            weighing, explanation, is_named=verdict != "unknown", remains=found.is_structure
        ),
        next_measurement=next_measurement(weighing, explanation, findings, found.proposals),
        notes=(
            *_of_survey(found),
            *doubtful_uncertainty(found),
            *_outliers(found),
            *_device(notable, survey),
            *like_drift(found),
            *alike_waves(found),
            *_cancelling(found, residuals.rms_um),
            *not_followed(found, residuals, of_device),
        ),
        residuals=residuals,
    )


def _verdict(found: Inference, findings: Sequence[Finding]) -> str:
    """The verdict over all, as those of the effects and what remains have it."""
    if found.is_structure:
        return "partly" if findings else "unknown"
    if not findings:
        return "nothing"
    return "class" if any(f.status == "class" for f in findings) else "named"


def _of_survey(found: Inference) -> Iterator[Note]:
    """Notes on the readings; what scattered too much for its uncertainty may be explained now."""
    is_settled = found.told.posterior.sizes.factor <= TOO_LOUD
    for note in found.weighing.survey.notes:
        is_doubt = note.kind is Kind.UNCERTAINTY and note.level is Level.QUESTION
        if not (is_doubt and is_settled):
            yield note


def _device(notable_um: Mapping[str, float], survey: Survey) -> Iterator[Note]:
    """A note on each thing that the measuring machine did to the readings."""
    for name, size_um in notable_um.items():
        said = (
            f"{name}: {size_um:.2g} um RMS of the readings, counted as of the measurement; "
            "what the machine tool does alike cannot be told from it"
        )
        if name == CLAMPINGS and (offsets := clamped_by_work_offset(survey)):
            said += f", such as a wrong work offset: they are those of {' and '.join(offsets)}"
        yield Note.plain(Kind.SCATTER, said, size_um, "um", place=name)


def _cancelling(found: Inference, rms_um: Mapping[str, float]) -> tuple[Note, ...]:
    """A note where effects and a form are large and cancel: without it they make matters worse."""
    before, after = rms_um["before"], rms_um["after"]
    if not found.proposals or after <= before:
        return ()
    said = (
        f"the effects alone make the residual larger, {before:.3g} to {after:.3g} um: they and "
        "what remains cancel in part; add the first form with them, or measure before adding"
    )
    return (Note.question(Kind.CANCELLING, said, after, "um", place="residual"),)


def not_followed(
    found: Inference, residuals: Residuals, of_device: Mapping[str, np.ndarray]
) -> Iterator[Note]:
    """A note on each measurement that what was found does not follow: laws may be as inexact.

    Of what remains as structure the verdict speaks; of odd readings, and of what the measuring
    machine did, other notes.
    """
    if found.is_structure or residuals.fit is None:
        return
    left_mm = sum(of_device.values(), -residuals.after_mm)
    counts = found.weighing.base.noise.weight >= _LITTLE
    survey = found.weighing.survey
    each = zip(survey.rows, residuals.rms_um_by_measurement, strict=True)
    for rows, (name, rms) in each:
        own = left_mm[rows][counts[rows]]
        left_um = rms_um(own) if len(own) else 0.0
        if left_um > TRUST * rms["expected_noise"]:
            said = (
                f"what was found does not follow {name}: {left_um:.2g} um RMS are left where "
                f"noise makes {rms['expected_noise']:.2g}, counted as inexactness of the laws"
            )
            yield Note.plain(Kind.SCATTER, said, left_um, "um", place=name)


def _outliers(found: Inference) -> tuple[Note, ...]:
    """A note on readings that stand apart from their neighbours."""
    survey = found.weighing.survey
    apart = np.flatnonzero(found.weighing.base.noise.weight < _LITTLE)
    if not len(apart):
        return ()
    names = [f"{m.name} {own}" for m in survey.measurements for own in m.id]
    shown = ", ".join(names[k] for k in apart[:6])
    more = f" and {len(apart) - 6} more" if len(apart) > 6 else ""
    said = (
        f"count for little, as they are out of all proportion ({len(apart)} of {len(survey)}): "
        f"{shown}{more}"
    )
    return (Note.plain(Kind.LEFT_OUT, said, len(apart), "1", place=names[apart[0]]),)
