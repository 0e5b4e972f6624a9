"""``tasks.py check-all``: which Pythons it takes, and the oldest dependencies."""

import importlib.util
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
VERSION = "{}.{}".format(*sys.version_info[:2])


@pytest.fixture
def tasks(monkeypatch, tmp_path):
    """The script, with no Python to be found but those of the test."""
    spec = importlib.util.spec_from_file_location("tasks", ROOT / "tasks.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setenv("PATH", str(tmp_path / "path"))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path / "pyenv"))
    monkeypatch.delenv("VMACH_PYTHONS", raising=False)
    return module


def python_in(folder, *, works, name=f"python{VERSION}"):
    folder.mkdir(parents=True)
    python = folder / name
    python.write_text(
        f'#!/bin/sh\nexec "{sys.executable}" "$@"\n' if works else "#!/bin/sh\nexit 127"
    )
    python.chmod(0o755)
    return python


def test_an_interpreter_that_does_not_run_is_passed_over(tasks, tmp_path, capsys):
    assert tasks.interpreter(VERSION) is None
    shim = python_in(tmp_path / "path", works=False)
    assert tasks.interpreter(VERSION) is None
    assert f"{shim} does not run" in capsys.readouterr().out
    real = python_in(tmp_path / "pyenv" / "versions" / f"{VERSION}.9" / "bin", works=True)
    assert tasks.interpreter(VERSION) == real
    assert tasks.interpreter("3.99") is None


def test_an_interpreter_may_be_named(tasks, tmp_path, monkeypatch):
    named = python_in(tmp_path / "own", works=True, name="my-python")
    monkeypatch.setenv("VMACH_PYTHONS", str(named))
    assert tasks.interpreter(VERSION) == named
    folder = python_in(tmp_path / "folder", works=True).parent
    monkeypatch.setenv("VMACH_PYTHONS", str(folder))
    assert tasks.interpreter(VERSION).parent == folder


def test_the_oldest_dependencies_are_exact(tasks):
    assert all(next(iter(Requirement(one).specifier)).operator == "==" for one in tasks.oldest())
    assert "numpy==1.26" in tasks.oldest()
