"""Haas's circular pocket and bolt circles, and back boring, against closed forms.

Mill Operator's Manual 96-8210 (G12, G13, G70, G71); FANUC B-64484EN (G87).
"""

import numpy as np
import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from tests.oracle.test_klartext_cycles import holes, tip

TOOLS = {1: ToolEntry(100.0, 10.0)}


def read(body, control="haas", path="part.nc"):
    text = f"O1\nG21 G90 G54 T1 M6\nG43 H1 G0 Z20. S1000 M3 F300.\n{body}\nM30\n"
    return read_program(Source(text.encode(), path), tools=TOOLS, dialect=control)


@pytest.mark.parametrize(("code", "sense"), [("G12", -1), ("G13", 1)])
def test_circular_pocket(code, sense):
    program = read(f"G0 X20. Y10.\nZ1.\n{code} D1 I6. K15. Q4. Z-2. F200.")
    places = tip(program)
    cut = places[places[:, 2] < -1.999]
    out = np.hypot(*(cut[:, :2] - [20, 10]).T)
    assert out.max() == pytest.approx(15 - 5)
    turned = program.moves.sweep_rad * program.moves.axis[:, 2]
    whole = np.abs(np.abs(turned) - 2 * np.pi) < 1e-9
    assert whole.sum() == 4  # 6, 10, 14, 15
    assert (np.sign(turned[whole]) == sense).all()
    assert program.moves.end_mm[-1, :2] == pytest.approx([20, 10])


def test_circular_pocket_goes_deeper_in_g91():
    places = tip(read("G0 X0. Y0.\nZ0.\nG91 G13 I8. Z-1.5 L3\nG90"))
    assert sorted(set(places[:, 2].round(6).tolist()))[0] == -4.5


def test_bolt_circle_and_arc():
    found = holes(read("G0 X50. Y40.\nG81 Z-5. R2. L0\nG70 I20. J30. L6"))
    angle = np.radians(30 + 60.0 * np.arange(6))
    assert found == pytest.approx(
        np.stack([50 + 20 * np.cos(angle), 40 + 20 * np.sin(angle)], axis=1)
    )
    found = holes(read("G0 X0. Y0.\nG81 Z-5. R2. L0\nG71 I20. J0. K15. L3"))
    angle = np.radians(15.0 * np.arange(3))
    assert found == pytest.approx(np.stack([20 * np.cos(angle), 20 * np.sin(angle)], axis=1))


def test_bolt_holes_along_an_angle():
    found = holes(read("G0 X5. Y-3.\nG81 Z-5. R2. L0\nG72 I12. J60. L4"))
    away = 12.0 * np.arange(4)
    line = [5 + away * np.cos(np.pi / 3), -3 + away * np.sin(np.pi / 3)]
    assert found == pytest.approx(np.stack(line, axis=1), abs=1e-4)


@pytest.mark.parametrize(
    ("body", "word"),
    [
        ("G12 D1 I4. Z-1.", "not larger than the tool's radius 5"),
        ("G12 Z-1.", "radius I"),
        ("G12 D1 I6. K15. Z-1.", "increment Q"),
        ("G70 I20. J0. L4", "without a canned cycle"),
        ("G81 Z-5. R2. F100. L0\nG71 I20. J0. L4", "G71 without K word"),
        ("G81 Z-5. R2. F100. L0\nG72 J0. L4", "G72 without I word"),
    ],
)
def test_what_lacks_a_word_is_refused(body, word):
    with pytest.raises(ProgramError, match=word):
        read("G0 X0. Y0.\n" + body)


def test_fanuc_has_other_codes_of_these_numbers():
    with pytest.raises(ProgramError, match="G12"):
        read("G0 X0. Y0.\nG12 I6. Z-1.", control="fanuc")


def test_back_boring():
    moves = read("G0 X5. Y6.\nG98 G87 X10. Y20. R-30. Z-22. Q2. F80.", control="fanuc").moves
    places = moves.end_mm - [0, 0, 100]
    start = np.flatnonzero(np.abs(places[:, 2] + 30) < 1e-9)[0]
    wanted = [[12, 20, 20], [12, 20, -30], [10, 20, -30], [10, 20, -22], [12, 20, -22],
              [12, 20, 20], [10, 20, 20]]  # fmt: skip
    assert places[start - 1 :] == pytest.approx(np.array(wanted))
    assert moves.at_feed[start + 2]


def test_programs_are_found_in_files_beside_the_calling_one(tmp_path):
    (tmp_path / "O1002.nc").write_text("%\nO1002\nG91 G0 Z-1.\nG90\nM99\n%\n")
    (tmp_path / "2000").write_text("O2000\nG0 X#1\nM99\n")
    main = tmp_path / "main.nc"
    main.write_text("O1\nG21 G90\nG0 X1. Z10.\nM98 P1002 L4\nG65 P2000 A7.\nG0 Y2.\nM30\n")
    program = read_program(main, tools=TOOLS, dialect="fanuc", home_mm=(0, 0, 0))
    assert program.moves.end_mm[-1].tolist() == [7, 2, 6]
    assert program.moves.line.tolist() == [3, 4, 4, 4, 4, 5, 6]
    (tmp_path / "2000").write_text("O2000\nG0 X#1\nG200\nM99\n")
    with pytest.raises(ProgramError, match="2000:3: "):
        read_program(main, tools=TOOLS, dialect="fanuc", home_mm=(0, 0, 0))


def test_variables_of_the_next_generation_control_are_the_common_ones():
    """96-8210, "System variables": #10100 is #100, #10550 is #550; #10200 has no older name."""
    said = "#100=3.\n#10550=#10100+4.\n#10200=1.\nG0 X#550 Y[#10100+#10200]\n"
    assert list(read(said).moves.end_mm[-1, :2]) == [7, 4]


def test_mirror_image_about_the_work_zero():
    """G101 X0. turns X and the sense of arcs, whatever its number; G100 ends it."""
    body = "G0 X0. Y0.\nG101 X3.\nG1 X10. Y5.\nG2 X14. Y9. I4.\nG100 X0.\nG1 X20."
    moves = read(body).moves
    ends = moves.end_mm[moves.at_feed][:, :2]
    assert ends.round(9).tolist() == [[-10, 5], [-14, 9], [20, 9]]
    arc = np.flatnonzero(moves.sweep_rad)[-1]
    assert moves.sweep_rad[arc] * moves.axis[arc, 2] == pytest.approx(np.pi / 2)
    with pytest.raises(ProgramError, match="G101"):
        read("G101 X0.", control="fanuc")
