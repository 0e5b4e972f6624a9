"""Forms beside what a search found, kept while it goes on: they take long."""

from __future__ import annotations

from collections.abc import Set as AbstractSet

from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.forms import Forms

__all__ = ["RememberedForms"]


class RememberedForms:
    """The last forms that were asked for."""

    def __init__(self) -> None:
        self._last: tuple[Weighing, Explanation, Forms, Explanation] | None = None

    def of(
        self, weighing: Weighing, found: Explanation, beside: AbstractSet[str] | None = None
    ) -> tuple[Forms, Explanation]:
        """Forms, and the explanation that they lead to, as `Forms.grown` has it.

        Parameters
        ----------
        weighing : Weighing
        found : Explanation
        beside : set of str, optional
            Labels of those of its effects that stay beside forms, where that is known.
        """
        if self._last is None or self._last[0] is not weighing or self._last[1] is not found:
            self._last = None  # large: not two at a time
            forms = Forms(weighing, found)
            self._last = weighing, found, forms, forms.grown(found, beside=beside)
        return self._last[2:]

    def lead(self, weighing: Weighing, found: Explanation) -> float:
        """Log odds by which forms explain more than what was found."""
        return self.of(weighing, found)[1].score - found.score
