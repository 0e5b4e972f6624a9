"""A number of a job file has one spelling: of two, neither is taken silently."""

import pytest

from tests.small_job import write_job
from vmach.checkup import check_job
from vmach.errors import InputError
from vmach.job import read_job

TOOL = 'shape = "flat"\ndiameter_mm = 12\nlength_mm = 90\n'


@pytest.mark.parametrize("spelling", ["01", '" 1"', '"+1"', '"1.0"'])
def test_a_tool_that_is_named_twice(tmp_path, spelling):
    path = write_job(tmp_path, more=f"[tools.{spelling}]\n{TOOL}")
    with pytest.raises(InputError, match=r"job\.toml:14: tool 1 is named twice"):
        read_job(path)
    assert any("tool 1 is named twice" in str(finding) for finding in check_job(path))


@pytest.mark.parametrize(
    ("tool", "message"),
    [
        ('shape = "profile"', "profile tool lacks profile_mm"),
        (
            'shape = "profile"\nangle_deg = 90\nprofile_mm = [[0, 0], [2, 3], [2, 9]]',
            "angle_deg does nothing for a profile tool; accepted: diameter_mm, length_mm, prof",
        ),
        (
            'shape = "flat"\nprofile_mm = [[0, 0], [2, 3], [2, 9]]',
            "profile_mm does nothing for a flat tool",
        ),
    ],
)
def test_a_dimension_that_does_nothing_for_a_shape(tmp_path, tool, message):
    path = write_job(tmp_path, more=f"[tools.2]\n{tool}\ndiameter_mm = 4\nlength_mm = 90\n")
    with pytest.raises(InputError, match=rf"job\.toml:14: tool 2: {message}"):
        read_job(path)


def test_a_work_offset_with_a_point_stands_in_quotes(tmp_path):
    path = write_job(tmp_path)
    text = path.read_text()
    path.write_text(text.replace("G54 =", "G59.1 ="))
    with pytest.raises(InputError, match=r'quotes around the point: "G59\.1" = \[x, y, z\]'):
        read_job(path)
    path.write_text(text.replace("G54 =", '"G59.1" ='))
    assert list(read_job(path).work_offsets_mm) == ["G59.1"]


def test_an_offset_that_is_named_twice(tmp_path):
    row = "[offsets.{}]\nlength_mm = 1\n"
    path = write_job(tmp_path, more=row.format(2) + row.format("02") + row.format(3))
    with pytest.raises(InputError, match=r"job\.toml:16: offset 2 is named twice"):
        read_job(path)


def test_another_spelling_alone_counts(tmp_path):
    path = write_job(tmp_path, more=f"[tools.02]\n{TOOL}")
    assert sorted(read_job(path).tools) == [1, 2]
