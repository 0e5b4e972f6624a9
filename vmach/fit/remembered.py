"""What was worked out last, as far as there is room for it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

__all__ = ["Remembered"]

Value = TypeVar("Value")


class Remembered(Generic[Value]):
    """Values by their keys; what was not asked for longest is forgotten first.

    Parameters
    ----------
    room : float
        That all values may take up together, in whatever `size` counts; the last stays anyway.
    size : callable, optional
        How much a value takes up; one where left out.
    """

    def __init__(self, room: float, size: Callable[[Value], float] = lambda value: 1.0) -> None:
        self._room, self._size, self._taken = room, size, 0.0
        self._known: dict[Hashable, Value] = {}

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The value of a key, made where it is not known."""
        if key in self._known:
            value = self._known.pop(key)
        else:
            value = make()
            self._taken += self._size(value)
        self._known[key] = value
        while self._taken > self._room and len(self._known) > 1:
            self._taken -= self._size(self._known.pop(next(iter(self._known))))
        return value
