"""Results appear whole or not at all, and never in the place of a file that vmach did not write."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from vmach.errors import InputError
from vmach.files.together import put_in_place
from vmach.files.workplace import exchange, nearest_existing, workplace
from vmach.files.written_files import (
    FILES_LIST,
    RESULTS_LIST,
    files_in,
    is_written,
    note_file,
    write_results_list,
)

__all__ = [
    "NameTakenError",
    "atomic_file",
    "atomic_folder",
    "check_folder",
    "check_outputs",
    "edited_file",
    "write_under_free_name",
]

#: folders that `atomic_folder` has given out: nothing in them is anybody's yet
_being_filled: set[Path] = set()


class NameTakenError(InputError):
    """Something has the name of a file that was to be new; it stays as it is."""

    def __init__(self, path: Path) -> None:
        hint = "another command may have written it just now; start this one again"
        super().__init__("is there already", file=path, accepted="a name of its own", hint=hint)


def check_outputs(outputs: Iterable[Path | None], *, inputs: Iterable[Path] = ()) -> None:
    """Refuse files that could not be written, or would replace what is not vmach's.

    Asked before the work begins, so that nobody waits for a result that has no place to go.

    Parameters
    ----------
    outputs : iterable of Path or None
        Files to write; None for one that was not asked for.
    inputs : iterable of Path
        Files that the work reads.

    Raises
    ------
    InputError
        A file that is named like an option, or is an input. One that another result has too, or
        that has no folder to lie in. One that is there and is not, to the bit, what vmach wrote.
    """
    _check_outputs(filter(None, outputs), inputs)


def check_folder(out_dir: Path, names: Iterable[str], *, inputs: Iterable[Path] = ()) -> None:
    """Refuse a folder that `atomic_folder` could not fill with files of these names.

    Asked before the work begins.

    Parameters
    ----------
    out_dir : Path
    names : iterable of str
        Files and folders that will be made in it. All that lies in such a folder counts.
    inputs : iterable of Path
        Files that the work reads.

    Raises
    ------
    InputError
    """
    _check_name(out_dir)
    out_dir = _resolved(out_dir)
    _check_writable_folder(nearest_existing(out_dir))
    with workplace(out_dir):
        pass
    if out_dir.exists():
        _check_outputs(_there(out_dir, names), inputs, results=out_dir)
    _check_can_be_exchanged(out_dir)


def _there(out_dir: Path, names: Iterable[str]) -> Iterator[Path]:
    """Files with these names, or in folders of these names."""
    for path in (out_dir / name for name in names):
        yield from files_in(path) if path.is_dir() else [path]


def _check_outputs(
    outputs: Iterable[Path], inputs: Iterable[Path], *, results: Path | None = None
) -> None:
    taken = {_resolved(path) for path in inputs}
    written: set[Path] = set()
    for path in outputs:
        _check_name(path)
        target = _resolved(path)
        if target in taken:
            what, accepted = "is read by this command", "another name for the result"
            raise InputError(what, file=path, accepted=accepted)
        if target in written:
            raise InputError("two results have this name", file=path, accepted="a name for each")
        _check_file(target, results=results)
        written.add(target)


def _check_name(path: Path) -> None:
    """Refuse what is an option that stands where a name was meant."""
    if str(path).startswith("-"):
        raise InputError(
            f"{str(path)!r} stands where the name of a result was expected",
            accepted="a name that does not begin with -",
            hint="a whole path may have any name",
        )


@contextmanager
def atomic_folder(out_dir: str | Path, *, replaced: Collection[str] = ()) -> Iterator[Path]:
    """Give a temporary folder that takes the place of `out_dir` when the block ends well.

    The old folder and the new one change places in one step: a kill at any moment leaves one of
    them, whole. Whatever ends the block early (an error, Ctrl-C) leaves `out_dir` as it was.
    Files of other names that `out_dir` holds, results or a user's, are in the new folder too.

    Parameters
    ----------
    out_dir : path
        Folder for the results; made, with its parents, if it does not exist.
    replaced : collection of str
        Names of all results of this kind of work. One that an earlier run left and this run does
        not make is not kept: beside the new ones it would be taken for one of them.

    Yields
    ------
    pathlib.Path
        Empty folder to write into.

    Raises
    ------
    InputError
        `out_dir` is a file, cannot be written to, is not a folder for results, or holds a file
        that a result would replace and that vmach did not write.
    """
    out_dir = _resolved(Path(out_dir))
    _check_can_be_exchanged(out_dir)
    with ExitStack() as stack:
        room = stack.enter_context(workplace(out_dir))
        content = room / "content"
        stack.enter_context(_faults_named(content, out_dir))
        content.mkdir()
        _being_filled.add(content)
        try:
            yield content
        finally:
            _being_filled.discard(content)
        put_in_place(_Folder(content, out_dir, room, frozenset(replaced)), stack)


@dataclass(frozen=True)
class _Folder:
    """A folder of results that is ready; `replaced` are names that are not kept."""

    content: Path
    place: Path
    room: Path
    replaced: frozenset[str]
    is_folder: ClassVar[bool] = True

    def prepare(self, coming: Collection[Path]) -> None:
        written = list(files_in(self.content))
        if not self.place.exists():
            write_results_list(self.content, written, earlier=None)
            self.place.parent.mkdir(parents=True, exist_ok=True)
            return
        places = [self.place / path.relative_to(self.content) for path in written]
        _check_outputs(places, [], results=self.place)
        self._bring_along(self.place, self.content)
        write_results_list(self.content, written, earlier=self.place)
        shutil.copymode(self.place, self.content)

    def put(self) -> None:
        if not self.place.exists():
            os.rename(self.content, self.place)
            return
        exchange(self.content, self.place, room=self.room)

    def finish(self) -> None:
        if self.content.exists():  # the old folder, with what was put there in the meantime
            self._bring_along(self.content, self.place)

    def set_aside(self) -> None:
        """The old folder stays until it is exchanged: it is never away."""

    def put_back(self) -> None:
        """There is nothing to undo."""

    def _bring_along(self, source: Path, target: Path) -> None:
        """Link the files of a folder into another one that lacks them."""
        for path in files_in(source):
            is_old = str(path.relative_to(source)) in self.replaced
            if not (is_old and is_written(path, results=source)):
                _link(path, target / path.relative_to(source))
        if (source / FILES_LIST).exists() and not (target / FILES_LIST).exists():
            shutil.copy2(source / FILES_LIST, target / FILES_LIST)


def _link(path: Path, copy: Path) -> None:
    """Let a file lie in another place too, unless something is there."""
    if os.path.lexists(copy):
        return
    copy.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.link(path, copy, follow_symlinks=False)
    except OSError:  # a file system without links
        shutil.copy2(path, copy, follow_symlinks=False)


@contextmanager
def atomic_file(path: str | Path, *, is_new: bool = False) -> Iterator[Path]:
    """Give a temporary path of the same name; rename it to `path` when the block ends well.

    Parameters
    ----------
    path : path
    is_new : bool
        Nothing may have this name. Of two commands that choose one name at once, one gets it.

    Raises
    ------
    InputError
        The folder of `path` is missing or cannot be written to; `path` is a folder or a device,
        or a file that vmach did not write.
    NameTakenError
        Something has the name of a new file, also where it came while the block ran.
    """
    path = _resolved(Path(path))  # a link stays, the file that it points to is replaced
    is_own_place = any(folder in _being_filled for folder in path.parents)
    if is_new:
        _check_new_file(path)
    elif not is_own_place:
        _check_file(path)
    with ExitStack() as stack:
        room = stack.enter_context(workplace(path))
        stack.enter_context(_faults_named(room / path.name, path))
        temporary = room / path.name
        yield temporary
        if is_own_place:
            os.replace(temporary, path)
        else:
            put_in_place((_NewFile if is_new else _File)(temporary, path), stack)


def write_under_free_name(choose: Callable[[], Path], content: bytes) -> Path:
    """Write a file under a name that nothing has.

    Parameters
    ----------
    choose : callable
        Gives a name that is free now; asked again where another command was faster.
    content : bytes

    Raises
    ------
    InputError
        As `atomic_file` does.
    """
    while True:
        path = choose()
        with contextlib.suppress(NameTakenError):
            with atomic_file(path, is_new=True) as temporary:
                temporary.write_bytes(content)
            return path


@dataclass(frozen=True)
class _File:
    """A single result that is ready."""

    content: Path
    place: Path
    is_folder: ClassVar[bool] = False

    def prepare(self, coming: Collection[Path]) -> None:
        note_file(self.place, self.content, coming=coming)

    def set_aside(self) -> None:
        if self.place.exists():
            os.replace(self.place, self.content.with_name("old"))

    def put(self) -> None:
        os.replace(self.content, self.place)

    def put_back(self) -> None:
        if self.content.with_name("old").exists():
            os.replace(self.content.with_name("old"), self.place)

    def finish(self) -> None:
        """All is done."""


@dataclass(frozen=True)
class _NewFile(_File):
    """A file in a place that nothing has; it takes nobody's."""

    def prepare(self, coming: Collection[Path]) -> None:
        if os.path.lexists(self.place):
            raise NameTakenError(self.place)
        super().prepare(coming)

    def set_aside(self) -> None:
        """Take the place already: there is nothing in it that would have to go."""
        self._take()

    def put(self) -> None:
        if not self._has_place():
            self._take()

    def put_back(self) -> None:
        if self._has_place():
            self.place.unlink(missing_ok=True)

    def _has_place(self) -> bool:
        if not self.content.exists():
            return True
        return self.place.exists() and os.path.samefile(self.content, self.place)

    def _take(self) -> None:
        """Let the file appear whole, in one step that fails where something has the name."""
        try:
            os.link(self.content, self.place)
        except FileExistsError:
            raise NameTakenError(self.place) from None
        except OSError:  # a file system without links: an empty file takes the name first
            self._take_without_links()

    def _take_without_links(self) -> None:
        try:
            os.close(os.open(self.place, os.O_CREAT | os.O_EXCL | os.O_WRONLY))
        except FileExistsError:
            raise NameTakenError(self.place) from None
        os.replace(self.content, self.place)


@contextmanager
def edited_file(path: Path) -> Iterator[Path]:
    """Give a temporary path for a user's own file that a command was told to edit.

    The file stays the user's: no command takes it for a result later. What it held before is kept
    beside it, as ``NAME.bak``, or ``NAME.2.bak`` and so on where that is there already.

    Raises
    ------
    InputError
        There is no such file, or it cannot be written to. Another command edits it at once.
    """
    path = _resolved(path)
    if not path.is_file():
        raise InputError("is no file that could be edited", file=path)
    _check_writable_folder(path.parent)
    with atomic_file(_free_backup(path), is_new=True) as before:
        shutil.copyfile(path, before)
    with ExitStack() as stack:
        room = stack.enter_context(workplace(path))
        stack.enter_context(_faults_named(room / path.name, path))
        temporary = room / path.name
        yield temporary
        shutil.copymode(path, temporary)
        put_in_place(_Edited(temporary, path), stack)


def _free_backup(path: Path) -> Path:
    """A name beside a file that nothing has: earlier states stay."""
    name, number = path.with_name(f"{path.name}.bak"), 1
    while os.path.lexists(name):
        number += 1
        name = path.with_name(f"{path.name}.{number}.bak")
    return name


@dataclass(frozen=True)
class _Edited(_File):
    """A user's own file with its new text; it is noted nowhere."""

    def prepare(self, coming: Collection[Path]) -> None:
        """Nothing takes time."""


@contextmanager
def _faults_named(temporary: Path, place: Path) -> Iterator[None]:
    """Let a complaint of the system, as of a full disk, name the file that it is about."""
    try:
        yield
    except OSError as error:
        file = Path(os.fsdecode(error.filename)) if error.filename else temporary
        if not file.is_relative_to(temporary):
            raise
        error.filename = str(place / file.relative_to(temporary))
        error.filename2 = None
        raise


def _resolved(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _check_new_file(path: Path) -> None:
    _check_writable_folder(path.parent)
    if os.path.lexists(path):
        raise NameTakenError(path)


def _check_file(path: Path, *, results: Path | None = None) -> None:
    _check_writable_folder(path.parent)
    if os.path.islink(path):  # what is left of one that leads to itself
        raise InputError("is a loop of links", file=path, accepted="the name of a file")
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):  # or another run has just set it aside
        return
    if not stat.S_ISREG(mode):
        what = "is a folder" if stat.S_ISDIR(mode) else "is a device, not a file"
        raise InputError(what, file=path, accepted="the name of a file for the result")
    if not is_written(path, results=results):
        raise InputError(
            "is there already, and vmach did not write it, or it was changed since",
            file=path,
            accepted="another name for the result",
            hint="remove the file if you do not need it",
        )


def _check_can_be_exchanged(out_dir: Path) -> None:
    """Refuse folders that are more than a place for results."""
    _check_writable_folder(nearest_existing(out_dir))
    if not out_dir.exists():
        return
    with contextlib.suppress(FileNotFoundError):  # the current folder may be gone
        if Path.cwd().is_relative_to(out_dir):
            raise InputError(
                "is the current folder, or holds it",
                file=out_dir,
                accepted="a folder of its own for the results",
            )
    if os.path.ismount(out_dir):
        raise InputError(
            "is where a file system is mounted", file=out_dir, accepted="a folder in it"
        )
    if (out_dir / RESULTS_LIST).exists():
        return
    for path in files_in(out_dir):
        if not is_written(path):
            raise InputError(
                f"holds '{path.relative_to(out_dir)}', which vmach did not write",
                file=out_dir,
                accepted="a new or an empty folder, or one with results of vmach",
            )


def _check_writable_folder(folder: Path) -> None:
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "does not exist"
        raise InputError(what, file=folder, accepted="a folder for the results")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot be written to", file=folder, hint="choose another folder")
