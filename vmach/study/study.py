"""A study as its file says it: the cases, and the function that works on each."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, Strict

from vmach.errors import InputError
from vmach.files.text_file import csv_rows, read_text
from vmach.files.toml_file import FileSection, Finite, Flag, Whole, line_of_key, read_toml
from vmach.study.case import Case, Value
from vmach.study.task import PREDICT, Task

__all__ = ["Study", "read_study"]

#: more cases are a slip of the product of lists; a case takes a kilobyte
_MOST_CASES = 1_000_000

_Scalar = Annotated[str, Strict()] | Flag | Annotated[int, Strict()] | Finite


class _StudySchema(FileSection):
    """A whole study file."""

    schema_: Literal[1] = Field(alias="schema")
    seed: Annotated[int, Strict(), Field(ge=0)] = 1
    function: str = PREDICT
    table: str | None = None
    draws: Whole | None = None
    cases: dict[str, _Scalar | list[_Scalar]] = Field(default_factory=dict)


@dataclass(frozen=True)
class Study:
    """N cases and what is done with each.

    Attributes
    ----------
    path : Path
        The study file.
    task : Task
    cases : tuple of Case
        No two alike.
    """

    path: Path
    task: Task
    cases: tuple[Case, ...]

    @property
    def folder(self) -> Path:
        """Where the study file lies."""
        return self.path.parent

    def shard(self, number: int, of: int) -> tuple[Case, ...]:
        """The cases of one of several shares, 1 to `of`."""
        return self.cases[number - 1 :: of]

    def files(self) -> tuple[Path, ...]:
        """Files that the cases name."""
        named = dict.fromkeys(
            self.folder / value
            for case in self.cases
            for value in case.values.values()
            if isinstance(value, str)
        )
        return tuple(path for path in named if path.is_file())


def read_study(path: str | Path) -> Study:
    """Read a study file.

    Raises
    ------
    InputError
        Anything wrong with it, with line, key and value; no such function; a case twice.

    Examples
    --------
    >>> from pathlib import Path
    >>> import vmach
    >>> law = "def twice(case, random): return {'y': 2 * case.values['x']}"
    >>> _ = Path("twice.py").write_text(law)
    >>> text = 'schema = 1\\nseed = 1\\nfunction = "twice:twice"\\n[cases]\\nx = [1, 2, 3]'
    >>> _ = Path("study.toml").write_text(text)
    >>> study = vmach.read_study("study.toml")
    >>> len(study.cases)
    3
    """
    path = Path(path)
    data = read_toml(path, _StudySchema, what="study file")
    text = read_text(path, what="study file")

    def fail(keys: list[str], what: str, accepted: str, hint: str | None = None) -> InputError:
        line = line_of_key(text, keys)
        return InputError(what, file=path, line=line, accepted=accepted, hint=hint)

    task = Task(data.function, path.parent.resolve())
    try:
        check = task.check()
    except InputError as error:
        raise fail(["function"], error.what, error.accepted or "", error.hint) from None
    lists = {k: v if isinstance(v, list) else [v] for k, v in data.cases.items()}
    for name, values in lists.items():
        if not values:
            raise fail(["cases", name], f"cases.{name} is empty", "one value or more")
    if data.draws and "draw" in lists:
        raise fail(["draws"], "draws, and cases.draw", "one of them")
    rows = list(_table(path.parent / data.table)) if data.table else [{}]
    count = len(rows) * math.prod(map(len, lists.values())) * (data.draws or 1)
    if count > _MOST_CASES:
        raise fail(["draws" if data.draws else "cases"], f"{count} cases", f"{_MOST_CASES} at most")
    if data.draws:
        lists["draw"] = list(range(1, data.draws + 1))
    cases = tuple(_product(rows, lists, path.parent.resolve(), data.seed))
    _check_once(cases, path)
    if check is not None:
        check(_values(cases), path.parent, lambda name, what, accepted: fail(
            ["cases", name] if name in lists or not data.table else ["table"], what, accepted
        ))  # fmt: skip
    return Study(path, task, cases)


def _values(cases: Sequence[Case]) -> dict[str, list[Value]]:
    """Every value that a name has in any case."""
    names = dict.fromkeys(name for case in cases for name in case.values)
    return {
        name: list(dict.fromkeys(case.values[name] for case in cases if name in case.values))
        for name in names
    }


def _product(
    rows: Sequence[dict[str, Value]], lists: dict[str, list], folder: Path, seed: int
) -> Iterator[Case]:
    """Every row of the table with every combination of the lists, the last list fastest."""
    for row in rows:
        for chosen in itertools.product(*lists.values()):
            yield Case(row | dict(zip(lists, chosen, strict=True)), folder, seed)


def _check_once(cases: Sequence[Case], path: Path) -> None:
    count = Counter(case.key for case in cases)
    twice = next((case for case in cases if count[case.key] > 1), None)
    if twice is not None:
        raise InputError(
            f"case {twice} occurs {count[twice.key]} times",
            file=path,
            accepted="every case once",
            hint="a column 'draw' or 'repeat' with a number tells them apart",
        )


def _table(path: Path) -> Iterator[dict[str, Value]]:
    """Rows of a CSV table, numbers as numbers."""
    rows = csv_rows(read_text(path, what="table of cases").splitlines(), path)
    header = [cell.strip() for cell in next(rows, [])]
    if not all(header) or len(set(header)) < len(header) or not header:
        raise InputError(
            f"header '{','.join(header)}'", file=path, line=1, accepted="a name for each column"
        )
    is_empty = True
    for line, row in enumerate(rows, 2):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            raise InputError(
                f"{len(row)} cells", file=path, line=line, accepted=f"{len(header)} cells"
            )
        is_empty = False
        yield dict(zip(header, map(_value, row), strict=True))
    if is_empty:
        raise InputError("the table has no rows", file=path, accepted="a row for each case")


def _value(cell: str) -> Value:
    text = cell.strip()
    for kind in (int, float):
        try:
            number = kind(text)
        except ValueError:
            continue
        return number if math.isfinite(number) else text
    return text
