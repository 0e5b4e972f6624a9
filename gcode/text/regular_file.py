"""Content of a program's file, never of a device or a pipe, which may not end."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from gcode.errors import ProgramError

__all__ = ["read_regular_file"]

#: ten times the largest programs of finishing with short blocks
_LARGEST_BYTES = 2**30


def read_regular_file(path: str | Path) -> bytes:
    """Content of a file.

    Raises
    ------
    ProgramError
        It is no regular file, or above 1 GiB.
    """
    found = os.stat(path)
    if not stat.S_ISREG(found.st_mode):
        raise ProgramError("not a file", file=path, accepted="a file, no folder, device or pipe")
    with open(path, "rb") as file:
        content = file.read(_LARGEST_BYTES + 1)
    if len(content) > _LARGEST_BYTES:
        size = max(len(content), found.st_size) / 2**30
        raise ProgramError(f"the file has {size:.3g} GiB", file=path, accepted="at most 1 GiB")
    return content
