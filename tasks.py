#!/usr/bin/env python3
"""Set vmach up in its own environment, then do a task.

    python3 tasks.py demo     machine the sample part and say where the report is
    python3 tasks.py test     pass the tests
    python3 tasks.py docs     build the documentation's site in out/site
    python3 tasks.py setup    only make the environment (.venv)

Needs Python 3.11 or newer and nothing else.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
SAMPLE = ROOT / "samples" / "iso10791_7" / "job.toml"
MEASURED_SAMPLE = ROOT / "samples" / "missing_effect" / "job.toml"


def main() -> int:
    """Run the task named on the command line; returns its exit status."""
    tasks = {"demo": demo, "test": test, "docs": docs, "setup": lambda _: 0}
    if len(sys.argv) < 2 or sys.argv[1] not in tasks:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    if sys.version_info < (3, 11):  # noqa: UP036  (any python3 may start this file)
        print(f"vmach needs Python 3.11 or newer; this is {sys.version.split()[0]}")
        return 1
    set_up()
    return tasks[sys.argv[1]](sys.argv[2:])


def set_up() -> None:
    """Make the environment and install vmach into it, unless that was done since."""
    stamp = VENV / "installed"
    wanted = (ROOT / "pyproject.toml").read_text()
    if PYTHON.exists() and stamp.exists() and stamp.read_text() == wanted:
        return
    print("setting up .venv (once, a few minutes)", flush=True)
    make_environment()
    install = [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*install, "--editable", f"{ROOT}[test]"], check=True)
    compile_kernels()
    stamp.write_text(wanted)


def compile_kernels() -> None:
    """Have the compiler's work done before somebody waits for a first result."""
    with tempfile.TemporaryDirectory() as folder:
        command = [PYTHON, "-m", "vmach", "diagnose", MEASURED_SAMPLE, "--out", folder]
        subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=True)


def make_environment() -> None:
    """A virtual environment with pip; Debian keeps what that needs in a package of its own."""
    if not has_ensurepip():
        package = f"python3.{sys.version_info.minor}-venv"
        command = ["apt-get", "install", "--yes", package]
        if os.geteuid() != 0 or not shutil.which("apt-get"):
            sys.exit(f"Python lacks its venv module; install it first: sudo {' '.join(command)}")
        subprocess.run(["apt-get", "update", "--quiet"], check=True)
        subprocess.run(command, check=True)
        os.execv(sys.executable, [sys.executable, *sys.argv])
    venv.create(VENV, with_pip=True, clear=True)


def has_ensurepip() -> bool:
    """Whether this Python can put pip into an environment."""
    check = [sys.executable, "-c", "import ensurepip, venv"]
    return subprocess.run(check, stderr=subprocess.DEVNULL).returncode == 0


def demo(arguments: list[str]) -> int:
    """Machine the sample part."""
    out = ROOT / "out" / "iso10791_7"
    command = [PYTHON, "-m", "vmach", "run", SAMPLE, "--out", out, *arguments]
    return subprocess.run(command, cwd=ROOT).returncode


def test(arguments: list[str]) -> int:
    """Pass the tests."""
    return subprocess.run([PYTHON, "-m", "pytest", *arguments], cwd=ROOT).returncode


def docs(arguments: list[str]) -> int:
    """Build the site: every page, and the reference from the docstrings; any warning fails it."""
    install = [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*install, "--editable", f"{ROOT}[docs]"], check=True)
    out = ROOT / "out" / "site"
    command = [PYTHON, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", ROOT / "docs", out]
    status = subprocess.run([*command, *arguments], cwd=ROOT).returncode
    if status == 0:
        print(f"the site is in {out / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
