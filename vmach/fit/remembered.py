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

    def __contains__(self, key: Hashable) -> bool:
        return key in self._known

    def __getitem__(self, key: Hashable) -> Value:
        value = self._known[key] = self._known.pop(key)
        return value

    def __setitem__(self, key: Hashable, value: Value) -> None:
        """Remember a value that is not known."""
        self._taken += self._size(value)
        self._known[key] = value
        while self._taken > self._room and len(self._known) > 1:
            self._taken -= self._size(self._known.pop(next(iter(self._known))))

    def get(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """The value of a key, made where it is not known."""
        if key not in self._known:
            self[key] = make()
        return self[key]

    def clear(self) -> None:
        """Forget all."""
        self._known.clear()
        self._taken = 0.0
