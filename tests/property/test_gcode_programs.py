"""Random programs: two readers agree, text comes back, nothing but one clear error happens."""

import re
from dataclasses import fields
from pathlib import Path as FilePath
from unittest.mock import patch

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode import (
    ControlSettings,
    ProgramError,
    Source,
    ToolEntry,
    canon,
    canon_calls,
    canon_lines,
    read_program,
)
from gcode.fast import fast_lane
from gcode.state.record import Path

FOLDER = FilePath(__file__).parents[1] / "golden" / "gcode"
PROGRAMS = sorted(FOLDER.glob("*.ngc"))
TOOLS = {n: ToolEntry(10.0 * n, 2.0 * n) for n in range(1, 6)}

numbers = st.one_of(
    st.integers(-99, 99).map(str),
    st.decimals(-999, 999, places=4).map(str),
    st.sampled_from(["-0", ".5", "-.25", "+7.", "0.1234567890123456789", "1 2", "00012", "0.0001"]),
)
words = st.builds(lambda a, b: a + b, st.sampled_from("XYZxyzFNABCIJKRPQLHST"), numbers)
codes = st.sampled_from(
    ["G0", "g1", "G01", "G2", "G3", "G17", "G18", "G19", "G90", "G91", "G91.1", "G90.1", "G94",
     "G98", "G99", "G54", "G55", "G59.3", "G43", "G49", "G80", "G81", "G82", "G83", "G73", "G85",
     "G89", "G84", "G74", "G61", "G64", "G4", "G40", "G21", "M3", "M4", "M5", "M7", "M8", "M9",
     "M6", "M0", "(remark)", "(MSG, hello)", "; tail", " "]
)  # fmt: skip
plain = st.lists(st.one_of(words, words, codes), max_size=6).map(" ".join)
#: lines that CAM systems write, with what a quarter of a millimetre of error makes of them
cam = st.one_of(
    st.builds("G{} X{} Y{} I{} J{} F{}".format, st.sampled_from([2, 3]), numbers, numbers, numbers,
              numbers, st.sampled_from(["100", "250.5", "0"])),
    st.builds("G{} X{} Y{} R{}".format, st.sampled_from([2, 3]), numbers, numbers, numbers),
    st.builds(lambda g, i, j, z: f"G{g} I{i} J{j} Z{z} P2", st.sampled_from([2, 3]), numbers,
              numbers, numbers),
    st.builds("G17 G{0} X{1} Y0. I{2}".format, st.sampled_from([2, 3]), st.just("20."),
              st.sampled_from(["10.", "10.01", "9.999", "10.1"])),
    st.builds("G1 X{} Y{} F{} S{}".format, numbers, numbers, st.integers(1, 900),
              st.integers(0, 9000)),
    st.builds("G{} X{} Y{} Z-3. R2. Q{} P.5".format, st.sampled_from([81, 83, 73, 85]), numbers,
              numbers, st.sampled_from(["1.5", "0"])),
    st.builds("G81 X{} Y{} Z-3. R2.".format, numbers, numbers),
    st.builds("G83 X{} Z{} R2. Q1.3".format, numbers, st.sampled_from(["-3.", "-7.7"])),
    st.builds("G89 Y{} Z-3. R2. P{}".format, numbers, st.sampled_from(["1", "0.5"])),
    st.builds("X{} Y{}".format, numbers, numbers),
    st.builds("X{} Y{} L{}".format, numbers, numbers, st.integers(0, 3)),
    st.builds("T{} M6".format, st.integers(0, 6)),
    st.builds("G43 H{} Z{}".format, st.integers(0, 6), numbers),
    st.builds("G5{}".format, st.integers(3, 9)),
    st.sampled_from(["G43", "G49", "G54", "M3 S4000", "M8", "M9", "M5", "G0 Z20.", "G80", "G18",
                     "G17", "G19", "(roughing) (fine)", "G90", "G91", "G0 X0 Y0", "G10 L2 P2 X3 R9",
                     "G84 Z-5 R1", "G74 Z-5 R1", "M4", "N5", "G92 X2", "G92.1", "M6", "G53 G0 Z0",
                     "G28 Z0", "G41 D1", "G40", "G42.1 D3", "G10 L1 P1 Z3"]),
)  # fmt: skip
small = st.decimals(-9, 9, places=3).map(str)
#: arcs that a control accepts wherever they begin, and other lines that are right anywhere
sound = st.one_of(
    st.builds(lambda g, a, b, z: f"G91 G17 G{g} X{2 * a} Y{2 * b} I{a} J{b} Z{z} F90",
              st.sampled_from([2, 3]), st.decimals(1, 9, places=3), st.decimals(-9, 9, places=3),
              small),
    st.builds("G91 G17 G{} X{} Y{} R{} F50".format, st.sampled_from([2, 3]), small,
              st.decimals(1, 9, places=3), st.sampled_from(["20.", "-31.5", "7"])),
    st.builds("G91 G18 G{} X{} Z{} R{} Y1".format, st.sampled_from([2, 3]), small,
              st.decimals(1, 9, places=3), st.sampled_from(["20.", "-31.5", "7"])),
    st.builds("G91.1 G19 G{} J{} K{} X{} P3 A5".format, st.sampled_from([2, 3]), small,
              st.decimals(1, 9, places=3), small),
    st.builds("G90 G1 X{} Y{} F{} S{}".format, small, small, st.integers(1, 900),
              st.integers(0, 9000)),
    st.builds("G0 X{} Z{} A{} C-3.5".format, small, small, small),
    st.builds("G90 G17 G{} X{} Y{} Z-3. R2. Q{} L2".format, st.sampled_from([83, 73]), small,
              small, st.sampled_from(["1.5", "0.7"])),
    st.builds("G{} G{} X{} Y{} Z-3. R2. ".format, st.sampled_from([98, 99]),
              st.sampled_from([81, 85]), small, small),
    st.builds("G91 G18 G{} X{} Y-3. Z{} R2. P.25 L3".format, st.sampled_from([82, 89]), small,
              small),
    st.builds("M3 G17 G90 G84 X{} Z-5 R1\nX{}".format, small, small),
    st.builds("T{} M6 G43".format, st.integers(0, 5)),
    st.builds("T{} M6\nG43 H{} Z{}".format, st.integers(0, 5), st.integers(0, 5), small),
    st.builds("G0 G5{} G90 X{}".format, st.integers(4, 9), small),
    st.sampled_from(["G0 G43 Z3", "G49", "G54", "M3 S4000", "M8", "M9 M5", "G0 Z20.", "G80", "G18",
                     "G17", "(roughing) (fine)", "G90", "G80 G10 L2 P2 X3 R9", "M4", "N5",
                     "G80 G92 X2", "G92.1", "G61", "G64 P.02", "M3 G86 X3 Z-2 R1 P.5",
                     "G88 X1 Z-2 R1 P0", "G4 P1.5", "M0", "G94 F70", "G21", "G91.1", "G20", "G40",
                     "G41 D1\nG0 X50 Y50\nG1 X90\nG40\nG0 X100", "G53 G0 Z0", "G28 Z0", "#1=2"]),
)  # fmt: skip
other = st.sampled_from(
    ["G90", "G20", "G21", "G92 X1", "G2 X5 Y5 R9", "T1 M6", "G43 H2", "G4 P1", "%", "/G0 X1",
     "#1=2", "G1 X#1", "O1 repeat [2]", "O1 endrepeat", "G55", "G81 X1 Z-1 R1", "G80", "G93",
     "G95", "G7", "M70", "M72", "(PRINT, #1)", "G38.2 Z-50"]
)  # fmt: skip
programs = st.lists(st.one_of(plain, cam, cam, cam, other), max_size=30)
sound_programs = st.lists(sound, max_size=30)


def outcome(text, **options):
    options.setdefault("tools", TOOLS)
    try:
        program = read_program(Source(text), max_blocks=2000, **options)
    except ProgramError as error:
        return str(error)
    return program


def assert_same_record(one, two):
    assert one.notes == two.notes
    assert [str(e) for e in one.record.events] == [str(e) for e in two.record.events]
    assert one.record.arcs.tobytes() == two.record.arcs.tobytes()
    assert one.record.dwells.tobytes() == two.record.dwells.tobytes()
    for field in fields(Path):
        slow, fast = (getattr(p.record.path(), field.name) for p in (one, two))
        assert slow.shape == fast.shape
        assert slow.tobytes() == fast.tobytes(), field.name


def assert_read_alike(text, **options):
    slow = outcome(text, fast=False, **options)
    with patch.object(fast_lane, "_SHORT", 0):  # even single lines go to the compiled reader
        fast = outcome(text, fast=True, **options)
    if isinstance(slow, str) or isinstance(fast, str):
        assert slow == fast
    else:
        assert_same_record(slow, fast)


@settings(max_examples=300, deadline=None)
@given(
    st.one_of(programs, sound_programs, sound_programs), st.sampled_from(["\n", "\r\n"]),
    st.sampled_from([1.0, 25.4]), st.booleans(),
)  # fmt: skip
def test_compiled_reader_gives_the_same_bits(lines, ending, unit_mm, preview):
    text = ending.join(["F10 S100", *lines, ""]).encode()
    offsets = {"G55": (10.5, -3.25, 7.1), "G59.3": (1.0, 2.0, 3.0)}
    assert_read_alike(text, machine_unit_mm=unit_mm, preview=preview, work_offsets_mm=offsets)


def test_a_negative_zero_keeps_its_sign_behind_a_line_that_falls_back():
    assert_read_alike(b"F100\nG1 X#1\nG1 Z-0\n")


#: what Fanuc and Haas have otherwise
fanuc = st.one_of(
    sound,
    st.builds("G{} X{} Y{} R2. Z{} F100 K{}".format, st.sampled_from([81, 82, 85, 84]), small,
              small, st.sampled_from(["-3.", "-7"]), st.integers(0, 3)),
    st.builds("G{} G98 X{} Z-9.3 R1. Q{} P{}".format, st.sampled_from([73, 83, 84, 89]), small,
              st.sampled_from(["2.", "1.7", "0"]), st.sampled_from(["300", "1.5"])),
    st.builds("X{} Y{} M8".format, small, small),
    st.builds("T{} M6\nG0 G43 H{} Z{} M3 S{}".format, st.integers(1, 5), st.integers(0, 6), small,
              st.integers(0, 12000)),
    st.builds("G91 G43 H{} Z{}".format, st.integers(1, 5), small),
    st.builds("G1 X{} Y{} Z{} F{} M9".format, small, small, small, st.integers(0, 900)),
    st.builds("M{} M{} X{}".format, st.sampled_from([3, 4, 8, 13]), st.sampled_from([5, 9]),
              small),
    st.sampled_from(["G80 X5.", "G80", "G2", "G0", "G3 F50", "H3", "G49", "G44 H2", "(a, b)",
                     "G68 R30.", "G69", "G51.1 X0.", "G50.1 X0.", "X1.,R2.", "G15", "G16", "#1=2.",
                     "S99.5", "G54 P2", "G54.1 P3", "G9 X3.", "G76 X1. Z-3. R1. Q.2",
                     "G86 X3. Z-2. R1.", "G87 Z-3.", "M98 P7", "G65 P7", "G53 Z0.", "G4 P500",
                     "M29", "/X3.", "D2", "M1"]),
)  # fmt: skip


@settings(max_examples=200, deadline=None)
@given(
    st.lists(fanuc, max_size=25), st.sampled_from(["fanuc", "haas", "mach", "centroid"]),
    st.sampled_from([None, "IS-B", "calculator"]), st.booleans(),
)  # fmt: skip
def test_compiled_reader_reads_fanuc_to_the_same_bits(lines, dialect, increment, preview):
    text = "\n".join(["O1", "F10. S100", *lines, ""]).encode()
    control = ControlSettings(increment=increment)
    assert_read_alike(text, dialect=dialect, control=control, preview=preview,
                      work_offsets_mm={"G55": (10.5, -3.25, 7.1)})  # fmt: skip


spoken = st.one_of(sound_programs.map(lambda lines: "\n".join(["F10", *lines, ""]).encode()),
                   st.sampled_from(PROGRAMS).map(FilePath.read_bytes))  # fmt: skip


@settings(max_examples=80, deadline=None)
@given(spoken, st.sampled_from([1, 3, 1 << 16]), st.sampled_from([0, 4_000]))
def test_canonical_text_has_the_calls(text, rows_at_once, compiled_from):
    program = outcome(text)
    if isinstance(program, str):
        return
    wanted = [" ".join([str(line), name, *(repr(v + 0.0) if isinstance(v, float) else str(v)
                                           for v in values)])
              for line, name, values in canon_calls(program)]  # fmt: skip
    with patch.multiple(canon, _ROWS=rows_at_once, _COMPILED_FROM=compiled_from):
        assert list(canon_lines(program)) == wanted


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(PROGRAMS), st.data())
def test_mutilated_programs_give_a_result_or_one_clear_error(path, data):
    text = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(text) - 1))
        text[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
    result = outcome(bytes(text))
    if isinstance(result, str):
        assert re.match(r"<program>:\d+:", result), result
    else:
        assert np.isfinite(result.moves.end_mm).all()


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_come_back(data):
    source = Source(data)
    assert source.rewritten({}) == data
    for line in range(1, len(source) + 1):
        for word in source.words(line):
            assert data[word.span[0] : word.span[1]].decode("latin-1") == word.text


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-500, 500)] * 3), min_size=1, max_size=20))
def test_straight_moves_end_where_the_words_say(points):
    rounded = np.round(points, 4)
    lines = [f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}" for x, y, z in rounded]
    moves = read_program(Source("\n".join(["F100", *lines, "M2"]).encode())).moves
    assert (moves.end_mm == rounded).all()
    lengths = np.linalg.norm(np.diff(rounded, axis=0), axis=1)
    assert np.allclose(moves.duration_s[1:], lengths * 0.6)
