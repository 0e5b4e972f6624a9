"""Files that change are noticed once, when they rest, and also while they are being read."""

import os
import shutil
import time

from tests.unit.workbench.conftest import Page, replace
from vmach.workbench.file_watch import FileWatch
from vmach.workbench.model.named_files import named_files


def write(path, text, at_ns):
    path.write_text(text)
    os.utime(path, ns=(at_ns, at_ns))


def test_a_file_counts_as_changed_when_it_rests(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now - 5 * 10**9)
    watch.watch([file], since_ns=now - 10**9)
    assert watch.changed() == [] and watch.changed() == []
    write(file, "", now)  # emptied, and not yet written
    assert watch.changed() == []
    write(file, "G1 X1", now)
    assert watch.changed() == []
    assert watch.changed() == [file]
    assert watch.changed() == []
    file.unlink()
    assert [watch.changed(), watch.changed(), watch.changed()] == [[], [file], []]


def test_a_file_that_changed_while_it_was_read_is_read_again(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now - 10**8)
    watch.watch([file], since_ns=now - 10**9)
    assert [watch.changed(), watch.changed(), watch.changed()] == [[], [file], []]


def test_a_time_to_come_is_no_change(tmp_path):
    file, watch, now = tmp_path / "a.nc", FileWatch(), time.time_ns()
    write(file, "G0", now + 10**12)
    watch.watch([file], since_ns=now)
    assert [watch.changed(), watch.changed()] == [[], []]


def test_the_file_that_has_the_error_is_watched_also_one_that_is_absent(measured_folder, tmp_path):
    folder = tmp_path / "job"
    shutil.copytree(measured_folder, folder, symlinks=True)
    good, program = (folder / "part.nc").read_text(), folder / "part.nc"
    program.write_text(good.replace("G1 Z-8", "G1 Z#"))
    page = Page(folder / "job.toml")
    with page.client:
        assert page.get("/api/about").status_code == 400
        revision = page.get("/api/state").json()["revision"]
        program.unlink()
        revision = page.wait_for_revision(revision)
        assert page.get("/api/about").status_code == 400
        replace(program, good)
        page.wait_for_revision(revision)
        assert page.get("/api/about").status_code == 200


def test_files_are_named_by_a_job_and_by_its_machine(measured_folder, tmp_path):
    found = {path.name for path in named_files(measured_folder / "job.toml")}
    assert {"job.toml", "machine.toml", "part.nc", "points.csv", "EXX.csv"} <= found
    broken = tmp_path / "broken.toml"
    broken.write_text("[[history]\n")
    assert named_files(broken) == [broken]
    assert named_files(tmp_path / "absent.toml") == [tmp_path / "absent.toml"]
