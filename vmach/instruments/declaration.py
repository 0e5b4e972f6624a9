"""What the class of an instrument has to say of itself, checked when it is found."""

from __future__ import annotations

import difflib
import inspect
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vmach.errors import InputError
from vmach.files.class_lines import lines_of_class
from vmach.measurements.instrument import Instrument

__all__ = ["check_declaration"]

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
#: likeness (0 to 1) from which on a function is a slip of a known one
_CLOSE = 0.7


def check_declaration(kind: type[Instrument]) -> None:
    """Refuse a class that does not say what an instrument has to say.

    Raises
    ------
    InputError
        With the file and the line of what is missing, misspelt or wrong.
    """
    _Declaration(kind).check()


class _Declaration:
    """A class, and where each of its attributes is written."""

    def __init__(self, kind: type[Instrument]) -> None:
        self.kind, self.file = kind, Path(inspect.getfile(kind))
        self._lines = lines_of_class(kind, self.file)

    def check(self) -> None:
        self._check_functions()
        name = self._given("name", "lower-case words joined by underscores")
        if not isinstance(name, str) or not _NAME.fullmatch(name):
            raise self.error(
                f"name = {name!r}", key="name", accepted="lower-case words joined by underscores"
            )
        for word in ("title", "sign_meaning", "left_free"):
            value = self._given(word, "a few words")
            if not isinstance(value, str) or not value.strip():
                raise self.error(f"{word} = {value!r}", key=word, accepted="a few words")
        if self.kind.is_section_of_job:
            self._check_columns()
            if self.kind.read is Instrument.read:
                raise self.error("read() is missing", accepted="def read(self, table, model)")

    def _check_functions(self) -> None:
        known = [n for n in vars(Instrument) if not n.startswith("_")]
        for name, value in vars(self.kind).items():
            if name.startswith("_") or name in known or not inspect.isroutine(value):
                continue
            if close := difflib.get_close_matches(name, known, n=1, cutoff=_CLOSE):
                raise self.error(
                    f"unknown function '{name}'", key=name, accepted=", ".join(sorted(known)),
                    hint=f"did you mean '{close[0]}'?",
                )  # fmt: skip

    def _check_columns(self) -> None:
        columns = self._given("columns", "a tuple of the names of columns")
        self._check_names("columns", columns)
        self._check_names("optional_columns", self.kind.optional_columns, may_be_empty=True)
        if self.kind.follows_program:
            return
        if "t_s" not in columns:
            raise self.error(
                f"columns = {columns!r} hold no times", key="columns", accepted="t_s among them",
                hint="or follows_program = True where the job's program tells when",
            )  # fmt: skip
        self._check_names("readings", self._given("readings", "a tuple of columns"), within=columns)
        self._check_names("signs", self.kind.signs, within=columns, may_be_empty=True)

    def _check_names(
        self,
        key: str,
        names: Any,
        *,
        within: Sequence[str] | None = None,
        may_be_empty: bool = False,
    ) -> None:
        accepted = "a tuple of names" if within is None else f"a tuple of {', '.join(within)}"
        good = isinstance(names, tuple) and all(isinstance(name, str) for name in names)
        if not good or (not names and not may_be_empty) or len(set(names)) < len(names):
            hint = f'a comma after it: {key} = ("{names}",)' if isinstance(names, str) else None
            raise self.error(f"{key} = {names!r}", key=key, accepted=accepted, hint=hint)
        if within is not None and not set(names) <= set(within):
            raise self.error(f"{key} = {names!r}", key=key, accepted=accepted)

    def _given(self, name: str, accepted: str) -> Any:
        value = getattr(self.kind, name, None)
        if value is None:
            raise self.error(f"'{name}' is missing", accepted=accepted)
        return value

    def error(
        self, what: str, *, key: str = "", accepted: str, hint: str | None = None
    ) -> InputError:
        what = f"instrument class {self.kind.__name__}: {what}"
        line = self._lines.get(key, self._lines.get(""))
        return InputError(what, file=self.file, line=line, accepted=accepted, hint=hint)
