"""A path as a user's law sees it: the same, but that none of its arrays can be changed."""

from __future__ import annotations

from functools import cache, wraps
from typing import Any

import numpy as np

from gcode import Moves
from vmach.machine import RigidDisplacement
from vmach.path.circumstances import Circumstances
from vmach.path.toolpath import PathStates

__all__ = ["read_only"]

_RECORDS = (Circumstances, PathStates, Moves, RigidDisplacement)


def read_only(value: Any) -> Any:
    """The same value; its arrays raise `ValueError` when something is written into them.

    Examples
    --------
    >>> import numpy as np
    >>> from vmach.effects.read_only import read_only
    >>> bool(read_only(np.zeros(3)).flags.writeable)
    False
    """
    if isinstance(value, np.ndarray):
        seen = value.view()
        seen.flags.writeable = False
        return seen
    if isinstance(value, tuple):
        return tuple(map(read_only, value))
    if isinstance(value, _RECORDS) and not hasattr(type(value), "_is_shield"):
        shield = object.__new__(_shield_of(type(value)))
        object.__setattr__(shield, "_behind", value)
        return shield
    return value


@cache
def _shield_of(kind: type) -> type:
    """A class whose objects look like those of another one and stand before one of them.

    What is asked for is made by the object behind, so that it is made once, of its own arrays.
    """

    def get(self: Any, name: str) -> Any:
        if name == "__class__":
            return kind
        found = getattr(object.__getattribute__(self, "_behind"), name)
        return _of_method(found) if callable(found) else read_only(found)

    return type(kind.__name__, (kind,), {"__getattribute__": get, "_is_shield": True})


def _of_method(method: Any) -> Any:
    @wraps(method)
    def seen(*arguments: Any, **named: Any) -> Any:
        return read_only(method(*arguments, **named))

    return seen
