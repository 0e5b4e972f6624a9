"""What only the user knows of a file: given as options, asked on a terminal, or refused."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from vmach.errors import InputError
from vmach.files.text_file import decimal_number
from vmach.job import Job, read_job

__all__ = ["Questions"]

_LARGEST = 1e6  #: of a number in an answer: what files of the project take


class _Columns(dict[str, str]):
    """Headings by the names of columns; what was asked for is remembered."""

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)


@dataclass
class Questions:
    """Answers, and whom to ask for those that are missing.

    Attributes
    ----------
    given : mapping of str to str
        By the key of the question.
    ask : callable or None
        Asks a person: question and what is taken where nothing is typed; None without a terminal.
    columns : mapping of str to str
        Which column of the file holds what, where its name does not say.
    job_file : Path or None
        Of the job whose nominal CAD points are laid on.
    machine_file : Path or None
        The machine file that the tables are for.
    used : set of str
        Keys that were asked for.
    assumed : dict of str to str
        What was taken because neither the file nor the user says it.
    """

    given: Mapping[str, str] = field(default_factory=dict)
    ask: Callable[[str, str], str] | None = None
    columns: Mapping[str, str] = field(default_factory=dict)
    job_file: Path | None = None
    machine_file: Path | None = None
    used: set[str] = field(default_factory=set)
    assumed: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.columns, _Columns):
            self.columns = _Columns(self.columns)

    def check_columns(self) -> None:
        """Refuse a heading of a column that no table has.

        Raises
        ------
        InputError
        """
        assert isinstance(self.columns, _Columns)
        asked = self.columns.asked
        for name, heading in self.columns.items():
            if name not in asked:
                known = ", ".join(sorted(asked)) or "none: these files need no --column"
                what = f"--column {name}={heading}: no file has a column of this name"
                raise InputError(what, accepted=known)

    @cached_property
    def job(self) -> Job | None:
        """The job, read when it is first asked for."""
        return None if self.job_file is None else read_job(self.job_file)

    def text(
        self,
        key: str,
        question: str,
        *,
        accepted: str,
        default: str | None = None,
        said: str | None = None,
    ) -> str:
        """An answer in words.

        Parameters
        ----------
        key, question, accepted : str
        default : str, optional
            What is assumed where nobody can be asked.
        said : str, optional
            What the file itself says: no assumption.

        Raises
        ------
        InputError
            It is not given, and nobody can be asked.
        """
        self.used.add(key)
        if key in self.given:
            return self.given[key].strip()
        if self.ask is not None:
            return self.ask(f"{question} ({accepted})", said or default or "").strip()
        if said is not None:
            return said
        if default is None:
            raise InputError(
                f"the file does not say: {question}", accepted=accepted, hint=f"--set {key}=..."
            )
        self.assumed[key] = default
        return default

    @classmethod
    def none_open(cls) -> Questions:
        """For a look at a file: a unit that its headings do not name is a question for later."""
        return cls({"unit": "um"})

    def unit(self) -> str:
        """What ``unit`` is given as, for headings that name none; empty without it."""
        self.used.add("unit")
        return self.given.get("unit", "")

    def told(self, key: str, choices: Sequence[str]) -> str:
        """One of some words where it is given, else the first: nobody is asked.

        Raises
        ------
        InputError
            Another word.
        """
        self.used.add(key)
        if key not in self.given:
            self.assumed[key] = choices[0]
        return _one_of(key, self.given.get(key, choices[0]), choices)

    def choice(
        self,
        key: str,
        question: str,
        choices: Sequence[str],
        *,
        default: str | None = None,
        said: str | None = None,
    ) -> str:
        """One of some words; `default` and `said` as in `text`.

        Raises
        ------
        InputError
            Another word.
        """
        accepted = ", ".join(choices)
        word = self.text(key, question, accepted=accepted, default=default, said=said)
        return _one_of(key, word, choices)

    def number(self, key: str, question: str, *, unit: str, default: float | None = None) -> float:
        """A number.

        Raises
        ------
        InputError
            It is none.
        """
        fallback = None if default is None else f"{default:g}"
        return self._numbers(key, question, 1, f"a number in {unit}", fallback)[0]

    def point(
        self, key: str, question: str, *, default: Sequence[float] | None = None
    ) -> list[float]:
        """Three coordinates.

        Raises
        ------
        InputError
            They are no numbers, or another count of them.
        """
        fallback = None if default is None else " ".join(f"{v:g}" for v in default)
        return self._numbers(key, question, 3, "three numbers in mm: '-300 -200 -250'", fallback)

    def _numbers(
        self, key: str, question: str, count: int, accepted: str, default: str | None
    ) -> list[float]:
        text = self.text(key, question, accepted=accepted, default=default)
        values = [decimal_number(word) for word in text.replace(",", " ").split()]
        if len(values) != count or not all(abs(value) <= _LARGEST for value in values):
            raise InputError(f"{key} = '{text}'", accepted=accepted)
        return values

    def taken(self, keys: Iterable[str]) -> str:
        """What was assumed of some keys, as ``counts=up, zero=0``; empty for none."""
        return ", ".join(f"{key}={self.assumed[key]}" for key in keys if key in self.assumed)

    def unused(self) -> list[str]:
        """Keys that were given and that nothing asked for."""
        return [key for key in self.given if key not in self.used]


def _one_of(key: str, word: str, choices: Sequence[str]) -> str:
    if word not in choices:
        raise InputError(f"{key} = '{word}'", accepted=", ".join(choices))
    return word
