"""Findings: the effects of an explanation, with all that is to be said of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from vmach.diagnosis.fitted_parameters import FittedParameters, fitted_parameters
from vmach.diagnosis.inference.other_sets import otherwise
from vmach.diagnosis.inference.remains import sizes_um
from vmach.diagnosis.inference.verdicts import Inference, Reason
from vmach.diagnosis.inference.weighing import Explanation
from vmach.diagnosis.other_clocks import at_other_clocks
from vmach.diagnosis.residuals.where_it_fails import Failure
from vmach.diagnosis.rivals import Rivals, rivals_of
from vmach.diagnosis.words import where_component
from vmach.effects import Effect, catalogue, label_of
from vmach.fit.other_sizes import beside_other_sizes
from vmach.machine import LINEAR_AXES

__all__ = ["Finding", "findings_of", "something_unknown"]


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
    weakly_identified : tuple of str
        Parameters of which the readings say hardly more than was known before.
    is_relative : bool
        Whether it is a curve whose level and slope the alignment of the part leaves open.
    odds, probability : float
        Log odds for it, given everything else, and the probability that it is no imitation of
        something else.
    size_um, share : float
        Root mean square of what it does to the readings, and its share of the mean square of
        all that was found and remains.
    """

    effect: Effect | None
    target: str
    parameters: dict
    u: dict
    rivals: Rivals
    where: str | None
    interval_95: dict
    weakly_identified: tuple[str, ...] = ()
    is_relative: bool = False
    odds: float = 0.0
    probability: float = 0.0
    size_um: float = 0.0
    share: float = 0.0

    @property
    def status(self) -> str:
        """Shown, or one of a class that the data cannot tell apart, by name or by target."""
        rivals = self.rivals
        one = len(rivals.names) < 2 and len({*rivals.labels, *rivals.in_sets, self.label}) < 2
        return "shown" if one else "class"

    @property
    def name(self) -> str:
        """Name of the effect, or "unknown"."""
        return self.effect.name if self.effect else "unknown"

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.name, self.target)

    @property
    def joint_rivals(self) -> tuple[str, ...]:
        """Names of rivals that no single target makes."""
        alone = {label.split()[0] for label in (*self.rivals.labels, *self.rivals.in_sets)}
        return tuple(name for name in self.rivals.names if name not in alone)

    @property
    def indistinct(self) -> tuple[str, ...]:
        """What the data cannot tell this effect from, in words."""
        others = (label for label in self.rivals.labels if label != self.label)
        sets = (one.words(self.label) for one in self.rivals.sets)
        return (*others, *sets, *map(_at_once, self.joint_rivals))


def _at_once(name: str) -> str:
    """An effect that would have to act on all axes, or all tools, at once."""
    effect = catalogue()[name]
    if not effect.imitates_as_team:
        return name
    return f"{name} on {'all axes' if effect.targets == LINEAR_AXES else 'all tools'} at once"


def findings_of(found: Inference) -> tuple[Finding, ...]:
    """A finding for every effect that is shown."""
    fit, judged = found.fit, _as_judged(found)
    if fit is None or not found.supports:
        return ()
    others, of_sizes = otherwise(found.among, found.told), beside_other_sizes(fit)
    by_clock = at_other_clocks(fit)
    sizes = sizes_um(found.among, found.told)[: len(found.supports)]
    total = found.remains_um**2 + sum(size**2 for size in sizes)
    return tuple(
        replace(
            _finding(
                found, fitted_parameters(fit, k, of_sizes[k], [*others[k], *by_clock[k]]), k, judged
            ),
            size_um=size,
            share=size**2 / total,
        )
        for k, size in enumerate(sizes)
    )


def _as_judged(found: Inference) -> Explanation:
    """The effects that are shown, beside forms and those of an impossible size.

    Beside what these stand for the others were judged, and rivals are weighed.
    """
    called = [weak.term for weak in found.weak if weak.why is Reason.IMPOSSIBLE]
    told = found.told
    if not called:
        return told
    return found.among.explain([*told.terms, *called], told.posterior.sizes, refine=False)


def _finding(found: Inference, fitted: FittedParameters, k: int, judged: Explanation) -> Finding:
    effect, target = found.explanation.terms[k].effect, found.explanation.terms[k].target
    is_component = effect.corrects_table
    return Finding(
        effect=effect,
        target=target,
        parameters=fitted.values,
        u=fitted.u,
        rivals=rivals_of(found.among, judged, k),
        where=where_component(fitted.values, fitted.u, target) if is_component else None,
        interval_95=fitted.interval_95,
        weakly_identified=fitted.weakly_identified,
        is_relative=is_component and all(m.on_part for m in found.among.survey.measurements),
        odds=found.supports[k].odds,
        probability=found.supports[k].probability,
    )


def something_unknown(failures: Sequence[Failure]) -> Finding:
    """The finding that something is there which no effect explains, and where it shows most."""
    where = "; ".join(f.text for f in failures[:3]) or None
    return Finding(None, "", {}, {}, Rivals((), ()), where, {})
