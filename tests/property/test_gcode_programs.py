"""Random programs: two readers agree, text comes back, nothing but one clear error happens."""

import re
from dataclasses import fields
from pathlib import Path
from unittest.mock import patch

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode import Moves, ProgramError, Source, ToolEntry, read_program
from gcode.fast import fast_lane

FOLDER = Path(__file__).parents[1] / "golden" / "gcode"
PROGRAMS = sorted(FOLDER.glob("*.ngc"))
TOOLS = {n: ToolEntry(10.0 * n, 2.0 * n) for n in range(1, 6)}

numbers = st.one_of(
    st.integers(-999, 999).map(str),
    st.decimals(-999, 999, places=4).map(str),
    st.sampled_from(["-0", ".5", "-.25", "+7.", "0.1234567890123456789", "1 2", "00012"]),
)
words = st.builds(lambda a, b: a + b, st.sampled_from("XYZxyzFN"), numbers)
plain = st.lists(
    st.one_of(words, st.sampled_from(["G0", "g1", "G01", "(remark)", " ", "; tail", "M8", "G91"])),
    max_size=6,
).map(" ".join)
other = st.sampled_from(
    ["G90", "G20", "G21", "G92 X1", "G2 X5 Y5 R9", "T1 M6", "G43 H2", "G4 P1", "%", "/G0 X1",
     "#1=2", "G1 X#1", "O1 repeat [2]", "O1 endrepeat", "G55", "G81 X1 Z-1 R1", "G80", "G93"]
)  # fmt: skip
programs = st.lists(st.one_of(plain, plain, plain, other), max_size=30)


def outcome(text, **options):
    try:
        program = read_program(Source(text), tools=TOOLS, max_blocks=2000, **options)
    except ProgramError as error:
        return str(error)
    return program


@settings(max_examples=300, deadline=None)
@given(programs, st.sampled_from(["\n", "\r\n"]))
def test_compiled_reader_gives_the_same_bits(lines, ending):
    text = ending.join(["F10", *lines, ""]).encode()
    slow = outcome(text, fast=False)
    with patch.object(fast_lane, "_SHORT", 0):  # even single lines go to the compiled reader
        fast = outcome(text, fast=True)
    if isinstance(slow, str) or isinstance(fast, str):
        assert slow == fast
        return
    assert slow.notes == fast.notes
    for field in fields(Moves):
        one, two = getattr(slow.moves, field.name), getattr(fast.moves, field.name)
        assert one.shape == two.shape
        assert one.tobytes() == two.tobytes(), field.name


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
