"""Complaints about TOML files name file, line, key, value and what is accepted."""

import re

import pytest

from vmach.errors import InputError
from vmach.files.toml_file import FileSection, Finite, Point, line_of_key, read_toml


class Inner(FileSection):
    length_mm: Finite = 1.0
    corner_mm: Point = (0.0, 0.0, 0.0)
    names: list[str] = []


class Outer(FileSection):
    machine: str
    inner: Inner = Inner()
    tools: dict[int, Inner] = {}
    either: dict[str, Finite | Inner] = {}


def read(tmp_path, text):
    path = tmp_path / "file.toml"
    path.write_text(text)
    return read_toml(path, Outer, what="test file")


def test_good_file(tmp_path):
    data = read(tmp_path, 'machine = "m"\n[tools.2]\nlength_mm = 3\n')
    assert data.tools[2].length_mm == 3.0


def test_unknown_key_in_a_nested_table(tmp_path):
    with pytest.raises(InputError) as caught:
        read(tmp_path, 'machine = "m"\n\n[tools.2]\nlenght_mm = 3\n')
    message = str(caught.value)
    assert "file.toml:4: unknown key 'tools.2.lenght_mm'" in message
    assert "accepted: length_mm, corner_mm, names" in message
    assert "did you mean 'length_mm'?" in message


def test_wrong_type(tmp_path):
    with pytest.raises(InputError, match=r"file.toml:3: 'inner.length_mm' = 'long'"):
        read(tmp_path, 'machine = "m"\n[inner]\nlength_mm = "long"\n')


@pytest.mark.parametrize(
    ("value", "accepted"),
    [
        ('"3"', "a number"),
        ("true", "a number"),
        ("nan", "a finite number"),
        ("1e7", "less than or equal to 1000000"),
        ("[3]", "a number"),
    ],
)
def test_no_number(tmp_path, value, accepted):
    with pytest.raises(
        InputError, match=rf"file.toml:3: 'inner.length_mm' = .*accepted: {accepted}"
    ):
        read(tmp_path, f'machine = "m"\n[inner]\nlength_mm = {value}\n')


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tools.abc]", "file.toml:2: 'tools.abc' = 'abc'; accepted: a whole number"),
        ('either.one = "3"', "file.toml:2: 'either.one' = '3'; accepted: a number, or a table"),
        (
            '[either.one]\nlength_mm = "x"',
            "file.toml:3: 'either.one.length_mm' = 'x'; accepted: a number",
        ),
        (
            "[either.one]\nnames = [3]",
            "file.toml:3: 'either.one.names.0' = 3; accepted: text in quotes",
        ),
    ],
)
def test_keys_are_those_of_the_file(tmp_path, text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        read(tmp_path, f'machine = "m"\n{text}\n')


def test_a_whole_number_is_a_number(tmp_path):
    assert read(tmp_path, 'machine = "m"\n[inner]\nlength_mm = 3\n').inner.length_mm == 3.0


@pytest.mark.parametrize(
    ("value", "accepted"), [("[1, 2]", "a longer list"), ('"1 2 3"', "a list in brackets")]
)
def test_no_point(tmp_path, value, accepted):
    with pytest.raises(InputError, match=rf"file.toml:3: 'inner.corner_mm' = .*{accepted}"):
        read(tmp_path, f'machine = "m"\n[inner]\ncorner_mm = {value}\n')


def test_a_byte_order_mark_and_windows_line_ends(tmp_path):
    path = tmp_path / "file.toml"
    path.write_bytes(b'\xef\xbb\xbfmachine = "m"\r\n[inner]\r\nlength_mm = 2\r\n')
    assert read_toml(path, Outer, what="test file").inner.length_mm == 2.0


def test_missing_key(tmp_path):
    with pytest.raises(InputError, match=r"file.toml: key 'machine' is missing"):
        read(tmp_path, "[inner]\n")


def test_no_toml(tmp_path):
    with pytest.raises(InputError, match=r"file.toml:2: test file is not valid TOML"):
        read(tmp_path, 'machine = "m"\nthis is not\n')


@pytest.mark.parametrize(
    "make", [lambda p: None, lambda p: p.mkdir(), lambda p: p.write_bytes(b"\xff")]
)
def test_unreadable_file(tmp_path, make):
    path = tmp_path / "file.toml"
    make(path)
    with pytest.raises(InputError, match=r"file\.toml(:1)?: test file"):
        read_toml(path, Outer, what="test file")


def test_line_of_a_key_inside_an_array_of_tables():
    text = 'a = 1\n[[measurements]]\nkind = "laser"\n\n[b.c]\nd = 2\n'
    assert line_of_key(text, ["measurements", "0", "kind"]) == 3
    assert line_of_key(text, ["b", "c", "d"]) == 6
    assert line_of_key(text, ["b", "c", "missing"]) == 5
    assert line_of_key(text, ["nowhere"]) is None


def test_tables_of_an_array_are_told_apart():
    text = '[[measurements]]\nkind = "laser"\n[[measurements]]\nfile = "a"\nkind = "tip"\n'
    assert line_of_key(text, ["measurements", "1", "kind"]) == 5
    assert line_of_key(text, ["measurements", "1", "missing"]) == 3


def test_a_long_value_is_cut_short(tmp_path):
    rows = ", ".join("{length_mm = 3}" for _ in range(500))
    with pytest.raises(
        InputError, match=r"'tools' = \[\{'length_mm': 3\}.* …; accepted: a table"
    ) as said:
        read(tmp_path, f'machine = "m"\ntools = [{rows}]\n')
    assert len(str(said.value).splitlines()[0]) < 300
