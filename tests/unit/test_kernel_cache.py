"""Cached kernels do not outlive the sources that they were compiled from."""

import os

from vmach.kernel_cache import _forget_in


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
