"""The example in the documentation is a complete effect, and the catalogue is listed in full."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import numpy as np
import pytest

import vmach.effects.effect
from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue, load_effect_file
from vmach.job import read_job
from vmach.path.preparation import prepare

DOCUMENT = Path(__file__).parents[2] / "docs" / "effects.md"
LAWS = DOCUMENT.with_name("laws.md")


@pytest.mark.usefixtures("no_effects_added")
def test_example_of_an_own_effect_runs(tmp_path):
    (code,) = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.S)
    file = tmp_path / "bed_twist.py"
    file.write_text(code, encoding="utf-8")
    job = read_job(write_job(tmp_path))
    states = prepare(job).path.nodes
    effect = load_effect_file(file)
    moved = effect.displacement(Circumstances(states, job), "", twist_um_per_m2=1e6)
    np.testing.assert_allclose(moved[:, 2], 1e-3 * states.nose_mm[:, 0] * states.nose_mm[:, 1])


def test_every_effect_and_parameter_is_in_the_table():
    text = DOCUMENT.read_text(encoding="utf-8")
    for name, effect in catalogue().items():
        row = next(
            line for line in text.splitlines() if line.startswith("|") and f"`{name}`" in line
        )
        if name not in ("fixture", "datum_shift", "component"):
            assert all(f"`{p.name}`" in row for p in effect.parameters), name


def test_every_law_has_its_equation():
    """The number in the source of a class is that of its row in the page of the laws."""
    rows = re.findall(r"^\| \((\d+)\) \| `(\w+)` \|", LAWS.read_text(encoding="utf-8"), re.M)
    assert [int(number) for number, _ in rows] == list(range(1, len(rows) + 1))
    stated = {name: effect.source for name, effect in catalogue().items()}
    assert {name for _, name in rows} == set(stated)
    for number, name in rows:
        assert stated[name].startswith(f"equation ({number}) of docs/laws.md; "), name


def test_docstring_example():
    found = doctest.testmod(vmach.effects.effect)
    assert found.attempted > 0 and found.failed == 0
