"""Examining what a search finds: is what it leaves noise, are its laws shown, is it likely?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.findings import Finding, findings_of
from vmach.diagnosis.gates.contrived import is_contrived
from vmach.diagnosis.gates.impossible_sizes import impossible_sizes
from vmach.diagnosis.gates.settling import settled
from vmach.diagnosis.gates.shown_laws import laws_not_shown
from vmach.diagnosis.residuals.outliers import without_outliers, without_suspects
from vmach.diagnosis.search import Search

__all__ = ["Examination", "examine"]


@dataclass(frozen=True)
class Examination:
    """An explanation with what speaks against it.

    Attributes
    ----------
    search : Search
        Over the readings that count.
    explanation : Explanation
    findings : tuple of Finding
    left : dict
        What is left beyond noise, or asked too much; empty where nothing is.
    not_shown, left_out : tuple of str
        Notes on laws that are not shown, and on readings that do not count.
    """

    search: Search
    explanation: Explanation
    findings: tuple[Finding, ...]
    left: dict[str, float]
    not_shown: tuple[str, ...]
    left_out: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """Named, class, unknown or nothing."""
        known = self.search.missing_tables
        if self.left or is_contrived(self.findings, expected=known):
            return "unknown"
        if not self.findings:
            return "nothing"
        return "class" if any(len(f.rivals.names) > 1 for f in self.findings) else "named"


def examine(search: Search) -> Examination:
    """What a search finds, held against all gates.

    Without a few readings that stand alone, where that makes all else plain.
    """
    found = _examined(search)
    if found.verdict != "unknown":
        return found
    fewer = without_suspects(found.search, found.explanation)
    if fewer is None:
        return found
    search, notes = fewer
    again = _examined(search, (*found.left_out, *notes))
    return found if again.verdict == "unknown" else again


def _examined(search: Search, left_out: tuple[str, ...] = ()) -> Examination:
    """What a search over all of its readings but outliers finds."""
    search, explanation, outliers = without_outliers(search)
    explanation = settled(search, explanation)
    findings = findings_of(search, explanation)
    left, not_shown = _objections(search, explanation, findings)
    return Examination(
        search, explanation, findings, left, tuple(not_shown), (*left_out, *outliers)
    )


def _objections(
    search: Search, explanation: Explanation, findings: Sequence[Finding]
) -> tuple[dict[str, float], list[str]]:
    """Why an explanation does not do: what it leaves or asks too much of, and notes in words."""
    left = search.left_in(explanation)
    if left:
        return left, []
    left, notes = impossible_sizes(findings)
    if left:
        return left, notes
    return laws_not_shown(search, explanation)
