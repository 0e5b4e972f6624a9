"""The text of a job that goes on from another: its paths, and what it notes of the job before."""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

import tomlkit

from vmach.files.toml_text import quoted_path
from vmach.history.job_text import checked_job, parsed_job
from vmach.job import Job
from vmach.job.path_keys import change_paths

__all__ = ["history_toml", "moved_path", "moved_text"]


def moved_text(text: str, old: Path, new: Path, *, file: Path) -> str:
    """The job's text with its relative paths seen from another folder.

    Raises
    ------
    InputError
        The text of `file` is written in a way that cannot be changed.
    """
    if old.resolve() == new.resolve():
        return text

    def move(name: str) -> str:
        return moved_path(name, old, new)

    document, wanted = parsed_job(text, file), tomllib.loads(text)
    change_paths(document, move)
    change_paths(wanted, move)
    return checked_job(tomlkit.dumps(document), wanted, file=file)


def moved_path(name: str, old: Path, new: Path) -> str:
    """A path that a file in one folder names, as one in another folder names it."""
    if Path(name).is_absolute():
        return Path(name).as_posix()
    return _seen_from(old / name, new)


def history_toml(
    old: Job,
    folder: Path,
    added: Sequence[str],
    *,
    figures: Mapping[str, float] | None = None,
    effect_files: Mapping[str, Path] | None = None,
) -> str:
    """The table ``[[history]]`` of a job in a folder that goes on from `old`.

    Parameters
    ----------
    old : Job
    folder : Path
    added : sequence of str
        What the job has and the one before had not, for people.
    figures : mapping of str to float, optional
        ``rms_before_um``, ``rms_after_um``.
    effect_files : mapping of str to Path, optional
        Files of effects of the user's own, beside those that `old` names.
    """
    last = old.history[-1] if old.history else {}
    files = {n: moved_path(f, old.folder, folder) for n, f in last.get("effect_files", {}).items()}
    files |= {name: _seen_from(file, folder) for name, file in (effect_files or {}).items()}
    own = ", ".join(f"{name} = {quoted_path(Path(file))}" for name, file in files.items())
    return (
        "\n[[history]]\n"
        f"previous = {quoted_path(Path(_seen_from(old.path, folder)))}\n"
        f"added = {json.dumps(list(added), ensure_ascii=False)}\n"
        + "".join(f"{name} = {value:.4g}\n" for name, value in (figures or {}).items())
        + (f"effect_files = {{{own}}}\n" if own else "")
    )


def _seen_from(path: Path, folder: Path) -> str:
    return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
