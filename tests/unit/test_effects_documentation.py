"""The example in the documentation is a complete effect, and the catalogue is listed in full."""

from __future__ import annotations

import doctest
import re
import runpy
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import vmach.effects.effect
from tests.small_job import write_job
from vmach.cli import app
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
    np.testing.assert_allclose(moved[:, 2], -1e-3 * states.nose_mm[:, 0] * states.nose_mm[:, 1])


@pytest.mark.usefixtures("no_effects_added")
def test_the_tables_are_those_of_the_classes():
    """Written anew by ``python docs/make_effect_tables.py``."""
    tables = runpy.run_path(str(DOCUMENT.with_name("make_effect_tables.py")))
    for page, table in ((DOCUMENT, "catalogue_table"), (LAWS, "law_table")):
        text = page.read_text(encoding="utf-8")
        assert text == tables["with_table"](text, tables[table]()), page.name


def test_equations_are_numbered_one_by_one():
    stated = [effect.source for effect in catalogue().values()]
    numbers = [int(re.match(r"equation \((\d+)\) of docs/laws.md; \S", s)[1]) for s in stated]
    assert sorted(numbers) == list(range(1, len(stated) + 1))


def test_an_effect_is_shown_with_all_it_says():
    found = CliRunner().invoke(app, ["effects", "show", "backlash"])
    assert found.exit_code == 0, found.output
    for said in ("law: -(reversal/2) s_j(take_up) ê_j", "ISO 230-2", "reversal_um: ", "cure: "):
        assert said in found.stdout
    wrong = CliRunner().invoke(app, ["effects", "show", "backlsh"])
    assert "did you mean 'backlash'?" in str(wrong.exception)


def test_docstring_example():
    found = doctest.testmod(vmach.effects.effect)
    assert found.attempted > 0 and found.failed == 0
