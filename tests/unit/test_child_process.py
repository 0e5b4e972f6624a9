"""Processes that the program starts run nothing of the folder that the user stands in."""

import os
import subprocess
import sys
from pathlib import Path

import stock
from stock.child_process import isolated_python

ROOT = Path(stock.__file__).parents[1]


def run_in(folder, program):
    """Run a program of Python in a folder where everything that could be imported is a trap."""
    (folder / "stock").mkdir()
    for trap in ("stock/__init__.py", "numpy.py", "json.py", "runpy.py", "sitecustomize.py"):
        (folder / trap).write_text("open('sprung', 'w').close()\n")
    return subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )


def test_a_child_process_runs_nothing_of_the_current_folder(tmp_path):
    program = (
        "import os, subprocess, sys\n"
        "from stock.child_process import isolated_python\n"
        "sys.path[:0] = ['', os.getcwd(), '.']\n"
        "sys.exit(subprocess.run(isolated_python('stock.errors')).returncode)\n"
    )
    done = run_in(tmp_path, program)
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "sprung").exists()


def test_a_child_process_imports_the_packages_of_its_parent(tmp_path):
    (tmp_path / "told.py").write_text(
        "import stock, sys\nprint(stock.__file__, __name__, *sys.argv[1:])\n"
    )
    sys.path.append(str(tmp_path))
    try:
        command = isolated_python("told", "a b", Path("c"))
    finally:
        sys.path.remove(str(tmp_path))
    said = subprocess.run(command, cwd="/", capture_output=True, text=True, check=True).stdout
    assert said == f"{stock.__file__} __main__ a b c\n"
