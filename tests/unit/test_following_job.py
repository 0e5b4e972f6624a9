"""The text of a job that goes on from another: its paths, and tables that are written inline."""

import tomllib
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

import pytest

from tests.small_job import write_job, write_nominal_stl
from vmach.errors import InputError
from vmach.files.toml_file import FileSection
from vmach.history.following_job import moved_text
from vmach.history.job_text import with_tables
from vmach.history.set_values import set_values
from vmach.instruments.catalogue import catalogue
from vmach.job import read_job
from vmach.job.path_keys import path_keys
from vmach.job.schema import JobSchema

#: keys whose text is no name of a file
WORDS = {
    "control.name", "control.increment", "control.ignore_calls.*", "control.options.*",
    "dialect", "workpiece_zero", "tools.*.name", "inspection.datums.*.*", "fitted.*.effect",
    "correlated.*.effects.*",
    "fitted.*.target", "history.*.added.*", "features.*.name", "features.*.faces",
    "features.*.faces.*", "datums.*", "tolerances.*", "tolerances.*.*", "drawing.part",
    "drawing.serial", "drawing.revision",
}  # fmt: skip


def texts(annotation: Any):
    """Keys below a type that hold any text."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation is str:
        yield ()
    elif isinstance(annotation, type) and issubclass(annotation, FileSection):
        for name, field in annotation.model_fields.items():
            yield from ((name, *keys) for keys in texts(field.annotation))
    elif origin is Annotated:
        yield from texts(parts[0])
    elif origin in (dict, list):
        yield from (("*", *keys) for keys in texts(parts[-1]))
    elif origin in (Union, UnionType):
        for part in parts:
            yield from texts(part)


def test_every_text_of_a_job_is_a_path_or_known_to_be_none():
    paths = {".".join(keys) for keys in path_keys()}
    assert {".".join(keys) for keys in texts(JobSchema)} <= paths | WORDS
    assert not paths & WORDS
    assert "measurements.*.file" in paths


def test_instruments_name_one_file():
    for kind in catalogue().values():
        named = {name for name, field in kind.model_fields.items() if field.annotation is str}
        assert named <= {"kind", "file"}


ALL_PATHS = """
schema = 1
"machine" = 'machine.toml'  # the old one
program = "part \\"1\\".nc"
nominal = "part.stl"
measured = '''points.csv'''
control = {subprograms = "subs"}
stock = {file = "blank.stl"}
drawing.logo = "logo.png"
fitted = []
measurements = [{kind = "laser", file = "l.csv"}]
[[history]]
previous = "first.toml"
effect_files = {own = "own.py"}
[work_offsets_mm]
G54 = [0, 0, 0]
[[history]]
previous = "second.toml"
[tools.1]
name = "part.stl"
"""


def test_every_path_is_moved(tmp_path):
    old, new = tmp_path / "job.toml", tmp_path / "sub"
    old.write_text(ALL_PATHS)
    text = moved_text(ALL_PATHS, tmp_path, new, file=old)
    said = tomllib.loads(text)
    assert "# the old one" in text
    assert said["machine"] == "../machine.toml" and said["program"] == '../part "1".nc'
    assert (said["nominal"], said["measured"]) == ("../part.stl", "../points.csv")
    assert said["control"]["subprograms"] == "../subs"
    assert said["stock"]["file"] == "../blank.stl" and said["drawing"]["logo"] == "../logo.png"
    assert said["measurements"][0]["file"] == "../l.csv"
    assert [step["previous"] for step in said["history"]] == ["../first.toml", "../second.toml"]
    assert said["history"][0]["effect_files"] == {"own": "../own.py"}
    assert said["tools"]["1"]["name"] == "part.stl"


def test_a_blank_of_the_same_name_elsewhere_is_not_taken(tmp_path):
    job = write_job(tmp_path)
    write_nominal_stl(tmp_path / "blank.stl")
    text = job.read_text()
    box = text[text.index("[stock]") : text.index("[tools.1]")]
    job.write_text('stock = {file = "blank.stl"}\n' + text.replace(box, ""))
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "blank.stl").write_text("another")
    made, _ = set_values(job, ["backlash:X.reversal_um=2"], out=tmp_path / "sub" / "x.toml")
    assert read_job(made).blank.file.resolve() == tmp_path / "blank.stl"


MORE = """
[effects.backlash.Y]
reversal_um = 2

[[fitted]]
effect = "backlash"
target = "Y"
one_sigma = [{reversal_um = 0.1}]

[[history]]
previous = "job.toml"
"""


@pytest.mark.parametrize(
    "inline",
    [
        "effects = {}\n",
        "effects = {backlash = {X = {reversal_um = 1}}}\n",
        "effects.backlash.X.reversal_um = 1\n",
        "history = []\nfitted = []\n",
        'history = [{previous = "a.toml"}]\nfitted = [{effect = "scale", one_sigma = []}]\n',
        "[effects]\nbacklash = {X = {reversal_um = 1}}\n",
        "[effects]\nbacklash.X.reversal_um = 1\n",
        "[effects]\n[effects.backlash]\nX = {reversal_um = 1}\n",
    ],
)
def test_tables_that_are_inline_grow(tmp_path, inline):
    job = tmp_path / "job.toml"
    job.write_text(f"{inline}[tools.1]  # the first\nlength_mm = 3\n")
    before = tomllib.loads(job.read_text())
    text = with_tables(job.read_text(), MORE, file=job)
    after = tomllib.loads(text)
    assert after["effects"]["backlash"]["Y"] == {"reversal_um": 2}
    there = before.get("effects", {}).get("backlash", {})
    assert {k: v for k, v in after["effects"]["backlash"].items() if k != "Y"} == there
    for key in ("fitted", "history"):
        assert after[key][:-1] == before.get(key, [])
    assert "# the first" in text


@pytest.mark.parametrize(
    "inline",
    [
        "effects = {backlash = {X = {reversal_um = 1}}}\n",
        "effects.backlash.X.reversal_um = 1\n",
        "history = []\nfitted = []\neffects = {}\n",
    ],
)
def test_values_are_set_where_effects_are_inline(tmp_path, inline):
    job = write_job(tmp_path)
    job.write_text(inline + job.read_text())
    made, _ = set_values(job, ["backlash:X.reversal_um=3", "backlash:Y.reversal_um=2"])
    assert read_job(made).effects["backlash"] == {"X": {"reversal_um": 3}, "Y": {"reversal_um": 2}}


def test_errors_of_a_machine_may_be_inline(tmp_path):
    job = write_job(tmp_path, {"ECX": (lambda x: 0.02 * x, None)})
    machine = tmp_path / "machine.toml"
    table = '[errors.ECX]\ntable = "errors/ECX.csv"\n'
    text = machine.read_text()
    assert table in text
    inline = 'errors = {ECX = {table = "errors/ECX.csv"}}\n'
    machine.write_text(inline + text.replace(table, ""))
    made, _ = set_values(job, [f"ECY={tmp_path / 'errors' / 'ECX.csv'}"])
    assert set(read_job(made).machine.components) == {"ECX", "ECY"}


def test_what_is_wrong_in_the_old_job_is_told_with_its_line(tmp_path):
    job = write_job(tmp_path, more="[effects.backlash.X]\nreversal_um = 1e9\n")
    before = sorted(tmp_path.glob("[!.]*"))
    with pytest.raises(InputError, match=r"job\.toml:15: reversal_um = 1000000000"):
        set_values(job, ["backlash:Y.reversal_um=3"])
    assert sorted(tmp_path.glob("[!.]*")) == before


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("backlash:Y.reversal_um=nan", "'nan' is no number"),
        ("backlash:Y.reversal_um=1_0", "'1_0' is no number"),
        ("backlash:Y.reversal=3", "no parameter 'reversal'"),
        ("backlash:Y.reversal_um=1e9", "out of bounds"),
        ("backlach:Y.reversal_um=3", "unknown effect"),
    ],
)
def test_the_word_that_cannot_be_set_is_quoted(tmp_path, word, said):
    with pytest.raises(InputError) as caught:
        set_values(write_job(tmp_path), [word])
    assert str(caught.value).startswith(f"'{word}': ") and said in str(caught.value)
    assert not Path(tmp_path / "job-2.toml").exists()
