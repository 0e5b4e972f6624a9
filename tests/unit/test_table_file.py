"""Tables by the ending of their file: the same cells in every form."""

import csv

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.files import table_file
from vmach.files.csv_table import fixed, whole, words
from vmach.files.table_file import check_table_file, write_table

SHOWN = np.array([True, False, True])
COLUMNS = {
    "id": words(["a", "b,c", "µ"]),
    "x_um": fixed(np.array([1.5, 0.0, -2.25]), 3, shown=SHOWN),
    "line": whole(np.array([7, 0, 9]), shown=SHOWN),
    "state": words(["cut", "uncut"], np.array([0, 1, 0], np.uint8)),
}
CELLS = {"id": ["a", "b,c", "µ"], "x_um": [1.5, None, -2.25], "line": [7, None, 9],
         "state": ["cut", "uncut", "cut"]}  # fmt: skip


def test_csv(tmp_path):
    write_table(tmp_path / "t.csv", COLUMNS)
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = {name: [row[name] for row in rows] for name in CELLS}
    assert found["id"] == CELLS["id"]
    assert found["x_um"] == ["1.500", "", "-2.250"]
    assert found["line"] == ["7", "", "9"]


def test_npz(tmp_path):
    write_table(tmp_path / "t.npz", COLUMNS)
    with np.load(tmp_path / "t.npz", allow_pickle=False) as found:
        assert set(found) == set(CELLS)
        assert found["id"].tolist() == CELLS["id"]
        np.testing.assert_array_equal(found["x_um"], [1.5, np.nan, -2.25])
        assert found["line"].tolist() == [7, 0, 9]
        assert found["state"].tolist() == CELLS["state"]


def test_the_case_of_an_ending_does_not_matter(tmp_path):
    write_table(tmp_path / "t.NPZ", COLUMNS)
    with np.load(tmp_path / "t.NPZ", allow_pickle=False) as found:
        assert found["line"].tolist() == [7, 0, 9]
    write_table(tmp_path / "t", COLUMNS)
    assert (tmp_path / "t").read_text(encoding="utf-8").startswith("id,x_um,line,state")


def test_parquet(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    write_table(tmp_path / "t.parquet", COLUMNS)
    assert parquet.read_table(tmp_path / "t.parquet").to_pydict() == CELLS


def test_parquet_without_its_package_is_refused_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr(table_file, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="pyarrow"):
        check_table_file(tmp_path / "t.parquet")
    check_table_file(tmp_path / "t.npz")
    check_table_file(None)


def test_commands_take_the_ending(tmp_path, monkeypatch, capsys):
    from tests.golden.test_bad_input import run_vmach
    from tests.small_job import write_job

    job = write_job(tmp_path, {"EXX": (lambda x: x / 50, (0, 0, -100))})
    for ending in ("csv", "npz"):
        status, *_ = run_vmach(monkeypatch, capsys, "path", job, "-o", tmp_path / f"t.{ending}")
        assert status == 0
    with (tmp_path / "t.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    with np.load(tmp_path / "t.npz") as found:
        assert list(found) == list(rows[0])
        for name in found:
            assert [float(row[name]) for row in rows] == found[name].tolist()
