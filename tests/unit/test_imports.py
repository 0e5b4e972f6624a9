"""The arrows of import point one way."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: layer of every part of vmach; a part may import its own layer and lower ones
LAYERS = [
    {
        "units",
        "errors",
        "variant",
        "atomic",
        "stage_clock",
        "progress",
        "kernel_cache",
        "terminal",
        "text_file",
    },
    {"csv_table", "toml_file", "points", "path_geometry", "alignment", "nominal"},
    {"machine", "accuracy", "iso230"},
    {"job_schema", "job", "tool_doubts", "toolpath"},
    {"sweeping", "preparation", "effects"},
    {"prediction", "error_budget", "collisions", "measurements", "tip_errors", "program_text"},
    {"fit"},
    {"prediction_uncertainty"},
    {"diagnosis", "controller_tables", "report", "history", "added_effects"},
    {"inspection"},
    {"pipeline"},
    {"results", "compensation"},
    {"commands"},
    {"cli", "__main__", "__init__"},
]


def imported_modules(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module


def layer_of(part):
    found = [number for number, parts in enumerate(LAYERS) if part in parts]
    assert found, f"vmach.{part} has no layer: give it one in {Path(__file__).name}"
    return found[0]


@pytest.mark.parametrize("package", ["gcode", "stock"])
def test_lower_packages_know_nobody(package):
    others = {"gcode", "stock", "vmach"} - {package}
    for path in (ROOT / package).rglob("*.py"):
        for module in imported_modules(path):
            assert module.split(".")[0] not in others, f"{path} imports {module}"


def test_vmach_imports_point_down():
    wrong = []
    for path in (ROOT / "vmach").rglob("*.py"):
        part = path.relative_to(ROOT / "vmach").parts[0].removesuffix(".py")
        for module in imported_modules(path):
            names = module.split(".")
            is_inner = names[0] == "vmach" and len(names) > 1
            if is_inner and layer_of(names[1]) > layer_of(part):
                wrong.append(f"{path.relative_to(ROOT)} imports {module}")
    assert not wrong, "\n".join(wrong)


def test_the_command_line_loads_nothing_that_takes_long():
    heavy = ["numba", "scipy", "matplotlib", "trimesh", "manifold3d", "pyvista"]
    code = f"import sys, vmach.cli; print([name for name in {heavy} if name in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_predictions_wait_for_no_pictures_and_no_solids():
    heavy = ["matplotlib", "trimesh", "pyvista", "scipy.stats"]
    code = (
        "import sys, vmach.run.pipeline, vmach.diagnosis.diagnose; "
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"
