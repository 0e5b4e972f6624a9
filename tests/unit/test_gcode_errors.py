"""Every refusal names file, line, what is wrong, and what would be right."""

import pytest

from gcode import (
    ARC_TOLERANCES,
    MachineLimits,
    ProgramError,
    Source,
    ToolEntry,
    read_program,
    read_tool_table,
)


def refusal(text, **options):
    with pytest.raises(ProgramError) as error:
        read_program(Source(text.encode(), "part.nc"), **options)
    return str(error.value)


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("G21\nG0 X1 Q\n", 2, "bad number"),
        ("G1 X1\n", 1, "feed zero"),
        ("G123\n", 1, "unknown G code G123"),
        ("M123\n", 1, "unknown M code M123"),
        ("G0 G1 X1\n", 1, "one modal group"),
        ("G0 U1\n", 1, "'U' is not known"),
        ("G0 X[1+]\n", 1, "bad number"),
        ("G0 X[1/0]\n", 1, "divide by zero"),
        ("G0 X[sqrt[-1]]\n", 1, "SQRT"),
        ("G0 X[2**[0.5]*[-1]**.5]\n", 1, "negative number"),
        ("#5400=1\n", 1, "read only"),
        ("G0 X#9999\n", 1, "out of range"),
        ("O1 endif\n", 1, "has no IF"),
        ("G21\nO1 while [1 EQ 0]\nG0 X1\n", 2, "seeking O<1>"),
        ("O1 call\n", 1, "seeking O<1>"),
        ("O1 sub\nO2 sub\n", 2, "inside a subroutine"),
        ("F1\nG43 H7\n", 2, "tool 7 is not in the tool table"),
        ("F9 G41.1 D4\nG2 X30 I15\nG40\nG2 X0 I-15\n", 4, "must be straight"),
        ("G4\n", 1, "G4 without P"),
        ("F1 G5.3\n", 1, "G5.3 without G5.2"),
        ("F1 G5.2 X1 Y1 P1\nX2 Y2\n", 2, "G5.2 with no P"),
        ("F1 G5.2 X1 Y1\n", 1, "G5.2 with no P"),
        ("F1 G5.2 X1 Y1 P-2\n", 1, "G5.2 with P-2"),
        ("M66 P0 L0\nG0 X#5399\n", 2, "#5399"),
        ("M72\n", 1, "M72 without M70"),
        ("(abort, no part)\n", 1, "no part"),
        ("G0 X1e5\n", 1, "E word without a code"),
    ],
)
def test_refused_with_file_line_and_reason(text, line, words):
    message = refusal(text)
    assert message.startswith(f"part.nc:{line}:")
    assert words in message


@pytest.mark.parametrize(("text", "dialect", "said"), [
    ("G21\nG0 \u042510 Y0\n", "linuxcnc", "bad character '\u0425': 'G0 \u042510 Y0'"),
    ("N10 G54\nN20 \u0425=10\n", "sinumerik", "word '\u0425' is not read: 'N20 \u0425=10'"),
    ("0 BEGIN PGM A MM\n1 L X+\u041e F9\n", "heidenhain", "cannot read 'X+\u041e F9'"),
    ("G21\nG0 X1 Q" + 40 * "\u0425" + "\n", "linuxcnc", "at '\u0425\u0425"),
])  # fmt: skip
def test_characters_are_shown_as_people_wrote_them(text, dialect, said):
    """Programs are read byte by byte; a letter of two bytes is still shown as one."""
    message = refusal(text, dialect=dialect)
    assert said in message
    assert not set(message) & set(map(chr, range(0x80, 0x100)))


def test_a_character_of_one_byte_is_shown_too():
    with pytest.raises(ProgramError, match="bad character 'Ü': 'G0 Ü1'"):
        read_program(Source("G0 Ü1\n".encode("cp1252"), "part.nc"))


def test_a_missing_tool_is_no_question_of_the_control():
    message = refusal("%\nO7 (PART)\nG21 G90\nT7 M6\nM30\n%\n", tools={1: ToolEntry()})
    assert message.endswith("(hint: add the tool to the table)")


def test_message_says_what_is_accepted_and_gives_a_hint():
    message = refusal("G21\nG1 X1\n")
    hint = "give a feed first, for example F500"
    assert message == f"part.nc:2: G1 with feed zero: 'G1 X1' (hint: {hint})"


@pytest.mark.parametrize(
    ("text", "block"),
    [
        ("G21\nM98 L3\n", "'M98 L3'"),
        ("G21\n  G2 X1 R5 I2 F100 ; in\r\n", "'G2 X1 R5 I2 F100 ; in'"),
        ("#1 = [1 / 0]\n", "'#1 = [1 / 0]'"),
        (f"M98 (no P{' and more' * 20})\n", "'M98 (no P" + " and more" * 5 + " and m...'"),
    ],
)  # fmt: skip
def test_message_shows_the_block(text, block):
    """What is refused may be a word that lacks, a value or all of it: the block has them."""
    message = refusal(text)
    assert f": {block}" in message and "\n" not in message


def test_too_many_blocks_end():
    text = "F9 G91\nO1 while [1]\nG1 X1\nO1 endwhile\n"
    assert "more than 1004 blocks" in refusal(text, max_blocks=1000)


@pytest.mark.parametrize("name", ["G53", "X"])
def test_unknown_work_offset(name):
    assert "unknown work offset" in refusal("M2\n", work_offsets_mm={name: (0, 0, 0)})


def test_work_offset_needs_three_finite_numbers():
    assert "three numbers" in refusal("M2\n", work_offsets_mm={"G54": (0, 0)})
    assert "three numbers" in refusal("M2\n", work_offsets_mm={"G54": (0, 0, float("nan"))})


def test_unknown_names_list_the_known_ones():
    assert "auto, centroid, fanuc, " in refusal("M2\n", dialect="klingon")
    assert "linuxcnc, grbl" in refusal("M2\n", arc_tolerances="none")


@pytest.mark.parametrize(
    "wrong", [{"rapid_mm_per_min": 0.0}, {"acceleration_mm_per_s2": -1.0}, {"tool_change_s": -1.0}]
)
def test_limits_are_checked(wrong):
    with pytest.raises(ProgramError, match=next(iter(wrong))):
        MachineLimits(**wrong)


def test_tool_table_errors_name_the_row(tmp_path):
    table = tmp_path / "tool.tbl"
    table.write_text("T1 P1 D6\nD3\n")
    with pytest.raises(ProgramError, match=r"tool\.tbl:2: not a row"):
        read_tool_table(table)


@pytest.mark.parametrize(
    ("control", "mismatch_mm", "accepted"),
    [
        ("linuxcnc", 0.0282, True),  # 2 * 0.01 * sqrt(2) mm
        ("linuxcnc", 0.0284, False),
        ("grbl", 0.0049, True),
        ("grbl", 0.0060, False),
        ("sinumerik", 0.0099, True),
        ("sinumerik", 0.0110, False),
        ("heidenhain", 0.0150, True),
        ("heidenhain", 0.0170, False),
    ],
)
def test_arc_tolerance_of_each_control(control, mismatch_mm, accepted):
    text = f"G21 F100\nG0 X0 Y-2\nG3 X{2 + mismatch_mm:.4f} Y0 I0 J2\n"
    assert control in ARC_TOLERANCES
    if accepted:
        assert len(read_program(Source(text.encode()), arc_tolerances=control).moves) == 2
    else:
        assert "differs from radius" in refusal(text, arc_tolerances=control)


@pytest.mark.parametrize(
    ("control", "mismatch_inch", "accepted"),
    [
        ("linuxcnc", 0.0028, True),  # 2 * 0.001 * sqrt(2) inch, more than in millimetres
        ("linuxcnc", 0.0029, False),
        ("grbl", 0.00019, True),  # 0.005 mm
        ("grbl", 0.00021, False),
    ],
)
def test_arc_tolerance_of_a_program_in_inches(control, mismatch_inch, accepted):
    text = f"G20 F4\nG0 X0 Y-.1\nG3 X{0.1 + mismatch_inch:.5f} Y0 I0 J.1\n"
    if accepted:
        assert len(read_program(Source(text.encode()), arc_tolerances=control).moves) == 2
    else:
        assert "differs from radius" in refusal(text, arc_tolerances=control)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("#1 = 0\nG0 X[#2 + 5 / #1]\n", "5 / 0"),
        ("#1 = 7\nG10 L#1 P1\n", "G10 with L7"),
        ("#1 = 0\nS1 M3\nG76 P1 Z-5 I-1 J#1 K2\n", "J0 K2"),
        ("G21 F9\n#1 = 4\nG2 X0 Y0 R#1\n", "R4 ends where it starts"),
    ],
)
def test_message_shows_values_that_parameters_hide(text, said):
    assert said in refusal(text)
