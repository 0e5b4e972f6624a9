"""The text of STEP files: strings, comments and numbers, well formed or not, in linear time."""

import time
from pathlib import Path

import pytest

from vmach.errors import InputError
from vmach.nominal.step.exchange_file import StepFile

NUT = (Path(__file__).parents[1] / "golden" / "cad" / "nut.step").read_text()
NAME = "'Open CASCADE STEP translator 7.6 2'"

#: reading the file takes 2 ms; the patterns of before took hours
LONGEST_S = 5.0


def step(tmp_path, text):
    path = tmp_path / "part.step"
    path.write_text(text, encoding="latin-1")
    return StepFile(path)


def product(tmp_path, name):
    return step(tmp_path, NUT.replace(NAME, name, 1)).of_type("PRODUCT")


def test_single_apostrophe_is_named_with_its_line(tmp_path):
    began = time.process_time()
    with pytest.raises(InputError, match=r"part\.step:17: the text 'Bob' .* twice: 'Bob''s nut'"):
        product(tmp_path, "'Bob's nut'")
    assert time.process_time() - began < LONGEST_S


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("'Bob''s nut'", "Bob's nut"),
        ("''''", "'"),
        ("''", ""),
        ("'a;b'", "a;b"),
        ("'#7=CIRCLE(1);'", "#7=CIRCLE(1);"),
        ("'/* no comment */'", "/* no comment */"),
        (r"'see \S\' 12'", r"see \S\' 12"),  # a section sign
        (r"'C:\S\'", "C:\\S\\"),  # a path
        ("'a\nb'", "a\nb"),
        ("/* 'nut' */ 'nut' /* ; */", "nut"),
    ],
)
def test_strings_and_comments(tmp_path, written, name):
    (entity,) = product(tmp_path, written)
    assert entity.arguments[0] == name


@pytest.mark.parametrize(
    "inserted",
    [
        "'" * 200_001,
        "/*" * 100_000,
        "#1=" * 100_000,
        "#1=A(" + "(" * 100_000,
        "#" + "1" * 5000 + "=A();",
    ],
)
def test_text_of_any_kind_ends_in_a_message(tmp_path, inserted):
    began = time.process_time()
    with pytest.raises(InputError, match=r"part\.step:8: "):
        step(tmp_path, NUT.replace("DATA;", "DATA;" + inserted, 1)).entity(1)
    assert time.process_time() - began < LONGEST_S


def test_comments_keep_the_lines(tmp_path):
    file = step(tmp_path, NUT.replace("DATA;", "DATA;\n/* one\ntwo */", 1))
    assert file.line(1) == StepFile(Path(__file__).parents[1] / "golden/cad/nut.step").line(1) + 2
