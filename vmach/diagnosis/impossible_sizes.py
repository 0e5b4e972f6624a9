"""Effects that fit only with a size that is none: no finding, however well they fit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vmach.fit.terms import JointFit

if TYPE_CHECKING:
    from vmach.diagnosis.findings import Finding
    from vmach.diagnosis.named_fit import NamedEffect

__all__ = ["has_impossible_sizes", "impossible_sizes"]

#: below zero by so many standard uncertainties
_SURELY = 3.0


def impossible_sizes(
    findings: Iterable[Finding | NamedEffect],
) -> tuple[dict[str, float], list[str]]:
    """Sizes that nature does not have: by how many standard uncertainties, and in words.

    Amplitudes are fitted with either sign. A tool that bends towards the wall imitates something
    else.
    """
    left, notes = {}, []
    for finding in findings:
        for parameter in finding.effect.parameters if finding.effect else ():
            if not parameter.is_size:
                continue
            value, u = finding.parameters[parameter.name], finding.u[parameter.name]
            if value < -_SURELY * u:
                left["a size below zero"] = max(-value / u, left.get("a size below zero", 0.0))
                notes.append(
                    f"{finding.label} would fit with {parameter.name} = {value:.3g} "
                    f"(u = {u:.2g}), which cannot be below zero"
                )
    return left, notes


def has_impossible_sizes(fit: JointFit) -> bool:
    """Whether a size is below zero in a fit, or what makes the effect is not there.

    A search need not follow it.
    """
    return any(_is_impossible(fit, k) for k in range(len(fit.terms)))


def _is_impossible(fit: JointFit, k: int) -> bool:
    judged = [p for p in fit.terms[k].effect.parameters if p.is_size or p.is_essential]
    value, u = (fit.parameters(k), fit.uncertainty(k)) if judged else ({}, {})
    ratios = [(p, value[p.name] / u[p.name]) for p in judged]
    return any(
        (p.is_size and ratio < -_SURELY) or (p.is_essential and abs(ratio) < _SURELY)
        for p, ratio in ratios
    )
