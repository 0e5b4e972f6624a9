"""Loops without end are refused at their first line; loops that end are not."""

from unittest.mock import patch

import pytest

from gcode import ProgramError, Source, ToolEntry, read_program
from gcode.control import loop_guard
from gcode.state.record import Record

SEARCH = """
O1 while [#1 LT 5000]
  #1 = [#1 + 1]
O1 endwhile
G1 X#1
M2
"""

ENDLESS = {
    "nothing": ("O1 while [1]\nO1 endwhile\nM2\n", 1),
    "counter forgotten": ("F9\nO1 while [#1 LT 5]\nG1 X1\nX0\nO1 endwhile\nM2\n", 2),
    "do": ("F9\nO1 do\nG1 X1\nX0\nO1 while [1]\nM2\n", 2),
    "a round of seven": ("F9\nO1 while [1]\n#1=[[#1+1] MOD 7]\nG1 X#1\nO1 endwhile\nM2\n", 2),
    "round an inner loop": (
        "F9\nO1 while [1]\n#2=0\nO2 while [#2 LT 9]\nG1 X#2\n#2=[#2+1]\nO2 endwhile\n"
        "O1 endwhile\nM2\n", 2),
    "round a subroutine": (
        "O9 sub\nO8 repeat [3]\nG1 X#1\nG1 X0\nO8 endrepeat\nO9 endsub\nF9\n"
        "O1 while [1]\nO9 call [4]\nO1 endwhile\nM2\n", 8),
    "with compensation": (
        "F9\nO1 while [1]\nG41.1 D2 G1 X10\nX20 Y10\nG40 X0 Y0\nO1 endwhile\nM2\n", 2),
    "continued": (
        "F9\nO1 while [1]\nG1 X1\nO2 if [1]\nO1 continue\nO2 endif\nO1 endwhile\nM2\n", 2),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDLESS)
def test_endless_loop_is_refused_at_its_first_line(name):
    text, line = ENDLESS[name]
    with pytest.raises(ProgramError, match="loop without end") as error:
        read_program(Source(text.encode()), max_blocks=1000)
    assert error.value.line == line


def test_search_without_a_move_has_its_limit(monkeypatch):
    assert len(read_program(Source(SEARCH.replace("G1", "G0").encode())).moves.line) == 1
    monkeypatch.setattr(loop_guard, "_BLOCKS_WITHOUT_MOVE", 2000)
    with pytest.raises(ProgramError, match="2000 blocks without a move") as error:
        read_program(Source(SEARCH.encode()))
    assert error.value.line == 2


def test_lines_do_not_count_against_the_limit_of_blocks():
    text = "G0 X1\n" * 50
    assert len(read_program(Source(text.encode()), max_blocks=0).moves.line) == 50


def test_blanks_inside_keywords_are_ignored():
    text = "o <a b> w h i l e [#1 L T 2]\n# 1 = [#1 + 1]\nG 0 X 1 0\no <ab> e n d while\nM2\n"
    assert read_program(Source(text.encode())).moves.end_mm[:, 0].tolist() == [10.0, 10.0]


SUBPROGRAM = "O5\nG1 X1\nM99\n"
COUNTED = {
    "repeat": ("F9\nO1 repeat [100000000]\nG1 X1\nO1 endrepeat\nM2\n", 2),
    "nested": ("F9\nO1 repeat [9000]\nO2 repeat [9000]\nG1 X1\nO2 endrepeat\nO1 endrepeat\nM2\n",
               2),
    "calls": ("F9\nO5 sub\nG1 X1\nO5 endsub\nO1 repeat [100000000]\nO5 call\nO1 endrepeat\nM2\n",
              5),
    "M98": (f"F9\nM98 P5 L100000000\nM2\n{SUBPROGRAM}", 2),
    "G65": (f"O1\nF9\nG65 P5 L100000000\nM30\n{SUBPROGRAM}", 3),
    "Fanuc M98": (f"O1\nF9\nIF [1 EQ 2] GOTO 5\nM98 P5 L100000000\nM30\n{SUBPROGRAM}", 4),
    "REP of REP": ("BEGIN PGM A MM\nTOOL CALL 1 Z S1\nLBL 1\nL IX+1 FMAX\n"
                   "CALL LBL 1 REP 9000\nCALL LBL 1 REP 65534\nEND PGM A MM\n", 6),
}  # fmt: skip


@pytest.mark.parametrize("name", COUNTED)
def test_too_many_counted_rounds_are_refused_after_the_first(name):
    text, line = COUNTED[name]
    run = []
    with (
        patch.object(Record, "straight", lambda self, *_, **__: run.append(1)),
        pytest.raises(ProgramError, match=r"runs more than .* further rounds") as error,
    ):
        read_program(Source(text.encode()), tools={1: ToolEntry(100, 10)})
    assert error.value.line == line
    assert len(run) < 10_000


def test_counted_rounds_that_the_limit_allows_are_run():
    for inner in ("REP 99", "REP 0"):
        text = ("BEGIN PGM A MM\nTOOL CALL 1 Z S1\nLBL 1\nL IX+1 FMAX\n"
                f"CALL LBL 1 {inner}\nCALL LBL 1 REP 99\nEND PGM A MM\n")  # fmt: skip
        source = Source(text.encode())
        found = read_program(source, tools={1: ToolEntry(100, 10)}, max_blocks=30_000)
        rounds = 100 * (1 + int(inner.split()[1]))
        assert found.moves.end_mm[-1, 0] == pytest.approx(rounds)
