"""Every file of the packages that is no Python goes into the wheel."""

from __future__ import annotations

import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_files_beside_the_code_are_package_data():
    with (ROOT / "pyproject.toml").open("rb") as file:
        patterns = tomllib.load(file)["tool"]["setuptools"]["package-data"]["*"]
    kept = {".py", ".pyc", ".nbi", ".nbc"}
    for package in ("gcode", "stock", "vmach"):
        for path in (ROOT / package).rglob("*"):
            if path.is_file() and path.suffix not in kept and "__pycache__" not in path.parts:
                assert any(fnmatch(path.name, p) for p in patterns), path.relative_to(ROOT)
