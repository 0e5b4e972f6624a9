"""Notes are records: decided upon by kind, read by their sentence."""

import ast
import json
import re
from pathlib import Path

import numpy as np
import pytest

from vmach.base.note import Kind, Level, Note, in_file, note_records
from vmach.errors import InputError
from vmach.measurements.plausibility.part_check import check_file
from vmach.nominal.points import SurfacePoints

ROOT = Path(__file__).parents[2]
PLAIN = Note.plain(Kind.ROWS, "rows sorted by position")
DOUBT = Note(Level.DOUBT, Kind.LENGTH, "tool 2", "is it in metres?", 0.1, "mm", "10 .. 1000 mm")


@pytest.mark.parametrize(
    ("note", "text"),
    [
        (PLAIN, "rows sorted by position"),
        (Note.question(Kind.CLOCK, "is t_s in seconds?"), "is t_s in seconds?"),
        (DOUBT, "doubt: tool 2: is it in metres?; accepted: 10 .. 1000 mm"),
        (*in_file([PLAIN], Path("a/exx.csv")), "exx.csv: rows sorted by position"),
        (*in_file([PLAIN], Path("a/exx.csv"), 7), "exx.csv:7: rows sorted by position"),
        (*in_file([DOUBT], Path("job.toml")),
         "job.toml: doubt: tool 2: is it in metres?; accepted: 10 .. 1000 mm"),
    ],
)  # fmt: skip
def test_text_has_place_level_sentence_and_what_is_accepted(note, text):
    assert str(note) == text
    (record,) = json.loads(json.dumps(note_records([note])))
    assert record["text"] == text
    assert (record["level"], record["kind"]) == (str(note.level), str(note.kind))


def test_refusal_of_measured_points_in_another_unit_carries_the_note(tmp_path):
    place = np.random.default_rng(1).uniform(0.0, 50.0, (20, 3))
    note = Note.question(Kind.UNIT, "in whatever words", 1e-3, "1")
    points = SurfacePoints(
        np.arange(20), np.full(20, ""), place, np.tile([0.0, 0.0, 1.0], (20, 1)),
        measured_mm=place * 1e-3, notes=(note,),
    )  # fmt: skip
    with pytest.raises(InputError, match="in whatever words") as refused:
        check_file(points, tmp_path / "points.csv")
    assert refused.value.note == note


def test_no_record_holds_notes_as_words():
    words = re.compile(r"^\s+notes: (tuple|list)\[str", re.MULTILINE)
    found = [
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "vmach").rglob("*.py")
        if path.parent.name != "schemas" and words.search(path.read_text())
    ]
    assert found == []


def test_nothing_is_decided_by_the_words_of_a_note():
    """No `"..." in note`, no `note.startswith(...)` in the package."""
    for path in (ROOT / "vmach").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
                asked = ast.unparse(node.comparators[0]).removeprefix("str(").removesuffix(")")
                assert asked not in ("note", "note.sentence", "note.text"), f"{path}:{node.lineno}"
            if isinstance(node, ast.Attribute) and node.attr in (
                "startswith", "endswith", "removeprefix", "split", "partition",
            ):  # fmt: skip
                asked = ast.unparse(node.value)
                assert asked not in ("note", "note.sentence", "note.text"), f"{path}:{node.lineno}"


def test_counts_of_numpy_are_numbers_of_json():
    note = Note.plain(Kind.ROWS, "rows", np.count_nonzero(np.array([1, 2]) > 1), "1")
    (record,) = json.loads(json.dumps(note_records([note])))
    assert record["size"] == 1
