"""A user's own effect, watched: what goes wrong in its functions is told by file and line."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.read_only import read_only
from vmach.errors import InputError
from vmach.files.plugins import line_in
from vmach.machine import RigidDisplacement
from vmach.path.circumstances import Circumstances

__all__ = ["blamed", "guard", "line_of"]


class _Wrong(Exception):
    """What a function gives is none of what is accepted."""

    def __init__(self, what: str, accepted: str) -> None:
        super().__init__(what)
        self.what, self.accepted = what, accepted


def guard(effect: Effect, file: Path) -> None:
    """Watch every function of an effect that its own file writes.

    They see a path whose arrays they cannot change. What they raise, and a result of another kind,
    is an error of the file.
    """
    for name, checked in _CHECKED.items():
        if _is_own(type(effect), name):
            setattr(effect, name, _guarded(effect, name, checked, file))


def _is_own(kind: type[Effect], name: str) -> bool:
    """Whether a function is written by the user, and not by this package."""
    owner = next(one for one in kind.__mro__ if name in vars(one))
    return not owner.__module__.startswith("vmach.")


def line_of(kind: type, name: str) -> int | None:
    """The line at which a function of a class begins."""
    code = getattr(inspect.unwrap(getattr(kind, name)), "__code__", None)
    return None if code is None else code.co_firstlineno


@contextmanager
def blamed(
    file: Path, what: str, *, accepted: str | None = None, line: int | None = None
) -> Iterator[None]:
    """Tell whatever ends the block as an error of a file, with its line.

    `line` holds where the error does not come from the file. An `InputError` has said it already.
    Ctrl-C goes through.
    """
    try:
        yield
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(
            f"{what} fails: {error!r}",
            file=file,
            line=line_in(file, error) or line,
            accepted=accepted,
        ) from error


def _guarded(
    effect: Effect, name: str, checked: Callable[..., Any], file: Path
) -> Callable[..., Any]:
    law, label = getattr(effect, name), f"{name}() of effect '{effect.name}'"

    @wraps(law)
    def watched(*arguments: Any, **parameters: Any) -> Any:
        count = len(arguments[0]) if arguments and isinstance(arguments[0], Circumstances) else 0
        # what is no number is told below, once
        with blamed(file, label), np.errstate(all="ignore"):
            found = law(*map(read_only, arguments), **parameters)
            found = list(found) if name in _LAZY else found  # its errors come while it runs
        try:
            return checked(found, count)
        except _Wrong as wrong:
            told = ", ".join(f"{k} = {v:g}" for k, v in parameters.items() if np.ndim(v) == 0)
            raise InputError(
                f"{label} gives {wrong.what}",
                file=file,
                line=line_of(type(effect), name),
                accepted=wrong.accepted + (f", for {told}" if told else ""),
            ) from None

    return watched


def _numbers(found: Any, shape: tuple[int | None, ...], accepted: str) -> np.ndarray:
    """An array of a shape, None for any length, of finite real numbers; a copy."""
    try:
        given = np.asarray(found)
    except ValueError:
        raise _Wrong("rows of different lengths", accepted) from None
    fits = len(given.shape) == len(shape) and all(
        wanted in (None, there) for wanted, there in zip(shape, given.shape, strict=True)
    )
    if not fits:
        raise _Wrong(f"an array of {given.shape}", accepted)
    if given.dtype.kind not in "fiu":
        raise _Wrong(f"an array of {given.dtype}", f"real numbers: {accepted}")
    values = np.array(given, dtype=float)
    if not np.isfinite(values).all():
        raise _Wrong("values that are no numbers", "finite displacements")
    return values


def _displaced(found: Any, count: int) -> RigidDisplacement | np.ndarray:
    if isinstance(found, RigidDisplacement):
        accepted = f"shift_mm and tilt_rad of (P, 3), one row a state: here {(count, 3)}"
        parts = [_numbers(part, (count, 3), accepted) for part in (found.shift_mm, found.tilt_rad)]
        return RigidDisplacement(*parts)
    return _pattern(found, count)


def _pattern(found: Any, count: int) -> np.ndarray:
    return _numbers(found, (count, 3), f"(P, 3) mm, one row a state: here {(count, 3)}")


def _shift(found: Any, count: int) -> np.ndarray | None:
    return None if found is None else _pattern(found, count)


def _patterns(found: Any, count: int) -> np.ndarray:
    accepted = f"(P, 3, K) mm, one row a state: here ({count}, 3, K)"
    return _numbers(found, (count, 3, None), accepted)


def _words(found: Any, count: int) -> tuple[str, ...]:
    if not isinstance(found, tuple | list) or not all(isinstance(word, str) for word in found):
        raise _Wrong(repr(found), 'a tuple of words: ("X", "Y"), or ("",) for no choice')
    return tuple(found)


def _reason(found: Any, count: int) -> str | None:
    if found is not None and not isinstance(found, str):
        raise _Wrong(repr(found), "why not, in words, or None")
    return found


def _yes_or_no(found: Any, count: int) -> bool:
    if not isinstance(found, bool | np.bool_):
        raise _Wrong(repr(found), "True or False")
    return bool(found)


def _complaint(found: Any, count: int) -> tuple[str, str, str] | None:
    if found is not None and (len(_words(found, count)) != 3):
        raise _Wrong(repr(found), "key, what is wrong and what is accepted, or None")
    return found


def _parameters(found: Any, count: int) -> dict[str, Any]:
    if not isinstance(found, Mapping) or not all(isinstance(name, str) for name in found):
        raise _Wrong(repr(found), "a dict from names of parameters to their values")
    return dict(found)


def _grid(found: Any, count: int) -> Iterator[dict[str, Any]]:
    return iter([_parameters(one, count) for one in found])


def _places(found: Any, count: int) -> list[tuple[dict[str, Any], float]]:
    if not isinstance(found, list) or not all(len(one) == 2 for one in found):
        raise _Wrong(repr(found), "a list of pairs: inner values, and how likely they are")
    return [(_parameters(values, count), float(odds)) for values, odds in found]


def _knots(found: Any, count: int) -> np.ndarray:
    return _numbers(found, (None,), "(K,) mm, positions of the axis")


def _curve(found: Any, count: int) -> np.ndarray:
    return _numbers(found, (None, None), "(K, K), one row a knot")


#: functions that an effect may write, and what checks that their results are of the right kind
_CHECKED: dict[str, Callable[[Any, int], Any]] = {
    "displacement": _displaced,
    "tool_shift": _shift,
    "possible_targets": _words,
    "is_unmeasured": _yes_or_no,
    "needed": _words,
    "complaint": _complaint,
    "not_testable": _reason,
    "slack_pattern": _pattern,
    "slack": _patterns,
    "unforeseen": _patterns,
    "shows_on": _yes_or_no,
    "is_twin_of": _yes_or_no,
    "knots_mm": _knots,
    "curve": _curve,
    "beyond_slope": _parameters,
    "inner_grid": _grid,
    "places": _places,
    "columns": _patterns,
    "settle": _parameters,
}
#: those that may be generators
_LAZY = ("inner_grid",)
