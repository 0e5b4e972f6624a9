"""``vmach import``: files of instruments and controls made the project's own."""

from __future__ import annotations

import json
import re
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vmach.commands.options import AsJson, typed
from vmach.errors import InputError

if TYPE_CHECKING:
    from vmach.importers import Imported, Questions, Section

__all__ = ["import_files"]

_SQUARENESS = re.compile(r"\s*([XYZ]{2})\s+([0-9.,]+)\s*(um/m|urad|arcsec|deg)?\s+(more|less)\s*")


def import_files(
    files: Annotated[
        list[Path] | None, typer.Argument(metavar="[FILE]...", help="files, or a folder of tables")
    ] = None,
    kind: Annotated[str | None, typer.Option(help="what the files are; else as they look")] = None,
    error: Annotated[
        str | None, typer.Option(help="which error a laser file holds: EXX, EYX, EBX ...")
    ] = None,
    squareness: Annotated[
        list[str] | None,
        typer.Option(
            help="from a report: 'XY 34.1 um/m more': the + axes enclose more than 90 degrees"
        ),
    ] = None,
    square: Annotated[
        list[str] | None,
        typer.Option(help="calliper lengths AC, BD, AD of a square, mm: 'XY 424.18 424.35 300'"),
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option(metavar="NAME=HEADING", help="which column holds what")
    ] = None,
    answer: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="what the file does not say; repeatable"),
    ] = None,
    job: Annotated[
        Path | None, typer.Option(help="job whose nominal CAD points are laid on")
    ] = None,
    into: Annotated[
        list[Path] | None,
        typer.Option(help="machine.toml, job.toml or their folder, to write the lines into"),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="folder for tables and readings")
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="ask nothing, take defaults")] = False,
    as_json: AsJson = False,
    show_kinds: Annotated[bool, typer.Option("--list", help="say what each kind reads")] = False,
) -> None:
    """Read files of instruments and controls, and write the project's own."""
    from vmach.importers.importing import Target, import_files, lines_to_paste, write_imported

    if show_kinds:
        _list_kinds()
        return
    if not files and not squareness and not square:
        raise InputError("nothing to import", accepted="FILE..., --squareness or --square")
    targets = _targets(into or [])
    given = _pairs(answer or [], "--set") | ({"error": error} if error else {})
    questions = _questions(given, _pairs(column or [], "--column"), targets, job, asks=not yes)
    found = [_squareness(text, questions) for text in squareness or []]
    found += [_square(text, questions) for text in square or []]
    found += import_files(files or [], questions, kind=kind)
    folder = out or (targets[0].parent if targets else Path())
    target = Target(folder, tuple(targets))
    written = write_imported(found, target)
    checks = _self_checks(found, written, targets)
    if as_json:
        print(json.dumps(_record(found, written, checks), indent=1))
    else:
        _tell(found, written, checks)
        for file, sections in sorted(lines_to_paste(found, target, _known(questions)).items()):
            _tell_lines(file, sections)


def _known(questions: Questions) -> dict[str, Path | None]:
    """The machine file and the job that the lines are for, as far as options tell them."""
    machine = questions.machine_file
    if machine is None:
        with suppress(InputError):  # not all kinds need the job, nor that it is whole
            machine = questions.job.machine_path if questions.job else None
    job = questions.job_file
    return {"machine": machine, "job": job / "job.toml" if job and job.is_dir() else job}


def _targets(into: list[Path]) -> list[Path]:
    found = []
    for path in into:
        inside = [path / "machine.toml", path / "job.toml"] if path.is_dir() else [path]
        missing = [one for one in inside if not one.is_file()]
        if len(missing) == len(inside):
            raise InputError("--into: no such file", file=missing[0],
                             accepted="machine.toml, job.toml or a folder with them")  # fmt: skip
        found += [one for one in inside if one.is_file()]
    return found


def _pairs(texts: list[str], option: str) -> dict[str, str]:
    found = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign or not key.strip() or not value.strip():
            raise InputError(f"{option} '{text}'", accepted=f"{option} NAME=VALUE")
        found[key.strip()] = value.strip()
    return found


def _questions(
    given: dict[str, str],
    columns: dict[str, str],
    targets: list[Path],
    job: Path | None,
    *,
    asks: bool,
) -> Questions:
    from vmach.importers import Questions
    from vmach.importers.importing import is_machine

    machines = [path for path in targets if is_machine(path)]
    jobs = [path for path in targets if not is_machine(path)]
    ask = (lambda text, default: typer.prompt(text, default=default or None, err=True)) if (
        asks and sys.stdin.isatty()) else None  # fmt: skip
    return Questions(
        given,
        ask,
        columns,
        job_file=job or (jobs[0] if jobs else None),
        machine_file=machines[0] if machines else None,
    )


def _squareness(text: str, questions: Questions) -> Imported:
    """``XY 34.1 um/m more`` as a line of [squareness]."""
    from vmach.base.units import urad_from_rad
    from vmach.importers import Questions as Asked
    from vmach.importers.squareness import squareness_sections
    from vmach.machine.tables.error_table import RAD_PER

    match = _SQUARENESS.fullmatch(text)
    number = match[2].replace(",", ".") if match else ""
    if match is None or number.count(".") > 1 or not number.strip("."):
        raise InputError(
            f"--squareness '{text}'",
            accepted="plane, size, unit (um/m, urad, arcsec, deg), more or less: "
            "'XY 34.1 um/m more'",
            hint="more: +X and +Y enclose more than 90 degrees",
        )
    size_urad = urad_from_rad(float(number) * RAD_PER[match[3] or "um/m"])
    told = Asked({"angle": match[4]}, machine_file=questions.machine_file)
    return squareness_sections(match[1], size_urad, told, what="--squareness")


def _square(text: str, questions: Questions) -> Imported:
    """``XY 424.18 424.35 300`` as a line of [squareness]."""
    from vmach.files.text_file import decimal_number
    from vmach.importers.squareness import NAMES, square_sections

    plane, *words = text.split() or [""]
    lengths = [decimal_number(word.replace(",", ".")) for word in words]
    good = len(lengths) == 3 and all(0.0 < length < 1e5 for length in lengths)
    if not good or plane not in {*NAMES, *(name[::-1] for name in NAMES)}:
        raise InputError(
            f"--square '{text}'",
            accepted="plane, diagonals AC and BD, side AD in mm: 'XY 424.18 424.35 300'",
            hint="A is the lowest corner, AC goes up along both axes, AD along the first",
        )
    return square_sections(plane, (lengths[0], lengths[1], lengths[2]), questions)


def _self_checks(found: list[Imported], written: list[Path], targets: list[Path]) -> list[str]:
    """What the readings would be on the job's machine, and which places it lacks, in words."""
    from vmach.importers.importing import is_machine
    from vmach.importers.self_check import check_readings, missing_places

    names = {Path(name).name for one in found for name in one.files}
    edited = [path for path in targets if path in written]
    jobs = [path for path in edited if not is_machine(path)]
    checks = [line for job in jobs for line in check_readings(job, names)]
    machines = [path for path in edited if is_machine(path)]
    return checks + [line for machine in machines for line in missing_places(machine)]


def _record(found: list[Imported], written: list[Path], checks: list[str]) -> dict[str, Any]:
    return {
        "imported": [
            {
                "told": list(one.told),
                "files": list(one.files),
                "sections": [
                    {"file": s.file, "table": s.table, "is_array": s.is_array,
                     "values": dict(s.values)}
                    for s in one.sections
                ],
            }
            for one in found
        ],
        "written": [str(path) for path in written],
        "self_checks": checks,
    }  # fmt: skip


def _tell(found: list[Imported], written: list[Path], checks: list[str]) -> None:
    for one in found:
        print(*one.told, sep="\n")
    for path in written:
        print(f"wrote {path}")
    for line in checks:
        print(line)


def _tell_lines(file: Path, sections: list[Section]) -> None:
    """What a file needs that was not told with ``--into``."""
    from vmach.importers.toml_text import section_text

    print(f"\nlines for {file} (or --into {typed(file)}):")
    print(*(section_text(section).rstrip("\n") for section in sections), sep="\n")


def _list_kinds() -> None:
    from vmach.importers import catalogue

    for name, importer in catalogue().items():
        print(f"{name}: {importer.title}")
        print(f"    reads {importer.reads}")
        for key, meaning in importer.keys.items():
            print(f"    --set {key}=...  {meaning}")
