"""Effects of a user's own, each in a Python file."""

from __future__ import annotations

import importlib.util
import traceback
from collections.abc import Callable
from pathlib import Path

import numpy as np

from vmach.effects.catalogue import add_effect
from vmach.effects.circumstances import Circumstances
from vmach.effects.effect import Displaced, Effect
from vmach.errors import InputError
from vmach.machine import RigidDisplacement
from vmach.text_file import read_text

__all__ = ["load_effect_file"]


def load_effect_file(path: str | Path) -> Effect:
    """Load a user's own effect from a Python file and put it into the catalogue.

    Raises
    ------
    InputError
        No such file, an error inside it, or not exactly one subclass of `Effect`.
    """
    path = Path(path)
    read_text(path, what="effect file")
    spec = importlib.util.spec_from_file_location(f"vmach_user_effect_{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise InputError(f"effect file cannot be loaded: {error!r}", file=path) from error
    kinds = [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, Effect)
        and value is not Effect
        and value.__module__ == module.__name__
    ]
    if len(kinds) != 1:
        raise InputError(
            f"{len(kinds)} effects in the file", file=path, accepted="one subclass of Effect"
        )
    effect = kinds[0]()
    effect.displacement = _guarded(effect, path)
    add_effect(effect)
    return effect


def _guarded(effect: Effect, file: Path) -> Callable[..., Displaced]:
    """The user's own law; what goes wrong in it is told by file and line."""
    law = effect.displacement

    def displacement(path: Circumstances, target: str, **parameters: float) -> Displaced:
        try:
            moved = law(path, target, **parameters)
        except Exception as error:
            frames = traceback.extract_tb(error.__traceback__)
            lines = [frame.lineno for frame in frames if frame.filename == str(file)]
            raise InputError(
                f"displacement() of effect '{effect.name}' fails: {error!r}",
                file=file,
                line=lines[-1] if lines else None,
            ) from error
        shape = (len(path), 3)
        if not isinstance(moved, RigidDisplacement) and np.shape(moved) != shape:
            raise InputError(
                f"displacement() of effect '{effect.name}' gives an array of {np.shape(moved)}",
                file=file,
                accepted=f"(P, 3) mm, one row a state: here {shape}",
            )
        return moved

    return displacement
