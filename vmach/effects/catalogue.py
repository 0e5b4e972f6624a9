"""The effects there are: those of this package, and those that others add by an entry point."""

from __future__ import annotations

import difflib
from functools import lru_cache

from vmach.effects import laws
from vmach.effects.declaration import check_declaration
from vmach.effects.effect import Effect
from vmach.errors import InputError
from vmach.files.plugins import classes_of
from vmach.job import Job

__all__ = [
    "ENTRY_POINT",
    "add_effect",
    "catalogue",
    "unknown_effect_hint",
]

#: group of entry points under which a package offers its own effects
ENTRY_POINT = "vmach.effects"

#: a name is a slip of one that is there from this likeness on, 0 to 1
_CLOSE = 0.75
#: effects that were added while the program runs, by their names
_added: dict[str, Effect] = {}


def catalogue() -> dict[str, Effect]:
    """Every known effect by its name, in order of how common it is; the caller's own copy."""
    known = _installed() | _added
    return dict(sorted(known.items(), key=lambda item: -item[1].commonness))


def add_effect(effect: Effect) -> None:
    """Make an effect known for as long as the program runs, in place of one of its name.

    Examples
    --------
    >>> import vmach
    >>> class BedSlope(vmach.Effect):
    ...     name = "bed_slope"
    ...     title = "slope of the bed"
    ...     parameters = (vmach.linear("rise_um_per_m", "rise along X", usual=10.0),)
    ...     targets = ("",)
    ...
    ...     def displacement(self, path, target, rise_um_per_m):
    ...         return vmach.along("Z", 1e-6 * rise_um_per_m * path.nose_mm[:, 0])
    >>> vmach.add_effect(BedSlope())
    >>> "bed_slope" in catalogue()
    True
    """
    _added[effect.name] = effect


@lru_cache(maxsize=1)
def _installed() -> dict[str, Effect]:
    """Effects of the rooms of ``laws``, and of packages beside vmach.

    Raises
    ------
    InputError
        With the file and the line of what is missing, unknown or misspelt; a name is there twice.
    """
    effects: dict[str, Effect] = {}
    for kind in classes_of(laws, ENTRY_POINT, Effect, what="effect"):
        check_declaration(kind, is_printed=kind.__module__.startswith(laws.__name__))
        if kind.name in effects:
            raise InputError(
                f"effect class {kind.__name__} of {kind.__module__}: name = '{kind.name}' is that "
                f"of {type(effects[kind.name]).__module__} too",
                accepted="a name of its own",
            )
        effects[kind.name] = kind()
    return effects


def unknown_effect_hint(name: str, job: Job | None = None) -> str:
    """What to do about a name that no effect has: a slip, or an effect of the user's own.

    A job's history says in which file an effect of the user's own was when it was added.
    """
    if job is not None:
        last = job.history[-1] if job.history else {}
        kept = last.get("effect_files", {}).get(name)
        file = job.folder / (kept or f"{name}.py")
        if file.is_file():
            return f"it is in {file}: vmach --effect-file {file} COMMAND ..."
        if kept:
            return (
                f"it was in {file}, which is not there: where is the file now? Name it with "
                "vmach --effect-file FILE COMMAND ..."
            )
    close = difflib.get_close_matches(name, catalogue(), n=1, cutoff=_CLOSE)
    if close:
        return f"did you mean '{close[0]}'?"
    return "is it an effect of your own? Name its file: vmach --effect-file FILE COMMAND ..."
