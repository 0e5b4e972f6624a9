"""Before any test: no compiled kernel that is older than its sources."""

from importlib import import_module

import pytest

from vmach.base.kernel_cache import collect_less_often, forget_stale_kernels

forget_stale_kernels()
collect_less_often()


@pytest.fixture(autouse=True)
def effects_are_forgotten(monkeypatch):
    """What a test adds to the catalogue of effects goes with it."""
    catalogue = import_module("vmach.effects.catalogue")
    monkeypatch.setattr(catalogue, "_added", dict(catalogue._added))


@pytest.fixture
def no_effects_added(monkeypatch):
    """The catalogue as it is installed."""
    monkeypatch.setattr(import_module("vmach.effects.catalogue"), "_added", {})
