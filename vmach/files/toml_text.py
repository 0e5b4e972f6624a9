"""Text as TOML writes it: in quotes, with what would end them escaped."""

from __future__ import annotations

import json
from pathlib import Path

from vmach.errors import InputError

__all__ = ["quoted", "quoted_path"]


def quoted(text: str) -> str:
    r"""A text between quotes.

    Examples
    --------
    >>> from vmach.files.toml_text import quoted
    >>> print(quoted('6" plate'))
    "6\" plate"
    """
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def quoted_path(path: Path) -> str:
    """The name of a file between quotes.

    Raises
    ------
    InputError
        It has bytes that are not UTF-8, which no TOML file can hold.
    """
    name = path.as_posix()
    try:
        name.encode()
    except UnicodeEncodeError:
        raise InputError(
            "the name is not UTF-8, and no TOML file can hold it", file=path,
            accepted="a name in UTF-8", hint="give the file or its folder another name",
        ) from None  # fmt: skip
    return quoted(name)
