#!/usr/bin/env python3
"""Set vmach up in its own environment, then do a task.

    python3 tasks.py demo     machine the sample part and say where the report is
    python3 tasks.py test     pass the tests
    python3 tasks.py check    lint, types and tests
    python3 tasks.py check-all [VERSION] [newest | oldest]
                              the same on every Python from 3.11 to 3.13 that is installed,
                              with the newest and the oldest dependencies; VMACH_PYTHONS
                              names interpreters (or folders of them) besides those found
    python3 tasks.py docs     build the documentation's site in out/site
    python3 tasks.py setup    only make the environment (.venv)

Needs Python 3.11 or newer and nothing else.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
SAMPLE = ROOT / "samples" / "iso10791_7" / "job.toml"
#: Pythons that vmach says it runs on
PYTHONS = ("3.11", "3.12", "3.13")


def main() -> int:
    """Run the task named on the command line; returns its exit status."""
    tasks = {
        "demo": demo,
        "test": test,
        "check": check,
        "check-all": check_all,
        "docs": docs,
        "setup": lambda _: 0,
    }
    if len(sys.argv) < 2 or sys.argv[1] not in tasks:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    if sys.version_info < (3, 11):  # noqa: UP036  (any python3 may start this file)
        print(f"vmach needs Python 3.11 or newer; this is {sys.version.split()[0]}")
        return 1
    if sys.argv[1] != "check-all":  # it makes environments of its own
        set_up()
    return tasks[sys.argv[1]](sys.argv[2:])


def set_up() -> None:
    """Make the environment and install vmach into it, unless that was done since."""
    stamp = VENV / "installed"
    wanted = (ROOT / "pyproject.toml").read_text()
    if PYTHON.exists() and stamp.exists() and stamp.read_text() == wanted:
        return
    print("1/3 making .venv (once; all three steps take a few minutes)", flush=True)
    make_environment()
    print("2/3 installing vmach and what it needs", flush=True)
    install = [PYTHON, "-m", "pip", "install", "--disable-pip-version-check", "--progress-bar=on"]
    packages = ["--editable", f"{ROOT}[test,check]"]
    pip = subprocess.Popen([*install, *packages], stdout=subprocess.PIPE, text=True)
    assert pip.stdout is not None
    for line in pip.stdout:
        if line.startswith(("Collecting", "Installing", "Building")):
            print(f"    {line.strip():.76}", flush=True)
    if pip.wait() != 0:
        sys.exit("pip could not install the packages; its messages stand above")
    print("3/3 compiling", flush=True)
    subprocess.run([PYTHON, "-P", "-m", "vmach", "warm-up"], check=True)
    stamp.write_text(wanted)


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


def check(arguments: list[str]) -> int:
    """Lint, types and tests; the first that fails ends it."""
    for tool in checks(arguments):
        print(f"== {tool[0]}", flush=True)
        status = subprocess.run([PYTHON, "-m", *tool], cwd=ROOT).returncode
        if status != 0:
            return status
    return 0


def check_all(arguments: list[str]) -> int:
    """Lint, types and tests on every Python there is, with the newest and oldest dependencies."""
    versions = [word for word in arguments if word in PYTHONS] or PYTHONS
    ages = [word for word in arguments if word in ("newest", "oldest")] or ["newest", "oldest"]
    for_pytest = [word for word in arguments if word not in (*PYTHONS, "newest", "oldest")]
    failed, passed = [], 0
    for version in versions:
        python = interpreter(version)
        if python is None:
            print(f"== Python {version}: not found, not tried", flush=True)
            continue
        for age in ages:
            # compiled packages of the oldest versions exist for the oldest Python only
            if age == "oldest" and version != PYTHONS[0]:
                continue
            print(f"== Python {version} ({python}), {age} dependencies", flush=True)
            if passes_with(python, age, for_pytest):
                passed += 1
            else:
                failed.append(f"Python {version} with the {age} dependencies")
    print(f"passed: {passed}" + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 0 if passed and not failed else 1


def interpreter(version: str) -> Path | None:
    """A Python of this version that runs: one that VMACH_PYTHONS names, on the PATH, or pyenv's."""
    named = os.environ.get("VMACH_PYTHONS", "").split(os.pathsep)
    found = [Path(name) for name in named if Path(name).is_file()]
    folders = [Path(name) for name in [*named, *os.get_exec_path()] if name]
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    folders += [place / "bin" for place in sorted(pyenv.glob(f"{version}.*"))]
    found += [folder / f"python{version}" for folder in folders]
    question = "import ensurepip, sys, venv; print('%d.%d' % sys.version_info[:2])"
    for python in found:
        if not python.is_file():
            continue
        asked = subprocess.run([python, "-c", question], capture_output=True, text=True)
        if asked.returncode == 0 and asked.stdout.strip() == version:
            return python
        if python.name == f"python{version}":
            print(f"== {python} does not run or lacks venv, passed over", flush=True)
    return None


def passes_with(python: Path, age: str, arguments: list[str]) -> bool:
    """Whether lint, types and tests pass in an environment of their own, made anew."""
    place = ROOT / "build" / f"check-{python.name}-{age}"
    subprocess.run([python, "-m", "venv", "--clear", place], check=True)
    packages = ["--editable", f"{ROOT}[test,check]"] + (oldest() if age == "oldest" else [])
    inside = place / "bin" / "python"
    install = [inside, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    if subprocess.run([*install, *packages]).returncode != 0:
        return False
    environment = os.environ | {"NUMBA_CACHE_DIR": str(place / "kernels")}
    # what an older numpy says of types is not what this code is checked against
    tools = [["pytest", *arguments]] if age == "oldest" else checks(arguments)
    passed = True  # one that fails does not hide what the next one says
    for tool in tools:
        print(f"== {tool[0]}", flush=True)
        passed &= subprocess.run([inside, "-m", *tool], cwd=ROOT, env=environment).returncode == 0
    return passed


def checks(arguments: list[str]) -> list[list[str]]:
    """What must pass: lint, types, tests."""
    return [["ruff", "check", "."], ["mypy"], ["pytest", *arguments]]


def oldest() -> list[str]:
    """Every dependency in the oldest version that pyproject.toml admits."""
    import tomllib

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = project["dependencies"] + project["optional-dependencies"]["test"]
    return [requirement.replace(">=", "==") for requirement in wanted]


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
