"""Nothing half-written is left, whatever goes wrong."""

import errno
import fcntl
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.report_case import points, run
from vmach.errors import InputError
from vmach.files import workplace, written_files
from vmach.files.atomic import (
    NameTakenError,
    atomic_file,
    atomic_folder,
    check_folder,
    check_outputs,
    write_under_free_name,
)
from vmach.files.together import together
from vmach.files.written_files import FILES_LIST, RESULTS_LIST, files_in
from vmach.report import write_summary


def test_new_folder_appears_whole_with_its_parents(tmp_path):
    with atomic_folder(tmp_path / "a" / "b") as folder:
        (folder / "x.txt").write_text("x")
        (folder / "sub").mkdir()
        (folder / "sub" / "y.txt").write_text("y")
        assert not (tmp_path / "a").exists()
    assert (tmp_path / "a" / "b" / "sub" / "y.txt").read_text() == "y"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def fill(out, **texts):
    with atomic_folder(out) as folder:
        for name, text in texts.items():
            (folder / f"{name}.txt").write_text(text)


def contents(folder):
    return {path.relative_to(folder).as_posix(): path.read_text() for path in files_in(folder)}


def test_existing_folder_keeps_other_files(tmp_path):
    out = tmp_path / "out"
    fill(out, x="before", old="old")
    (out / "user").mkdir()
    (out / "user" / "notes").write_text("a user's")
    (out / "link").symlink_to("old.txt")
    fill(out, x="after")
    kept = {"old.txt": "old", "x.txt": "after", "user/notes": "a user's", "link": "old"}
    assert contents(out) == kept
    assert (out / "link").is_symlink()
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    fill(out, old="new")  # still known after a run that did not write it
    assert contents(out) == kept | {"old.txt": "new", "link": "new"}


def test_what_vmach_wrote_is_known_to_sha256sum(tmp_path):
    fill(tmp_path / "out", x="x", y="y")
    check = ["sha256sum", "--check", "--strict", RESULTS_LIST]
    assert subprocess.run(check, cwd=tmp_path / "out", capture_output=True).returncode == 0


def test_a_folder_with_files_of_others_is_no_place_for_results(tmp_path, monkeypatch):
    (tmp_path / "thesis.txt").write_text("")
    with pytest.raises(InputError, match=r"holds 'thesis.txt', which vmach did not write"):
        fill(tmp_path, x="x")
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    for folder in (".", ".."):
        with pytest.raises(InputError, match="is the current folder, or holds it"):
            fill(folder, x="x")
    with pytest.raises(InputError, match="file system is mounted"):
        fill("/proc", x="x")


def test_a_file_that_vmach_did_not_write_stays(tmp_path):
    out = tmp_path / "out"
    fill(out, x="before", y="before")
    (out / "x.txt").write_text("edited by its user")
    (out / "sub").mkdir()
    (out / "sub" / "z.txt").write_text("a user's")
    before = contents(out)
    for names in (["x.txt"], ["y.txt", "sub"]):
        with pytest.raises(InputError, match="vmach did not write it, or it was changed since"):
            check_folder(out, names)
    with pytest.raises(InputError, match=r"x\.txt: is there already"):
        fill(out, x="after", y="after")
    (tmp_path / "single").write_text("a user's")
    with pytest.raises(InputError, match="single: is there already"):
        write(tmp_path / "single", "after")
    assert contents(out) == before
    assert (tmp_path / "single").read_text() == "a user's"


def write(path, text):
    with atomic_file(path) as temporary:
        temporary.write_text(text)


def test_a_single_result_may_be_made_again(tmp_path):
    for text in ("one", "two", "two"):
        check_outputs([tmp_path / "x.csv"])
        write(tmp_path / "x.csv", text)
        write(tmp_path / "y.csv", text)
    assert contents(tmp_path) == {"x.csv": "two", "y.csv": "two"}


def test_single_results_are_known_to_sha256sum(tmp_path):
    for text in ("first", "second"):
        with atomic_file(tmp_path / "a.csv") as file:
            file.write_text(text)
    (tmp_path / "b.csv").write_text("a user's")
    check = ["sha256sum", "--check", "--strict", "--ignore-missing", FILES_LIST]
    said = subprocess.run(check, cwd=tmp_path, capture_output=True, text=True)
    assert "improperly formatted" not in said.stderr


def test_single_results_do_not_make_a_folder_one_of_users(tmp_path):
    write(tmp_path / "x.csv", "x")
    (tmp_path / "job.toml").write_text("a user's")
    with pytest.raises(InputError, match=r"holds 'job\.toml'"):
        fill(tmp_path, y="y")


def test_a_full_disk_names_the_result(tmp_path):
    for place in (atomic_file(tmp_path / "x"), atomic_folder(tmp_path / "x")):
        with pytest.raises(OSError, match="No space") as caught, place:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        assert caught.value.filename == str(tmp_path / "x")
    with pytest.raises(OSError, match="No space") as caught, atomic_folder(tmp_path / "x") as out:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(out / "sub" / "y"))
    assert caught.value.filename == str(tmp_path / "x" / "sub" / "y")


_WRITER = """
import sys, time
from pathlib import Path
from vmach.files.atomic import atomic_file, atomic_folder

print("ready", flush=True)
for count in range(10**9):
    with atomic_folder(sys.argv[1]) as folder:
        for name in range(8):
            (folder / f"{name}.txt").write_text(str(count))
    with atomic_file(sys.argv[1] + ".csv") as temporary:
        temporary.write_text(str(count))
"""


def test_a_kill_leaves_one_whole_result(tmp_path, monkeypatch):
    """Killed at a dozen moments: all files of the folder come from one run, the user's stays."""
    out = tmp_path / "out"
    fill(out, **{str(name): "0" for name in range(8)})
    (out / "notes").write_text("a user's")
    rng = random.Random(1)
    for _ in range(12):
        command = [sys.executable, "-c", _WRITER, str(out)]
        writer = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        writer.stdout.readline()
        time.sleep(rng.uniform(0.0, 0.05))
        writer.kill()
        writer.wait()
        writer.stdout.close()
        texts = contents(out)
        assert texts.pop("notes") == "a user's"
        assert len(texts) == 8
        assert len(set(texts.values())) == 1
    monkeypatch.setattr(workplace, "_PATIENCE_S", 0.0)  # some were killed before they had a lock
    fill(out, **{str(name): "last" for name in range(8)})  # what is known may be replaced
    write(tmp_path / "out.csv", "last")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"out", "out.csv", FILES_LIST}  # and what the killed left is swept


def test_without_an_exchange_a_folder_set_aside_is_put_back(tmp_path, monkeypatch):
    monkeypatch.setattr(workplace, "_exchange_at_once", lambda first, second: False)
    out = tmp_path / "out"
    fill(out, x="one")
    fill(out, x="two")
    assert contents(out) == {"x.txt": "two"}
    killed = tmp_path / ".out.vmach-killed"
    killed.mkdir()
    (killed / "lock").write_text("")
    out.rename(killed / "aside")
    check_folder(out, ["x.txt"])
    assert contents(out) == {"x.txt": "two"}
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_folder_at_work_is_not_swept(tmp_path):
    with workplace.workplace(tmp_path / "out") as first:
        with workplace.workplace(tmp_path / "out") as second:
            assert first != second
        assert first.exists()


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt])
@pytest.mark.parametrize("exists", [True, False])
def test_interrupted_folder_leaves_nothing(tmp_path, error, exists):
    out = tmp_path / "out"
    if exists:
        fill(out, x="before")
    with pytest.raises(error), atomic_folder(out) as folder:
        (folder / "x.txt").write_text("half")
        raise error
    assert out.exists() == exists
    assert [path.name for path in files_in(tmp_path)] == (["x.txt"] if exists else [])
    assert not exists or (out / "x.txt").read_text() == "before"


def test_interrupted_file_leaves_the_old_one(tmp_path):
    path = tmp_path / "x.json"
    write(path, "before")
    with pytest.raises(RuntimeError), atomic_file(path) as temporary:
        temporary.write_text("half")
        raise RuntimeError
    assert path.read_text() == "before"
    assert list(files_in(tmp_path)) == [path]


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
    write(tmp_path / "real.csv", "before")
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


@pytest.mark.parametrize("name", ["--no-page", "-"])
def test_an_option_is_no_name_of_a_result(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    for check in (lambda: check_outputs([Path(name)]), lambda: check_folder(Path(name), ["x"])):
        with pytest.raises(InputError, match=f"'{name}' stands where the name of a result"):
            check()
    check_outputs([tmp_path / name])
    assert not list(tmp_path.iterdir())


def test_results_of_an_earlier_run_do_not_stay_beside_new_ones(tmp_path):
    out = tmp_path / "out"
    fill(out, x="one", y="one", z="one")
    (out / "notes").write_text("a user's")
    with atomic_folder(out, replaced=["x.txt", "y.txt"]) as folder:
        (folder / "x.txt").write_text("two")
    assert contents(out) == {"x.txt": "two", "z.txt": "one", "notes": "a user's"}


def test_a_changed_result_of_an_earlier_run_stays(tmp_path):
    out = tmp_path / "out"
    fill(out, x="one", y="one")
    (out / "y.txt").write_text("edited by its user")
    with atomic_folder(out, replaced=["x.txt", "y.txt"]) as folder:
        (folder / "x.txt").write_text("two")
    assert contents(out) == {"x.txt": "two", "y.txt": "edited by its user"}


_PAIR_WRITER = """
import os, sys
from pathlib import Path
from vmach.files.atomic import atomic_file, atomic_folder
from vmach.files.together import together

place, text, last = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
count = 0

def dies(do):
    def done(*arguments, **keywords):
        global count
        count += 1
        if count > last:
            os._exit(9)
        return do(*arguments, **keywords)
    return done

with together():
    with atomic_file(place / "part.nc") as temporary:
        temporary.write_text(text)
    with atomic_file(place / "report.html") as temporary:
        temporary.write_text(text)
    if sys.argv[4] == "folder":
        with atomic_folder(place / "out") as folder:
            (folder / "page.html").write_text(text)
    for name in ("rename", "replace", "link", "unlink", "rmdir"):
        setattr(os, name, dies(getattr(os, name)))
    from vmach.files import workplace
    workplace._exchange_at_once = dies(workplace._exchange_at_once)
"""


@pytest.mark.parametrize("kind", ["files", "folder"])
def test_a_kill_between_any_two_steps_leaves_no_mixture(tmp_path, kind, monkeypatch):
    """Dies before every step of the system that moves, links or removes a file, one run each."""
    monkeypatch.setattr(workplace, "_PATIENCE_S", 0.0)
    seen = set()
    for last in range(40):
        place = tmp_path / str(last)
        place.mkdir()
        for text, steps in (("old", 999), ("new", last)):
            command = [sys.executable, "-c", _PAIR_WRITER, str(place), text, str(steps), kind]
            status = subprocess.run(command).returncode
        texts = {text for name, text in contents(place).items() if ".vmach-" not in name}
        assert len(texts) == 1, (last, contents(place))
        seen |= texts
        with together():  # what is known may be replaced
            write(place / "part.nc", "last")
            write(place / "report.html", "last")
        assert (place / "report.html").read_text() == "last"
        if status == 0:
            break
    assert status == 0
    assert seen == {"old", "new"}


def test_an_error_in_a_block_of_results_leaves_all_as_they_were(tmp_path):
    for name in "ab":
        write(tmp_path / name, "old")
    with pytest.raises(RuntimeError), together():
        write(tmp_path / "a", "new")
        write(tmp_path / "c", "new")
        raise RuntimeError
    assert contents(tmp_path) == {"a": "old", "b": "old"}


def test_a_result_that_cannot_take_its_place_leaves_the_others(tmp_path, monkeypatch):
    for name in "ab":
        write(tmp_path / name, "old")
    replace = os.replace

    def full(source, target):
        if str(target) == str(tmp_path / "a"):
            raise OSError(errno.EIO, os.strerror(errno.EIO), str(source))
        replace(source, target)

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="Input/output"), together():
        write(tmp_path / "a", "new")
        write(tmp_path / "b", "new")
    assert contents(tmp_path) == {"a": "old", "b": "old"}


AT_ONCE = """
import sys
from pathlib import Path
from vmach.files.atomic import atomic_file, atomic_folder
from vmach.files.together import together

place, who = Path(sys.argv[1]), sys.argv[2]
for k in range(40):
    with together():
        for name in ("first", "second"):
            with atomic_file(place / name) as file:
                file.write_text(f"{who}{k}")
        with atomic_folder(place / "out") as folder:
            (folder / "third").write_text(f"{who}{k}")
"""


def test_runs_at_once_leave_the_results_of_one(tmp_path):
    runs = [
        subprocess.Popen([sys.executable, "-c", AT_ONCE, tmp_path, who], stderr=subprocess.PIPE)
        for who in ("a", "b", "c")
    ]
    assert [run.communicate()[1].decode() for run in runs] == [""] * 3
    places = [tmp_path / name for name in ("first", "second", "out/third")]
    assert len({place.read_text() for place in places}) == 1
    check_outputs(places[:2])  # all are known
    check_folder(tmp_path / "out", ["third"])


NEW_AT_ONCE = """
import sys
from pathlib import Path
from vmach.files.atomic import write_under_free_name
from vmach.files.job_name import free_job_name

for k in range(20):
    text = f"{sys.argv[2]}{k}"
    path = write_under_free_name(lambda: free_job_name(Path(sys.argv[1])), text.encode())
    print(path, text)
"""


def test_runs_at_once_that_choose_a_free_name_each_get_one(tmp_path):
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", NEW_AT_ONCE, tmp_path / "job.toml", who],
            stdout=subprocess.PIPE, text=True,
        )
        for who in "abc"
    ]  # fmt: skip
    told = [line.split() for run in runs for line in run.communicate()[0].splitlines()]
    assert [run.returncode for run in runs] == [0] * 3
    assert len({path for path, _ in told}) == 60
    assert all(Path(path).read_text() == text for path, text in told)


def no_links(*_):
    raise OSError(errno.EPERM, os.strerror(errno.EPERM))


@pytest.mark.parametrize("has_links", [True, False])
def test_a_new_file_leaves_what_comes_while_it_is_written(tmp_path, monkeypatch, has_links):
    """Also where a program comes that knows no locks, and where a file system has no links."""
    if not has_links:
        monkeypatch.setattr(os, "link", no_links)
    with atomic_file(tmp_path / "free", is_new=True) as temporary:
        temporary.write_text("new")
    with pytest.raises(NameTakenError), atomic_file(tmp_path / "a", is_new=True) as temporary:
        temporary.write_text("new")
        (tmp_path / "a").write_text("another's")
    monkeypatch.setattr(os.path, "lexists", lambda path: False)
    with pytest.raises(NameTakenError), together():
        for name in ("b", "c", "a"):
            with atomic_file(tmp_path / name, is_new=True) as temporary:
                temporary.write_text("new")
    assert contents(tmp_path) == {"free": "new", "a": "another's"}


def test_another_name_is_chosen_where_the_first_was_taken(tmp_path):
    names = iter([tmp_path / "a", tmp_path / "b"])
    (tmp_path / "a").write_text("another's")
    assert write_under_free_name(lambda: next(names), b"new") == tmp_path / "b"
    assert contents(tmp_path) == {"a": "another's", "b": "new"}


def test_a_result_that_two_runs_replace_while_it_is_read_is_known(tmp_path, monkeypatch):
    """The second of them forgets what the first replaced; the reader has that in its hands."""
    result = tmp_path / "x.csv"
    write(result, "old")
    digest_of = written_files._sum

    def read_slowly(path):
        digest = digest_of(path)
        if path.read_text() == "old":
            with monkeypatch.context() as others:
                others.setattr(written_files, "_sum", digest_of)
                write(result, "first")
                write(result, "second")
        return digest

    monkeypatch.setattr(written_files, "_sum", read_slowly)
    check_outputs([result])
    assert result.read_text() == "second"
    result.write_text("a user's")
    with pytest.raises(InputError, match="vmach did not write it"):
        check_outputs([result])


def test_nobody_begins_to_work_in_a_folder_that_is_cleared(tmp_path, monkeypatch):
    """A run that has made its folder, and not yet locked it, is not cleared away after it has."""
    left = tmp_path / ".result.vmach-left"
    left.mkdir()
    (left / "lock").touch()
    seen, clear = [], workplace._clear

    def clear_it(folder):
        if folder == left:
            other = os.open(folder / "lock", os.O_RDWR)
            with pytest.raises(BlockingIOError):
                fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
            os.close(other)
            seen.append(folder)
        clear(folder)

    monkeypatch.setattr(workplace, "_clear", clear_it)
    with workplace.workplace(tmp_path / "result"):
        pass
    assert seen == [left] and not left.exists()
