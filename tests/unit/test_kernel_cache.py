"""Cached kernels do not outlive the sources that they were compiled from."""

import os
import tempfile
from pathlib import Path

from vmach.base import kernel_cache
from vmach.base.kernel_cache import _forget_in, find_room_for_kernels


def make_package(folder):
    (folder / "inner" / "__pycache__").mkdir(parents=True)
    (folder / "kernel.py").write_text("from numba import njit\n")
    (folder / "plain.py").write_text("x = 1\n")
    cached = folder / "inner" / "__pycache__" / "kernel.f-1.py311.nbc"
    cached.write_bytes(b"machine code")
    return cached


def test_kernels_are_forgotten_when_a_kernel_source_changes(tmp_path):
    cached = make_package(tmp_path)
    _forget_in(tmp_path)
    assert not cached.exists()  # nobody knows what they were compiled from
    cached.write_bytes(b"machine code")
    _forget_in(tmp_path)
    assert cached.exists()
    (tmp_path / "plain.py").write_text("x = 2\n")
    os.utime(tmp_path / "kernel.py")
    _forget_in(tmp_path)
    assert cached.exists()
    (tmp_path / "kernel.py").write_text("from numba import njit  # changed\n")
    _forget_in(tmp_path)
    assert not cached.exists()


def test_a_read_only_system_gets_a_folder_that_only_the_user_can_write_to(tmp_path, monkeypatch):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    find_room_for_kernels()
    assert os.environ["NUMBA_CACHE_DIR"] == ""  # beside the package there is room
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(kernel_cache, "_has_room", lambda folder: False)
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")  # so that it is put back afterwards
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    find_room_for_kernels()
    first = Path(os.environ.pop("NUMBA_CACHE_DIR"))
    assert first.parent == tmp_path
    assert first.stat().st_mode & 0o077 == 0
    first.chmod(0o777)  # somebody else could have put kernels there
    find_room_for_kernels()
    assert Path(os.environ["NUMBA_CACHE_DIR"]) != first


def test_a_folder_that_cannot_be_made_has_no_room(tmp_path):
    (tmp_path / "file").write_text("")
    assert kernel_cache._has_room(tmp_path / "new" / "folder")
    assert not kernel_cache._has_room(tmp_path / "file" / "folder")
