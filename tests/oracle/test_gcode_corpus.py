"""Programs of others against LinuxCNC's interpreter, where such a corpus is at hand.

The environment variable VMACH_GCODE_CORPUS names a folder of programs with FILE.canon17 (calls of
LinuxCNC's interpreter, all digits, mm), FILE.reject (its refusal), and a tool table FILE.tbl or
tool.tbl in inches. Without it these tests are skipped; `golden/gcode` stands alone.
"""

import os
from pathlib import Path

import pytest

from gcode import ProgramError, Source, canon_lines, read_program, read_tool_table

CORPUS = os.environ.get("VMACH_GCODE_CORPUS")
FOLDER = Path(CORPUS or ".")
NO_PROGRAM = {".canon17", ".canon", ".reject", ".tbl", ".md", ".tsv", ".py", ".sh", ".camotics"}
PROGRAMS = sorted(p for p in FOLDER.iterdir() if p.suffix not in NO_PROGRAM) if CORPUS else []
SILENT = {"comment", "message"}
#: Calls of M2, which the oracle appends to programs without an end.
ENDING = {"set_g5x_offset", "set_xy_rotation", "set_feed_rate", "set_plane", "set_g92_offset"}

pytestmark = pytest.mark.skipif(not CORPUS, reason="VMACH_GCODE_CORPUS is not set")


def beside(path, suffix):
    return path.with_name(path.name + suffix)


def read(path):
    table = beside(path, ".tbl")
    tools = read_tool_table(table if table.exists() else FOLDER / "tool.tbl", unit_mm=25.4)
    return read_program(path, tools=tools, machine_unit_mm=25.4)


def calls(lines):
    split = [line.split() for line in lines]
    found = [(int(w[0]), w[1], [float(v) for v in w[2:]]) for w in split
             if len(w) > 1 and w[0].isdigit() and w[1] not in SILENT]  # fmt: skip
    while found and found[-1][1] in ENDING:
        found.pop()
    return found


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.name)
def test_as_linuxcnc_reads_it(path):
    expected = beside(path, ".canon17")
    if not expected.exists():
        if beside(path, ".reject").exists():
            with pytest.raises(ProgramError):
                read(path)
        return
    wanted = calls(expected.read_text(encoding="latin-1").splitlines())
    got = calls(canon_lines(read(path)))
    assert len(got) == len(wanted)
    for one, two in zip(wanted, got, strict=True):
        assert two[:2] == one[:2]
        if one[1] != "change_tool":
            assert two[2] == pytest.approx(one[2], abs=1e-9, rel=1e-15)


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.name)
def test_every_byte_can_be_written_back(path):
    source = Source.read(path)
    assert source.rewritten({}) == path.read_bytes()
    words = [w for line in range(1, len(source) + 1) for w in source.words(line)]
    same = source.rewritten({w.span: w.text for w in words})
    assert same == path.read_bytes()
