"""What an importer is: one class that knows one kind of file, and what it makes of it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["Imported", "Importer", "Section"]


@dataclass(frozen=True)
class Section:
    """Keys of one table of a machine file or a job file.

    Attributes
    ----------
    file : {"machine", "job"}
    table : str
        ``errors.EXX``; empty for keys above the first table.
    values : mapping
        Numbers, words, lists of them, true or false.
    is_array : bool
        One more ``[[table]]`` instead of the one ``[table]``.
    comment : str
        What stands behind the first key; empty for none.
    """

    file: Literal["machine", "job"]
    table: str
    values: Mapping[str, Any]
    is_array: bool = False
    comment: str = ""


@dataclass(frozen=True)
class Imported:
    """What came of one file.

    Attributes
    ----------
    files : mapping of str to str
        Text by the name of the file to write, relative to the folder of results.
    sections : tuple of Section
        What a machine file or a job file has to say of them.
    told : tuple of str
        Lines for the user: what was taken for what, and the self-check; nothing is decided by
        them.
    """

    files: Mapping[str, str] = field(default_factory=dict)
    sections: tuple[Section, ...] = ()
    told: tuple[str, ...] = ()

    @classmethod
    def joined(cls, parts: Iterable[Imported], told: tuple[str, ...] = ()) -> Imported:
        """What came of one file in parts, and more lines for the user."""
        found = list(parts)
        return cls(
            {name: text for one in found for name, text in one.files.items()},
            tuple(section for one in found for section in one.sections),
            (*(note for one in found for note in one.told), *told),
        )


class Importer:
    """A kind of file that comes from an instrument or a control.

    A subclass is one file: the class attributes below, `recognises` and `read`.
    """

    #: what the command line calls it
    name: ClassVar[str]
    #: heading, and what files it reads, in words
    title: ClassVar[str]
    reads: ClassVar[str]
    #: keys of ``--set`` that it asks for, each with what it means
    keys: ClassVar[Mapping[str, str]] = {}
    #: kinds with a smaller rank are tried first
    rank: ClassVar[int] = 50

    @abstractmethod
    def recognises(self, source: SourceFile) -> bool:
        """Whether a file looks like one of this kind."""
        raise NotImplementedError

    @abstractmethod
    def read(self, source: SourceFile, questions: Questions) -> Imported:
        """What the file holds.

        Raises
        ------
        InputError
            A file, line or answer that cannot be used.
        """
        raise NotImplementedError
