"""Search over sets of effects: adding, dropping and exchanging until nothing is more probable."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace

import numpy as np

from vmach.diagnosis.gates.impossible_sizes import impossible_terms
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.sizes import Sizes

__all__ = [
    "beside_little",
    "search",
    "search_beyond",
    "search_exchanging",
    "search_possible",
    "without_needless",
]

#: size in u of a discrepancy that leaves effects to show; chosen: with 0.1 and 0.02 searches of 88
#: parts ended as well
_LITTLE = 0.3
#: candidates that are tried at each step; with two, 2 of 87 searches ended worse; of 199 effects
#: that were dropped, 197 were among the three that cost least
_TRIED = 3
#: candidates that are tried beside an impossible size; chosen: on a part that was looked at the one
#: that was missing came fourth
_MORE = 6
#: candidates of which pairs are weighed; of four that had to be, the last was the 18th
_LEADING = 30
#: candidates that are fitted as the first of two; of four that had to be, the last was third
_FIRSTS = 5
#: pairs in the place of one that are fitted; of five that were taken in 72 searches, the last was
#: tenth by its odds before the fit
_PAIRS = 12
#: log odds by which a pair may lie behind before its first is fitted; chosen: 26 on one part
_ROUGH = 30.0
#: log odds by which one may lie behind the effect whose place it takes; in none of a few hundred
#: refits did one from further behind catch up
_NEAR = 6.0
#: log odds by which a set that fills a discrepancy may lie behind, or behind forms, to be led on
#: from; in 113 searches two caught up, from 11 and 2, and none of eight from further behind than 12
_BEHIND = 20.0
#: share of what an effect stands for that the first of two in its place takes alone, at least;
#: chosen: half of an even split. It saves fits; whatever passes is weighed by the readings
_SHARE = 0.25
#: decimals of a score; beyond them rounding would choose among tools that cannot be told apart
_TIE = 5
#: effects at most that fill a discrepancy; with twelve 99 searches that were looked at ended alike
_FILLED = 6
#: a move counts where it makes the whole more probable by this much
_STEP = 0.5
#: log odds of a candidate below which it is not worth a fit; chosen: a fit moves little but its
#: inner parameters
_HOPELESS = -2.0
#: moves at most; a search that goes on has something to report already
_MOVES = 12

_Moves = Sequence[Callable[[Weighing, Explanation], Iterator[Explanation]]]
_Rival = Callable[[Weighing, Explanation], float]  # log odds


def search(weighing: Weighing, here: Explanation) -> Explanation:
    """The most probable set that adding one effect after the other leads to."""
    return _led_on(weighing, here, (_added,))


def search_exchanging(weighing: Weighing, here: Explanation) -> Explanation:
    """A more probable set, by effects that are added or take the place of others."""
    return _led_on(weighing, here, (_added, _exchanged))


def search_beyond(
    weighing: Weighing, here: Explanation, rival: _Rival = lambda weighing, here: 0.0
) -> Explanation:
    """A more probable set, by all moves; a large discrepancy is filled where none of them helps.

    A rival is asked by how much something else explains more: effects far behind are left alone.
    """
    moves = (_added, _uncovered, _afresh, _exchanged, _elsewhere, _split, _paired)
    here = _led_on(weighing, here, moves)
    for _ in range(_MOVES):
        filled = _filled(weighing, here, moves, rival)
        if filled.score < here.score + _STEP:
            break
        here = filled
    return here


def search_possible(weighing: Weighing, here: Explanation) -> Explanation:
    """A set whose sizes nature has, with one effect more or another, and what that leads to.

    It is taken where it is not clearly less probable than one with an impossible size.
    """
    if _is_possible(weighing, here):
        return here
    found = (e for e in _near_impossible(weighing, here) if _is_possible(weighing, e))
    best = _best(weighing, found, here.score - CLEARLY)
    if best is None:
        return here
    further = _led_on(weighing, best, (_exchanged,))
    return further if _is_possible(weighing, further) else best


def _led_on(weighing: Weighing, here: Explanation, moves: _Moves) -> Explanation:
    """Where moves lead to, while one makes the whole more probable; the first kinds first."""
    here = _remembered(weighing, here)
    for _ in range(_MOVES):
        found = (_best(weighing, move(weighing, here), here.score + _STEP) for move in moves)
        better = next(filter(None, found), None)
        if better is None:
            break
        here = without_needless(weighing, better)
    return here


def _best(weighing: Weighing, found: Iterator[Explanation], than: float) -> Explanation | None:
    """The most probable of some explanations where its score is larger than a given one."""
    remembered = (_remembered(weighing, e) for e in found)
    best = max(remembered, key=lambda e: round(e.score, _TIE), default=None)
    return best if best is not None and best.score > than else None


def _remembered(weighing: Weighing, tried: Explanation) -> Explanation:
    """An explanation, noted among those that were tried where nature has such sizes."""
    is_possible = tried.fit is None or not impossible_terms(tried.fit)
    return weighing.remembered(tried) if is_possible else tried


def _is_possible(weighing: Weighing, here: Explanation) -> bool:
    """Whether nature has its sizes, as they are judged."""
    fit = weighing.careful(here)
    return fit is None or not impossible_terms(fit)


def _near_impossible(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """One effect more of many, as what is missing hides; others in place of an impossible size."""
    for k in _ranked(weighing, weighing.gains(here), here.labels)[:_MORE]:
        yield weighing.extend(here, k)
    fit = weighing.careful(here)
    assert fit is not None
    impossible = {here.terms[k].label: k for k in impossible_terms(fit)}
    for gone in impossible.values():
        others = weighing.without(here, [gone], resize=False)
        for k in _leading(weighing, others, here.labels):
            yield weighing.extend(others, k)
    fewer = weighing.with_candidates([c for c in weighing.candidates if c.label not in impossible])
    found = search_exchanging(fewer, fewer.nothing())
    yield weighing.explain(found.terms, found.posterior.sizes, refine=False)


def _added(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """One effect more."""
    for k in _leading(weighing, here, here.labels):
        yield weighing.extend(here, k)


def _uncovered(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """One effect more, that a large discrepancy hides: beside little of it, which may then grow."""
    little = beside_little(here)
    sizes = little.posterior.sizes
    if sizes != here.posterior.sizes:
        for k in _leading(weighing, little, here.labels):
            one = weighing.extend(here, k)
            tried = (weighing.resized(one, sizes), weighing.extend(little, k))
            yield max(tried, key=lambda e: e.score)


def _afresh(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """One effect as it would be chosen beside the others, or the others as they are without it.

    It was chosen before they were there, and they were fitted while it was.
    """
    for k, term in enumerate(here.terms):
        others = weighing.without(here, [k], resize=False)
        own = weighing.term(weighing.index_of(term.label), others)
        if (own.width, own.inner) != (term.width, term.inner):
            yield weighing.explain([*others.terms, own], here.posterior.sizes)
        if any(other.inner for other in others.terms):
            yield weighing.explain(others.terms, here.posterior.sizes)


def _exchanged(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """Others in place of one effect, or of two that share what one does.

    Members stay as they are at first: where they grow into a gap, they hide what could fill it.
    """
    least = here.score - _NEAR
    for count in (1, 2):
        for gone in itertools.combinations(range(len(here.terms)), count):
            others = weighing.without(here, gone, resize=False)
            for child in _filled_up(weighing, others, here.labels, count, least):
                if child.score > least:
                    yield weighing.explain(child.terms, child.posterior.sizes)


def _elsewhere(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """One effect less, and another clearly elsewhere without that; one more where it helps."""
    least = here.score - _NEAR
    for gone, kept in itertools.permutations(range(len(here.terms)), 2):
        others = weighing.without(here, sorted((gone, kept)), resize=False)
        k = weighing.index_of(here.terms[kept].label)
        as_it_is = weighing.without(here, [gone], resize=False).score
        if others.score + weighing.gains(others)[k] >= as_it_is + CLEARLY:
            afresh = weighing.extend(others, k, resize=False)
            for child in (afresh, *_filled_up(weighing, afresh, here.labels, 1, least)):
                if child.score > least:
                    yield weighing.explain(child.terms, child.posterior.sizes)


def _filled(weighing: Weighing, here: Explanation, moves: _Moves, rival: _Rival) -> Explanation:
    """Several effects in place of a large discrepancy, and what other moves make of them.

    Together they may be less probable at first, as some stand for others. As given where none do.
    """
    sizes = beside_little(here).posterior.sizes
    if sizes == here.posterior.sizes:
        return here
    start = weighing.explain(here.terms, sizes, refine=False, resize=False)
    *_, last = start, *_filled_up(weighing, start, here.labels, _FILLED)
    if last is start:
        return here
    filled = without_needless(weighing, weighing.explain(last.terms, sizes))
    behind, is_new = here.score - filled.score, filled.labels != here.labels
    if is_new and behind < _BEHIND and behind + rival(weighing, here) < _BEHIND:
        filled = _led_on(weighing, filled, moves)
    return _remembered(weighing, filled)


def _filled_up(
    weighing: Weighing,
    start: Explanation,
    but: AbstractSet[str],
    most: int,
    least: float = -np.inf,
) -> Iterator[Explanation]:
    """An explanation with ever more effects, while members and inner parameters but moments stay.

    The last of them has to make it more probable than the least, those before by their share.
    """
    for count in range(most, 0, -1):
        worth = (least - start.score) * (_SHARE if count > 1 else 1.0)
        leading = _leading(weighing, start, but | start.labels, worth)
        sudden = ((k, weighing.candidates[k].effect.is_sudden) for k in leading)
        children = (weighing.extend(start, k, refine=r, resize=False) for k, r in sudden)
        best = max(children, key=lambda e: e.score, default=start)
        if best.score < start.score + _STEP:
            return
        yield best
        start = best


def _split(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """Two effects in place of one that stands for both, found beside members as they start."""
    pairs: list[tuple[float, Explanation, int]] = []
    for start in _starts(here):
        least = start.score - (2.0 * _NEAR if start is here else 0.0)
        pairs += _in_place_of_one(weighing, start, least)
    pairs.sort(key=lambda pair: -round(pair[0], _TIE))
    for _, one, j in pairs[:_PAIRS]:
        yield weighing.extend(one, j)


def _in_place_of_one(
    weighing: Weighing, start: Explanation, least: float
) -> Iterator[tuple[float, Explanation, int]]:
    """Scores of two effects in place of one, above the least, the first fitted; and the other."""
    for k, term in enumerate(start.terms):
        others = weighing.without(start, [k], resize=False)
        for i in _firsts(weighing, others, term.label, least - _ROUGH):
            one = weighing.extend(others, i, refine=False, resize=False)
            # what was there may be another of the two, elsewhere than where it stood for both
            odds = one.score + weighing.gains(one)
            for j in _ranked(weighing, odds, others.labels | one.labels)[:_TRIED]:
                if odds[j] > max(least, one.score):
                    yield float(odds[j]), one, j


def _firsts(weighing: Weighing, others: Explanation, own: str, least: float) -> list[int]:
    """Those of pairs in the place of one effect, none idle, that place the other one better."""
    alone, curves = weighing.gains(others), {c.label for c in weighing.candidates if c.is_curve}
    odds = weighing.pair_gains(others, _ranked(weighing, alone, others.labels | curves)[:_LEADING])
    alone[weighing.index_of(own)] = -np.inf
    odds[(odds <= np.maximum.outer(alone, alone)) | (odds < odds.T)] = -np.inf
    best = odds.max(axis=1, initial=-np.inf)
    leading = _ranked(weighing, best, others.labels)[:_FIRSTS]
    return [i for i in leading if others.score + best[i] > least]


def _starts(here: Explanation) -> Iterator[Explanation]:
    """An explanation, and the same beside little of a large discrepancy, which may then grow."""
    yield here
    if (little := beside_little(here)).posterior.sizes != here.posterior.sizes:
        yield little


def _paired(weighing: Weighing, here: Explanation) -> Iterator[Explanation]:
    """Two effects more, of which neither may say anything alone; beside little, which may grow."""
    little = beside_little(here)
    for i, j in _leading_pairs(weighing.pair_gains(little)):
        yield weighing.extend(weighing.extend(little, i, refine=False, resize=False), j)


def _leading_pairs(gains: np.ndarray) -> Iterator[tuple[int, int]]:
    """Pairs that are worth a fit, by gains (C, C), the most probable first; none shares one."""
    gains = np.round(gains, _TIE)
    for _ in range(_TRIED):
        if gains.max(initial=-np.inf) < 2.0 * _HOPELESS:
            return
        i, j = divmod(int(np.argmax(gains)), len(gains))
        yield i, j
        gains[[i, j]] = gains[:, [i, j]] = -np.inf


def _ranked(weighing: Weighing, gains: np.ndarray, but: AbstractSet[str]) -> list[int]:
    """Candidates, the most probable first."""
    order = np.argsort(-np.round(gains, _TIE), kind="stable")
    return [k for k in order if weighing.candidates[k].label not in but]


def _leading(
    weighing: Weighing, here: Explanation, but: AbstractSet[str], worth: float = _HOPELESS
) -> Iterator[int]:
    """Candidates that are worth a fit beside an explanation."""
    gains, least = weighing.gains(here), max(worth, _HOPELESS)
    return (k for k in _ranked(weighing, gains, but)[:_TRIED] if gains[k] > least)


def beside_little(here: Explanation) -> Explanation:
    """An explanation beside a discrepancy that leaves effects to show."""
    sizes = here.posterior.sizes
    small = Sizes(min(sizes.factor, 1.0), tuple(min(s, _LITTLE) for s in sizes.members))
    return replace(here, posterior=replace(here.posterior, sizes=small))


def without_needless(
    weighing: Weighing, here: Explanation, *, but: AbstractSet[str] = frozenset()
) -> Explanation:
    """Drop effects that the others make needless, those that cost least beside given sizes.

    Some may have to stay, by their labels.
    """
    while len(here.terms) > 1:
        free = [k for k, term in enumerate(here.terms) if term.label not in but]
        left = {k: weighing.without(here, [k], resize=False).score for k in free}
        fewer = (weighing.without(here, [k]) for k in sorted(free, key=lambda k: -left[k])[:_TRIED])
        best = max(fewer, key=lambda e: e.score, default=None)
        if best is None or best.score < here.score:
            break
        here = best
    return here
