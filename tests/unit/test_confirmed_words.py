"""The table of confirmed words: data, documentation, tests and note agree."""

from pathlib import Path

import pytest

from gcode import Source, read_program
from gcode.language.confirmation import TRUTHS, confirmation_table, unconfirmed_words
from gcode.language.registry import dialect_called

ROOT = Path(__file__).parents[2]
NAMES = ("fanuc", "haas", "mach", "centroid", "mazak", "okuma", "heidenhain", "sinumerik")


def notes(text, dialect):
    return {note.word: note.meaning for note in read_program(
        Source(text.encode(), "part"), dialect=dialect).notes}  # fmt: skip


def test_the_documentation_has_the_table():
    tables = {name: dialect_called(name).confirmed for name in NAMES}
    assert confirmation_table(tables) in (ROOT / "docs/gcode.md").read_text(encoding="utf-8")


def test_the_tests_of_a_truth_exist():
    for _, files in TRUTHS.values():
        assert all((ROOT / "tests/oracle" / file).is_file() for file in files)


@pytest.mark.parametrize("name", NAMES)
def test_a_word_stands_in_a_test_of_its_truth(name):
    for truth, said in dialect_called(name).confirmed.items():
        texts = [(ROOT / "tests/oracle" / file).read_text(encoding="utf-8").upper()
                 for file in TRUTHS[truth][1]]  # fmt: skip
        if truth == "posts" or not texts:
            continue  # their words stand in the posted files
        for word in (word.strip().upper() for word in said.split(";")):
            code = word.rstrip("0123456789.")
            pieces = [word.split(), [f"{code}0{word[len(code) :]}"]]
            found = [all(piece in text for piece in some) for text in texts for some in pieces]
            assert any(found), (truth, word)


def test_a_program_says_once_what_nobody_has_confirmed():
    assert "not confirmed" not in notes("O1\nG21 G0 X1.\nG22\nM30\n", "fanuc")
    assert "not confirmed" not in notes("BEGIN PGM A MM\nL X+1 FMAX\n", "heidenhain")
    found = notes("O1\nG21 G0 X1.\nG154 P2\nG154 P1\nM30\n", "fanuc")
    assert found["not confirmed"].startswith("G154: ")


def test_a_dialect_without_a_table_says_nothing():
    assert unconfirmed_words(["G0", "G999"], {}) == []
    assert unconfirmed_words(["G0", "G999", "M7"], {"manual": "G0; M7"}) == ["G999"]
