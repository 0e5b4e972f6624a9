"""What the first command says, and that its work can be done beforehand."""

import subprocess
import sys
from pathlib import Path

import stock
from tests.golden.test_bad_input import run_vmach
from vmach.base import kernel_cache
from vmach.commands import warm_up


def test_warm_up_runs_a_part_and_a_diagnosis(monkeypatch, capsys):
    status, told, _ = run_vmach(monkeypatch, capsys, "warm-up")
    assert status == 0
    assert told.splitlines()[0].startswith("compiling what a machined part")
    assert told.splitlines()[-1].startswith("ready after")


def test_the_first_command_says_why_it_takes_long(monkeypatch, capsys):
    begun = []
    monkeypatch.setattr(warm_up, "is_cold", lambda: True)
    monkeypatch.setattr(stock, "compile_ahead", lambda: begun.append(True))
    warm_up.compile_if_cold("run")
    assert capsys.readouterr().err == ""  # nobody looks
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    for command in ("run", "effects", None):
        warm_up.compile_if_cold(command)
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert len(begun) == 2  # for both "run", whoever looks
    assert "vmach warm-up does it beforehand" in told


def test_cold_means_no_kernel_beside_the_packages(tmp_path, monkeypatch):
    package = tmp_path / "stock"
    (package / "__pycache__").mkdir(parents=True)
    (package / "__init__.py").write_text("")
    spec = type("Spec", (), {"origin": str(package / "__init__.py")})
    monkeypatch.setattr(kernel_cache, "find_spec", lambda name: spec)
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    assert kernel_cache.is_cold()
    (package / "__pycache__" / "walk.py311.nbi").write_bytes(b"")
    assert not kernel_cache.is_cold()


def test_loading_the_command_line_stays_light():
    code = "import sys, vmach.cli; print([m for m in ('numpy', 'pydantic') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


#: prints which signatures of the kernels of nominal CAD a part of every kind of surface adds
WARM = """
import pathlib, sys
from vmach.commands import warm_up
from vmach.nominal import read_nominal
from vmach.nominal.mesh import thinning
from vmach.nominal.surfaces import bspline_kernel, crossings, crowding, curved_triangles, delaunay

def compiled():
    modules = (bspline_kernel, crossings, crowding, curved_triangles, delaunay, thinning)
    kernels = [k for m in modules for k in vars(m).items() if hasattr(k[1], "signatures")]
    return {(name, str(s)) for name, kernel in kernels for s in kernel.signatures}

warm_up._cad(pathlib.Path(sys.argv[1]))
before = compiled()
for path in sys.argv[2:]:
    read_nominal(path).sample(5.0)
print(len(before) > 0, sorted(compiled() - before))
"""


def test_warm_up_compiles_all_that_reading_cad_needs(tmp_path):
    cad = Path(__file__).parents[1] / "golden" / "cad"
    parts = [str(cad / f"{name}.step") for name in ("loft", "nurbs_torus", "octant", "nut")]
    code = [sys.executable, "-c", WARM, str(tmp_path), *parts]
    found = subprocess.run(code, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "True []"


#: prints which signatures of the compiled reader a program of every kind of line adds
READ = """
import pathlib, sys
from gcode import ToolEntry, read_program
from gcode.fast import klartext_lines, line_kernel, sinumerik_lines
from vmach.commands import warm_up

def compiled():
    modules = line_kernel, klartext_lines, sinumerik_lines
    kernels = [k for m in modules for k in vars(m).items() if hasattr(k[1], "signatures")]
    return {(name, str(s)) for name, kernel in kernels for s in kernel.signatures}


folder = pathlib.Path(sys.argv[1])
(folder / "part.nc").write_text(warm_up._FILES["part.nc"])
warm_up._read(folder)
before = compiled()
tools = {k: ToolEntry(100.0, 10.0) for k in (1, 2, 3)}
moves = read_program(sys.argv[2], tools=tools, work_offsets_mm={"G54": (0.0, 0.0, 0.0)}).moves
for control in ("sinumerik", "heidenhain", "tnciso"):
    path = folder / f"long.{control}"
    len(read_program(path, tools=tools, dialect=control).moves)
print(len(before) > 0, len(moves) > 10_000, sorted(compiled() - before))
"""


def test_warm_up_compiles_all_that_reading_a_long_program_needs(tmp_path):
    rows = "".join(
        f"G1 X{k}. Y1. F1500 S{k + 1000}\nX{k}.5 Z-1.25\nG2 X{k + 1}.5 I0.5 J0. (arc)\nG0 Z2.\n"
        for k in range(2000)
    )
    head = "G21 G17 G90 G94 G54\nT1 M6\nS6000 M3\nG43 H1\nG0 Z20.\n"
    cycle = "G99 G81 X1. Y1. Z-3. R2. F200\nX2.\nG80\nT2 M6\nG4 P1\n"
    (tmp_path / "long.nc").write_text(head + rows + cycle + rows + "M30\n")
    plain = rows.replace("(arc)", "; arc")
    (tmp_path / "long.sinumerik").write_text(f"G17 G90 G71 F90\n{plain}G700\nF5\n{plain}M30\n")
    lines = "".join(
        f"L X+{k} Y+1 F1500\nCC IX+1 Y+1\nC IX+2 DR+ ; arc\nL Z+2 FMAX M8\n" for k in range(2000)
    )
    (tmp_path / "long.heidenhain").write_text(f"BEGIN PGM A MM\n{lines}END PGM A MM\n")
    blocks = "".join(f"G01 X+{k} Y+1 F1500*\nG00 Z+2 M8*\n" for k in range(3000))
    (tmp_path / "long.tnciso").write_text(f"%A G71*\n{blocks}N9 %A G71*\n")
    code = [sys.executable, "-c", READ, str(tmp_path), str(tmp_path / "long.nc")]
    found = subprocess.run(code, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "True True []"


#: prints which signatures of all kernels a compensated sample adds
WARM_COMPENSATION = """
import pathlib, sys
from vmach.commands import warm_up
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.compensation.compensate import compensate
from vmach.job import read_job

def compiled():
    modules = [m for n, m in sys.modules.items() if n.split(".")[0] in ("gcode", "stock", "vmach")]
    kernels = {k for m in modules for k in vars(m).values() if hasattr(k, "nopython_signatures")}
    return {(k.__module__, k.__name__, str(s)) for k in kernels for s in k.signatures}

folder = pathlib.Path(sys.argv[1])
for file, text in warm_up._FILES.items():
    (folder / file).write_text(text)
for work in (warm_up._machine, warm_up._read, warm_up._cad, warm_up._compensate):
    work(folder)
before = compiled()
job = read_job(sys.argv[2])
surface = read_surface(job, with_aim=True)
check_surface(job, compensate(job, round_points=surface.aim).text, surface)
print(len(before) > 0, sorted(compiled() - before))
"""


def test_warm_up_compiles_all_that_a_compensation_needs(tmp_path):
    sample = Path(__file__).parents[2] / "samples" / "freecad_pocket"
    code = [sys.executable, "-c", WARM_COMPENSATION, str(tmp_path), str(sample)]
    found = subprocess.run(code, capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "True []"
