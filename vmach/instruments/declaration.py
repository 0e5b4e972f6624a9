"""What the class of an instrument has to say of itself, checked when it is found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vmach.files.declaration import Declaration
from vmach.measurements.instrument import Instrument

__all__ = ["check_declaration"]


def check_declaration(kind: type[Instrument]) -> None:
    """Refuse a class that does not say what an instrument has to say.

    Raises
    ------
    InputError
        With the file and the line of what is missing, misspelt or wrong.
    """
    _OfInstrument(kind, Instrument, "instrument").check()


class _OfInstrument(Declaration):
    """What the class of an instrument says."""

    def check(self) -> None:
        self.check_known()
        self.check_name()
        self.check_words(("title", "sign_meaning", "left_free"))
        if self.kind.is_section_of_job:
            self._check_columns()
            if self.kind.read is Instrument.read:
                raise self.error("read() is missing", accepted="def read(self, table, model)")

    def _check_columns(self) -> None:
        columns = self.given("columns", "a tuple of the names of columns")
        self._check_names("columns", columns)
        self._check_names("optional_columns", self.kind.optional_columns, may_be_empty=True)
        if self.kind.follows_program:
            return
        if "t_s" not in (*columns, *self.kind.optional_columns):
            raise self.error(
                f"columns = {columns!r} hold no times", key="columns", accepted="t_s among them",
                hint="or follows_program = True where the job's program tells when",
            )  # fmt: skip
        self._check_names("readings", self.given("readings", "a tuple of columns"), within=columns)
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
