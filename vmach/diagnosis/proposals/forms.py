"""Forms for what remains, weighed by the same evidence beside the same discrepancy."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from itertools import combinations

import numpy as np

from vmach.base.units import um_from_mm
from vmach.diagnosis.inference.moves import (
    beside_little,
    search,
    search_exchanging,
    without_needless,
)
from vmach.diagnosis.inference.remains import remains_mm, remains_um, sizes_um, usual_u_um
from vmach.diagnosis.inference.rules import CLEARLY, WORTH_A_FORM
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.form import Form
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.diagnosis.proposals.held_out import held_out_um
from vmach.diagnosis.proposals.leading_forms import SAME, TIE, LeadingForms
from vmach.diagnosis.proposals.proposal import Proposal
from vmach.fit.candidates import Candidate
from vmach.fit.terms import Term
from vmach.fit.whitening import orthonormal, share_within

__all__ = ["Forms"]

#: forms that are fitted at each step, by their evidence beside the discrepancy and nearly without
_FITTED = 6
#: those that are fitted first in the place of effects; of three causes that effects imitated,
#: twelve led to the same forms
_FIRST = 2
#: share of what effects bring that the first form in their place brings, at least; chosen: what
#: two forms are is mostly one of them. It saves fits; the readings weigh what passes
_SHARE = 0.5
#: forms that are added one after the other
_MOST = 4
#: proposals that are told
_TOLD = 3
#: share of what was beyond noise that a form leaves at most of features that were not fitted,
#: where the discrepancy may hold it as well
_HALVED = 0.5


class Forms:
    """The forms over the readings of a weighing, beside what a search found there.

    Parameters
    ----------
    weighing : Weighing
    found : Explanation
        Its effects stay candidates.
    """

    def __init__(self, weighing: Weighing, found: Explanation) -> None:
        weighing.forget_columns()  # forms take much memory of their own
        self._weighing = weighing
        self._known = [weighing.candidates[weighing.index_of(t.label)] for t in found.terms]
        self._columns = FormColumns(weighing.survey)
        self._leading = LeadingForms(weighing, self._columns)
        self._chosen: dict[str, Form] = {}

    def grown(self, found: Explanation, *, beside: AbstractSet[str] | None = None) -> Explanation:
        """An explanation with forms added while that is clearly more probable.

        Effects may imitate another cause: forms compete with all of them, and with those that the
        search needs least, as the others may be known causes. In the end every effect competes
        with the forms: one that imitations hid may be what a form says.

        Parameters
        ----------
        found : Explanation
        beside : set of str, optional
            Labels of those of its effects that stay beside forms, where that is known.
        """
        start = self._start(found)
        best = self._grown(start)
        for fewer in self._with_fewer(found, start, beside):
            alone = self._alone(fewer, best)
            is_clear = alone.score > best.score + CLEARLY
            if is_clear and not self._says_the_same(found, best.labels, alone.labels):
                best = alone
        return self._among_all_effects(best)

    def _among_all_effects(self, here: Explanation) -> Explanation:
        """An explanation with forms, where effects that were not found before may stand beside."""
        forms = [self._chosen[t.label] for t in here.terms if t.label in self._chosen]
        if not forms:
            return here
        every = self._of(self._weighing.candidates, forms)
        start = every.explain(here.terms, here.posterior.sizes, refine=False)
        found = search_exchanging(every, start)
        new = found.labels - here.labels
        self._known += [c for c in self._weighing.candidates if c.label in new]
        return found

    def added(self, found: Explanation) -> Explanation:
        """An explanation with forms beside its effects, which all stay."""
        return self._grown(self._start(found), but=found.labels)

    def _start(self, found: Explanation) -> Explanation:
        """An explanation where forms are candidates."""
        return self._with(()).explain(found.terms, found.posterior.sizes, refine=False)

    def _says_the_same(
        self, found: Explanation, labels: AbstractSet[str], instead: AbstractSet[str]
    ) -> bool:
        """Whether a form of another set does what an effect that it gives up does as well.

        With as many amounts, on one target or on several: two tools that wear alike are still
        tools that wear. More amounts follow another cause by chance, as a curve does.
        """
        new = [form for label, form in self._chosen.items() if label in instead - labels]
        gone = [
            t for t in found.terms if t.label in labels - instead and not t.effect.corrects_table
        ]
        for form in new:
            space = self._columns.space_of(form)
            by_amounts: dict[Hashable, list[np.ndarray]] = {}
            for term in gone:
                moved = self._amounts_mm(term)
                for some in combinations(range(moved.shape[1]), space.shape[1]):
                    by_amounts.setdefault((term.effect.name, some), []).append(moved[:, some])
            spans = (orthonormal(np.hstack(moved)) for moved in by_amounts.values())
            if any(share_within(space, span) > SAME for span in spans):
                return True
        return False

    def _amounts_mm(self, term: Term) -> np.ndarray:
        """What each amount of an effect does alone beyond alignment, (n, K)."""
        survey = self._weighing.survey
        columns = survey.signature(term.effect, term.target, term.inner)
        return columns - survey.aligned(columns)

    def _moved_mm(self, found: Explanation, k: int) -> np.ndarray:
        """What effect k of an explanation does beyond alignment, (n, 1)."""
        assert found.fit is not None
        moved = found.fit.explained_mm(k)[:, None]
        return moved - self._weighing.survey.aligned(moved)

    def _with_fewer(
        self, found: Explanation, start: Explanation, beside: AbstractSet[str] | None
    ) -> Iterator[Explanation]:
        """Without any effect, and without those that the search needs least: one, two, ...

        Parameters
        ----------
        found : Explanation
        start : Explanation
            The same where forms are candidates.
        beside : set of str or None
            Labels of those that stay, where that is known.
        """
        weighing, count = self._with(()), len(found.terms)
        if beside is not None:
            gone = [k for k, term in enumerate(found.terms) if term.label not in beside]
            if gone:
                yield weighing.without(start, gone)
            return
        if count:
            yield weighing.nothing()
        without = [self._weighing.without(found, [k]).score for k in range(count)]
        order = np.argsort(without)[::-1].tolist()
        for fewer in range(1, count):
            # forms that were chosen meanwhile are candidates too
            yield self._with(()).without(start, order[:fewer])

    def _is_worth_a_form(self, here: Explanation) -> bool:
        """Whether as much remains; a factor on the stated uncertainty may stand for a form."""
        rest = remains_um(self._weighing, here, noise=1.0)
        return rest >= WORTH_A_FORM * usual_u_um(self._weighing)

    def _alone(self, fewer: Explanation, than: Explanation) -> Explanation:
        """Forms beside few effects, where the first brings a good share of what others bring.

        As given where none does. The first is sought beside the discrepancy that the others leave.
        Effects that it leaves something to do come back.
        """
        self._columns.add_conspicuous(*self._left_mm(fewer))
        beside = replace(fewer, posterior=replace(fewer.posterior, sizes=than.posterior.sizes))
        first = self._extended(fewer, self._leading.of([beside], _FIRST))
        brought = first.score - fewer.score
        if brought <= _SHARE * (than.score - fewer.score):
            return fewer
        return self._grown(search(self._with(()), first))

    def _grown(self, here: Explanation, *, but: AbstractSet[str] = frozenset()) -> Explanation:
        """An explanation with forms; effects that they make needless go, but some."""
        for k in range(_MOST):
            if not self._is_worth_a_form(here):
                break
            if k == 0 and here.terms:
                # effects may have taken a part of what one form is
                self._columns.add_conspicuous(*self._left_mm(self._weighing.alone))
            self._columns.add_conspicuous(*self._left_mm(here))
            better = self._extended(here, self._leading.of(_two_views(here), _FITTED), but=but)
            if better.score < here.score + CLEARLY:
                break
            here = better
        return here

    def _extended(
        self, here: Explanation, leading: Sequence[Form], *, but: AbstractSet[str] = frozenset()
    ) -> Explanation:
        """An explanation with the best of some forms, without what it makes needless, but some.

        Ways and times of the best are fitted finer than forms are listed.
        """
        best = self._best(here, leading)
        if best is None:
            return here
        if near := self._columns.near(best[1]):
            finer = self._best(here, near)
            best = max(best, finer or best, key=lambda pair: round(pair[0].score, TIE))
        extended, form = best
        self._chosen[form.label] = form
        return without_needless(self._with(leading), extended, but=but)

    def _best(self, here: Explanation, leading: Sequence[Form]) -> tuple[Explanation, Form] | None:
        """An explanation with that of some forms that makes it the most probable, and the form."""
        weighing, little = self._with(leading), beside_little(here).posterior.sizes

        def fitted(form: Form) -> Explanation:
            one = weighing.extend(here, weighing.index_of(form.label))
            if little == here.posterior.sizes:
                return one
            # members that are large hide what a form could do in their place
            return max(one, weighing.resized(one, little), key=lambda e: e.score)

        # one at a time: a fit of many readings takes much memory
        pairs = ((fitted(form), form) for form in leading)
        return max(pairs, key=lambda pair: round(pair[0].score, TIE), default=None)

    def holds(self, found: Explanation, k: int, form: Term) -> bool:
        """Whether what effect k of an explanation does is all in the span of a form."""
        own = orthonormal(self._moved_mm(found, k))
        return share_within(own, self._columns.space_of(self._chosen[form.label])) > SAME

    def proposals(self, alone: Explanation, grown: Explanation) -> tuple[Proposal, ...]:
        """The forms of a grown explanation, then others that would do nearly as well.

        Parameters
        ----------
        alone : Explanation
            The effects that are shown.
        grown : Explanation
            With forms.
        """
        self._columns.add_conspicuous(*self._left_mm(alone))
        first = [self._chosen[t.label] for t in grown.terms if t.label in self._chosen]
        leading = [*first, *self._leading.of(_two_views(alone), _FITTED)]
        simpler = [form for one in leading for form in self._columns.simpler(one)]
        forms = dict.fromkeys([*leading, *simpler])
        weighing = self._with([*forms])
        start = weighing.explain(alone.terms, alone.posterior.sizes, refine=False)
        shown_mm = float(np.median(weighing.base.noise.shown_mm))
        noise_um = grown.posterior.sizes.factor * um_from_mm(shown_mm)
        found: list[Proposal] = []
        for here in (start, beside_little(start)):
            for form in forms:
                k, resize = weighing.index_of(form.label), here is start
                trial = weighing.extend(here, k, resize=resize)
                if trial.score <= here.score + CLEARLY:
                    continue
                proposal = _proposal(weighing, form, here, trial)
                # what the discrepancy holds as well has to foretell
                if proposal.share_left(noise_um) < (1.0 if resize else _HALVED):
                    found.append(proposal)
        told = _told(found, len(weighing.survey))
        return tuple(replace(p, form=self._columns.held(p.form)) for p in told)

    def among(self, terms: Sequence[Term]) -> Weighing:
        """The weighing of all effects, with the forms of some terms."""
        if not terms:
            return self._weighing
        chosen = [self._chosen[term.label] for term in terms]
        weighing = self._of(self._weighing.candidates, chosen)
        weighing.tried = self._weighing.tried
        return weighing

    def _with(self, forms: Sequence[Form]) -> Weighing:
        """A weighing of the known effects, the forms that were added, and some more."""
        return self._of(self._known, [*self._chosen.values(), *forms])

    def _of(self, effects: Sequence[Candidate], forms: Sequence[Form]) -> Weighing:
        """A weighing of effects and forms, each of these once."""
        listed, every = len(self._columns), {form.label: form for form in forms}
        return self._weighing.with_others(
            effects,
            [self._columns.candidate(form) for form in every.values()],
            [-float(np.log(listed * form.looked_at)) for form in every.values()],
        )

    def _left_mm(self, here: Explanation) -> tuple[np.ndarray, np.ndarray]:
        """What effects and alignment leave of the readings, and members beside them, (n,) each."""
        survey = self._weighing.survey
        explained = np.zeros(len(survey))
        if here.fit is not None:
            explained = sum(here.fit.explained_mm(k) for k in range(len(here.terms)))
        beside = survey.residual_mm - explained
        left = np.stack([beside, beside - remains_mm(self._weighing, here)], axis=1)
        whole, rest = (left - survey.aligned(left)).T
        return whole, rest


def _proposal(weighing: Weighing, form: Form, start: Explanation, trial: Explanation) -> Proposal:
    """A form, as it was fitted last of all."""
    fit, last = trial.fit, len(trial.terms) - 1
    assert fit is not None
    return Proposal(
        form=form,
        amounts_um=fit.parameters(last),
        u_um=fit.uncertainty(last),
        size_um=sizes_um(weighing, trial)[last],
        odds=trial.score - start.score,
        remains_um=remains_um(weighing, trial),
        held_out_um=held_out_um(weighing.survey, fit, last),
    )


def _told(found: Sequence[Proposal], readings: int) -> Sequence[Proposal]:
    """Those that foretell best what was not fitted, of other states each.

    Of those within one standard error of the best, the simplest: the rule of
    T. Hastie, R. Tibshirani and J. Friedman, The Elements of Statistical Learning, 7.10.
    """
    told: list[Proposal] = []
    left = list(found)
    while left and len(told) < _TOLD:
        most = min(p.held_out_um[1] for p in left) * (1.0 + 1.0 / np.sqrt(2.0 * readings))
        close = [p for p in left if p.held_out_um[1] <= most]
        told.append(min(close, key=_complexity))
        left = [p for p in left if p.form.kinds != told[-1].form.kinds]
    return told


def _complexity(proposal: Proposal) -> tuple[int, int, float]:
    """Smaller the simpler it is; of two that are as simple, the more probable one."""
    return len(proposal.amounts_um), len(proposal.form.state_words), -proposal.odds


def _two_views(here: Explanation) -> list[Explanation]:
    """An explanation as it is, and beside a discrepancy that leaves forms to show, if it hides."""
    little = beside_little(here)
    return [here] if little.posterior.sizes == here.posterior.sizes else [here, little]
