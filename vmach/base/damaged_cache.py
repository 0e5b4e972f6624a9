"""Files that Python and numba keep for the next start, where one of them is cut short.

Both write them whole. A full disk, a copy or a crash may still leave a part.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Any

__all__ = ["drop_cut_kernels", "drop_damaged"]

#: what a pickle ends with
_STOP = b"."


def drop_cut_kernels(files: Iterable[Path]) -> None:
    """Delete those of some compiled kernels that do not end as they should."""
    for kept in files:
        with suppress(OSError), kept.open("rb") as file:
            size = file.seek(0, 2)
            file.seek(max(size - 1, 0))
            if file.read() != _STOP:
                kept.unlink(missing_ok=True)


def drop_damaged(error: BaseException) -> tuple[Path, ...]:
    """Delete the kept files that an error comes from; these are given back."""
    found = tuple(dict.fromkeys(_files_behind(error)))
    for file in found:
        with suppress(OSError):
            file.unlink(missing_ok=True)
    return found


def _files_behind(error: BaseException | None) -> Iterator[Path]:
    while error is not None:
        trace = error.__traceback__
        while trace is not None:
            yield from _file_of(trace.tb_frame)
            trace = trace.tb_next
        error = error.__cause__


def _file_of(frame: FrameType) -> Iterator[Path]:
    """What a frame was about to load: bytecode, or the kernels of a function."""
    place, name, said = frame.f_code.co_filename, frame.f_code.co_name, frame.f_locals
    if "importlib" in place and name == "_compile_bytecode" and said.get("bytecode_path"):
        yield Path(said["bytecode_path"])
    if Path(place).parts[-3:] == ("numba", "core", "caching.py") and "load" in name:
        yield from _kernels_of(said.get("self"))


def _kernels_of(cache: Any) -> Iterator[Path]:
    index = Path(getattr(cache, "_index_path", ""))
    if index.suffix == ".nbi":
        yield index
        yield from index.parent.glob(f"{index.stem}.*.nbc")
