"""Comparing a part with a file of measured points that cannot be its own is refused, too."""

import pytest

from tests.small_job import write_job
from vmach.errors import InputError
from vmach.run.pipeline import machine_part


def compare(folder, change):
    job = write_job(folder)
    header, *rows = (folder / "points.csv").read_text().splitlines()
    rows = [",".join(cells) for cells in change([row.split(",") for row in rows])]
    (folder / "points.csv").write_text("\n".join([header, *rows]) + "\n")
    return machine_part(job, prefer_measured=True)


def inside_out(rows):
    return [[*r[:5], *(repr(-float(c)) for c in r[5:8]), *r[8:]] for r in rows]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda rows: rows[:5], r"points\.csv: 5 measured points"),
        (inside_out, r"points\.csv: the program cuts 0 of .* turned round"),
        (lambda rows: [[*r[:11], "5000"] for r in rows], r"points\.csv: u_um is 5000 um"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, change, message):
    with pytest.raises(InputError, match=message):
        compare(tmp_path, change)


def test_a_sound_file_is_compared(tmp_path):
    assert len(compare(tmp_path, lambda rows: rows).points.line) > 60
