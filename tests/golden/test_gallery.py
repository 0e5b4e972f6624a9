"""Every script of the gallery runs, from a folder that is named like the package."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
SCRIPTS = sorted(GALLERY.glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_answers_its_question(script, tmp_path):
    folder = tmp_path / "vmach"
    folder.mkdir()
    (folder / "__init__.py").write_text("raise SystemExit('the wrong package')\n")
    run = subprocess.run(
        [sys.executable, "-W", "error", script],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env=os.environ | {"PYTHONPATH": str(GALLERY.parents[1])},
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip().splitlines()[0] != "%"


def test_the_page_shows_every_script():
    page = (GALLERY / "README.md").read_text()
    assert [path.name for path in SCRIPTS if f"({path.name})" not in page] == []
