"""Every program in golden/gcode read as LinuxCNC's interpreter reads it.

``NAME.canon`` holds what LinuxCNC 2.9 (Debian 2.9.0~pre1) says for ``NAME.ngc``, all digits;
``NAME.reject`` its words for a program that it refuses, the block last. They are written by
``golden/gcode/make_golden.py``.
"""

from pathlib import Path

import pytest

from gcode import ProgramError, canon_lines, read_program, read_tool_table

FOLDER = Path(__file__).with_name("gcode")
#: Said by the oracle, and not a canonical call that moves or sets anything.
SILENT = {"comment", "message"}
TOLERANCE_MM = 1e-9


@pytest.fixture(scope="module")
def tools():
    return read_tool_table(FOLDER / "tool.tbl", unit_mm=25.4)


def split(lines):
    words = (line.split() for line in lines)
    return [(int(w[0]), w[1], [float(v) for v in w[2:]]) for w in words if w[1] not in SILENT]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.canon")), ids=lambda p: p.stem)
def test_same_canonical_calls(path, tools):
    expected = split(path.read_text().splitlines())
    program = read_program(path.with_suffix(".ngc"), tools=tools, machine_unit_mm=25.4)
    actual = split(canon_lines(program))
    for wanted, got in zip(expected, actual, strict=True):
        if wanted[1] == "change_tool":  # the oracle gives the pocket
            wanted, got = wanted[:2], got[:2]
        else:
            assert got[2] == pytest.approx(wanted[2], abs=TOLERANCE_MM, rel=0), (wanted, got)
        assert got[:2] == wanted[:2]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.reject")), ids=lambda p: p.stem)
def test_refused_in_the_same_line(path, tools):
    block = path.read_text().splitlines()[-1]
    source = path.with_suffix(".ngc")
    line = source.read_text().splitlines().index(block) + 1
    with pytest.raises(ProgramError) as error:
        read_program(source, tools=tools, machine_unit_mm=25.4)
    assert str(error.value).startswith(f"{source}:{line}:")
