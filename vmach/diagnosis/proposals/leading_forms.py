"""The forms that are worth a fit, of thousands over the readings.

All are weighed by their evidence on some of the readings; those that the readings cannot tell apart
count once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vmach.diagnosis.inference.bank import apart
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.form import Form
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.fit.base import Base
from vmach.fit.evidence import Evidence
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.discrepancy import Members
from vmach.fit.signature_group import SignatureGroup
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.whitening import share_within

__all__ = ["SAME", "TIE", "LeadingForms"]

#: a form whose readings follow those of another one, or of effects, that closely is the same; it
#: holds an effect whose readings follow its own that closely
SAME = 0.98
#: decimals of a gain; beyond them rounding would choose among forms that do the same
TIE = 5
#: readings at most that all forms are looked through on; the best are fitted to all readings
_LOOKED_THROUGH = 3000
#: numbers that products of forms may take up while they are kept
_ROOM = 25_000_000
#: numbers of forms that are weighed together, 24 MB
_AT_ONCE = 3_000_000


class LeadingForms:
    """Forms by their evidence; products that were worked out are kept.

    Parameters
    ----------
    weighing : Weighing
    columns : FormColumns
        The forms; more may be added to it.
    """

    def __init__(self, weighing: Weighing, columns: FormColumns) -> None:
        self._columns = columns
        self._screen = _Screen(weighing)
        self._banks: list[_Bank] = []
        self._listed = 0

    def of(self, views: Sequence[Explanation], most: int) -> list[Form]:
        """Forms worth a fit beside an explanation, so many at most from each view of it."""
        seen = [self._screen.posterior(v.posterior.sizes, v.posterior.effects) for v in views]
        of_effects = [apart(view) for view in seen]
        gains: list[list[np.ndarray]] = [[] for _ in seen]
        forms: list[Form] = []
        for bank in self._weighed():
            forms += bank.forms
            for view, own, gain in zip(seen, of_effects, gains, strict=True):
                gain.append(bank.gains(view, *own))
        chosen: list[Form] = []
        for gain in gains:
            taken = self._most_probable(forms, np.round(np.concatenate(gain), TIE), most)
            chosen += [form for form in taken if form not in chosen]
        return [form for form in chosen if form.label not in views[0].labels]

    def _most_probable(self, forms: Sequence[Form], gain: np.ndarray, most: int) -> list[Form]:
        """So many at most, of those that these readings cannot tell apart the simplest.

        Of several that are as simple the most probable, then the first that is listed.
        """
        taken: list[_Alike] = []
        for k in np.argsort(-gain, kind="stable"):
            if gain[k] < CLEARLY:
                break
            form, span = forms[k], self._columns.space_of(forms[k])
            one = _Alike(form, span, float(gain[k]), (span.shape[1], len(form.state_words)))
            same = next((j for j, other in enumerate(taken) if one.is_within(other)), None)
            if same is not None:
                taken[same] = taken[same].or_simpler(one)
            elif len(taken) == most:
                break
            else:
                taken.append(one)
        return [alike.simplest for alike in taken]

    def _weighed(self) -> Iterator[_Bank]:
        """Forms with their products, kept for the next time where there is room for them."""
        yield from self._banks
        forms, count = self._columns.forms, len(self._screen.base.y)
        room, many = _ROOM // count, max(_AT_ONCE // count, 1)
        for k in range(self._listed, len(forms), many):
            new = forms[k : k + many]
            weighed = _Bank(self._screen, self._columns, new)
            if k == self._listed and k + len(new) < room:
                self._banks.append(weighed)
                self._listed += len(new)
            yield weighed


class _Bank:
    """Those of some forms that readings show, weighed together.

    Parameters
    ----------
    screen : _Screen
        The readings.
    columns : FormColumns
    forms : sequence of Form

    Attributes
    ----------
    forms : list of Form
        That are shown, in their order.
    """

    def __init__(self, screen: _Screen, columns: FormColumns, forms: Sequence[Form]) -> None:
        self._groups, listed = [], []
        for numbers, blocks in columns.shown(forms, screen.rows):
            rows = [block.reshape(-1, block.shape[2]) for block in blocks]
            none = [np.zeros(1)] * len(numbers)
            self._groups.append(SignatureGroup(screen.base, rows, none, blocks[0].shape[1]))
            listed += numbers
        self._place = np.argsort(np.array(listed, dtype=int))
        self.forms = [forms[k] for k in sorted(listed)]
        self._price = np.log([form.looked_at for form in self.forms])

    def gains(self, posterior: Posterior, taken: np.ndarray, seen: np.ndarray) -> np.ndarray:
        """Log evidence of each beside a posterior, less what it costs to have tried many, (F,).

        Its effects take (r, e) of white columns, and (e,) of the readings.
        """
        back = posterior.base.back(taken)
        parts = [group.evidence(posterior.members, back, seen) for group in self._groups]
        return Evidence.joined(parts, self._place).log_factor[:, 0] - self._price


@dataclass(frozen=True)
class _Alike:
    """Forms that readings cannot tell apart: the simplest, and the first one's span and gain.

    Attributes
    ----------
    simplest : Form
    span : (n, K) float64
    gain : float
    complexity : (int, int)
        Of the simplest: amounts, then states that it depends on.
    """

    simplest: Form
    span: np.ndarray
    gain: float
    complexity: tuple[int, int]

    def is_within(self, other: _Alike) -> bool:
        """Whether it does nothing that others do not."""
        return share_within(self.span, other.span) >= SAME

    def or_simpler(self, one: _Alike) -> _Alike:
        """With one more, unless that is clearly less probable."""
        is_as_probable = one.gain > self.gain - CLEARLY
        if is_as_probable and one.complexity < self.complexity:
            return replace(self, simplest=one.simplest, complexity=one.complexity)
        return self


class _Screen:
    """Some of the readings, evenly spread, where all would take long to look through.

    Parameters
    ----------
    weighing : Weighing
    """

    def __init__(self, weighing: Weighing) -> None:
        base, count = weighing.base, len(weighing.survey)
        self.rows: np.ndarray | slice = slice(None)
        self.base = base
        if count > _LOOKED_THROUGH:
            rows = np.unique(np.linspace(0, count - 1, _LOOKED_THROUGH).astype(int))
            every = base.members
            kept = np.isin(np.arange(count), rows)
            members = Members(
                every.fixed_mm[rows], every.names, tuple(c[rows] for c in every.columns_mm)
            )
            self.rows = rows
            screened = _kept(weighing.survey, kept)
            self.base = Base(screened, base.noise.of_some(rows), members)

    def posterior(self, sizes: Sizes, effects: Effects) -> Posterior:
        """Members at given sizes, and effects, as these readings have them."""
        own = Effects(self.base.columns(effects.columns.mm[self.rows]), effects.log_prior)
        return Posterior(self.base, sizes, own)


def _kept(survey: Survey, rows: np.ndarray) -> Survey:
    """A survey with some of its readings, (n,) bool."""
    pairs = zip(survey.measurements, survey.rows, strict=True)
    return replace(survey, measurements=tuple(m.keep(rows[o]) for m, o in pairs if rows[o].any()))
