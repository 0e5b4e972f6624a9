"""Complaints about TOML files name file, line, key, value and what is accepted."""

import pytest

from vmach.errors import InputError
from vmach.toml_file import FileSection, line_of_key, read_toml


class Inner(FileSection):
    length_mm: float = 1.0
    names: list[str] = []


class Outer(FileSection):
    machine: str
    inner: Inner = Inner()
    tools: dict[int, Inner] = {}


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
    assert "accepted: length_mm, names" in message
    assert "did you mean 'length_mm'?" in message


def test_wrong_type(tmp_path):
    with pytest.raises(InputError, match=r"file.toml:3: 'inner.length_mm' = 'long'"):
        read(tmp_path, 'machine = "m"\n[inner]\nlength_mm = "long"\n')


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
    with pytest.raises(InputError, match=r"file\.toml: test file"):
        read_toml(path, Outer, what="test file")


def test_line_of_a_key_inside_an_array_of_tables():
    text = 'a = 1\n[[measurements]]\nkind = "laser"\n\n[b.c]\nd = 2\n'
    assert line_of_key(text, ["measurements", "0", "kind"]) == 3
    assert line_of_key(text, ["b", "c", "d"]) == 6
    assert line_of_key(text, ["b", "c", "missing"]) == 5
    assert line_of_key(text, ["nowhere"]) is None
