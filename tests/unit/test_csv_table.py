"""CSV by compiled code: the text of Python's csv module, to the character."""

import csv
import io
from types import SimpleNamespace

import numpy as np
import pytest

from vmach.files import csv_table
from vmach.files.csv_table import fixed, rounded, whole, words, write_csv

RNG = np.random.default_rng(5)
#: sizes of all orders, ties of the rounding, zeros of both signs, what has no digits
AWKWARD = np.array([
    0.0, -0.0, 0.5, -0.5, 1.5, 2.5, 0.125, 0.375, 1e-9, -1e-9, 5e-7, 4.9999995e-7, 9.9999995, 1e-4,
    9.99e-5, 1.2e-5, -1e-6, 123456.7891, 1e14, 1e15, 1e16, -1e22, 1e300, np.inf, -np.inf, np.nan,
    0.1 + 0.2, 2.675, 1.005, 999999.9999995, 0.99995,
])  # fmt: skip
NUMBERS = np.concatenate([
    AWKWARD, RNG.normal(size=400) * 10.0 ** RNG.integers(-9, 12, 400),
    RNG.integers(-10**7, 10**7, 400) / 2e3, RNG.integers(-10**6, 10**6, 200) / 2e6,
])  # fmt: skip


def text_of(columns):
    file = io.BytesIO()
    write_csv(file, columns)
    return file.getvalue().decode()


def text_of_csv_module(heading, rows):
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(heading)
    writer.writerows(rows)
    return file.getvalue()


@pytest.mark.parametrize("decimals", [0, 1, 3, 4, 6])
def test_fixed_numbers_are_those_of_format(decimals):
    rows = [[f"{x:.{decimals}f}"] for x in NUMBERS.tolist()]
    assert text_of({"a": fixed(NUMBERS, decimals)}) == text_of_csv_module(["a"], rows)


@pytest.mark.parametrize("decimals", [1, 3, 4, 6])
def test_rounded_numbers_are_those_of_repr(decimals):
    rows = [[x] for x in NUMBERS.round(decimals).tolist()]
    assert text_of({"a": rounded(NUMBERS, decimals)}) == text_of_csv_module(["a"], rows)


def test_words_are_quoted_where_they_hold_what_divides_cells(monkeypatch):
    monkeypatch.setattr(csv_table, "_ROWS", 3)  # in several parts
    names = ["plain", 'quote"', "comma,", "line\nfeed", "é µm", "", "last"]
    numbers = np.arange(7) - 3
    shown = numbers % 2 == 0
    columns = {
        "na,me": words(names),
        "n": whole(numbers, shown=shown),
        "x": fixed(numbers / 3.0, 2, shown=shown),
        "state": words(["cut", "un,cut"], numbers % 2),
    }
    rows = [
        [name, n if s else "", f"{n / 3:.2f}" if s else "", ["cut", "un,cut"][n % 2]]
        for name, n, s in zip(names, numbers.tolist(), shown, strict=True)
    ]
    assert text_of(columns) == text_of_csv_module(columns, rows)


def test_a_table_without_rows_has_its_heading():
    assert text_of({"a": fixed(np.zeros(0), 3), "b": words([])}) == "a,b\n"


def test_whole_columns_of_a_prediction_are_made_once(monkeypatch):
    """Every property of a prediction is asked a fixed number of times, however many the points."""
    from stock import EdgeStatus
    from vmach.run import results

    class Counted:
        asked = 0

        def __init__(self, count):
            self.status = np.full(count, EdgeStatus.CUT, np.uint8)
            self.deviation_mm, self.variant = np.linspace(0, 1, count), "abbe"
            self.edges = SimpleNamespace(status=self.status)
            self.states = SimpleNamespace(line=np.arange(count), tool=np.arange(count),
                                          time_s=np.arange(count) / 7)  # fmt: skip

        @property
        def is_cut(self):
            Counted.asked += 1
            return self.status == EdgeStatus.CUT

    monkeypatch.setattr(results, "prediction_u_mm", lambda found: found.deviation_mm / 3)
    asked = []
    for count in (3, 300):
        Counted.asked = 0
        columns = results.prediction_columns(_points(count), Counted(count))
        results.write_columns(io.StringIO(), columns)
        asked.append(Counted.asked)
    assert asked[0] == asked[1]


def _points(count):
    from vmach.nominal.points import SurfacePoints

    normal = np.tile([0.0, 0.0, 1.0], (count, 1))
    ids = np.arange(count).astype(str)
    return SurfacePoints(ids, ids, np.zeros((count, 3)), normal)
