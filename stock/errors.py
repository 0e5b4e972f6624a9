"""Errors that a user of this package can cause and mend."""

from __future__ import annotations

__all__ = ["StockError"]


class StockError(ValueError):
    """A tool, a sweep, a point or the blank cannot be worked with.

    Parameters
    ----------
    what : str
        What is wrong, with the value and its unit.
    accepted : str, optional
        What would be accepted.
    hint : str, optional
        What to do about it.
    """

    def __init__(self, what: str, *, accepted: str | None = None, hint: str | None = None) -> None:
        self.what, self.accepted, self.hint = what, accepted, hint
        text = what
        if accepted:
            text += f"; accepted: {accepted}"
        if hint:
            text += f" (hint: {hint})"
        super().__init__(text)
