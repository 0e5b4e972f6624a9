"""What a machine's builder made: the job says it, or it is refused once, all together."""

import pytest

from gcode import ControlSettings, ProgramError, Source, ToolEntry, read_program
from tests.small_job import write_job
from vmach.errors import InputError
from vmach.job import read_job

TOOLS = {1: ToolEntry(100.0, 10.0)}


def read(text, dialect, **control):
    source = Source(text.encode(), f"part.{dialect}")
    return read_program(source, tools=TOOLS, dialect=dialect, home_mm=(0, 0, 500),
                        control=ControlSettings(**control))  # fmt: skip


SINUMERIK = """T1 D1 M6
L_OPEN(1)
IF _READY==1
G0 X=$MN_USER_DATA_INT[3]+_ZERO[1]
ENDIF
M303
_STEP=2.5
G0 Y=_STEP*2
CLAMP
M30
"""


def test_all_that_is_missing_is_said_at_once():
    with pytest.raises(ProgramError) as error:
        read(SINUMERIK, "sinumerik")
    said = str(error.value)
    assert "subprograms L_OPEN, CLAMP; variables _READY, $MN_USER_DATA_INT[3], _ZERO[1]" in said
    assert "M codes M303" in said
    assert "ignore_calls = ['L_OPEN', 'CLAMP'], if they move nothing" in said
    assert "'$MN_USER_DATA_INT[3]' = ..." in said
    assert "_STEP" not in said


def test_the_name_of_the_program_is_no_variable():
    with pytest.raises(ProgramError) as error:
        read("%_N_part_7_MPF\nG0 X=_AWAY\nM30\n", "sinumerik")
    assert "variables _AWAY:" in str(error.value)


@pytest.mark.parametrize(("body", "said"), [
    ("DIAMON", r"DIAMON \(diameters: a turning program\)"),
    ("PRESETON(X,0)", r"PRESETON \(another place for the axis\)"),
    ("CYCLE95(1)", "CYCLE95 is a cycle of turning programs"),
    ("G33 Z-9 K1", "G33 is not read.*of turning programs"),
    ("E_MI_PL(1)", r"E_MI_PL \(a work step of ShopMill\)"),
    ("CYCLE802(1,2)", r"CYCLE802 \(a list of places\)"),
])  # fmt: skip
def test_what_the_control_itself_has_is_no_word_of_the_builder(body, said):
    with pytest.raises(ProgramError, match=said):
        read(f"G0 X0\n{body}\nM30\n", "sinumerik")


def test_a_semicolon_in_a_text_begins_no_comment():
    program = read('T1 M6 ; the mill\nMSG("T1; MILL") ; "10\nG0 X7\nM30\n', "sinumerik")
    assert program.moves.end_mm[-1, 0] == 7


def test_what_the_job_says_is_obeyed():
    program = read(
        SINUMERIK,
        "sinumerik",
        ignore_m=frozenset((303,)),
        ignore_calls=frozenset(("l_open", "CLAMP")),
        variables={"_READY": 1, "$MN_USER_DATA_INT[ 3 ]": 20.0, "_ZERO[1]": 7.0},
    )
    assert program.moves.end_mm[-1, :2].tolist() == [27.0, 5.0]
    noted = {note.word for note in program.notes}
    assert {"L_OPEN", "CLAMP", "M303", "_STEP"} <= noted


def test_a_cycle_that_cuts_is_not_offered_to_be_left_out():
    with pytest.raises(ProgramError) as error:
        read("L_OPEN\nCYCLE60(1)\nCYCLE977(1)\nM30", "sinumerik")
    assert "ignore_calls = ['L_OPEN', 'CYCLE977']" in str(error.value)


def test_a_name_without_an_underscore_is_no_variable_of_the_builder():
    """It may be an axis that this machine does not have."""
    with pytest.raises(ProgramError, match="variables PINOLE"):
        read("PINOLE=100\nM30", "sinumerik")


def test_what_a_program_tells_the_machine_moves_nothing():
    program = read("$A_OUT[1]=1\n$AC_PARAM[2]=4\nG0 X=$AC_PARAM[2]\nM30", "sinumerik")
    assert program.moves.end_mm[-1, 0] == 4.0
    with pytest.raises(ProgramError, match=r"variables \$MC_CUTCOM_NORM_HEIGHT"):
        read("$MC_CUTCOM_NORM_HEIGHT=1\nM30", "sinumerik")


@pytest.mark.parametrize("code", [61, 70, 72, 99])
def test_codes_of_another_control_are_the_builders(code):
    """M70 to M73 keep and bring back modes in RS274/NGC; here they do not."""
    if code == 70:
        read("G91\nM70\nG0 X1\nM30", "sinumerik")
        return
    with pytest.raises(ProgramError, match=f"M codes M{code}"):
        read(f"M{code}\nM30", "sinumerik")


def test_subprograms_may_lie_in_a_folder_of_their_own(tmp_path):
    (tmp_path / "cma").mkdir()
    (tmp_path / "cma" / "L77.SPF").write_text("G91 G0 X3\nG90\nM17\n")
    (tmp_path / "cma" / "REF.H").write_text("BEGIN PGM REF MM\nL X+4 FMAX\nEND PGM REF MM\n")
    (tmp_path / "cma" / "O9000.nc").write_text("O9000\nG91 G0 X5.\nG90\nM99\n")
    job = write_job(tmp_path, more='[control]\nsubprograms = "cma"\n')
    folder = read_job(job).control.subprograms
    for dialect, text, x in (
        ("sinumerik", "G0 X0\nL77\nM30", 3),
        ("heidenhain", "BEGIN PGM A MM\nCALL PGM TNC:\\REF\nEND PGM A MM", 4),
        ("fanuc", "G21 G90\nG0 X0.\nM98 P9000\nM30", 5),
    ):
        found = read(text, dialect, subprograms=folder)
        assert found.moves.end_mm[-1, 0] == x
    job = write_job(tmp_path, more='[control]\nsubprograms = "nowhere"\n')
    with pytest.raises(InputError, match="subprograms = 'nowhere': no such folder"):
        read_job(job)


KLARTEXT = """BEGIN PGM A MM
TOOL CALL 1 Z S500
CALL PGM TNC:\\REF
TCH PROBE 411 DATUM OUTSIDE RECT. ~
    Q321=+0    ;CENTRE ~
    Q322=+5    ;CENTRE
M31 M45
L X+Q322 FMAX
END PGM A MM
"""


def test_klartext_says_calls_and_measuring_cycles_at_once():
    with pytest.raises(
        ProgramError, match=r"beside it: REF, TCH PROBE 411.*\['REF', 'TCH PROBE 411'\]"
    ):
        read(KLARTEXT, "heidenhain")
    calls = frozenset(("Ref", "tch probe 411"))
    with pytest.raises(ProgramError, match=r"M31 M45.*ignore_m = \[31, 45\]"):
        read(KLARTEXT, "heidenhain", ignore_calls=calls)
    program = read(KLARTEXT, "heidenhain", ignore_calls=calls, ignore_m=frozenset((31, 45)))
    assert program.moves.end_mm[-1, 0] == 5.0
    assert any("the zero is that of the job" in note.meaning for note in program.notes)


def test_a_macro_that_the_job_leaves_out_is_noted():
    text = "G21 G90\nG0 X1.\nG65 P9810 Z5. F1000\nM98 P77\nX2.\nM30"
    with pytest.raises(ProgramError, match=r"ignore_calls = \['O9810', 'O77'\]"):
        read(text, "fanuc")
    program = read(text, "fanuc", ignore_calls=frozenset(("O9810", "O0077")))
    assert program.moves.end_mm[-1].tolist() == [2.0, 0.0, 500.0]
    assert {"O9810", "O77"} <= {note.word for note in program.notes}


def test_fanuc_says_all_programs_it_lacks_at_once():
    text = (
        "G21 G90\nG0 X1.\nG65 P9810 Z5. F1000\nG65 Z2. P9810\nM98 P30077\nM98 P20100 L2\n"
        "M98 P5\n(M98 P6)\nM98 P#1\nG66 P8.\nX2.\nM30\nO5\nX3.\nM99"
    )
    with pytest.raises(ProgramError, match=r"beside it: O9810, O77, O20100\b.*O0077\.nc"):
        read(text, "fanuc")
    with pytest.raises(ProgramError, match=r"beside it: O77, O20100\b"):
        read(text, "fanuc", ignore_calls=frozenset(("O9810",)))


def test_what_the_controls_memory_holds_is_said_by_the_job():
    text = "BEGIN PGM A MM\nL X+QR20 Y+Q3 FMAX\nFN 16: F-PRINT A.A / SCREEN:\nEND PGM A MM"
    with pytest.raises(ProgramError, match=r"QR20 was never set.*variables = \{ 'QR20' = "):
        read(text, "heidenhain")
    program = read(text, "heidenhain", variables={"qr20": 8.0, "Q3": 4.0})
    assert program.moves.end_mm[-1, :2].tolist() == [8.0, 4.0]
    assert "FN 16" in {note.word for note in program.notes}


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ("ID=1 WHENEVER $AA_IM[X]>3 DO $AC_OVR=0", "synchronised action"),
        ("G0 Y=DC(3)", "DC with Y"),
        ("CYCLE978(1,2)", "ignore_calls = ..CYCLE978.."),
        ('CYCLE62("AA",1)', "CYCLE72 takes the contour's name itself"),
        ("CYCLE79(1)", "polygon"),
    ],
)
def test_words_that_are_no_variables_are_told_as_what_they_are(block, said):
    with pytest.raises(ProgramError, match=said) as error:
        read(f"G0 X1\n{block}\nM30", "sinumerik")
    assert "variables" not in str(error.value)


def test_a_rotary_axis_goes_to_the_place_that_dc_names():
    program = read("G91\nG0 C=DC(30)\nC=ACP(20)\nCYCLE800\nM30", "sinumerik")
    assert program.moves.end_mm.shape[0] == 2
    assert program.moves.rotary_end_deg[-1, 2] == pytest.approx(20.0)


@pytest.mark.parametrize(
    "line",
    ["ACC[X]=80", "VELOLIMA[Y]=50", "JERKLIM[X]=75", "OVR=100", "SPOS[1]=0", "SPOS=ACP(10)", "DL=0",
     "TCARR=0", "CTOL=0.01", "G645 OTOL=0.5", "ADISPOS=.1", "BRISKA(X)", "WAITM(1,1,2)", "SETMS",
     "G25 S100", "G26 S1=5000", "G62", "TOFFL=0", "GROUP_ADDEND(0,0)", "TOROTOF"],
)  # fmt: skip
def test_words_of_the_control_that_move_nothing_are_not_the_builders(line):
    program = read(f"G0 X1 Y2\n{line}\nG1 X3 F100\nM30", "sinumerik")
    assert program.moves.end_mm[-1, :2].tolist() == [3.0, 2.0]


@pytest.mark.parametrize(
    ("line", "meaning"),
    [("TOFFL=1", "tool offset of the program"), ("TOFF[Z]=0.5", "tool offset of the program"),
     ("POS[X]=100", "positioning axis"), ("DL=1", "additive tool offset"), ("OVR=50", "override"),
     ("G1 ANG=30 X10", "angle of a line"), ("MEAS=1 X10", "measuring"), ("TCARR=2", "tool carrier"),
     ("G75 FP=2 Z0", "fixed point"), ("G147 DISR=5 X1", "soft approach"), ("FZ=.1", "per tooth"),
     ("TOFRAME", "frame along the tool"), ("ROTS X10", "solid angles")],
)  # fmt: skip
def test_words_of_the_control_that_move_are_no_variables_that_a_job_could_say(line, meaning):
    """They were told to be the builder's, with the advice to put them into the job."""
    with pytest.raises(ProgramError, match=meaning) as error:
        read(f"G0 X1 Y2\n{line}\nM30", "sinumerik")
    assert "builder" not in str(error.value)
    with pytest.raises(ProgramError) as error:
        read(f"G0 X=UNKNOWN_ONE\n{line}\nM30", "sinumerik")
    assert "variables UNKNOWN_ONE:" in str(error.value)


def test_a_variable_that_the_program_declares_is_its_own():
    program = read("DEF REAL FZ\nFZ=0.5\nG0 X=FZ\nM30", "sinumerik")
    assert program.moves.end_mm[-1, 0] == 0.5


def test_an_axis_as_index_is_a_name():
    """Its value was looked for until the expression was 'nested too deeply'."""
    with pytest.raises(ProgramError, match=r"variables GAP\[X\]"):
        read("GAP[X]=80\nM30", "sinumerik")


@pytest.mark.parametrize("line", ["R1=_NC[_KC]", "IF _NC[_KC[2]]==1 GOTOF ENDE"])
def test_an_index_of_the_builder_is_told_with_its_field(line):
    """The list of what is unknown was made within itself until it was 'nested too deeply'."""
    with pytest.raises(ProgramError) as error:
        read(f"{line}\nG0 X=_LATER\nENDE:\nM30", "sinumerik")
    said = str(error.value)
    assert all(name in said for name in ("_KC", "_NC[_KC", "_LATER")), said


@pytest.mark.parametrize(
    "line",
    ["$P_UIFR[1,X,RT]=5", "$P_UIFR[1,X,FI]=R1+1", "$P_BFRAME[X,TR]=5", "$P_CHBFR[0]=CTRANS(X,5)",
     "$P_UIFR[1]=CROT(Z,30)", "$P_PFRAME=CTRANS()", "$TC_DP6[1,1]=5", "$P_UIFR[1,Z,SC]=0",
     "R2=1 $P_UIFR[1,X,MI]=1"],
)  # fmt: skip
def test_frames_and_tools_are_not_the_builders(line):
    """The job was asked for their values, and with one the part was neither turned nor moved."""
    name = line.removeprefix("R2=1 ").partition("=")[0]
    with pytest.raises(ProgramError) as error:
        read(f"G0 X=_ANY\n{line}\nM30", "sinumerik", variables={"_ANY": 1.0, name: 0.0})
    assert name in str(error.value)
    with pytest.raises(ProgramError) as error:
        read(f"G0 X=_ANY\n{line}\nM30", "sinumerik")
    assert "variables _ANY:" in str(error.value)


@pytest.mark.parametrize(
    "line",
    ["$P_UIFR[1,X,RT]=0", "$P_UIFR[1,X,FI]=0.0", "$P_CHBFR[0]=CTRANS()", "$P_BFRAME[X,TR]=0",
     "$P_UIFR[1,Z,SC]=1", "$P_UIFR[1,X,RT]=0 $P_UIFR[1,Y,RT]=0 R1=7"],
)  # fmt: skip
def test_a_frame_that_is_set_to_nothing_changes_nothing(line):
    program = read(f"{line}\nG54 G0 X3 Y=R1\nM30", "sinumerik")
    assert program.moves.end_mm[-1, :2].tolist() == [3.0, 7.0 if "R1" in line else 0.0]


def test_an_index_may_be_an_element_of_another_field():
    program = read("DEF INT AA[3]=(0,2,1),BB[3]\nBB[AA[1]]=7\nG0 X=BB[AA[1]]\n"
                   "$AC_MARKER[AA[2]]=3\nG0 Y=$AC_MARKER[AA[2]]\nM30", "sinumerik")  # fmt: skip
    assert program.moves.end_mm[-1, :2].tolist() == [7.0, 3.0]


def test_a_field_may_be_filled_without_set():
    program = read("DEF INT AA[3]=(1,2,3)\nG0 X=AA[1] Y=AA[2]\nM30", "sinumerik")
    assert program.moves.end_mm[-1, :2].tolist() == [2.0, 3.0]


@pytest.mark.parametrize(
    ("line", "hint"), [("G43 Z10 H1", "ISO dialect"), ("(FACE)", "a comment begins with ;")]
)
def test_words_of_fanuc_are_told_as_such(line, hint):
    with pytest.raises(ProgramError, match=hint):
        read(f"{line}\nM30", "sinumerik")
