"""``vmach warm-up``: the compiler's work, done before somebody waits for a result."""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from vmach.base.kernel_cache import is_cold

__all__ = ["compile_if_cold", "warm_up"]

#: commands that look for edges, which takes longest to compile
_COMPILING = {"run", "compare", "predict", "diagnose", "add", "history", "compensate"}

#: a pocket and what was measured on it: small, and every kernel of a run is asked for
_FILES = {
    "job.toml": """\
schema = 1
machine = "machine.toml"
program = "part.nc"
measured = "points.csv"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [-30, -30, -20]
max_mm = [30, 30, 0]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
""",
    "machine.toml": """\
schema = 1
name = "warm-up"
chain = "t (C) Z Y b X' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 12000
tool_change_s = 5
[errors.EXX]
table = "EXX.csv"
measured_at_mm = [0, 0, 0]
[errors.EBX]
table = "EBX.csv"
[axes.X]
travel_mm = [-400, 0]
[axes.Y]
travel_mm = [-300, 0]
[axes.Z]
travel_mm = [-300, 0]
""",
    "EXX.csv": "position_mm,forward_um,backward_um\n-400,0,1\n-200,12,13\n0,4,5\n",
    "EBX.csv": "position_mm,forward_urad,backward_urad\n-400,0,1\n-200,12,13\n0,4,5\n",
    "part.nc": """\
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X0 Y0 Z5
G1 Z-8 F300
G1 X-15 Y-10 F900
G1 X15
G2 X15 Y10 I0 J10
G1 X-15
G1 Y-10
G0 Z5
M30
""",
    "points.csv": "id,feature,x,y,z,i,j,k,mx,my,mz\n"
    + "".join(
        f"{k},floor,{k - 8},-10,-8,0,0,1,{k - 8},-10,{-8 + 1e-3 * (k * 7 % 5):.3f}\n"
        for k in range(16)
    ),
}

#: control -> lines of a language whose plain motion has compiled code of its own
_OTHER_LANGUAGES = {
    "sinumerik": b"G1 X1 F100\nG2 X2 I0.5 J0\nM30\n",
    "heidenhain": b"L X+1 F100\nCC X+2 Y+0\nC X+3 DR+\nL M30\n",
}

#: a free-form face over the sides of a square, and the face below it: see `_cad`
_STEP = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('CONFIG_CONTROL_DESIGN'));
ENDSEC;
DATA;
#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3))
REPRESENTATION_CONTEXT('',''));
#2=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#3=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#4=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#5),#1);
#5=MANIFOLD_SOLID_BREP('',#6);
#6=CLOSED_SHELL('',(#7,#8));
#7=ADVANCED_FACE('',(#9),#11,.T.);
#8=ADVANCED_FACE('',(#10),#12,.F.);
#9=FACE_OUTER_BOUND('',#13,.T.);
#10=FACE_OUTER_BOUND('',#14,.T.);
#11=B_SPLINE_SURFACE_WITH_KNOTS('',2,2,((#41,#51,#44),(#52,#55,#53),(#42,#54,#43)),
.UNSPECIFIED.,.F.,.F.,.F.,(3,3),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.);
#12=PLANE('',#15);
#13=EDGE_LOOP('',(#16,#17,#18,#19));
#14=EDGE_LOOP('',(#20,#21,#22,#23));
#15=AXIS2_PLACEMENT_3D('',#41,$,$);
#16=ORIENTED_EDGE('',*,*,#24,.T.);
#17=ORIENTED_EDGE('',*,*,#25,.T.);
#18=ORIENTED_EDGE('',*,*,#26,.T.);
#19=ORIENTED_EDGE('',*,*,#27,.T.);
#20=ORIENTED_EDGE('',*,*,#27,.F.);
#21=ORIENTED_EDGE('',*,*,#26,.F.);
#22=ORIENTED_EDGE('',*,*,#25,.F.);
#23=ORIENTED_EDGE('',*,*,#24,.F.);
#24=EDGE_CURVE('',#31,#32,#61,.T.);
#25=EDGE_CURVE('',#32,#33,#62,.T.);
#26=EDGE_CURVE('',#33,#34,#63,.T.);
#27=EDGE_CURVE('',#34,#31,#64,.T.);
#31=VERTEX_POINT('',#41);
#32=VERTEX_POINT('',#42);
#33=VERTEX_POINT('',#43);
#34=VERTEX_POINT('',#44);
#41=CARTESIAN_POINT('',(0.,0.,0.));
#42=CARTESIAN_POINT('',(10.,0.,0.));
#43=CARTESIAN_POINT('',(10.,10.,0.));
#44=CARTESIAN_POINT('',(0.,10.,0.));
#51=CARTESIAN_POINT('',(0.,5.,0.));
#52=CARTESIAN_POINT('',(5.,0.,0.));
#53=CARTESIAN_POINT('',(5.,10.,0.));
#54=CARTESIAN_POINT('',(10.,5.,0.));
#55=CARTESIAN_POINT('',(5.,5.,4.));
#61=B_SPLINE_CURVE_WITH_KNOTS('',2,(#41,#52,#42),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.);
#62=LINE('',#42,#72);
#63=LINE('',#43,#73);
#64=LINE('',#44,#74);
#72=VECTOR('',#82,1.);
#73=VECTOR('',#83,1.);
#74=VECTOR('',#84,1.);
#82=DIRECTION('',(0.,1.,0.));
#83=DIRECTION('',(-1.,0.,0.));
#84=DIRECTION('',(0.,-1.,0.));
ENDSEC;
END-ISO-10303-21;
"""


def warm_up() -> None:
    """Compile the numerical kernels, once after an installation."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in _FILES.items():
            (folder / file).write_text(text, encoding="utf-8")
        works = (
            ("a machined part", _machine),
            ("a long program", _read),
            ("nominal CAD", _cad),
            ("a compensated program", _compensate),
            ("a diagnosis", _diagnose),
        )
        for what, work in works:
            print(f"compiling what {what} needs ...", flush=True)
            work(folder)
    print(f"ready after {time.monotonic() - start:.0f} s")


def _machine(folder: Path) -> None:
    from vmach.run.pipeline import machine_part
    from vmach.run.results import write_results

    write_results(machine_part(folder), folder / "out", command="vmach warm-up")


def _read(folder: Path) -> None:
    """Short programs are read without the compiled reader: it is asked for here."""
    from gcode import Source, ToolEntry, read_program

    tools = {1: ToolEntry(100.0, 10.0)}
    read_program(folder / "part.nc", tools=tools, fast=True)
    for control, text in _OTHER_LANGUAGES.items():
        read_program(Source(text), tools=tools, dialect=control, fast=True)


def _cad(folder: Path) -> None:
    from vmach.nominal import read_nominal

    path = folder / "part.step"
    path.write_text(_STEP, encoding="ascii")
    read_nominal(path).sample(1.0)


def _compensate(folder: Path) -> None:
    """As the command does without CAD: points that are measured say where the surface is."""
    from vmach.compensation.aim.surface import check_surface, read_surface
    from vmach.compensation.compensate import compensate
    from vmach.job import read_job

    job = read_job(folder)
    surface = read_surface(job, with_aim=True)
    assert surface is not None  # there is a blank
    check_surface(job, compensate(job, round_points=surface.aim).text, surface)


def _diagnose(folder: Path) -> None:
    import numpy as np

    from vmach.diagnosis.diagnose import diagnose
    from vmach.diagnosis.residuals.job_survey import survey_job
    from vmach.fit.noise.feature_noise import FeatureNoise

    survey = survey_job(folder)
    diagnose(survey)
    # the noise of these readings is not correlated
    correlated = FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey)), 0.5, 0.5)
    correlated.white(survey.nuisance)


def compile_if_cold(command: str | None) -> None:
    """Begin to compile for the first command, and say on a terminal why it takes longer.

    Where standard error is no terminal nobody waits, and a message of an error stands alone.
    """
    if command not in _COMPILING or {"-h", "--help"} & set(sys.argv) or not is_cold():
        return
    if sys.stderr.isatty():
        print(
            "vmach: compiling first, once after an installation or an update, up to a minute; "
            "vmach warm-up does it beforehand",
            file=sys.stderr,
        )
    from stock import compile_ahead

    compile_ahead()
