"""One good file of each kind that is imported, with the answers that it needs."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tests.small_job import write_job

LASER = """\
Machine;DMU 50;;
Axis;X;;
Position (mm);Abweichung (µm);Richtung;Lauf
-300,0;0,0;+;1
-200,0;1,5;+;1
-100,0;3,2;+;1
-100,0;2,2;-;1
-200,0;0,4;-;1
-300,0;-1,1;-;1
"""
RTL = """\
HEADER::
File type  : rtl
Owner      : Linear
Version no : V20.02.02
TARGET DATA::
Filetype: Linear
Target-count: 3
Flags: 1 0 1
Targets:
0.0000 100.0000
200.0000
USER-TEXT::
Machine: DMU 50
Serial No: 1234
Date: 10:15 Jan 12 2015
By: Operator
Axis: X
Location: Hall 3
TITLE: X axis
RUNS::
Run-count: 4
DEVIATIONS::
Run Target Data:
1 1 0.1000
1 2 1.5000
1 3 3.2000
2 3 2.2000
2 2 0.4000
2 1 -1.1000
3 1 0.2000
3 2 1.6000
3 3 3.3000
4 3 2.4000
4 2 0.6000
4 1 -0.9000
ENVIRONMENT::
Air temp: 20.1 20.2 C
EOF::
"""
PCDMIS = """\
PART NAME  : PLATE
REV NUMBER : A
DIM LOC1= LOCATION OF CIRCLE CIR1  UNITS=MM ,$
GRAPH=OFF  TEXT=OFF  MULT=10.00  OUTPUT=BOTH
AX    NOMINAL       +TOL       -TOL       MEAS        DEV     OUTTOL
X      10.000      0.100      0.100     10.011      0.011      0.000 ----#----
Y      20.000      0.100      0.100     19.995     -0.005      0.000 ---#-----
Z       0.000      0.100      0.100      0.000      0.000      0.000 ----#----
D       8.000      0.100      0.100      8.012      0.012      0.000 ----#----
END OF DIMENSION LOC1
DIM LOC2= TRUE POSITION OF CIRCLE CIR2  UNITS=MM ,$
AX       MEAS    NOMINAL       +TOL       -TOL      BONUS        DEV     OUTTOL
X     -28.623    -28.600                                       0.023
Y       9.125      9.100                                       0.025
DF      4.254      4.200      0.200      0.000      0.054      0.054      0.000
TP      0.068        MMC      0.200                 0.054      0.068      0.000
END OF DIMENSION LOC2
DIM FLAT1= FLATNESS OF PLANE PLN1  UNITS=MM ,$
AX    NOMINAL       +TOL       -TOL       MEAS        DEV     OUTTOL
M       0.000      0.050      0.000      0.008      0.008      0.000 ----#----
END OF DIMENSION FLAT1
DIM LOC3= LOCATION OF POINT PNT1  UNITS=MM ,$
AX    NOMINAL       +TOL       -TOL       MEAS        DEV     OUTTOL
X       5.000      0.100      0.100      5.000      0.000      0.000 ----#----
Y       3.000      0.100      0.100      3.001      0.001      0.000 ----#----
Z       0.000      0.100      0.100     -0.012     -0.012      0.000 ---#-----
END OF DIMENSION LOC3
"""
BALLBAR = "Run,Feed (mm/min),Angle (deg),Deviation (um)\n" + "".join(
    f"{run},1000,{angle if run == 'CCW' else 360 - angle},{0.1 * angle % 7 - 3:.2f}\n"
    for run in ("CCW", "CW")
    for angle in range(0, 360, 15)
)
BALLBAR_REPORT = """\
<?xml version="1.0"?>
<BALLBAR>
 <PLANE TEST_PLANE="XY"/>
 <FEATURES>
  <FEATURE NAME="AF_CIRCULARITY" DT="UT_LENGTH_UM">9.1</FEATURE>
  <FEATURE NAME="AF_SQUARENESS" DT="UT_SQUARENESS">-34.1</FEATURE>
 </FEATURES>
</BALLBAR>
"""
DRIFT = "Time (min)\tSpeed (rpm)\tdX (µm)\tdY (µm)\tdZ (µm)\n" + "".join(
    f"{k}\t6000\t{0.1 * k:.2f}\t0.0\t{12 * (1 - np.exp(-k / 20)):.3f}\n" for k in range(0, 60, 3)
)
ETALON = """\
// exchange text
[EXX]
Gridpoints = {
-300.0 0.001
-100.0 0.003
0.0 0.002
}
[EBX]
Gridpoints = {
-300.0 0.00001
0.0 0.00002
}
[C0Y]
VALUE = 0.0000341
"""
ISG = "X EXX EYX\n-300 0.001 0.002\n0 0.002 0.001\n# \nY EYY\n-200 0.001\n0 0.004\n"
PROBE_LOG = "".join(
    f"{x:.4f} {y:.4f} {z:.4f} 0.0 0.0 0.0 0.0 0.0 0.0\n"
    for x, y, z in ((-2.0, -2.0, 1.0), (5.0, 3.0, 1.001), (2.0, 4.0, 0.998), (6.0, -3.0, 1.0))
)
DMIS = """\
DMISMN/'plate',05.2
UNITS/MM,ANGDEC
F(P1)=FEAT/POINT,CART,0,0,0,0,0,1
FA(P1)=FEAT/POINT,CART,0.001,0.002,-0.0123,0,0,1
F(H1)=FEAT/CIRCLE,INNER,CART,10,20,0,0,0,1,8.0
FA(H1)=FEAT/CIRCLE,INNER,CART,10.011,19.995,0,0,0,$
1,8.012
ENDFIL
"""
QIF = """\
<?xml version="1.0"?>
<QIFDocument versionQIF="3.0.0" idMax="9" xmlns="http://qifstandards.org/xsd/qif3">
 <FileUnits><PrimaryUnits><LinearUnit><SIUnitName>meter</SIUnitName>
  <UnitName>inch</UnitName><UnitConversion><Factor>0.0254</Factor></UnitConversion>
 </LinearUnit></PrimaryUnits></FileUnits>
 <Features>
  <FeatureDefinitions n="2">
   <PointFeatureDefinition id="1"/>
   <CircleFeatureDefinition id="2"><Diameter>0.5</Diameter></CircleFeatureDefinition>
  </FeatureDefinitions>
  <FeatureNominals n="2">
   <PointFeatureNominal id="3"><FeatureDefinitionId>1</FeatureDefinitionId>
    <Location>1 2 0</Location><Normal>0 0 1</Normal></PointFeatureNominal>
   <CircleFeatureNominal id="4"><FeatureDefinitionId>2</FeatureDefinitionId>
    <Location>3 1 0</Location><Normal>0 0 1</Normal></CircleFeatureNominal>
  </FeatureNominals>
  <FeatureItems n="2">
   <PointFeatureItem id="5"><FeatureNominalId>3</FeatureNominalId>
    <FeatureName>TOP</FeatureName></PointFeatureItem>
   <CircleFeatureItem id="6"><FeatureNominalId>4</FeatureNominalId>
    <FeatureName>BORE</FeatureName></CircleFeatureItem>
  </FeatureItems>
 </Features>
 <Results><MeasurementResultsSet n="1"><MeasurementResults id="7"><MeasuredFeatures n="2">
  <PointFeatureMeasurement id="8"><FeatureItemId>5</FeatureItemId>
   <Location>1.0 2.0 0.001</Location></PointFeatureMeasurement>
  <CircleFeatureMeasurement id="9"><FeatureItemId>6</FeatureItemId>
   <Location>3.001 1 0</Location><Normal>0 0 1</Normal><Diameter>0.501</Diameter>
  </CircleFeatureMeasurement>
 </MeasuredFeatures></MeasurementResults></MeasurementResultsSet></Results>
</QIFDocument>
"""
CMM = """\
Name;Nom X;Nom Y;Nom Z;I;J;K;Meas X;Meas Y;Meas Z
P1;0,0;0,0;0,0;0;0;1;0,0;0,0;-0,0123
P2;5,0;0,0;0,0;0;0;1;5,0;0,0;0,0045
"""
HOLES = """\
Name;Nom X (mm);Nom Y (mm);Meas X (mm);Meas Y (mm);Nominal Diameter (mm);Measured Diameter (mm)
H1;10,0;20,0;10,011;19,995;8,0;8,012
H2;30,0;20,0;30,013;19,991;8,0;8,011
H3;10,0;60,0;10,012;59,992;8,0;8,010
"""
PLY = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n" + (
    "property float z\nend_header\n-2 -2 0.004\n5 3 0.005\n2 4 -0.001\n6 -3 0\n"
)
XYZ = "# x y z\n-2 -2 0.004\n5.0 3.0 0.005\n2,4,-0.001\n6;-3;0\n"
LINUXCNC = {
    "joints.ini": "[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = 0\n",
    "x.comp": "-300 -299.998 -299.999\n0 0.002 0.001\n",
}

CEC = """\
%_N_NC_CEC_INI
CHANDATA(1)
$AN_CEC[0,0]=-0.001
$AN_CEC[0,1]=-0.003
$AN_CEC[0,2]=0.002
$AN_CEC_INPUT_AXIS[0]=(X1)
$AN_CEC_OUTPUT_AXIS[0]=(Z1)
$AN_CEC_STEP[0]=100.0
$AN_CEC_MIN[0]=-200.0
$AN_CEC_MAX[0]=0.0
$AN_CEC_DIRECTION[0]=0
$AN_CEC_MULT_BY_TABLE[0]=0
$AN_CEC_IS_MODULO[0]=0
M17
"""
ENC = """\
%_N_AX_EEC_INI
CHANDATA(1)
$AA_ENC_COMP[0,0,X1]=0.001
$AA_ENC_COMP[0,1,X1]=0.004
$AA_ENC_COMP_STEP[0,X1]=300.0
$AA_ENC_COMP_MIN[0,X1]=-300.0
$AA_ENC_COMP_MAX[0,X1]=0.0
M17
"""
HEIDENHAIN = {
    "CONFIG.CMA": "BEGIN CONFIG.CMA\nNR ACTIVE X Y Z\n0 * XERR.COM - -\n[END]\n",
    "XERR.COM": "BEGIN XERR.COM MM\nNR AXISPOS BACKLASH X Y\n0 -300 0.001 0.002 0.000\n"
    "1 0 0.003 0.004 0.001\n[END]\n",
}
ISG_TABLES = {
    "volcomp.lis": "chain xyz\nchain XYZ\nworkpiece_axes 0\nfile[0] volcomp.csv\n",
    "volcomp.csv": "// mm, rad\nX EXX EBX\n-300 0.001 0.00001\n0 0.002 0.00002\n#\nC0Y\n0.00003\n",
}
COMPONENTS = {
    "chain.json": '{"order": "XYZ", "squareness_rad": {"EC0Y": 3e-05}, "tables": ["EXX"]}\n',
    "EXX.csv": "position_mm,forward_um,backward_um\n-300,1.0,2.0\n0,3.0,4.0\n",
}
#: what lies in the folder beside the file that is imported
BESIDE = {**LINUXCNC, **HEIDENHAIN, **ISG_TABLES, **COMPONENTS}

#: answers that a person would give
_BALLBAR = {"centre": "-200 -150 -150", "radius": "100", "tool_length": "150"}
_DRIFT = {"at": "-200 -150 -150", "tool_length": "150"}


@dataclass(frozen=True)
class Sample:
    """A file of one kind; `entry` is the one to import where it is not that one."""

    kind: str
    file: str
    text: str
    answers: dict[str, str] = field(default_factory=dict)
    entry: str = ""

    def write(self, folder: Path, text: str | None = None) -> Path:
        """Write it, or another text in its place, and what lies beside it; the path to import."""
        for name, other in BESIDE.items():
            (folder / name).write_text(other, encoding="utf-8")
        content = self.text if text is None else text
        (folder / self.file).write_bytes(content.encode("utf-8", "replace"))
        return folder / (self.entry or self.file)


SAMPLES = (
    Sample("laser", "x.csv", LASER, {"error": "EXX"}),
    Sample("renishaw_rtl", "x.rtl", RTL),
    Sample("pcdmis", "plate.txt", PCDMIS),
    Sample("ballbar", "ballbar.csv", BALLBAR, _BALLBAR),
    Sample("ballbar_report", "qc20.b5r", BALLBAR_REPORT, {"angle": "more"}),
    Sample("drift", "drift.txt", DRIFT, _DRIFT),
    Sample("volumetric", "etalon.txt", ETALON),
    Sample("volumetric", "isg.csv", ISG),
    Sample("probe_log", "probe.txt", PROBE_LOG, {"ball_mm": "2"}),
    Sample("dmis", "part.dmo", DMIS),
    Sample("qif", "part.qif", QIF),
    Sample("cmm_table", "cmm.csv", CMM),
    Sample("cmm_table", "holes.csv", HOLES),
    Sample("scan", "scan.ply", PLY),
    Sample("scan", "scan.xyz", XYZ),
    Sample("controller_tables", "joints.ini", LINUXCNC["joints.ini"]),
    Sample("controller_tables", "x.comp", LINUXCNC["x.comp"], entry="joints.ini"),
    Sample("controller_tables", "NC_CEC.INI", CEC),
    Sample("controller_tables", "AX_EEC.INI", ENC),
    Sample("controller_tables", "XERR.COM", HEIDENHAIN["XERR.COM"], entry="CONFIG.CMA"),
    Sample("controller_tables", "CONFIG.CMA", HEIDENHAIN["CONFIG.CMA"]),
    Sample("controller_tables", "volcomp.csv", ISG_TABLES["volcomp.csv"], entry="volcomp.lis"),
    Sample("controller_tables", "EXX.csv", COMPONENTS["EXX.csv"], entry="chain.json"),
    Sample("controller_tables", "chain.json", COMPONENTS["chain.json"]),
)


def write_plate(path: Path) -> None:
    """A plate of 40 x 30 x 10 mm as STL, its top at Z 0, the middle of it at X 0 Y 0."""
    import trimesh

    plate = trimesh.creation.box((40.0, 30.0, 10.0))
    plate.apply_translation((0.0, 0.0, -5.0))
    plate.export(path)


def write_plate_job(folder: Path) -> Path:
    """A job whose nominal CAD is the plate."""
    job = write_job(folder)
    write_plate(folder / "plate.stl")
    text = job.read_text().replace(
        'program = "part.nc"', 'program = "part.nc"\nnominal = "plate.stl"'
    )
    job.write_text(text)
    return job
