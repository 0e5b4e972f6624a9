"""The examples in the docstrings of `import vmach` run, and give what they say."""

from __future__ import annotations

import doctest
import inspect
import sys
from pathlib import Path

import pytest

import vmach

ROOT = Path(__file__).parents[2]
NAMES = sorted(set(vmach.__all__) - {"__version__"})


@pytest.fixture
def beside_the_samples(tmp_path, monkeypatch):
    """A folder to write into, from which the samples are reached as from the repository."""
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", [n for n in NAMES if ">>> " in (getattr(vmach, n).__doc__ or "")])
@pytest.mark.usefixtures("beside_the_samples", "no_effects_added")
def test_example_runs(name):
    thing = getattr(vmach, name)
    names = vars(sys.modules[thing.__module__]).copy()
    (example,) = doctest.DocTestFinder(recurse=False).find(thing, name, globs=names)
    said: list[str] = []
    doctest.DocTestRunner().run(example, out=said.append)
    assert not said, "".join(said)


def test_every_function_has_an_example():
    functions = [name for name in NAMES if inspect.isfunction(getattr(vmach, name))]
    assert len(functions) >= 18
    assert [name for name in functions if ">>> " not in getattr(vmach, name).__doc__] == []
