"""Effects that fit only with a size that nature does not have: no finding, whatever they fit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from vmach.base.note import Kind, Note
from vmach.effects.declaration import unit_of
from vmach.effects.effect import Effect
from vmach.effects.parameter import Parameter
from vmach.fit.terms import JointFit

if TYPE_CHECKING:
    from vmach.diagnosis.findings import Finding
    from vmach.diagnosis.named_fit import NamedEffect

__all__ = ["impossible_size_notes", "impossible_terms"]

#: beyond a bound by so many standard uncertainties
_SURELY = 3.0
#: what makes an effect is missing where zero is in its interval of 95 %
_MISSING = 2.0


def impossible_size_notes(findings: Iterable[Finding | NamedEffect]) -> tuple[Note, ...]:
    """A note on every size that nature does not have, in the parameter's unit.

    Amplitudes are fitted with either sign and any size. A tool that bends towards the wall
    imitates something else.
    """
    notes = []
    for finding in findings:
        for parameter, why in _beyond(finding.effect, finding.parameters, finding.u):
            name, size = parameter.name, finding.parameters[parameter.name]
            said = (
                f"{finding.label} would fit with {name} = {size:.3g} "
                f"(u = {finding.u[name]:.2g}), which cannot be {why}"
            )
            place = finding.label
            notes.append(Note.question(Kind.IMPOSSIBLE, said, size, unit_of(name), place=place))
    return tuple(notes)


def impossible_terms(fit: JointFit) -> list[int]:
    """Numbers of the terms with a size that nature does not have, or without what makes them."""
    return [k for k in range(len(fit.terms)) if _is_impossible(fit, k)]


def _is_impossible(fit: JointFit, k: int) -> bool:
    effect = fit.terms[k].effect
    if not any(p.is_bounded or p.is_essential for p in effect.parameters):
        return False
    value, u = fit.parameters(k), fit.uncertainty(k)
    makes_it = [p.name for p in effect.parameters if p.is_essential]
    is_missing = any(abs(value[name]) < _MISSING * u[name] for name in makes_it)
    return is_missing or any(True for _ in _beyond(effect, value, u))


def _beyond(
    effect: Effect | None, value: Mapping[str, float], u: Mapping[str, float]
) -> Iterator[tuple[Parameter, str]]:
    """Parameters surely beyond a bound, and which bound."""
    for p in effect.parameters if effect else ():
        here = value.get(p.name)
        checks = []
        if p.is_size:
            checks.append((-here, u[p.name], "below zero"))
        if math.isfinite(p.most):
            checks.append((abs(here) - p.most, u[p.name], f"above {p.most:g}"))
        if p.at_most:
            over, both = abs(here) - abs(value[p.at_most]), math.hypot(u[p.name], u[p.at_most])
            checks.append((over, both, f"more than {p.at_most} = {value[p.at_most]:.3g}"))
        for over, spread, why in checks:
            if over > _SURELY * spread:
                yield p, why
