"""Effects of a user's own, each in a Python file."""

from __future__ import annotations

import inspect
from pathlib import Path
from types import ModuleType

from vmach.effects.catalogue import add_effect, catalogue
from vmach.effects.declaration import check_declaration
from vmach.effects.effect import Effect
from vmach.effects.guard import blamed, guard, line_of
from vmach.effects.law_check import check_law
from vmach.effects.trial_path import trial_path
from vmach.errors import InputError
from vmach.files.plugins import classes_in, loading
from vmach.files.text_file import read_text

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
    kinds = classes_in(_module_of(path), Effect)
    if len(kinds) != 1:
        raise InputError(
            f"{len(kinds)} effects in the file", file=path, accepted="one subclass of Effect"
        )
    kind = kinds[0]
    check_declaration(kind, path)
    _check_name(kind.name, path)
    made = "a class that is made without arguments"
    begin = line_of(kind, "__init__")
    with blamed(path, f"__init__() of effect '{kind.name}'", accepted=made, line=begin):
        effect = kind()
    with blamed(path, f"effect '{kind.name}'"):
        guard(effect, path)
        effect.file = path
        check_law(effect, trial_path(), file=path)
    add_effect(effect)
    return effect


def _module_of(path: Path) -> ModuleType:
    """A file of Python, run; nothing that was compiled earlier is taken in its place."""
    text = read_text(path, what="effect file")
    module = ModuleType(f"vmach_user_effect_{path.stem}")
    module.__file__ = str(path)
    with loading(path, "effect"):
        exec(compile(text, str(path), "exec", dont_inherit=True), module.__dict__)
    return module


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
