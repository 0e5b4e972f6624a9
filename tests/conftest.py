"""Before any test: no compiled kernel that is older than its sources."""

from importlib import import_module

import pytest

from vmach.base.kernel_cache import collect_less_often, forget_stale_kernels

forget_stale_kernels()
collect_less_often()


@pytest.fixture
def no_effects_added(monkeypatch):
    """Effects of the test's own files are forgotten after it."""
    monkeypatch.setattr(import_module("vmach.effects.catalogue"), "_added", {})
