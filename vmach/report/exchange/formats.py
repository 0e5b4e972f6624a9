"""Which format a file of results has, by its ending."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from vmach.errors import InputError
from vmach.features.result import FeatureResult, Value
from vmach.files.atomic import atomic_file
from vmach.report.result import RunRecord

__all__ = ["ENDINGS", "check_ending", "reported", "write_features_file"]

#: module and what it is, by ending
ENDINGS = {
    ".qif": ("qif", "QIF 3.0 results (ISO 23952)"),
    ".dmo": ("dmis", "DMIS output (ISO 22093)"),
    ".dfq": ("qdas", "Q-DAS ASCII transfer format"),
    ".csv": ("table", "CSV"),
    ".pdf": ("sheet", "a report to print and sign"),
}


def check_ending(path: Path) -> None:
    """Refuse a file whose ending is none of `ENDINGS`.

    Raises
    ------
    InputError
        Another ending.
    """
    if path.suffix.lower() not in ENDINGS:
        known = ", ".join(f"{ending} ({what})" for ending, (_, what) in ENDINGS.items())
        raise InputError(f"{path}: the ending {path.suffix!r}", accepted=known)


def write_features_file(path: Path, run: RunRecord, **more: Path | None) -> None:
    """Write the results of a drawing in the format of the file's ending.

    Parameters
    ----------
    path : Path
    run : RunRecord
    more : picture, logo
        Files for the printed report.

    Raises
    ------
    InputError
        Another ending, or a folder that cannot be written to.
    """
    check_ending(path)
    module = import_module(f"vmach.report.exchange.{ENDINGS[path.suffix.lower()][0]}")
    write: Callable[..., bytes] = module.content
    data = write(run, **more)
    with atomic_file(path) as temporary:
        temporary.write_bytes(data)


def reported(result: FeatureResult) -> Value | None:
    """The value that a file carries: measured where the part was measured, else predicted."""
    return result.measured or result.predicted
