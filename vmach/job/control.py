"""The control that the command line names in place of the job's."""

from __future__ import annotations

from contextvars import ContextVar

from gcode import ProgramError, dialect_name, dialect_names
from vmach.errors import InputError

__all__ = ["control_told", "tell_control"]

_TOLD: ContextVar[str | None] = ContextVar("control", default=None)


def tell_control(name: str | None) -> str | None:
    """From now on every job is read for this control; None for the job's own.

    Raises
    ------
    InputError
        There is no such control.
    """
    try:
        _TOLD.set(None if name is None else dialect_name(name))
    except ProgramError:
        known = ", ".join(dialect_names())
        raise InputError(f"--control {name}", accepted=f"auto, {known}") from None
    return name


def control_told() -> str | None:
    """The control that the command line names."""
    return _TOLD.get()
