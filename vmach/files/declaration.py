"""What the class of a plug-in says of itself, checked when it is found.

What is missing, unknown or misspelt is an error with the line in the file that says it.
"""

from __future__ import annotations

import ast
import difflib
import inspect
import re
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import Any

from vmach.errors import InputError

__all__ = ["Declaration"]

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
#: likeness (0 to 1) from which on an attribute, or a function, is a slip of a known one
_LIKE = (0.6, 0.75)


class Declaration:
    """A class, and where each of its attributes is written.

    Parameters
    ----------
    kind : type
    base : type
        What it is derived from: its attributes are those that are known.
    what : str
        What it is, for messages.
    file : Path, optional
        Where it stands; needed where it is in no module that Python knows.
    """

    def __init__(self, kind: type, base: type, what: str, file: Path | None = None) -> None:
        self.kind, self.base, self.what = kind, base, what
        self.file = file or _file_of(kind)

    def error(
        self, said: str, *, key: str = "", accepted: str, hint: str | None = None
    ) -> InputError:
        """What is wrong, with the line of an attribute, or of the class."""
        line = self._lines.get(key, self._lines.get(""))
        said = f"{self.what} class {self.kind.__name__}: {said}"
        return InputError(said, file=self.file, line=line, accepted=accepted, hint=hint)

    @cached_property
    def _lines(self) -> dict[str, int]:
        """Where it and its attributes stand; of no use where all is right, so found late."""
        return {} if self.file is None else _lines_of_class(self.kind, self.file)

    def given(self, name: str, accepted: str) -> Any:
        """An attribute that has to be there."""
        value = getattr(self.kind, name, None)
        if value is None:
            raise self.error(f"'{name}' is missing", accepted=accepted)
        return value

    def check_name(self) -> None:
        """Its name is what a file can say."""
        accepted = "lower-case words joined by underscores"
        name = self.given("name", accepted)
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise self.error(f"name = {name!r}", key="name", accepted=accepted)

    def check_words(self, names: Iterable[str]) -> None:
        """Attributes that have to say something."""
        for name in names:
            value = self.given(name, "a few words")
            if not isinstance(value, str) or not value.strip():
                raise self.error(f"{name} = {value!r}", key=name, accepted="a few words")

    def check_known(self, *more: str) -> None:
        """Attributes that nobody asks for are slips; those of the class's own begin with _."""
        known = {name for name in dir(self.base) if not name.startswith("_")}
        known |= set(inspect.get_annotations(self.base)) | set(more)
        for name, value in vars(self.kind).items():
            if name.startswith("_") or name in known:
                continue
            is_function = inspect.isroutine(value) or isinstance(value, property)
            alike = [k for k in known if is_function <= callable(getattr(self.base, k, None))]
            close = difflib.get_close_matches(name, alike, n=1, cutoff=_LIKE[is_function])
            if is_function and not close:
                continue
            raise self.error(
                f"unknown attribute '{name}'",
                key=name,
                accepted=", ".join(sorted(known)),
                hint=f"did you mean '{close[0]}'?"
                if close
                else f"what is the class's own is called _{name}",
            )


def _file_of(kind: type) -> Path | None:
    try:
        return Path(inspect.getfile(kind))
    except (OSError, TypeError):
        return None


def _lines_of_class(kind: type, file: Path) -> dict[str, int]:
    """1-based line of a class under "", and of its attributes and functions by their names.

    Empty where the file has no class of that name.
    """
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8-sig"))):
        if isinstance(node, ast.ClassDef) and node.name == kind.__name__:
            lines = {"": node.lineno}
            for part in node.body:
                lines |= dict.fromkeys(_names_in(part), part.lineno)
            return lines
    return {}


def _names_in(part: ast.stmt) -> list[str]:
    if isinstance(part, ast.FunctionDef):
        return [part.name]
    if isinstance(part, ast.AnnAssign):
        return [part.target.id] if isinstance(part.target, ast.Name) else []
    if isinstance(part, ast.Assign):
        return [target.id for target in part.targets if isinstance(target, ast.Name)]
    return []
