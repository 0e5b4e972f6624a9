"""Effects of a user's own, each in a Python file."""

from __future__ import annotations

import importlib.util
import inspect
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from vmach.effects.catalogue import add_effect, catalogue
from vmach.effects.declaration import check_declaration
from vmach.effects.effect import Displaced, Effect
from vmach.effects.law_check import check_law
from vmach.effects.trial_path import trial_path
from vmach.errors import InputError
from vmach.files.plugins import classes_in, line_in, loading
from vmach.files.text_file import read_text
from vmach.machine import RigidDisplacement
from vmach.path.circumstances import Circumstances

__all__ = ["load_effect_file"]


def load_effect_file(path: str | Path) -> Effect:
    """Load a user's own effect from a Python file and put it into the catalogue.

    Raises
    ------
    InputError
        There is no such file, it has an error, or it has not exactly one subclass of `Effect`.
        The class lacks a statement, or has the name of another effect. The law is not
        proportional to its amplitudes.
    """
    path = Path(path)
    read_text(path, what="effect file")
    spec = importlib.util.spec_from_file_location(f"vmach_user_effect_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with loading(path, "effect"):
        spec.loader.exec_module(module)
    kinds = classes_in(module, Effect)
    if len(kinds) != 1:
        raise InputError(
            f"{len(kinds)} effects in the file", file=path, accepted="one subclass of Effect"
        )
    check_declaration(kinds[0], path)
    _check_name(kinds[0].name, path)
    effect = kinds[0]()
    effect.displacement = _guarded(effect, path)
    effect.file = path
    check_law(effect, trial_path(), file=path)
    add_effect(effect)
    return effect


def _check_name(name: str, path: Path) -> None:
    """Refuse the name of an effect that is there; a file may be loaded again."""
    other = catalogue().get(name)
    if other is None or path.resolve() in (_file_of(other), _file_of(type(other))):
        return
    where = f"in {other.file}" if other.file else f"already: {other.title}"
    text = read_text(path, what="effect file").splitlines()
    raise InputError(
        f"name = '{name}': there is an effect of this name {where}",
        file=path,
        line=next((n for n, row in enumerate(text, 1) if "name" in row and name in row), None),
        accepted="a name of its own",
        hint=f"call it 'own_{name}'",
    )


def _file_of(effect: Effect | type[Effect]) -> Path | None:
    """Where an effect was loaded from; of a class, where it is written."""
    if isinstance(effect, Effect):
        return effect.file and effect.file.resolve()
    try:
        return Path(inspect.getfile(effect)).resolve()
    except (OSError, TypeError):
        return None


def _guarded(effect: Effect, file: Path) -> Callable[..., Displaced]:
    """The user's own law; what goes wrong in it is told by file and line."""
    law = effect.displacement
    line = type(effect).displacement.__code__.co_firstlineno

    def displacement(path: Circumstances, target: str, **parameters: float) -> Displaced:
        try:
            moved = law(path, target, **parameters)
        except Exception as error:
            raise InputError(
                f"displacement() of effect '{effect.name}' fails: {error!r}",
                file=file,
                line=line_in(file, error),
            ) from error
        shape = (len(path), 3)
        if not isinstance(moved, RigidDisplacement) and np.shape(moved) != shape:
            raise InputError(
                f"displacement() of effect '{effect.name}' gives an array of {np.shape(moved)}",
                file=file,
                line=line,
                accepted=f"(P, 3) mm, one row a state: here {shape}",
            )
        shift = moved.shift_mm if isinstance(moved, RigidDisplacement) else moved
        if not np.isfinite(shift).all():
            raise InputError(
                f"displacement() of effect '{effect.name}' gives values that are no numbers",
                file=file,
                line=line,
                accepted="finite displacements, for " + _told(parameters),
            )
        return moved

    return displacement


def _told(parameters: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in parameters.items())
