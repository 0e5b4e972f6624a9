"""``vmach init``: a first job from a program, a nominal CAD and a few answers."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.errors import InputError
from vmach.files.text_file import check_is_file

__all__ = ["init"]

_DEFAULT_TRAVEL = "760 460 510"
#: endings of files that are looked for, in any case
_PROGRAMS = (".nc", ".ngc", ".h", ".mpf", ".cnc", ".tap", ".eia")
_PARTS = (".step", ".stp", ".stl")


def init(
    folder: Annotated[Path, typer.Argument(help="where the job is to be")] = Path("."),
    program: Annotated[
        Path | None, typer.Option(help="NC program; the only one of the folder")
    ] = None,
    nominal: Annotated[
        Path | None, typer.Option(help="STEP or STL of the part; the only one of the folder")
    ] = None,
    kinematics: Annotated[
        str | None, typer.Option(help="vmc, bridge, travelling-column, portal-table, router")
    ] = None,
    travel: Annotated[str | None, typer.Option(help="of X, Y and Z in mm: '760 460 510'")] = None,
    control: Annotated[str, typer.Option(help="control that the program is for")] = "auto",
    yes: Annotated[bool, typer.Option("--yes", "-y", help="ask nothing, take defaults")] = False,
) -> None:
    """Write job.toml and machine.toml from a program, a CAD file and a few answers."""
    from vmach.checkup import Weight, check_job
    from vmach.setup import KINEMATICS, Answers, new_job

    asks = sys.stdin.isatty() and not yes
    program = program or _only(folder, _PROGRAMS, "program")
    check_is_file(program, what="NC program")
    nominal = nominal or _only_or_none(folder, _PARTS)
    if kinematics is None and asks:
        for kind in KINEMATICS.values():
            print(f"\n{kind.name}: {kind.title}{kind.picture}")
    kinematics = kinematics or _answer("kinematics", "vmc", asks=asks)
    if kinematics not in KINEMATICS:
        raise InputError(f"--kinematics {kinematics}", accepted=", ".join(KINEMATICS))
    travel = travel or _answer("travel of X, Y and Z in mm", _DEFAULT_TRAVEL, asks=asks)
    answers = Answers(program, nominal, KINEMATICS[kinematics], _three(travel), control)
    for path in new_job(folder, answers):
        print(f"wrote {path}")
    found = check_job(folder)
    to_mend = [finding for finding in found if finding.weight is Weight.MEND]
    print(*to_mend, sep="\n", end="\n" if to_mend else "")
    print(f"next: mend the lines marked '# mend', then  vmach check {shlex.quote(str(folder))}")


def _answer(what: str, default: str, *, asks: bool) -> str:
    return typer.prompt(what, default=default) if asks else default


def _three(text: str) -> tuple[float, float, float]:
    try:
        values = tuple(float(word) for word in text.replace(",", " ").split())
    except ValueError:
        values = ()
    if len(values) != 3 or not all(0.0 < v < 1e5 for v in values):
        raise InputError(f"--travel '{text}'", accepted="three lengths in mm: '760 460 510'")
    return values


def _found(folder: Path, endings: tuple[str, ...]) -> list[Path]:
    return sorted(path for path in folder.glob("*") if path.suffix.lower() in endings)


def _only(folder: Path, endings: tuple[str, ...], what: str) -> Path:
    found = _found(folder, endings)
    if len(found) == 1:
        return found[0]
    names = ", ".join(path.name for path in found) or "none is there"
    raise InputError(f"which {what}? In {folder}: {names}", accepted=f"--{what} FILE")


def _only_or_none(folder: Path, endings: tuple[str, ...]) -> Path | None:
    found = _found(folder, endings)
    return found[0] if len(found) == 1 else None
