"""An error model by its name."""

from __future__ import annotations

from vmach.base.variant import Variant
from vmach.errors import InputError

__all__ = ["variant_called"]


def variant_called(name: object) -> Variant:
    """The variant of this name; raises InputError for any other."""
    try:
        return Variant(str(name))
    except ValueError:
        raise InputError(f"model = {name!r}", accepted=", ".join(Variant)) from None
