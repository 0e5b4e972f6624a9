"""Benchmarks run seldom: what they take from the package is there all the same."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

BENCHMARKS = sorted((Path(__file__).parents[1] / "benchmarks").glob("*.py"))
#: peers that are measured beside, and not installed with the tests
PEERS = ("FreeCAD", "opencamlib")


@pytest.mark.parametrize("path", BENCHMARKS, ids=lambda path: path.stem)
def test_benchmark_takes_only_what_is_there(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a script finds what lies beside it
    monkeypatch.syspath_prepend(path.parent)
    try:
        importlib.import_module(f"tests.benchmarks.{path.stem}")
    except ModuleNotFoundError as missing:
        if missing.name not in PEERS:
            raise
        pytest.skip(f"{missing.name} is not installed")
