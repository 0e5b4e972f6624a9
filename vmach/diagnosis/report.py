"""A diagnosis as JSON and as text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.note import Kind, note_records
from vmach.diagnosis.diagnose import Diagnosis
from vmach.diagnosis.findings import Finding
from vmach.diagnosis.inference.verdicts import Weak
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.residuals.where_it_fails import Failure
from vmach.diagnosis.rivals import OtherSet
from vmach.diagnosis.words import (
    RELATIVE,
    counted_as_of_measurement,
    describe,
    expected,
    rounded,
    title_of,
    weak_words,
)
from vmach.effects.declaration import unit_of
from vmach.files.atomic import atomic_file

__all__ = ["as_json", "as_text", "words_of_add", "write_figures"]

_VERDICTS = {
    "named": "The model lacks:",
    "class": "The model lacks something that these measurements narrow down to a class:",
    "partly": "The model lacks this, and something else remains:",
    "unknown": "Something real is left that no known effect clearly explains:",
    "nothing": "The measurements agree with the model: nothing is missing that they could show.",
}


def as_json(found: Diagnosis, *, program: str | None = None) -> dict[str, Any]:
    """The diagnosis for machines; `program` is the file of the next measurement."""
    following = found.next_measurement
    return {
        "verdict": found.verdict,
        "effects": [_finding(finding) for finding in found.findings],
        "weak_effects": [_weak(weak) for weak in found.weak],
        "remains_um": round(found.remains_um, 3),
        "of_measurement_um": {name: round(size, 3) for name, size in found.of_device_um.items()},
        "remains_by_um": {name: round(size, 3) for name, size in found.remains_by_um.items()},
        "proposals": [_proposal(p) for p in found.proposals],
        "rms_um": _rounded_rms(found.rms_um),
        "measurements": [
            {"name": name, "rms_um": _rounded_rms(rms)}
            for name, rms in found.residuals.rms_um_by_measurement
        ],
        "candidates": [vars(score) for score in found.candidates],
        "where_it_fails": [
            {"by": f.by, "p": float(f"{f.p:.3g}"), "text": f.text} for f in found.failures
        ],
        "next_measurement": None
        if following is None
        else {
            "separates": list(following.separates),
            "text": following.text,
            "program": program,
        },
        "blind_spots": [vars(b) | {"unit": unit_of(b.parameter)} for b in found.blind_spots],
        "notes": [str(note) for note in found.notes],
        "note_records": note_records(found.notes),
    }


def _rounded_rms(rms_um: Mapping[str, float]) -> dict[str, float]:
    return {name: round(value, 4) for name, value in rms_um.items()}


def _weak(weak: Weak) -> dict[str, Any]:
    return {
        "effect": weak.term.effect.name,
        "target": weak.term.target or None,
        "log_odds": round(weak.support.odds, 2),
        "probability": round(weak.support.probability, 3),
        "why": weak_words(weak),
        "status": "weak",
    }


def _proposal(p: Proposal) -> dict[str, Any]:
    without, with_it = p.held_out_um
    return {
        "formula": p.form.formula,
        "states": list(p.form.state_words),
        "direction": p.form.direction.words,
        "amount_um": _rounded(p.amount_um),
        "u_um": _rounded(p.amount_u_um),
        "amounts": len(p.amounts_um),
        "each": [
            {"of": of, "amount_um": _rounded(p.amounts_um[n]), "u_um": _rounded(p.u_um[n])}
            for n, of in p.of_each.items()
        ],
        "size_um": round(p.size_um, 3),
        "evidence": round(p.odds, 2),
        "remains_um": round(p.remains_um, 3),
        "held_out_um": {"without": round(without, 3), "with": round(with_it, 3)},
        "refuted_by": p.form.refute,
    }


def _finding(finding: Finding) -> dict[str, Any]:
    entry = {
        "effect": finding.name,
        "target": finding.target or None,
        "status": finding.status,
        "share": round(finding.share, 4),
        "size_um": round(finding.size_um, 3),
        "log_odds": round(finding.odds, 2),
        "probability": round(finding.probability, 3),
        "parameters": {k: _rounded(v) for k, v in finding.parameters.items()},
        "u": {k: _rounded(v) for k, v in finding.u.items()},
        "interval_95": {k: _rounded(list(v)) for k, v in finding.interval_95.items()},
        "weakly_identified": list(finding.weakly_identified),
        "class": list(finding.rivals.names),
        "where": finding.where,
    }
    if finding.effect is not None:
        sets = [_other_set(one) for one in finding.rivals.sets]
        entry |= {"rivals": list(finding.rivals.labels), "other_sets": sets}
        entry |= describe(finding.effect) | {"title": title_of(finding.effect, finding.target)}
        entry["remark"] = RELATIVE if finding.is_relative else None
    return entry


def _other_set(one: OtherSet) -> dict[str, Any]:
    return {
        "without": sorted(one.without),
        "with": sorted(one.instead),
        "log_odds": round(one.odds, 2),
    }


def _rounded(value: Any) -> Any:
    if isinstance(value, list):
        return [_rounded(v) for v in value]
    return float(f"{value:.6g}")


def as_text(found: Diagnosis, *, program: str | None = None) -> str:
    """The diagnosis for people."""
    rms = found.rms_um
    # a file that says something else than is true comes before anything that the machine lacks
    first = [note for note in found.notes if note.kind is Kind.EXCHANGED]
    lines = [*(f"Look at the files first: {note}" for note in first), _verdict_line(found)]
    for finding in found.findings:
        lines += _finding_lines(finding, is_told_apart=found.next_measurement is not None)
    if found.verdict in ("partly", "unknown"):
        parts = "; ".join(f"{name} {size:.2f}" for name, size in found.remains_by_um.items())
        lines.append(f"  what remains beside noise: {found.remains_um:.2f} um RMS; {parts}")
    for number, p in enumerate(found.proposals, 1):
        without, with_it = p.held_out_um
        lines.append(
            f"  form {number}: {p.words}; log odds {p.odds:.0f}, "
            f"features held out {without:.2f} -> {with_it:.2f} um"
        )
        lines += _amount_lines(p)
        lines.append(f"    to refute it: {p.form.refute}")
    lines += [
        f"  weak: {w.term.label}: {weak_words(w)}; not counted as present" for w in found.weak
    ]
    states = found.residuals.states
    fell = ", ".join(f"{rms[state]:.2f} um {state}" for state in states)
    fell = fell if len(states) > 1 else f"{rms['before']:.2f} um"
    noise = f"{expected(found.residuals)} account for {rms['expected_noise']:.2f} um"
    of_device = np.linalg.norm([*found.of_device_um.values()])
    noise += f", the measuring for {of_device:.2g} um" if of_device else ""
    lines.append(f"RMS of measured minus predicted: {fell}; {noise}")
    of_each = found.residuals.rms_um_by_measurement
    lines += [
        f"  {name}: {' -> '.join(f'{rms[state]:.2f}' for state in states)} um, "
        f"noise {rms['expected_noise']:.2f}"
        for name, rms in of_each[: len(of_each) * (len(of_each) > 1)]
    ]
    if found.failures:
        lines.append("Where the model fails (p: how often chance alone would look like this):")
        clearest: dict[str, Failure] = {}
        for failure in found.failures:
            clearest.setdefault(failure.by, failure)
        lines += [f"  {f.by:14s} {_chance(f.p)}  {f.text}" for f in clearest.values()]
    unseen = [b for b in found.blind_spots if b.from_size is not None][:6]
    if unseen:
        lines.append("These measurements cannot show:")
        lines += [f"  {b.label}: {b.text}" for b in unseen]
    if found.next_measurement is not None:
        lines.append(f"Measure next: {found.next_measurement.text}")
        if program:
            lines.append(f"  program: {program}")
    lines += [f"note: {note}" for note in found.notes if note not in first]
    return "\n".join(lines)


def _amount_lines(proposal: Proposal) -> list[str]:
    """Those of several amounts that are clear, as parameters of an effect are said."""
    lines = []
    for name in proposal.clear_amounts:
        value, u = proposal.amounts_um[name], proposal.u_um[name]
        said = rounded(value, (value - 2.0 * u, value + 2.0 * u))[0]
        lines.append(f"    {name} = {said}  (u = {u:.2g}): {proposal.of_each[name]}")
    if proposal.of_each and not lines:
        lines.append(f"    {len(proposal.of_each)} amounts, none of them clear")
    return lines


def words_of_add(found: Diagnosis) -> str:
    """What is shown, as `vmach add` is told of it."""
    every = [f for f in found.findings if f.effect is not None]
    return " ".join(f"{f.name}:{f.target}" if f.target else f.name for f in every)


def _verdict_line(found: Diagnosis) -> str:
    if found.verdict == "class" and any(f.status == "shown" for f in found.findings):
        return "The model lacks these; of some these measurements show no more than a class:"
    if found.verdict == "nothing" and found.of_device_um:
        return f"{_VERDICTS['nothing']} {counted_as_of_measurement(found.of_device_um)}"
    return _VERDICTS[found.verdict]


def _chance(p: float) -> str:
    """How often chance alone would look like this."""
    return f"p = {p:<6.1g}" if p >= 1e-9 else "p < 1e-9 "


def _uncertainty(finding: Finding, name: str) -> str:
    if name in finding.weakly_identified:
        return "(weakly identified by these readings)"
    _, low, high = rounded(finding.parameters[name], finding.interval_95[name])
    return f"(u = {finding.u[name]:.2g}; 95 % between {low} and {high})"


def _finding_lines(finding: Finding, *, is_told_apart: bool) -> list[str]:
    if finding.effect is None:
        return [f"  where: {finding.where or 'everywhere; more scatter than the uncertainty says'}"]
    lines = [
        f"  {finding.label}: {title_of(finding.effect, finding.target)}",
        f"    {finding.status}, {finding.size_um:.2f} um RMS of these readings, "
        f"{100 * finding.share:.0f} % of all found or left (log odds {finding.odds:.0f})",
    ]
    if finding.where:
        lines.append(f"    where: {finding.where}")
        if finding.is_relative:
            lines.append(f"    {RELATIVE}")
    else:
        meaning = {p.name: p.meaning for p in finding.effect.parameters}
        lines += [
            f"    {name} = {rounded(value, finding.interval_95[name])[0]}  "
            f"{_uncertainty(finding, name)}: {meaning[name]}"
            for name, value in finding.parameters.items()
        ]
    if finding.indistinct:
        lines.append(f"    cannot be told from: {', '.join(finding.indistinct)}")
        if not is_told_apart:
            lines.append("    none of the tests that vmach can plan tells them apart")
    effect = finding.effect
    for word, text in (
        ("usual", effect.usual_size),
        ("confirm", effect.confirm),
        ("cure", effect.cure),
    ):
        if text:
            lines.append(f"    {word}: {text}")
    return lines


def write_figures(path: Path, found: Diagnosis, *, program: str | None) -> None:
    """Write the diagnosis as JSON; `program` is the file of the next measurement.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    text = json.dumps(as_json(found, program=program), indent=1)
    with atomic_file(path) as temporary:
        temporary.write_text(text + "\n", encoding="utf-8")
