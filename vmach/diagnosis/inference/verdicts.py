"""A verdict for each effect, and what remains beside them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.by_definition import as_defined
from vmach.diagnosis.inference.moves import (
    search,
    search_beyond,
    search_exchanging,
    search_possible,
    without_needless,
)
from vmach.diagnosis.inference.noise import beside_own_noise, noise_before
from vmach.diagnosis.inference.own_contacts import chosen_by_all, chosen_by_one, over_own_contacts
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.remains import is_structure, remains_um, sizes_um
from vmach.diagnosis.inference.rules import KEPT
from vmach.diagnosis.inference.support import Support, supports_of
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.form import FormEffect
from vmach.diagnosis.proposals.forms import Forms
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.diagnosis.proposals.remembered_forms import RememberedForms
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.sizes import Sizes
from vmach.fit.terms import JointFit, Term

__all__ = ["Inference", "Reason", "Weak", "beside_forms", "infer", "judged", "led"]

#: times that contacts and the noise of single readings are estimated anew
_PASSES = 2
#: readings of a measurement that a search goes over first, at least, where there are twice as many;
#: chosen: half of 500 to 900 points cost three right answers of 136 parts, so many none of 16
_SEARCHED = 2500

_Found = tuple[Weighing, Explanation]
_LeadOn = Callable[[Weighing, Explanation], Explanation]


class Reason(StrEnum):
    """Why an effect that the search took is not shown."""

    DOUBTFUL = "evidence and size do not make it certain"
    REPLACED = "a form over states explains the readings as well"
    IMPOSSIBLE = "would need a size that nature does not have"


@dataclass(frozen=True)
class Weak:
    """An effect that the readings speak for, though not clearly.

    Attributes
    ----------
    term : Term
    support : Support
    why : Reason
    """

    term: Term
    support: Support
    why: Reason


@dataclass(frozen=True)
class Inference:
    """What was found.

    Attributes
    ----------
    weighing : Weighing
        With the noise that the readings show.
    explanation : Explanation
        By the effects that are shown.
    among : Weighing
        The same with forms among its candidates.
    told : Explanation
        By the effects that are shown, and forms beside them: what an effect's parameters are.
    supports : tuple of Support
        What speaks for each.
    weak : tuple of Weak
    remains_um : float
        Root mean square of what neither effects nor noise explain.
    is_structure : bool
        Whether that is more than the uncertainty of one reading.
    proposals : tuple of Proposal
        Forms for what remains, the most probable first.
    """

    weighing: Weighing
    explanation: Explanation
    among: Weighing
    told: Explanation
    supports: tuple[Support, ...]
    weak: tuple[Weak, ...]
    remains_um: float
    is_structure: bool
    proposals: tuple[Proposal, ...] = ()

    @property
    def fit(self) -> JointFit | None:
        """Of the effects that are shown, first, and forms beside them."""
        return self.among.careful(self.told)

    @property
    def fit_of_effects(self) -> JointFit | None:
        """Of the effects alone, as they were fitted beside the forms."""
        return self.fit.first(len(self.supports)) if self.fit and self.supports else None

    @cached_property
    def noise(self) -> Posterior:
        """What counts as noise: the discrepancy too, unless it is structure."""
        base, sizes = self.weighing.base, self.explanation.posterior.sizes
        if self.is_structure:
            sizes = Sizes(1.0, (0.0,) * len(sizes.members))
        return Posterior(base, sizes, Effects(base.no_columns))


def infer(weighing: Weighing) -> Inference:
    """Search, noise of single readings and effects in turn, and weigh what was found.

    Forms over states compete with the effects for what the readings show.
    """
    weighing, found, forms, grown = led(weighing)
    among, beside, stay, replaced = beside_forms(weighing, forms, found, grown)
    told, supports, weak = judged(among, beside, stay)
    shown = told.terms[: len(told.terms) - stay]
    alone = weighing.explain(shown, found.posterior.sizes, refine=False)
    remains = remains_um(among, told, noise=grown.posterior.sizes.factor, count=len(shown))
    structure = is_structure(weighing, remains) or stay > 0
    return Inference(
        weighing,
        alone,
        among,
        told,
        tuple(supports[term.label] for term in shown),
        (*replaced, *weak),
        remains,
        structure,
        proposals=forms.proposals(alone, grown) if structure else (),
    )


def led(weighing: Weighing) -> tuple[Weighing, Explanation, Forms, Explanation]:
    """The most probable effects, and the same where forms compete with them.

    Returns
    -------
    Weighing
        With the noise that they leave, over the contacts that they choose.
    Explanation
        By effects alone.
    Forms
    Explanation
        By effects and forms.
    """
    weighing, found, forms, grown = _led(weighing)
    chosen = _forms_of(grown)
    moved = chosen_by_all(forms.among(chosen), grown) if chosen else None
    if moved is None:
        return weighing, found, forms, grown
    effects, terms, kept = weighing.effects, found.terms, found.labels & grown.labels
    weighing.release()
    del weighing, found, forms, grown  # large, and of other contacts
    weighing, found = _taken_over(prepare_weighing(moved, effects), terms, by_forms=True)
    return _with_forms(weighing, found, RememberedForms(), kept)


def _led(weighing: Weighing) -> tuple[Weighing, Explanation, Forms, Explanation]:
    """The same over contacts that effects choose.

    Of many readings some are searched first. Where no form takes the place of effects there, none
    is tried in the place of these on all readings: that takes long.
    """
    few, beside, known = weighing.survey.thinned(_SEARCHED), None, RememberedForms()
    if few is weighing.survey:
        weighing, found = _sought(weighing, known)
    else:
        some, found = _sought(prepare_weighing(few, weighing.effects), known)
        terms, (_, grown) = found.terms, known.of(some, found)
        beside = None if _forms_of(grown) else found.labels & grown.labels
        some.release()
        known = RememberedForms()
        weighing, found = _taken_over(weighing, terms)
    return _with_forms(weighing, found, known, beside)


def _with_forms(
    weighing: Weighing, found: Explanation, known: RememberedForms, beside: AbstractSet[str] | None
) -> tuple[Weighing, Explanation, Forms, Explanation]:
    """Effects as nature has them, and forms beside some of them, or in the place of any."""
    weighing, found = as_defined(weighing, search_possible(weighing, found))
    return weighing, found, *known.of(weighing, found, beside)


def _taken_over(weighing: Weighing, terms: Sequence[Term], *, by_forms: bool = False) -> _Found:
    """What some of the readings, or other contacts, led to, and what all lead to beside it.

    Their noise comes first: taken for white, it would be told as effects. Effects alone would not
    choose contacts that forms chose.
    """
    # what a few readings show may be nothing that all do
    shown = {candidate.label for candidate in weighing.candidates}
    known = [term for term in terms if term.label in shown]
    found = weighing.explain(known, weighing.small().posterior.sizes)
    if not by_forms:
        weighing, found = over_own_contacts(weighing, found)
    weighing, found = beside_own_noise(weighing, found)
    return weighing, search_exchanging(weighing, without_needless(weighing, found))


def _sought(weighing: Weighing, known: RememberedForms) -> _Found:
    """What a search finds from nothing, and the weighing with the noise that it leaves.

    Two more starts lead to one: over contacts that an effect would choose, unless that was found,
    and beside the tails of readings before any effect, unless none are left of them.
    """
    chosen, tails = chosen_by_one(weighing), noise_before(weighing)
    weighing, found = _settled(weighing, weighing.nothing(), search)
    if chosen is not None and chosen[0] not in found.labels:
        there = prepare_weighing(chosen[1], weighing.effects)
        weighing, found = _better(weighing, found, there)
    if not tails.is_plain and not weighing.base.noise.is_plain:
        tailed = weighing.with_candidates(weighing.candidates).with_noise(tails)
        weighing, found = _better(weighing, found, tailed)
    return _settled(weighing, found, lambda w, e: search_beyond(w, e, known.lead))


def _forms_of(grown: Explanation) -> list[Term]:
    return [term for term in grown.terms if isinstance(term.effect, FormEffect)]


def _better(weighing: Weighing, found: Explanation, start: Weighing) -> _Found:
    """What another start leads to, where that is more probable; one at a time, for its memory."""
    weighing.forget()
    other, end = _settled(start, start.nothing(), search)
    if end.score > found.score:
        return other, end
    other.forget()
    return weighing, found


def _settled(weighing: Weighing, start: Explanation, lead_on: _LeadOn) -> _Found:
    """The most probable set that moves lead to, over its own contacts and beside its own noise."""
    found, led_from = lead_on(weighing, start), start.labels
    for _ in range(_PASSES):
        before, labels = weighing, found.labels
        weighing, found = beside_own_noise(*over_own_contacts(weighing, found))
        if weighing is before:
            break
        # another noise may make needless what stood for it
        found = without_needless(weighing, found)
        is_same = led_from == labels == found.labels
        found = weighing.remembered_as(before, found) if is_same else lead_on(weighing, found)
        led_from = labels
    return weighing, found


def beside_forms(
    weighing: Weighing, forms: Forms, found: Explanation, grown: Explanation
) -> tuple[Weighing, Explanation, int, tuple[Weak, ...]]:
    """Effects to judge, then what is of other causes and stays, and how many these are.

    An effect keeps about its size beside a form, or was found there. One that shrinks is an
    imitation; one that grows is a part of the form's cause, and stays beside it. Before, it stands
    beside as little discrepancy as the form leaves: a large one would hide it. A form that holds
    all of an effect and more, as a curve holds a scale, says nothing of one that every machine
    has: it does not stand beside it.

    Returns
    -------
    Weighing
        With the forms among its candidates.
    Explanation
    int
        So many of its terms, the last, are of other causes.
    tuple of Weak
        What is an imitation or a part of another cause.
    """
    chosen = _forms_of(grown)
    if not chosen and grown.labels == found.labels:
        return weighing, found, 0, ()
    usual = [k for k, t in enumerate(found.terms) if weighing.prior_of(t.effect, t.target) > 0.0]
    holding = {(k, form.label) for k in usual for form in chosen if forms.holds(found, k, form)}
    held = {k for k, _ in holding}
    stay = [form for form in chosen if form.label not in {label for _, label in holding}]
    among = forms.among(stay)
    sizes = dict(zip((t.label for t in grown.terms), sizes_um(weighing, grown), strict=True))
    beside = {term.label: term for term in grown.terms}
    alone = weighing.explain(found.terms, grown.posterior.sizes, refine=False, resize=False)
    effects, gone = [], []
    for k, (term, size) in enumerate(zip(found.terms, sizes_um(weighing, alone), strict=True)):
        if KEPT * size < sizes.get(term.label, 0.0) < size / KEPT or k in held:
            effects.append(beside.get(term.label, term))
            continue
        gone.append(k)
        if sizes.get(term.label, 0.0) > size and stay:
            stay.append(beside[term.label])
    known = found.labels | {form.label for form in chosen}
    effects += [term for term in grown.terms if term.label not in known]
    supports = supports_of(weighing, found) if gone else ()
    replaced = tuple(Weak(found.terms[k], supports[k], Reason.REPLACED) for k in gone)
    here = among.explain([*effects, *stay], grown.posterior.sizes, refine=False)
    return among, here, len(stay), replaced


def judged(
    weighing: Weighing, found: Explanation, stay: int = 0
) -> tuple[Explanation, dict[str, Support], tuple[Weak, ...]]:
    """An explanation without effects that are not shown, what speaks for the others, and those.

    Imitations go, the least probable first. The others stay judged as beside them: their smallest
    odds count, and the smallest rest. What is not certain stays beside what is judged.

    Parameters
    ----------
    weighing : Weighing
    found : Explanation
    stay : int
        So many of its terms, the last, are of other causes, and stay.
    """
    supports: dict[str, Support] = {}
    weak: list[Weak] = []
    while True:
        effects = found.terms[: len(found.terms) - stay]
        here = zip(effects, supports_of(weighing, found, len(effects)), strict=True)
        supports = {t.label: s.after(supports.get(t.label, s)) for t, s in here}
        doubted = _doubted(weighing, found, supports)
        if doubted is None:
            break
        k, why = doubted
        term = found.terms[k]
        weak.append(Weak(term, supports[term.label], why))
        found = weighing.without(found, [k])
    unsure = [term for term in effects if not supports[term.label].is_shown]
    found = weighing.without(found, [k for k, t in enumerate(found.terms) if t in unsure])
    found, sure = _one_of(weighing, found, unsure, supports, stay)
    supports |= sure
    weak += [Weak(t, supports[t.label], Reason.DOUBTFUL) for t in unsure if t.label not in sure]
    return found, supports, tuple(weak)


def _one_of(
    weighing: Weighing,
    found: Explanation,
    unsure: Sequence[Term],
    supports: Mapping[str, Support],
    stay: int,
) -> tuple[Explanation, dict[str, Support]]:
    """An explanation with those of some unsure effects that are sure without the others.

    Each of two may be needless beside the other, and one of them is there: a class.
    """
    sure: dict[str, Support] = {}
    left = [term for term in unsure if supports[term.label].probability >= 0.5]
    while left:
        count = len(found.terms) - stay
        shown, others = found.terms[:count], found.terms[count:]
        trials = [
            weighing.explain([*shown, term, *others], found.posterior.sizes, refine=False)
            for term in left
        ]
        best = max(range(len(left)), key=lambda k: trials[k].score)
        term = left.pop(best)
        support = supports_of(weighing, trials[best], count + 1)[-1]
        support = support.beside(supports[term.label].rest_um)
        if not support.is_shown:
            break
        found, sure[term.label] = trials[best], support
    return found, sure


def _doubted(
    weighing: Weighing, found: Explanation, supports: Mapping[str, Support]
) -> tuple[int, Reason] | None:
    """The effect that is most probably an imitation, and why."""
    fit, count = weighing.careful(found), len(supports)
    unlikely = [k for k in range(count) if supports[found.terms[k].label].probability < 0.5]
    impossible = [k for k in impossible_terms(fit) if k < count] if fit else []
    for why, ks in ((Reason.DOUBTFUL, unlikely), (Reason.IMPOSSIBLE, impossible)):
        if ks:
            return min(ks, key=lambda k: supports[found.terms[k].label].order), why
    return None
