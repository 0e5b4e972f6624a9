"""The arrows of import point one way."""

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

#: layer of every room of vmach; a room may import its own layer and lower ones, never in a circle
LAYERS = [
    {"base", "errors"},
    {"files", "schemas", "features"},
    {"nominal", "machine", "report"},
    {"plausibility", "iso230"},
    {"job", "volumetric"},
    {"path"},
    {"effects", "program_text"},
    {"prediction"},
    {"uncertainty"},
    {"measurements", "instruments", "controller_tables"},
    {"fit"},
    {"diagnosis", "run", "importers"},
    {"history", "compensation", "checkup", "study"},
    {"setup"},
    {"api"},
    {"workbench"},
    {"commands"},
    {"cli", "__main__", "__init__"},
]
#: the same of gcode: a stretch of plain motion is run by compiled code from within the flow
GCODE_LAYERS = [
    {"errors"}, {"text", "geometry"}, {"state", "writing"}, {"motion", "fast", "moves"},
    {"control"}, {"language"}, {"dialects"}, {"run"}, {"program"}, {"canon"}, {"__init__"},
]  # fmt: skip
#: Python files directly in vmach/, and in any one room, at most
TOP_LEVEL_FILES, ROOM_FILES = 5, 20


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


def test_gcode_imports_point_down_and_only_its_door_is_used():
    layer = {room: number for number, rooms in enumerate(GCODE_LAYERS) for room in rooms}
    wrong = []
    for path in (*(ROOT / "gcode").rglob("*.py"), *(ROOT / "vmach").rglob("*.py")):
        package, room = path.relative_to(ROOT).parts[0], path.relative_to(ROOT).parts[1]
        for module in imported_modules(path):
            names = module.split(".")
            if names[0] != "gcode" or (package == "vmach" and len(names) == 1):
                continue
            above = layer[room.removesuffix(".py")] if package == "gcode" else -1
            if len(names) == 1 or layer[names[1]] > above:
                wrong.append(f"{path.relative_to(ROOT)} imports {module}")
    assert not wrong, "\n".join(wrong)


def room_of(path):
    return path.relative_to(ROOT / "vmach").parts[0].removesuffix(".py")


def arrows_between_rooms():
    """(room, imported room, where), the door of the package left out."""
    for path in (ROOT / "vmach").rglob("*.py"):
        for module in imported_modules(path):
            names = module.split(".")
            if names[0] == "vmach" and len(names) > 1 and names[1] != room_of(path):
                yield room_of(path), names[1], f"{path.relative_to(ROOT)} imports {module}"


def test_vmach_imports_point_down():
    wrong = [
        where
        for room, imported, where in arrows_between_rooms()
        if layer_of(imported) > layer_of(room)
    ]
    assert not wrong, "\n".join(wrong)


def test_no_rooms_import_each_other_in_a_circle():
    graph = {}
    for room, imported, _ in arrows_between_rooms():
        if room != "__init__":
            graph.setdefault(room, set()).add(imported)
    tuple(TopologicalSorter(graph).static_order())  # raises CycleError with the circle


def test_rooms_stay_small():
    crowded = {
        str(folder.relative_to(ROOT)): count
        for package in ("vmach", "gcode", "stock")
        for folder in (ROOT / package, *(ROOT / package).rglob("*/"))
        if (count := len(list(folder.glob("*.py")))) > ROOM_FILES
        and (folder / "__init__.py").exists()
    }
    assert not crowded
    assert len(list((ROOT / "vmach").glob("*.py"))) <= TOP_LEVEL_FILES


def test_the_command_line_loads_nothing_that_takes_long():
    heavy = ["numba", "scipy", "matplotlib", "trimesh", "manifold3d", "pyvista", "rich"]
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
