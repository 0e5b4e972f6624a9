"""Nothing half-written is left, whatever goes wrong."""

import pytest

from tests.report_case import points, run
from vmach.errors import InputError
from vmach.files.atomic import atomic_file, atomic_folder, check_outputs
from vmach.report import write_summary


def test_new_folder_appears_whole_with_its_parents(tmp_path):
    with atomic_folder(tmp_path / "a" / "b") as folder:
        (folder / "x.txt").write_text("x")
        (folder / "sub").mkdir()
        (folder / "sub" / "y.txt").write_text("y")
        assert not (tmp_path / "a").exists()
    assert (tmp_path / "a" / "b" / "sub" / "y.txt").read_text() == "y"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_existing_folder_keeps_other_files(tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "old.txt").write_text("old")
    (out / "x.txt").write_text("before")
    with atomic_folder(out) as folder:
        (folder / "x.txt").write_text("after")
    assert (out / "old.txt").read_text() == "old"
    assert (out / "x.txt").read_text() == "after"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
@pytest.mark.parametrize("exists", [True, False])
def test_interrupted_folder_leaves_nothing(tmp_path, error, exists):
    out = tmp_path / "out"
    if exists:
        out.mkdir()
        (out / "x.txt").write_text("before")
    with pytest.raises(error), atomic_folder(out) as folder:
        (folder / "x.txt").write_text("half")
        raise error
    assert out.exists() == exists
    assert [path.name for path in tmp_path.rglob("*")] == (["out", "x.txt"] if exists else [])
    assert not exists or (out / "x.txt").read_text() == "before"


def test_interrupted_file_leaves_the_old_one(tmp_path):
    path = tmp_path / "x.json"
    path.write_text("before")
    with pytest.raises(RuntimeError), atomic_file(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_a_record_that_cannot_be_written_leaves_no_summary(tmp_path):
    with pytest.raises(TypeError):
        write_summary(tmp_path / "s.json", points(5), run(facts={"Machine": object()}))
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "out").write_text("")
    with pytest.raises(InputError, match="is a file"), atomic_folder(tmp_path / "out"):
        pass
    with pytest.raises(InputError, match="is a file"), atomic_folder(tmp_path / "out" / "in"):
        pass
    with pytest.raises(InputError, match="does not exist"), atomic_file(tmp_path / "no" / "x"):
        pass


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "real.csv").write_text("before")
    (tmp_path / "link.csv").symlink_to("real.csv")
    with atomic_file(tmp_path / "link.csv") as temporary:
        temporary.write_text("after")
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "real.csv").read_text() == "after"


def test_a_device_or_a_folder_is_never_replaced(tmp_path):
    with pytest.raises(InputError, match="is a device"), atomic_file("/dev/null"):
        pass
    with pytest.raises(InputError, match="is a folder"), atomic_file(tmp_path):
        pass


def test_outputs_replace_neither_an_input_nor_each_other(tmp_path):
    (tmp_path / "job.toml").write_text("")
    (tmp_path / "link").symlink_to("job.toml")
    inputs = [tmp_path / "job.toml"]
    check_outputs([tmp_path / "a", None, tmp_path / "b"], inputs=inputs)
    for outputs, message in (
        ([tmp_path / "job.toml"], "is read by this command"),
        ([tmp_path / "link"], "is read by this command"),
        ([tmp_path / "a", tmp_path / "." / "a"], "two results have this name"),
        ([tmp_path / "no" / "a"], "does not exist"),
    ):
        with pytest.raises(InputError, match=message):
            check_outputs(outputs, inputs=inputs)
