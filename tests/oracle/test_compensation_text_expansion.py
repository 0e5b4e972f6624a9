"""Programs written out in plain blocks make the path that LinuxCNC makes of the original.

``golden/gcode`` holds programs for every feature with LinuxCNC's calls (``NAME.canon``). Where its
interpreter is installed it also reads the new text.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from gcode import Source, read_program, read_tool_table
from tests.oracle.linuxcnc_interpreter import ARC, INCH_MM, is_installed, judge, rows_of
from vmach.errors import InputError
from vmach.program_text.expanding.expansion import expanded

FOLDER = Path(__file__).parents[1] / "golden" / "gcode"
#: what plain blocks cannot do, by the reason that is given
REFUSED = {
    "cycle_spindle": "boring",
    "lathe_diameter": "diameter mode",
    "probing": "probing",
    "splines": "spline",
    "threading": "threading",
    "modal_state_m70": "M7[03] cannot be written out",
}
PROGRAMS = sorted(p.stem for p in FOLDER.glob("*.canon"))


def read(name, tools):
    return read_program(FOLDER / f"{name}.ngc", tools=tools, machine_unit_mm=INCH_MM)


@pytest.fixture(scope="module")
def tools():
    return read_tool_table(FOLDER / "tool.tbl", unit_mm=INCH_MM)


def going(kinds, starts, ends):
    far = [np.abs(b - a).max() > 1e-9 for a, b in zip(starts, ends, strict=True)]
    return [k for k, kind in enumerate(kinds) if kind == ARC or (kind < ARC and far[k])]


def ends_of(verdict):
    rows = going(verdict.kind, verdict.start, verdict.end)
    middles = [verdict.at(k, 0.5) for k in rows]
    kinds = [verdict.kind[k] for k in rows]
    return kinds, np.array([verdict.end[k] for k in rows]), np.array(middles)


@pytest.mark.parametrize("name", [n for n in PROGRAMS if n not in REFUSED])
def test_same_path_as_linuxcnc_made_of_the_original(name, tools):
    program, expansion = expanded(read(name, tools))
    moves = program.moves
    wanted = ends_of(rows_of((FOLDER / f"{name}.canon").read_text()))
    rows = going(moves.kind, moves.start_mm, moves.end_mm)
    offset = len(rows) - len(wanted[0])
    assert offset in (0, -1)  # the first move may start where it ends
    assert [int(moves.kind[k]) for k in rows] == wanted[0][-len(rows) :]
    off = moves.end_mm[rows] - wanted[1][-len(rows) :]
    assert np.abs(off).max() < 1e-7
    assert len(expansion.origin) == len(expansion.source)


@pytest.mark.skipif(not is_installed(), reason="LinuxCNC is not installed")
@pytest.mark.parametrize("name", [n for n in PROGRAMS if n not in REFUSED])
def test_linuxcnc_makes_the_same_path_of_both_texts(name, tools):
    _, expansion = expanded(read(name, tools))
    table = [(n, e.length_mm, e.diameter_mm) for n, e in tools.items()]
    old, new = (judge(text, tools=table) for text in
                ((FOLDER / f"{name}.ngc").read_bytes(), expansion.source.data))  # fmt: skip
    assert old.refusal is None
    assert new.refusal is None
    one, two = ends_of(old), ends_of(new)
    assert one[0] == two[0]
    for first, second in zip(one[1:], two[1:], strict=True):
        assert np.abs(first - second).max(initial=0.0) < 1e-7


@pytest.mark.parametrize(("name", "why"), REFUSED.items())
def test_what_plain_blocks_cannot_do_is_refused(name, why, tools):
    with pytest.raises(InputError, match=why) as caught:
        expanded(read(name, tools))
    assert caught.value.line is not None


def text_of(text, dialect="auto", **options):
    source = Source(text.encode("latin-1"))
    program = read_program(source, dialect=dialect, **options)
    return expanded(program)[1]


def test_only_what_needs_it_is_written_out():
    found = text_of(
        "G21 G90 G17 (a)\nM3 S500\nG0 X0 Y0 Z5\nF100\nN7 G98 G81 X1 Y2 Z-3 R1 (hole)\nX4\nG80\n"
        "G1 X [2+3] f[10*5] (b)\nM2\n"
    )
    assert found.source.data.decode().splitlines() == [
        "G21 G90 G17 (a)",
        "M3 S500",
        "G0 X0 Y0 Z5",
        "F100",
        "N7 G61 G0 X1. Y2. (hole)",
        "G0 Z1.",
        "G1 Z-3.",
        "G0 Z5.",
        "G0 X4.",
        "G0 Z1.",
        "G1 Z-3.",
        "G0 Z5.",
        "G80",
        "G64",
        "G1 X5. F50. (b)",
        "M2",
    ]
    assert sorted(found.reasons) == [5, 6, 7, 8]  # G64 stands behind line 7


def test_a_sign_before_a_sign_is_written_out():
    """LinuxCNC negates the number behind the first sign; a writer finds no number there."""
    found = text_of("G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z--3 F100 (a - - b)\nX+-4\nX4 (a--b)\nM2\n")
    lines = found.source.data.decode().splitlines()
    assert lines[2:5] == ["G1 Z3. F100. (a - - b)", "X-4.", "X4 (a--b)"]


def test_loops_and_subprograms_run_in_order_with_numbers():
    found = text_of(
        "%\nO10 SUB\nG1 X#1 (in)\nO10 ENDSUB\nG21 G90 F100 (start)\n#5=2\n"
        "O20 WHILE [#5 GT 0]\nO10 CALL [#5*1.5]\n#5=[#5-1]\nO20 ENDWHILE\n(DEBUG, #5 left)\nM2\n%\n"
    )
    assert found.source.data.decode().splitlines() == [
        "%",
        "G21 G90 F100 (start)",
        "G1 X3. (in)",
        "G1 X1.5 (in)",
        "(DEBUG, 0.000000 left)",
        "M2",
        "%",
    ]


def test_fanuc_macros_and_branches_run_in_order():
    found = text_of(
        "%\nO1(MAIN);\nG21G90G54;\nN5 G65P2A3.F100;\nM98P3L2;\nIF[1EQ1]GOTO9;\nG0X99.;\nN9M30;\n"
        "O2;\nG1X#1F#9;\nM99;\nO3;\nN5 G91G0Y1.;\nG90;\nM99;\n%\n"
    )
    lines = found.source.data.decode().splitlines()
    assert lines[:3] == ["%", "O1(MAIN);", "G21G90G54;"]
    assert [re.sub(r"\s", "", line) for line in lines[3:]] == [
        "G1X3.F100.;",
        "N5G91G0Y1.;",
        "G90;",
        "G91G0Y1.;",
        "G90;",
        "N9M30;",
        "%",
    ]


def test_a_program_that_runs_too_long_is_refused(monkeypatch):
    monkeypatch.setattr("vmach.program_text.expanding.unrolling._MOST_LINES", 100)
    with pytest.raises(InputError, match="lines"):
        text_of("#1=0\nO1 WHILE [#1 LT 50]\nG0 X#1\n#1=[#1+1]\nO1 ENDWHILE\nM2\n")
