"""Plain lines written in compiled code are those that are written one by one."""

from itertools import pairwise
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gcode import MoveKind, Source, ToolEntry, dialect_called, read_program
from tests.lane_programs import Dice, random_program
from vmach.program_text import Piece, Pieces, Rewriter, Target, block_modes, plain_program
from vmach.program_text.runs.axis_words import axis_words
from vmach.program_text.runs.splicing import Edits, spliced

TOOLS = {k: ToolEntry(100.0, 10.0) for k in (1, 2)}
numbers = st.sampled_from(
    [
        "0",
        "0.",
        ".5",
        "-.25",
        "+7.",
        "+0.125",
        "-3.0000",
        "12",
        "-0.001",
        "8.1234567",
        "0.50",
        "+.0",
    ]
)
lines = st.builds(
    lambda label, code, places, letters, last: " ".join(
        [label, code, *(k + v for k, v in zip(letters, places, strict=False)), last]
    ),
    st.sampled_from(["", "", "N7"]),
    st.sampled_from(["", "", "G1", "g01", "G0"]),
    st.lists(numbers, min_size=1, max_size=3),
    st.sampled_from(["XYZ", "ZXY", "yzx", "XZ"]),
    st.sampled_from(["", "", "F200", "(go)", "; end"]),
)
arcs = st.sampled_from(["G91 G2 X2 I1\nG90", "G91 G1 X1\nG90", "/X5", "X 6 Y1 0", "G20\nX.5\nG21"])
#: arcs from known places, by centre and by radius, in all planes, some with words that are missing
turns = st.builds(
    "G90 G1 X0. Y0. Z0. F300\n{}\nG17".format,
    st.sampled_from([
        "G2 X10. Y0. I5. J0.", "G02 X5. Y5. I5 J-0.", "G3 X10 Y0 I5", "G3 X8.0 Y-6. I5. J.0 F50",
        "G2 X3. Y3. R4.", "G3 X3. Y3. Z1. R-4.125", "G2 X10. Y0. I5. J0. Z-2.\nX0. Y0. I-5. J0.",
        "G18 G2 X10. Z0. I5. K0.", "G19 G3 Y3. Z3. R+3.5", "G90.1 G2 X10. Y0. I5. J0.\nG91.1",
        "G2 I5. J0.", "G2 X10. Y0. I5. J0. K0.", "G20 G2 X1. Y0. I.5 J0.\nG21", "G2 X.1 Y0. I5. J0",
    ]),
)  # fmt: skip
programs = st.lists(st.one_of(lines, lines, lines, arcs, turns), min_size=1, max_size=25)


def written(text, seed, resolution_mm, *, compiled, dialect="linuxcnc"):
    """The program with random corrections of its ends; some lines count as not the user's."""
    program = read_program(Source(text), home_mm=(0.0, 0.0, 0.0), dialect=dialect, tools=TOOLS)
    random, moves = np.random.default_rng(seed), program.moves
    own = frozenset(moves.line[random.uniform(size=len(moves)) < 0.3 * (seed % 2)].tolist())
    rewriter = Rewriter(program, block_modes(program), own, dialect_called(dialect))
    if not compiled:
        rewriter._columns.is_plain[:] = False
    share = float(rewriter._columns.is_plain[rewriter.moving].mean()) if compiled else 0.0
    pieces = []
    for move in rewriter.moving:
        arc = moves.kind[move] == MoveKind.ARC
        cuts = [0.0, 0.4, 1.0] if random.uniform() < 0.1 and not arc else [0.0, 1.0]
        kept = bool(random.uniform() < 0.1)
        pieces += [Piece(move, a, b, is_arc=bool(arc), kept=kept and len(cuts) == 2)
                   for a, b in pairwise(cuts)]  # fmt: skip
    size = random.choice([0.0, 1e-12, 3e-4, 5e-4, 0.02], (len(pieces), 1))
    ends = size * random.uniform(-1.0, 1.0, (len(pieces), 3))
    return rewriter.write(Target(Pieces.of(pieces), ends, 0.5 * ends), resolution_mm), share


@settings(max_examples=150, deadline=None)
@given(
    programs, st.integers(0, 2**31), st.sampled_from([1e-3, 1e-4, 1e-7]), st.sampled_from("\n\r")
)
def test_compiled_lines_are_those_written_one_by_one(found, seed, resolution_mm, ending):
    text = ("\r\n" if ending == "\r" else "\n").join(["F100 G1 X0 Y0 Z0", *found]).encode()
    assert_written_alike(text, seed, resolution_mm)


def assert_written_alike(text, seed, resolution_mm, dialect="linuxcnc"):
    """The share of moves that are written in compiled code; None where the program is refused."""
    try:
        with patch.object(plain_program, "axis_words", no_words):
            slow, _ = written(text, seed, resolution_mm, compiled=False, dialect=dialect)
    except ValueError as error:
        with pytest.raises(type(error)):
            written(text, seed, resolution_mm, compiled=True, dialect=dialect)
        return None
    fast, share = written(text, seed, resolution_mm, compiled=True, dialect=dialect)
    assert fast.text == slow.text
    assert fast.line_of_piece.tolist() == slow.line_of_piece.tolist()
    assert (fast.inserted_after, fast.swallowed) == (slow.inserted_after, slow.swallowed)
    return share


def no_words(data, starts, line, form):
    """Words of lines of which none is plain: their texts are read one by one."""
    return axis_words(data, starts, line, "")


@pytest.mark.parametrize("language", ["sinumerik", "heidenhain"])
def test_lines_of_other_controls_are_those_written_one_by_one(language):
    dice, shares = Dice(5), []
    for seed in range(150):
        text = random_program(language, dice, sound=seed % 4 > 0)
        if seed % 8:  # as `compensate` asks for them
            text = text.replace(b",", b".").replace(b"70+5", b"75").replace(b"= ", b"=")
        resolution_mm = dice.choice([1e-3, 1e-4, 1e-7])
        shares.append(assert_written_alike(text, seed, resolution_mm, dialect=language))
    read = [share for share in shares if share is not None]
    assert len(read) > 60
    assert np.mean(read) > 0.2


@settings(max_examples=60, deadline=None)
@given(st.binary(min_size=1, max_size=60), st.data())
def test_spans_are_replaced_as_the_source_replaces_them(data, draw):
    cuts = sorted(draw.draw(st.lists(st.integers(0, len(data)), min_size=2, max_size=12)))
    spans = list(dict.fromkeys(zip(cuts[::2], cuts[1::2], strict=False)))
    texts = [draw.draw(st.text("abc.7", max_size=9)) for _ in spans]
    changes = dict(zip(spans, texts, strict=True))
    compiled = [k for k in range(len(spans)) if k % 2]
    room, length = np.zeros((len(compiled), 9), np.uint8), []
    for row, k in zip(room, compiled, strict=True):
        row[: len(texts[k])] = np.frombuffer(texts[k].encode(), np.uint8)
        length.append(len(texts[k]))
    start, stop = np.array([spans[k] for k in compiled], np.int64).reshape(-1, 2).T
    edits = Edits(start, stop, room, np.array(length, np.int64))
    others = {span: text for k, (span, text) in enumerate(changes.items()) if k not in compiled}
    assert spliced(data, edits, others) == Source(data).rewritten(changes)
