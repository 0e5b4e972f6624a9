"""The token store keeps every byte and knows where each word stands."""

import pytest

from gcode import ProgramError, Source, canon_lines, read_program
from gcode.text.source import readable

TEXT = b"%\r\nN10 G1 X 1.5Y-.25 (X9) F#<feed>\ng0 x[#1 + 2*[3]] y2 ; z7\n#3=4 Z[1]\nM3\xe9\n\n"


def test_bytes_come_back_untouched():
    assert Source(TEXT).rewritten({}) == TEXT


def test_words_have_letter_value_text_and_span():
    source = Source(TEXT)
    words = source.words(2)
    assert [(w.letter, w.value, w.text) for w in words] == [
        ("N", 10.0, "N10"),
        ("G", 1.0, "G1"),
        ("X", 1.5, "X 1.5"),
        ("Y", -0.25, "Y-.25"),
        ("F", None, "F#<feed>"),
    ]
    for word in words:
        assert TEXT[word.span[0] : word.span[1]].decode() == word.text


def test_words_with_expressions_end_where_the_next_begins():
    words = Source(TEXT).words(3)
    assert [(w.letter, w.text) for w in words] == [
        ("G", "g0"), ("X", "x[#1 + 2*[3]]"), ("Y", "y2"),
    ]  # fmt: skip


def test_parameter_settings_are_no_words():
    assert [w.letter for w in Source(TEXT).words(4)] == ["Z"]


def test_replacing_a_word_leaves_everything_else():
    source = Source(TEXT)
    word = source.words(2)[2]
    changed = source.rewritten({word.span: "X2.000"})
    assert changed == TEXT.replace(b"X 1.5", b"X2.000")


def test_overlapping_replacements_are_refused():
    with pytest.raises(ValueError, match="overlap"):
        Source(TEXT).rewritten({(0, 5): "a", (3, 8): "b"})


def test_lines_are_counted_with_and_without_final_newline():
    assert len(Source(b"a\nb")) == 2
    assert len(Source(b"a\nb\n")) == 2
    assert len(Source(b"")) == 0


@pytest.mark.parametrize("text", [b"%\nG21\nT1 M6\nG0 X1\nM30\n%\n", b"G21\nT1 M6\nG0 X1\nM30\n"])
def test_a_byte_order_mark_is_stepped_over_and_kept(tmp_path, text):
    marked = b"\xef\xbb\xbf" + text
    plain, path = tmp_path / "plain.nc", tmp_path / "marked.nc"
    plain.write_bytes(text)
    path.write_bytes(marked)
    assert list(canon_lines(read_program(path))) == list(canon_lines(read_program(plain)))
    source = Source.read(path)
    line = source.lines.index("G0 X1") + 1
    start, stop = source.words(line)[1].span
    assert marked[start:stop] == b"X1"
    assert source.rewritten({(start, stop): "X2"}) == marked.replace(b"X1", b"X2")


def test_what_is_no_text_is_refused(tmp_path):
    path = tmp_path / "part.nc"
    path.write_bytes(b"G0 X1\nG1 \0\0")
    with pytest.raises(ProgramError, match=r"part\.nc:2: .* no text"):
        Source.read(path)


@pytest.mark.parametrize(
    "text, is_whole",
    [
        (b"%\nG21\nG0 X1\n%\n", True),
        (b"%\nG21\nG0 X1\n%", True),
        (b"%\nO1\nG21\nG0 X1\nM30\n", True),
        (b"\n%\nG21\nG0 X1\nN9M02\n", True),
        (b"G21\nG0 X1\n", True),  # nothing says that an end has to come
        (b"%\nG21\nG0 X1\nG0 X-4", False),
        (b"%\r\nG21\r\nG0 X1\r\nG1 X2 F300", False),
        (b"%\n", False),
    ],
)
def test_a_program_cut_short_is_noted(text, is_whole):
    notes = [n for n in read_program(Source(text, "part.nc")).notes if "cut short" in n.meaning]
    assert len(notes) == (not is_whole)
    assert all(n.line == len(text.splitlines()) for n in notes)


@pytest.mark.parametrize(
    "data, shown",
    [
        (b"(PLATTE)", "(PLATTE)"),
        ("(M\u00dcLLER \u2013 SK\u00c5R)".encode(), "(M\u00dcLLER \u2013 SK\u00c5R)"),
        ("(M\u00dcLLER \u2013)".encode("cp1252"), "(M\u00dcLLER \u2013)"),
        (b"(\x81\xdc)", "(\x81\xdc)"),  # neither: as it is
    ],
)
def test_a_line_is_shown_as_it_was_written(data, shown):
    (line,) = Source(data).lines
    assert readable(line) == shown
    assert line.encode("latin-1") == data


@pytest.mark.parametrize("dialect", ["linuxcnc", "fanuc", "sinumerik", "heidenhain"])
def test_lines_that_end_with_carriage_returns_alone_are_refused(tmp_path, dialect):
    """As one line, all behind the first comment or program name would be lost in silence."""
    path = tmp_path / "part.nc"
    path.write_bytes(b"0 BEGIN PGM A MM ; a\r1 L X+1 F100\r2 END PGM A MM\r")
    with pytest.raises(ProgramError, match=r"part.nc:1: its lines end with carriage returns alone"):
        read_program(path, dialect=dialect)
    path.write_bytes(b"G21 G90 G0 X1\r")
    assert len(read_program(path).moves) == 1
