"""Files of compensation tables written by hand, with the correction that they mean; bad files."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vmach.controller_tables import FORMATS, table_formats
from vmach.controller_tables.formats.components import read_components, write_components
from vmach.controller_tables.formats.grid import read_grid, write_grid
from vmach.controller_tables.formats.heidenhain import read_heidenhain, write_heidenhain
from vmach.controller_tables.formats.isg import read_isg, write_isg
from vmach.controller_tables.formats.linuxcnc import read_linuxcnc, write_linuxcnc
from vmach.controller_tables.formats.sinumerik_cec import read_cec, write_cec
from vmach.controller_tables.formats.sinumerik_enc import read_enc_comp, write_enc_comp
from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term, scaled
from vmach.errors import InputError
from vmach.files import plugins
from vmach.machine.files.volumetric_file import read_volumetric_file
from vmach.machine.tables.error_table import RAD_PER, read_error_table

NO_TOOL = np.zeros(3)
FORWARD, BACKWARD = np.ones((1, 3)), -np.ones((1, 3))


def correction_um(read, place, direction=FORWARD, tool=NO_TOOL):
    nose = np.array([place], dtype=float)
    return 1e3 * read.applied_correction(nose, direction, np.asarray(tool, dtype=float))[0]


# --- LinuxCNC ------------------------------------------------------------------------------


def linuxcnc_files(folder, rows, file_type):
    (folder / "x.comp").write_text(rows)
    (folder / "joints.ini").write_text(
        f"[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = {file_type}\n"
    )
    return folder


def test_linuxcnc_type_0_is_actual_positions_and_goes_the_other_way(tmp_path):
    # at 100 the joint stops 10 um too far moving up, 4 um short moving down
    rows = "0 0 0\n100 100.010 99.996\n"
    read = read_linuxcnc(linuxcnc_files(tmp_path, rows, 0))
    assert correction_um(read, [100, 5, 5]) == pytest.approx([-10, 0, 0])
    assert correction_um(read, [100, 5, 5], BACKWARD) == pytest.approx([4, 0, 0])
    assert correction_um(read, [50, 5, 5]) == pytest.approx([-5, 0, 0])
    assert correction_um(read, [900, 5, 5]) == pytest.approx([-10, 0, 0])  # held
    assert correction_um(read, [-900, 5, 5]) == pytest.approx([0, 0, 0])


def test_linuxcnc_type_1_is_trims_that_are_added(tmp_path):
    read = read_linuxcnc(linuxcnc_files(tmp_path, "0 0 0\n100 -0.010 0.004\n", 1))
    assert correction_um(read, [100, 5, 5]) == pytest.approx([-10, 0, 0])
    assert correction_um(read, [100, 5, 5], BACKWARD) == pytest.approx([4, 0, 0])


def test_linuxcnc_reads_no_further_than_a_comment(tmp_path):
    rows = "0 0 0\n100 0.001 0.001\n# the end\n200 9 9\n"
    read = read_linuxcnc(linuxcnc_files(tmp_path, rows, 1))
    assert correction_um(read, [200, 0, 0]) == pytest.approx([1, 0, 0])
    (told,) = read.unread
    assert told.startswith("x.comp:4: 1 entry below line 3 left out: LinuxCNC stops reading")


def test_linuxcnc_files_that_are_read_to_their_end_leave_nothing_out(tmp_path):
    rows = "0 0 0\n100 0.001 0.001\n\n# of 3 points 100 mm apart\n1 is X\n"
    assert read_linuxcnc(linuxcnc_files(tmp_path, rows, 1)).unread == ()


@pytest.mark.parametrize(
    ("rows", "file_type", "line"),
    [
        ("0 0 0\n100 100.010 99.996\n", 1, 2),  # actual positions, told as trims
        ("0 0 0\n5 0.001 0\n200 0.001 0.002\n", 0, 3),  # trims, told as actual positions
    ],
)
def test_linuxcnc_entries_of_the_other_type_are_told_with_their_line(
    rows, file_type, line, tmp_path
):
    with pytest.raises(InputError, match=f"COMP_FILE_TYPE = {file_type}") as told:
        read_linuxcnc(linuxcnc_files(tmp_path, rows, file_type))
    assert (told.value.file.name, told.value.line) == ("x.comp", line)
    assert f"type {1 - file_type} is: nominal" in str(told.value)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("# head\n0 0 0\n", "0 entries.*hint: LinuxCNC stops reading"),
        ("0 0 0\n0 1 1\n", "does not increase"),
        ("".join(f"{k} 0 0\n" for k in range(257)), "257 entries"),
    ],
)
def test_linuxcnc_files_that_the_control_would_not_take(tmp_path, rows, message):
    with pytest.raises(InputError, match=message):
        read_linuxcnc(linuxcnc_files(tmp_path, rows, 1))


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ("0 0 0\n100 100.01\n200 200 200\n", 2),  # a cell is missing
        ("0 0 0\n100 100 100\n200 200,01 200\n300 300 300\n", 3),
        ("0 nan 0\n100 100 100\n", 1),
    ],
)
def test_linuxcnc_entry_that_would_cut_the_table_short_is_refused(tmp_path, rows, line):
    with pytest.raises(InputError, match="is no entry") as told:
        read_linuxcnc(linuxcnc_files(tmp_path, rows, 0))
    assert (told.value.file.name, told.value.line) == ("x.comp", line)


def test_linuxcnc_keys_of_a_joint_may_stand_in_any_order(tmp_path):
    # LinuxCNC looks keys up by section; without COMP_FILE_TYPE it takes 0
    linuxcnc_files(tmp_path, "0 0 0\n100 100.010 100.010\n", 0)
    (tmp_path / "y.comp").write_text("0 0 0\n100 100.070 100.070\n")
    (tmp_path / "z.comp").write_text("0 0 0\n100 0.003 0.003\n")
    (tmp_path / "joints.ini").write_text(
        "[JOINT_0]\nCOMP_FILE = x.comp\n"
        "[JOINT_1]\nCOMP_FILE_TYPE = 0\nCOMP_FILE = y.comp\n"
        "[JOINT_2]\nCOMP_FILE_TYPE = 1\nCOMP_FILE = z.comp\n"
        "[AXIS_X]\nCOMP_FILE = none.comp\n"
    )
    read = read_linuxcnc(tmp_path)
    assert correction_um(read, [100, 100, 100]) == pytest.approx([-10, -70, 3])


@pytest.mark.parametrize(
    ("ini", "line", "message"),
    [
        ("[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = one\n", 3, "COMP_FILE_TYPE is 'one'"),
        ("[JOINT_0]\nCOMP_FILE_TYPE = 2\nCOMP_FILE = x.comp\n", 2, "COMP_FILE_TYPE is '2'"),
        ("[JOINT_3]\nCOMP_FILE = x.comp\n", 1, "JOINT_3"),
        ("[TRAJ]\nLINEAR_UNITS = inch\n[JOINT_0]\nCOMP_FILE = x.comp\n", 2, "inch"),
    ],
)
def test_linuxcnc_ini_that_no_axis_in_mm_can_have(tmp_path, ini, line, message):
    linuxcnc_files(tmp_path, "0 0 0\n1 1 1\n", 0)
    (tmp_path / "joints.ini").write_text(ini)
    with pytest.raises(InputError, match=message) as told:
        read_linuxcnc(tmp_path)
    assert (told.value.file.name, told.value.line) == ("joints.ini", line)


# --- SINUMERIK -----------------------------------------------------------------------------

CEC = """%_N_NC_CEC_INI
CHANDATA(1)
$AN_CEC[0,0]=0.000 ; Z follows X
$AN_CEC[0,1]=0.010
$AN_CEC[0,2]=-0.004
$AN_CEC_INPUT_AXIS[0]=(X1)
$AN_CEC_OUTPUT_AXIS[0]=(Z1)
$AN_CEC_STEP[0]=50.0
$AN_CEC_MIN[0]=-100.0
$AN_CEC_MAX[0]=0.0
$AN_CEC_DIRECTION[0]=1
$AN_CEC_MULT_BY_TABLE[0]=2
$AN_CEC_IS_MODULO[0]=0
$AN_CEC[1,0]=0.0
$AN_CEC[1,1]=0.5
$AN_CEC_INPUT_AXIS[1]=(Y1)
$AN_CEC_OUTPUT_AXIS[1]=(Z1)
$AN_CEC_STEP[1]=100.0
$AN_CEC_MIN[1]=0.0
$AN_CEC_MAX[1]=100.0
$AN_CEC_DIRECTION[1]=0
$AN_CEC_MULT_BY_TABLE[1]=0
$AN_CEC_IS_MODULO[1]=0
M17
"""


def test_cec_by_hand(tmp_path):
    (tmp_path / "NC_CEC.INI").write_text(CEC)
    read = read_cec(tmp_path)
    assert correction_um(read, [-50, 0, 0]) == pytest.approx([0, 0, 10])
    assert correction_um(read, [-25, 0, 0]) == pytest.approx([0, 0, 3])
    assert correction_um(read, [-50, 0, 0], BACKWARD) == pytest.approx([0, 0, 0])
    # own values of both tables, and their product: 10 + 500 + 10 x 0.5
    assert correction_um(read, [-50, 100, 0]) == pytest.approx([0, 0, 515])
    assert correction_um(read, [5, 0, 0]) == pytest.approx([0, 0, -4])  # held
    error = read_cec(tmp_path, entries="error")
    assert correction_um(error, [-50, 100, 0]) == pytest.approx([0, 0, -515])


def test_cec_product_tables_are_taken_out_again(tmp_path):
    """X moved by a(Y) z: only the product may remain of the two tables that make it."""
    knots = tuple(Knots.over(*ends, 4) for ends in ((-100, 0), (0, 200), (-400, 0)))
    values = np.array([0.0, 0.002, -0.005, 0.001, 0.003])
    product = AxisTable(Term(1, 0, factor_axis=2), knots[1].position_mm, values, values)
    write_cec(tmp_path, [product], knots)
    read = read_cec(tmp_path)
    assert any(int(table.settings["MULT_BY_TABLE"]) for table in read.tables.values())
    assert "and products of two positions" in (tmp_path / "NC_CEC.INI").read_text()
    plain = AxisTable(Term(1, 0), knots[1].position_mm, values, values)
    (tmp_path / "plain").mkdir()
    (path,) = write_cec(tmp_path / "plain", [plain], knots)
    assert "products" not in path.read_text()
    assert "; does not hold: angles beyond their mean" in path.read_text()
    rng = np.random.default_rng(1)
    nose = np.column_stack([rng.uniform(*ends, 50) for ends in ((-100, 0), (0, 200), (-400, 0))])
    expected = np.interp(nose[:, 1], knots[1].position_mm, values) * (1 + nose[:, 2] / 200.0)
    found = read.applied_correction(nose, np.zeros((50, 3)), NO_TOOL)
    assert scaled(knots[2], np.array([-400.0, 0.0])) == pytest.approx([-1, 1])
    assert found[:, 0] == pytest.approx(expected, abs=2e-7)
    assert not found[:, 1:].any()


def test_enc_comp_moves_against_a_positive_value(tmp_path):
    (tmp_path / "AX_EEC.INI").write_text(
        "%_N_AX_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,X1]=0.003\n$AA_ENC_COMP[0,1,X1]=0.010\n"
        "$AA_ENC_COMP_STEP[0,X1]=1.0\n$AA_ENC_COMP_MIN[0,X1]=-200.0\n"
        "$AA_ENC_COMP_MAX[0,X1]=-199.0\n$AA_ENC_COMP_IS_MODULO[0,X1]=0\nM17\n"
    )
    read = read_enc_comp(tmp_path)
    assert correction_um(read, [-199, 1, 1]) == pytest.approx([-10, 0, 0])
    assert correction_um(read, [-199.5, 1, 1], BACKWARD) == pytest.approx([-6.5, 0, 0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("STEP[0]=50.0", "STEP[0]=25.0", "3 entries for -100 .. 0 mm"),
        ("$AN_CEC_MAX[0]=0.0\n", "", "no MAX"),
        ("$AN_CEC[0,1]=", "$AN_SEC[0,1]=", "no line of a compensation table"),
    ],
)
def test_bad_cec_files(tmp_path, old, new, message):
    (tmp_path / "NC_CEC.INI").write_text(CEC.replace(old, new))
    with pytest.raises(InputError, match=message):
        read_cec(tmp_path)


ENC = """$AA_ENC_COMP[0,0,X1]=0.010
$AA_ENC_COMP[0,1,X1]=0.020
$AA_ENC_COMP[0,2,X1]=0.030
$AA_ENC_COMP_STEP[0,X1]=250.0
$AA_ENC_COMP_MIN[0,X1]=-500.0
$AA_ENC_COMP_MAX[0,X1]=0.0
$AA_ENC_COMP_IS_MODULO[0,X1]=0
"""


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("[0,0,X1]", "[0,3,X1]", 1, "no entry 0"),  # numbered 1 .. 3
        ("[0,2,X1]", "[0,1,X1]", 3, "entry 1 stands here a second time"),
        ("STEP[0,X1]=250.0", "STEP[0,X1]=0.0", 1, "STEP 0.0"),
        ("MODULO[0,X1]=0", "MODULO[0,X1]=1", 7, "IS_MODULO is 1"),
    ],
)
def test_encoder_table_that_cannot_be_placed_is_refused(tmp_path, old, new, line, message):
    (tmp_path / "AX_EEC.INI").write_text(ENC)
    assert correction_um(read_enc_comp(tmp_path), [-500, 0, 0]) == pytest.approx([-10, 0, 0])
    (tmp_path / "AX_EEC.INI").write_text(ENC.replace(old, new))
    with pytest.raises(InputError, match=message) as told:
        read_enc_comp(tmp_path)
    assert told.value.line == line


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("DIRECTION[0]=1", "DIRECTION[0]=2", "DIRECTION is 2"),
        ("OUTPUT_AXIS[0]=(", "OUTPUT_AXIS[0]=(A", "OUTPUT_AXIS is .*begins with X, Y or Z"),
    ],
)
def test_cec_of_a_direction_or_an_axis_that_is_not_read_is_refused(tmp_path, old, new, message):
    (tmp_path / "NC_CEC.INI").write_text(CEC.replace(old, new))
    with pytest.raises(InputError, match=message) as told:
        read_cec(tmp_path)
    assert new in CEC.replace(old, new).splitlines()[told.value.line - 1]


# --- HEIDENHAIN ----------------------------------------------------------------------------


def heidenhain_files(folder, com):
    (folder / "CONFIG.CMA").write_text(
        "BEGIN CONFIG.CMA\nNR ACTIVE X Y Z\n0 - OLD.COM - -\n1 * - YERR.COM -\n[END]\n"
    )
    (folder / "YERR.COM").write_text(com)
    return folder


COM = """BEGIN YERR.COM MM
NR AXISPOS BACKLASH Y Z
0 -90.0 0.000 0.000 0.000
1 -40.0 0.016 0.010 -0.020
2 10.0 0.000 0.000 0.000
[END]
"""


def test_heidenhain_table_in_inches_is_refused(tmp_path):
    folder = heidenhain_files(tmp_path, COM.replace("YERR.COM MM", "YERR.COM INCH"))
    with pytest.raises(InputError, match=r"YERR\.COM INCH") as told:
        read_heidenhain(folder)
    assert (told.value.file.name, told.value.line) == ("YERR.COM", 1)


def test_heidenhain_backlash_without_the_errors_of_its_axis_is_refused(tmp_path):
    alone = COM.replace(" Y ", " X ", 1)
    assert alone != COM
    folder = heidenhain_files(tmp_path, alone)
    with pytest.raises(InputError, match="BACKLASH without a column Y") as told:
        read_heidenhain(folder)
    assert (told.value.file.name, told.value.line) == ("YERR.COM", 2)


def test_heidenhain_y_and_z_follow_y(tmp_path):
    read = read_heidenhain(heidenhain_files(tmp_path, COM))
    assert correction_um(read, [0, -40, 0]) == pytest.approx([0, -10, 20])
    assert correction_um(read, [0, -40, 0], BACKWARD) == pytest.approx([0, -16, 20])
    assert correction_um(read, [0, -15, 0]) == pytest.approx([0, -5, 10])
    assert correction_um(read, [0, 99, 0]) == pytest.approx([0, 0, 0])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("2 10.0 0.000 0.000 0.000\n", "2 10.0 0.000\n", "3 cells"),
        ("-40.0", "forty", "no number"),
        ("2 10.0", "2 -95.0", "AXISPOS increasing"),
        ("[END]\n", "", r"\[END\]"),
    ],
)
def test_bad_heidenhain_tables(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message):
        read_heidenhain(heidenhain_files(tmp_path, COM.replace(old, new)))


# --- ISG and our own forms -----------------------------------------------------------------

VOLCOMP = """// by hand
X EXX EBX
-100.0 0.000 0.00001
0.0 0.010 0.00001
#
C0Y
0.00002
"""


def isg_files(folder, text=VOLCOMP, order="XYZ"):
    (folder / "volcomp.csv").write_text(text)
    (folder / "volcomp_tool.csv").write_text("N0X N0Y N0Z\n0 0 -1\n")
    (folder / "volcomp.lis").write_text(
        f"chain {order}\nworkpiece_axes 0\nfile[0] volcomp.csv\nfile[1] volcomp_tool.csv\n"
    )
    return folder


def test_isg_arms_reach_from_the_axis_to_the_tip(tmp_path):
    """EBX turns what X carries: Y, Z and the tool. x moves by 10 urad times z, z by nothing."""
    read = read_isg(isg_files(tmp_path))
    tool = [0, 0, -150]
    expected = [-(5.0 + 1e-2 * (-300 - 150) - 2e-2 * 50), 0, 0]
    assert correction_um(read, [-50, 50, -300], tool=tool) == pytest.approx(expected, abs=1e-4)


def test_isg_order_of_the_chain_counts(tmp_path):
    """With X nearest the tool only the tool hangs on its angle."""
    read = read_isg(isg_files(tmp_path, order="ZYX"))
    expected = [-(5.0 + 1e-2 * -150 - 2e-2 * 50), 0, 0]
    found = correction_um(read, [-50, 50, -300], tool=[0, 0, -150])
    assert found == pytest.approx(expected, abs=1e-4)


def test_isg_bad_files(tmp_path):
    with pytest.raises(InputError, match="rows of 3 numbers"):
        read_isg(isg_files(tmp_path, VOLCOMP.replace("0.0 0.010 0.00001", "0.0 0.010")))
    isg_files(tmp_path)
    (tmp_path / "volcomp_tool.csv").write_text("N0X N0Y N0Z\n1 0 0\n")
    with pytest.raises(InputError, match="0 0 -1"):
        read_isg(tmp_path)


def test_two_readers_agree_on_an_isg_file(tmp_path):
    """The machine file's reader of this format was written apart from this one."""
    read = read_isg(isg_files(tmp_path))
    other = read_volumetric_file(tmp_path / "volcomp.csv", "isg-csv")
    assert other.squareness_rad == read.squareness_rad == {"EC0Y": 2e-5}
    assert other.tables.keys() == read.tables.keys()
    for name, (position, value) in other.tables.items():
        assert np.array_equal(position, read.tables[name][0])
        assert np.array_equal(value, read.tables[name][1])


def test_component_tables_by_hand(tmp_path):
    (tmp_path / "chain.json").write_text(
        '{"order": "XYZ", "squareness_rad": {}, "tables": ["EYX", "EAZ"]}'
    )
    (tmp_path / "EYX.csv").write_text(
        "# straightness\nposition_mm,forward_um,backward_um\n0,0,0\n100,8,2\n"
    )
    (tmp_path / "EAZ.csv").write_text("position_mm,forward_urad,backward_urad\n0,10,10\n9,10,10\n")
    (tmp_path / "EXX.csv").write_text("left by another run")
    read = read_components(tmp_path)
    tool = [0, 0, -100]  # EAZ about X: the tip, 100 below, goes to +y by 1 um
    assert correction_um(read, [50, 0, 0], tool=tool) == pytest.approx([0, -5, 0], abs=1e-4)
    found = correction_um(read, [50, 0, 0], BACKWARD, tool=tool)
    assert found == pytest.approx([0, -2, 0], abs=1e-4)


def test_component_tables_are_error_tables_of_a_machine_file(tmp_path):
    table = (np.array([0.0, 10.0]), np.array([1e-6, 2e-6]), np.array([1e-6, 3e-6]))
    write_components(tmp_path, _chain({"EAX": table}))
    other = read_error_table(tmp_path / "EAX.csv", RAD_PER, "arcsec")
    assert other.forward == pytest.approx(table[1])
    assert other.backward == pytest.approx(table[2])


def test_grid_by_hand(tmp_path):
    lines = ["x_mm,y_mm,z_mm,dx_um,dy_um,dz_um"]
    lines += [
        f"{x},{y},{z},{x * y},{z},0" for z in (0, 1) for y in (0, 2) for x in (0, 4)
    ]  # rows in another order than written
    (tmp_path / "grid.csv").write_text("\n".join(lines))
    read = read_grid(tmp_path)
    assert correction_um(read, [4, 2, 1]) == pytest.approx([-8, -1, 0])
    assert correction_um(read, [1, 1, 0.5]) == pytest.approx([-1, -0.5, 0])
    assert correction_um(read, [9, 9, 9]) == pytest.approx([-8, -1, 0])
    (tmp_path / "grid.csv").write_text("\n".join(lines[:-1]))
    with pytest.raises(InputError, match="7 rows for 8 grid points"):
        read_grid(tmp_path)


# --- written and read back -----------------------------------------------------------------


def _chain(tables):
    from vmach.controller_tables.rigid_chain import RigidChain

    return RigidChain("YXZ", tables, {"EB0Z": 1.2e-5})


def random_tables(rng, terms, knots):
    found = []
    for term in terms:
        position = knots[term.input_axis].position_mm
        forward = np.round(rng.uniform(-0.05, 0.05, len(position)), 6)
        backward = np.round(rng.uniform(-0.05, 0.05, len(position)), 6)
        found.append(AxisTable(term, position, forward, backward if term.by_direction else forward))
    return found


KNOTS = tuple(Knots.over(*ends, n) for ends, n in (((-760.0, 0), 7), ((-3, 461), 6), ((0, 99), 5)))
OWN = [Term(k, k, True) for k in range(3)]
CROSS = [Term(j, i, i == j) for i in range(3) for j in range(3)]


def expected_correction(tables, nose, direction):
    found = np.zeros_like(nose)
    for table in tables:
        j, i = table.term.input_axis, table.term.output_axis
        forward, backward = (
            np.interp(nose[:, j], table.position_mm, values)
            for values in (table.forward_mm, table.backward_mm)
        )
        found[:, i] += np.where(direction[:, j] > 0, forward, backward)
    return found


@pytest.mark.parametrize(
    ("write", "read", "terms"),
    [
        (lambda f, t: write_linuxcnc(f, t, file_type=0), read_linuxcnc, OWN),
        (lambda f, t: write_linuxcnc(f, t, file_type=1), read_linuxcnc, OWN),
        (write_enc_comp, read_enc_comp, [Term(k, k) for k in range(3)]),
        (lambda f, t: write_cec(f, t, KNOTS), read_cec, [Term(j, i, True) for i in (0, 1, 2)
                                                         for j in (0, 1, 2)]),
        (lambda f, t: write_cec(f, t, KNOTS, entries="error"),
         lambda f: read_cec(f, entries="error"), CROSS),
        (write_heidenhain, read_heidenhain, CROSS),
    ],
)  # fmt: skip
def test_what_is_read_back_is_what_was_written(tmp_path, write, read, terms):
    rng = np.random.default_rng(7)
    tables = random_tables(rng, terms, KNOTS)
    write(tmp_path, tables)
    nose = rng.uniform([-800, -10, -5], [10, 480, 110], (300, 3))
    direction = rng.choice([-1.0, 1.0], (300, 3))
    found = read(tmp_path).applied_correction(nose, direction, NO_TOOL)
    assert found == pytest.approx(expected_correction(tables, nose, direction), abs=1e-9)


def test_model_forms_come_back_digit_by_digit(tmp_path):
    rng = np.random.default_rng(3)
    position = KNOTS[0].position_mm
    tables = {
        "EYX": (position, *np.round(rng.uniform(-0.02, 0.02, (2, 8)), 7)),
        "ECX": (position, *np.round(rng.uniform(-2e-5, 2e-5, (2, 8)), 10)),
    }
    for write, read, name in (
        (write_isg, read_isg, "volcomp.csv"), (write_components, read_components, "EYX.csv"),
    ):  # fmt: skip
        first, again = tmp_path / f"{name}1", tmp_path / f"{name}2"
        first.mkdir()
        again.mkdir()
        write(first, _chain(tables))
        back = read(first)
        write(again, back)
        for path in first.iterdir():
            assert (again / path.name).read_bytes() == path.read_bytes()
        assert back.order == "YXZ"
        assert back.squareness_rad == {"EB0Z": 1.2e-5}
    assert back.tables["ECX"][2] == pytest.approx(tables["ECX"][2], abs=1e-10)
    assert back.tables["EYX"][1] == pytest.approx(tables["EYX"][1], abs=1e-7)


def test_grid_comes_back_digit_by_digit(tmp_path):
    lines = ["x_mm,y_mm,z_mm,dx_um,dy_um,dz_um"]
    rng = np.random.default_rng(5)
    for x in (-10.5, 0.0, 7.25):
        for y in (1.0, 2.0):
            lines += [
                f"{x:.4f},{y:.4f},{z:.4f}," + ",".join(f"{v:.4f}" for v in rng.uniform(-9, 9, 3))
                for z in (-3.0, 4.0)
            ]
    (tmp_path / "grid.csv").write_text("\n".join(lines) + "\n")
    written = write_grid(tmp_path, read_grid(tmp_path), tool_length_mm=120.0)[0].read_text()
    assert [line for line in written.splitlines() if line[0] != "#"] == lines
    assert "tool length 120.0000 mm" in written


@pytest.mark.parametrize(
    "wrong", [{"name": "My grid"}, {"rank": "5"}, {"holds": ""}, {"most_entries": 1}, {"read": 3}]
)
def test_a_format_says_what_it_has_to(wrong):
    key = next(iter(wrong))
    with pytest.raises(InputError, match=f"table format .*: {key} = "):
        replace(FORMATS["grid"], **wrong)


def test_a_format_of_another_package_is_found_and_checked(monkeypatch):
    mine = replace(FORMATS["grid"], name="mine", rank=5)

    class Entry:
        name, value, group, module, dist = (
            "mine",
            "shop:FORMATS",
            "vmach.table_formats",
            "shop",
            None,
        )

        def __init__(self, offered):
            self.load = lambda: offered

    monkeypatch.setattr(plugins, "entry_points", lambda group: [Entry((mine,))])
    assert next(iter(table_formats._catalogue())) == "mine"
    for offered, message in ((mine, "accepted: FORMATS"), ((FORMATS["grid"],), "'grid' is taken")):
        entries = [Entry(offered)]
        monkeypatch.setattr(plugins, "entry_points", lambda group, found=entries: found)
        with pytest.raises(InputError, match=message):
            table_formats._catalogue()
