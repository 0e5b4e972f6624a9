"""A dialect is checked when it is loaded: what is missing, unknown or taken, with its line."""

from importlib.metadata import EntryPoint

import pytest

from gcode import ProgramError, Source, dialect_names
from gcode.language import registry
from gcode.language.registry import load_dialects
from gcode.writing.block_text import BlockText
from gcode.writing.line_edit import BlockMotion, LineEdit

HEAD = """from gcode import Dialect
from gcode.language.translate import Translated


class Reader(Translated):
    def obey(self, text):
        self.execute(text)


class Own(Dialect):
    name = "own"
    title = "Own"
    source = "its manual"
    reader = Reader
"""
BROKEN = {
    "misspelt": (HEAD + "    sinonyms = ('o',)\n", 15, "did you mean 'synonyms'"),
    "no source": (HEAD.replace('    source = "its manual"\n', ""), 10, "has no source"),
    "bytes": (
        HEAD + "    import re as _re\n    marks = _re.compile(b'a')\n",
        16,
        "pattern of text",
    ),
    "wrong type": (HEAD + "    reads = 'linuxcnc'\n", 15, "accepted: tuple"),
    "no class": (HEAD + "    text = 'plain'\n", 15, "subclass of BlockText"),
    "taken": (HEAD.replace('"own"', '"fanuc"'), 11, "is taken: FANUC"),
    "taken synonym": (HEAD + "    synonyms = ('siemens',)\n", 11, "is taken: SINUMERIK"),
    "reads nothing": (HEAD.replace("    reader = Reader\n", ""), 10, "reads nothing"),
    "name": (HEAD.replace('"own"', '"Own control"'), 11, "lower case"),
}


def loaded(tmp_path, monkeypatch, text, name="own_dialect"):
    (tmp_path / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    return EntryPoint(name, f"{name}:Own", registry.ENTRY_POINTS)


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_dialect_is_refused_with_its_line(case, tmp_path, monkeypatch):
    text, line, reason = BROKEN[case]
    name = "broken_" + case.replace(" ", "_")
    kind = loaded(tmp_path, monkeypatch, text, name).load()
    with pytest.raises(ProgramError, match=reason) as error:
        load_dialects(kind)
    assert (error.value.file.name, error.value.line) == (f"{name}.py", line)


def test_a_package_brings_one_by_an_entry_point(tmp_path, monkeypatch):
    point = loaded(tmp_path, monkeypatch, HEAD)
    monkeypatch.setattr(registry, "entry_points", lambda group: [point])
    assert load_dialects()["own"].title == "Own"


def test_an_entry_point_that_cannot_be_loaded_is_named(tmp_path, monkeypatch):
    point = loaded(tmp_path, monkeypatch, "import nothing_of_this_name\n", "broken_import")
    monkeypatch.setattr(registry, "entry_points", lambda group: [point])
    with pytest.raises(
        ProgramError, match=r"'broken_import = broken_import:Own' of vmach.dialects"
    ):
        load_dialects()


def test_every_dialect_names_what_it_follows():
    found = load_dialects()
    assert {"linuxcnc", "fanuc", "haas", "sinumerik", "heidenhain", "grbl"} <= set(dialect_names())
    assert all(len(kind.source) > 20 for kind in found.values())


@pytest.mark.parametrize(("is_modal", "second"), [(True, "X2"), (False, "G1 X2")])
def test_a_control_may_want_the_motion_word_in_every_block(is_modal, second):
    class Text(BlockText):
        pass

    Text.is_modal = is_modal
    source = Source(b"G1 X5\nM30\n")
    edit = LineEdit(Text(source), 1, nominal=1, ending=frozenset())
    changes = edit.changes([BlockMotion(1, {"X": "1"}), BlockMotion(1, {"X": "2"})], 1, None)
    assert source.rewritten(changes).decode() == f"G1 X1\n{second}\nM30\n"
