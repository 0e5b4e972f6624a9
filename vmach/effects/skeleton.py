"""The skeleton of a user's own effect, written by ``vmach effects new NAME``."""

from __future__ import annotations

import re
from pathlib import Path

from vmach.effects.catalogue import catalogue
from vmach.errors import InputError
from vmach.files.atomic import atomic_file

__all__ = ["write_skeleton"]

_TEXT = '''"""{title}."""

from vmach.effects import Effect, along, linear


class {kind}(Effect):
    """Say here what happens, and why."""

    name = "{name}"
    title = "{title}"
    parameters = (linear("rise_um_per_m", "rise of the tool per metre along X", usual=10.0),)
    targets = ("",)
    shows_as = "what a measured part shows of it"
    law = "rise x ê_z"
    usual_size = "1 to 10 um per metre"
    confirm = "how to see it on the machine"
    cure = "how to mend it"
    source = "where the law comes from, with the number of its equation"

    def displacement(self, path, target, rise_um_per_m):
        # (P, 3) mm, tool relative to workpiece; `path` knows position, direction, time, tool ...
        return along("Z", 1e-6 * rise_um_per_m * path.nose_mm[:, 0])
'''


def write_skeleton(name: str, folder: Path) -> Path:
    """Write ``NAME.py`` with a complete effect to start from.

    Raises
    ------
    InputError
        Not a lower-case name, a name that is taken, or a file that is there already.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        raise InputError(
            f"'{name}' is no name for an effect", accepted="lower-case words joined by underscores"
        )
    if name in catalogue():
        raise InputError(f"there is an effect '{name}' already", hint="choose another name")
    path = folder / f"{name}.py"
    if path.exists():
        raise InputError("file is there already", file=path)
    kind = "".join(word.capitalize() for word in name.split("_"))
    text = _TEXT.format(name=name, kind=kind, title=name.replace("_", " "))
    with atomic_file(path, is_new=True) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path
