"""What is kept for the next start and was cut short is dropped, and not without a word."""

import importlib.util
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from vmach import cli
from vmach.__main__ import main
from vmach.base.damaged_cache import drop_cut_kernels, drop_damaged

KERNEL = """
from numba import njit

@njit(cache=True)
def twice(x):
    return 2 * x
"""


@pytest.fixture
def kernel(tmp_path, monkeypatch):
    """A function that loads a kept kernel, or compiles it."""
    (tmp_path / "kernel.py").write_text(KERNEL)

    def call():
        spec = importlib.util.spec_from_file_location("kernel", tmp_path / "kernel.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module.twice(3)

    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path / "kept"))
    assert call() == 6
    return call


@pytest.mark.parametrize("kind", ["nbi", "nbc"])
@pytest.mark.parametrize("left", [0.0, 0.6])
def test_kernels_that_are_cut_short_are_compiled_anew(tmp_path, kernel, kind, left):
    (kept,) = (tmp_path / "kept").rglob(f"*.{kind}")
    whole = kept.read_bytes()
    kept.write_bytes(whole[: int(left * len(whole))])
    with pytest.raises(Exception) as caught:
        kernel()
    drop_cut_kernels((tmp_path / "kept").rglob("*.nb?"))
    assert not kept.exists()
    assert kernel() == 6 and kept.exists()
    kept.write_bytes(whole[: int(left * len(whole))])
    assert kept in drop_damaged(caught.value)
    assert kernel() == 6


def test_whole_kernels_stay(tmp_path, kernel):
    before = sorted((tmp_path / "kept").rglob("*.nb?"))
    drop_cut_kernels((tmp_path / "kept").rglob("*.nb?"))
    assert sorted((tmp_path / "kept").rglob("*.nb?")) == before and len(before) == 2


def test_bytecode_that_is_cut_short_is_named_and_dropped(tmp_path):
    env = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    env |= {"PYTHONPYCACHEPREFIX": str(tmp_path), "PYTHONPATH": str(Path(cli.__file__).parents[1])}

    def vmach():
        command = [sys.executable, "-m", "vmach", "schema", "job"]
        return subprocess.run(command, env=env, capture_output=True, text=True, timeout=120)

    first = vmach()
    assert first.returncode == 0, first.stderr
    (kept,) = tmp_path.rglob("editor_schemas.*.pyc")
    kept.write_bytes(kept.read_bytes()[:100])
    second = vmach()
    assert second.returncode == 1 and "Aborted" not in second.stderr
    assert second.stderr.startswith(f"vmach: {kept}: ") and "start the command" in second.stderr
    assert vmach().stdout == first.stdout


def test_a_mistake_in_a_module_is_no_damage(tmp_path, monkeypatch):
    (tmp_path / "wrong_module.py").write_text("x = (\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(SyntaxError) as caught:
        import_module("wrong_module")
    assert drop_damaged(caught.value) == ()


@pytest.mark.parametrize("error", [EOFError, "Abort"])
def test_nothing_ends_with_a_bare_word(monkeypatch, capsys, error):
    def fails(*_):
        raise (typer.Abort if error == "Abort" else error)

    monkeypatch.setattr(import_module("vmach.effects"), "catalogue", fails)
    monkeypatch.setattr(sys, "argv", ["vmach", "effects", "list"])
    with pytest.raises(SystemExit) as stopped:
        main()
    told = capsys.readouterr().err
    assert stopped.value.code == (130 if error == "Abort" else 70)
    assert "Aborted" not in told and told.startswith("vmach: ")
    assert CliRunner().invoke(cli.app, ["--version"]).exit_code == 0
