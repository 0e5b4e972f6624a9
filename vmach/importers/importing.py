"""Import of files: which kind each is, what comes of it, and where it is written."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from vmach.errors import InputError
from vmach.files.atomic import atomic_file, check_outputs, edited_file
from vmach.files.text_file import as_written, read_text
from vmach.files.together import together
from vmach.files.toml_file import complaints
from vmach.importers.catalogue import catalogue
from vmach.importers.importer import Imported, Importer, Section
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.importers.toml_text import text_with
from vmach.job.schema import JobSchema
from vmach.machine.files.machine_schema import MachineSchema

__all__ = [
    "Target",
    "import_files",
    "is_machine",
    "kind_of",
    "lines_to_paste",
    "write_imported",
]


@dataclass(frozen=True)
class Target:
    """Where the outputs go.

    Attributes
    ----------
    folder : Path
        For tables, readings and points.
    into : tuple of Path
        Machine and job files that are to have the new sections; none to print them only.
    """

    folder: Path
    into: tuple[Path, ...] = ()


def kind_of(source: SourceFile, wanted: str | None) -> Importer:
    """The importer for a file, as told or as the file looks.

    Raises
    ------
    InputError
        No such kind, or a file that none of them knows.
    """
    known = catalogue()
    if wanted is not None:
        if wanted not in known:
            raise InputError(f"--kind {wanted}", accepted=", ".join(known))
        return known[wanted]
    if not source.path.exists():
        raise InputError("file to import not found", file=source.path)
    for importer in known.values():
        if _is_of(importer, source):
            return importer
    raise source.error(
        "no importer knows this file",
        accepted=", ".join(known),
        hint="--kind NAME says what it is; 'vmach import --list' says what each kind reads",
    )


def _is_of(importer: Importer, source: SourceFile) -> bool:
    """Whether a file is of a kind; one with a fault is, and reading it with all answers says so."""
    try:
        return importer.recognises(source)
    except InputError:
        return True


def import_files(
    paths: Sequence[Path], questions: Questions, *, kind: str | None = None
) -> list[Imported]:
    """What some files hold; nothing is written.

    Parameters
    ----------
    paths : sequence of Path
        Files, or folders of a control's tables.
    questions : Questions
    kind : str, optional
        Of all of them; else as each looks.

    Raises
    ------
    InputError
        A file that cannot be read, an answer that is missing, or one that nothing asked for.
    """
    found = []
    for path in paths:
        source = SourceFile(path)
        importer = kind_of(source, kind)
        questions.assumed.clear()
        try:
            found.append(_with_assumptions(importer.read(source, questions), questions))
        except InputError as error:
            if error.file is not None:
                raise
            raise source.error(error.what, accepted=error.accepted or "", hint=error.hint) from None
    questions.check_columns()
    unused = questions.unused()
    if unused:
        keys = ", ".join(dict.fromkeys(k for one in catalogue().values() for k in one.keys))
        raise InputError(f"--set {unused[0]}: no file asks for it", accepted=keys)
    return found


def _with_assumptions(one: Imported, questions: Questions) -> Imported:
    """What came of a file, with a line on the answers that nobody gave."""
    taken = questions.taken(questions.assumed)
    if not taken:
        return one
    said = f"assumed, as nobody has said it: {taken} (--set KEY=VALUE says otherwise)"
    return replace(one, told=(*one.told, said))


def write_imported(imported: Sequence[Imported], target: Target) -> list[Path]:
    """Write files and sections, all of them or none; returns what was written.

    Raises
    ------
    InputError
        A result that would replace a file of the user, two of one name, a section that is there
        already, or one that makes the machine or the job file wrong.
    """
    files = [(target.folder / name, text) for one in imported for name, text in one.files.items()]
    texts = _edited(imported, target)
    for path, _ in files:
        path.parent.mkdir(parents=True, exist_ok=True)
    check_outputs([path for path, _ in files], inputs=target.into)
    with together():
        for path, text in files:
            with atomic_file(path) as temporary:
                temporary.write_text(text, encoding="utf-8")
        for path, text in texts.items():
            with edited_file(path) as temporary:
                temporary.write_bytes(as_written(text, path))
    return [*(path for path, _ in files), *texts]


def _edited(imported: Sequence[Imported], target: Target) -> dict[Path, str]:
    """The machine and job files with their new sections."""
    sections = [section for one in imported for section in one.sections]
    texts = {}
    for path in target.into:
        before = read_text(path, what="file to edit")
        kind = "machine" if is_machine(path) else "job"
        schema = MachineSchema if kind == "machine" else JobSchema
        own = [_seen_from(path.parent, s, target.folder) for s in sections if s.file == kind]
        if not own:
            _check_is_edited(path, before)
            continue
        faults = sorted(map(str, complaints(path, schema, what=f"{kind} file")))
        if faults:
            raise InputError(f"has faults, the first: {faults[0]}", file=path, hint="mend it first")
        texts[path] = text_with(before, own, file=path)
    return texts


def _check_is_edited(path: Path, text: str) -> None:
    """Refuse what is neither a machine nor a job file, though nothing goes into it.

    Raises
    ------
    InputError
    """
    try:
        data = tomllib.loads(text)
    except ValueError:
        data = {}
    if path.suffix.lower() != ".toml" and not data.keys() & {"chain", "program"}:
        raise InputError(
            "--into: is neither a machine nor a job file",
            file=path,
            accepted="machine.toml, job.toml or a folder with them",
        )


def is_machine(path: Path) -> bool:
    """Whether a TOML file is a machine file, and no job."""
    text = read_text(path, what="file to edit")
    return any(line.replace(" ", "").startswith("chain=") for line in text.splitlines())


def lines_to_paste(
    imported: Sequence[Imported], target: Target, known: Mapping[str, Path | None]
) -> dict[Path, list[Section]]:
    """Sections that were written nowhere, by the file that needs them.

    Parameters
    ----------
    imported : sequence of Imported
    target : Target
    known : mapping of str to Path or None
        The machine file ("machine") and the job ("job"), where they are known; the lines name
        files as seen from there. Else as ``machine.toml`` and ``job.toml`` in the current folder.
    """
    found: dict[Path, list[Section]] = {}
    written = {"machine" if is_machine(path) else "job" for path in target.into}
    for section in (section for one in imported for section in one.sections):
        if section.file not in written:
            file = known.get(section.file) or Path(f"{section.file}.toml")
            found.setdefault(file, []).append(_seen_from(file.parent, section, target.folder))
    return found


def _seen_from(place: Path, section: Section, folder: Path) -> Section:
    """The section with its files, which lie in `folder`, seen from the file that names them."""
    here = place.resolve()
    values = dict(section.values)
    for key in ("table", "file", "measured"):
        if key in values:
            path = (folder / str(values[key])).resolve()
            inside = path.is_relative_to(here)
            values[key] = (path.relative_to(here) if inside else path).as_posix()
    return replace(section, values=values)
